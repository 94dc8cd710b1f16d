"""Programs around printed functions: each reads rows of numbers, calls one and writes its results."""

from __future__ import annotations

from microfacet._export.file import Content, Tables, function_of, plain_file
from microfacet._export.graph import Graph
from microfacet._export.language import Language
from microfacet._export.languages import languages
from microfacet._export.printer import Function

__all__ = ["PREFIX", "calls", "compute_glsl", "content_of", "text_and_functions", "wrapped"]

PREFIX = "try_"
_DOMAINS = {"alpha": (0.0, 1.0), "gamma": (1.5, 100.0)}


def content_of(graphs: dict[str, Graph]) -> Content:
    """A file of these graphs."""
    return Content(PREFIX, graphs, {name: f"The case {name}." for name in graphs}, ["Cases."], _DOMAINS)


def text_and_functions(name: str, graphs: dict[str, Graph]) -> tuple[str, dict[str, Function]]:
    """The file in a language, and what its functions take and give."""
    language, content = languages()[name], content_of(graphs)
    tables = Tables(language, PREFIX)
    functions = {case: function_of(language, content, case, tables) for case in graphs}
    return plain_file(language, content), functions


def inputs_of(function: Function) -> int:
    """How many numbers a function takes."""
    return sum(count for _, _, count in function.parameters)


def outputs_of(function: Function) -> int:
    """How many numbers a function gives."""
    return sum(count for _, _, count in function.results)


def calls(language: Language, name: str, function: Function, read: str) -> tuple[str, str, list[str]]:
    """The call, the type of its value, and its components; {k} in `read` is the number of an argument."""
    arguments, k = [], 0
    for _, type_, count in function.parameters:
        reads = [read.format(k=k + i) for i in range(count)]
        k += count
        together = language.vector.format(type=type_, values=", ".join(reads))
        arguments.append(reads[0] if count == 1 else together)
    type_ = function.results[0][1] if len(function.results) == 1 else f"{PREFIX}{name}_result"
    outs = []
    for field, _, count in function.results:
        base = "r" if len(function.results) == 1 else f"r.{field}"
        outs += [base] if count == 1 else [f"{base}.{letter}" for letter in "xyzw"[:count]]
    return f"{PREFIX}{name}({', '.join(arguments)})", type_, outs


def wrapped(language: Language, functions: dict[str, Function], head: str) -> str:
    """C functions run_NAME(rows, results, count), for languages that look like C; `head` stands before."""
    parts = []
    for name, function in functions.items():
        call, type_, outs = calls(language, name, function, f"in[i * {inputs_of(function)} + {{k}}]")
        stores = "\n".join(f"    out[i * {len(outs)} + {j}] = {out};" for j, out in enumerate(outs))
        parts.append(
            f"{head}void run_{name}(const float *in, float *out, int count) {{\n"
            f"  for (int i = 0; i < count; ++i) {{\n    const {type_} r = {call};\n{stores}\n  }}\n}}\n"
        )
    return "\n".join(parts)


def compute_glsl(language: Language, name: str, function: Function, text: str) -> str:
    """A compute shader."""
    call, type_, outs = calls(language, name, function, f"numbers[i * {inputs_of(function)} + {{k}}]")
    stores = "\n".join(f"  results[i * {len(outs)} + {j}] = {out};" for j, out in enumerate(outs))
    return f"""#version 450
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) readonly buffer Numbers {{ float numbers[]; }};
layout(std430, set = 0, binding = 1) buffer Results {{ float results[]; }};
{text}
void main() {{
  int i = int(gl_GlobalInvocationID.x);
  if (i >= numbers.length() / {inputs_of(function)}) return;
  {type_} r = {call};
{stores}
}}
"""


def compute_hlsl(language: Language, name: str, function: Function, text: str) -> str:
    """A compute shader, also of Slang."""
    call, type_, outs = calls(language, name, function, f"numbers[i * {inputs_of(function)} + {{k}}]")
    stores = "\n".join(f"  results[i * {len(outs)} + {j}] = {out};" for j, out in enumerate(outs))
    return f"""{text}
[[vk::binding(0, 0)]] StructuredBuffer<float> numbers : register(t0);
[[vk::binding(1, 0)]] RWStructuredBuffer<float> results : register(u0);
[numthreads(64, 1, 1)]
void main(uint3 id : SV_DispatchThreadID) {{
  int i = int(id.x);
  {type_} r = {call};
{stores}
}}
"""


def compute_wgsl(language: Language, name: str, function: Function, text: str) -> str:
    """A compute shader."""
    call, _, outs = calls(language, name, function, f"numbers[i * {inputs_of(function)} + {{k}}]")
    stores = "\n".join(f"  results[i * {len(outs)} + {j}] = {out};" for j, out in enumerate(outs))
    return f"""{text}
@group(0) @binding(0) var<storage, read> numbers: array<f32>;
@group(0) @binding(1) var<storage, read_write> results: array<f32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
  let i = i32(id.x);
  if (i >= i32(arrayLength(&numbers)) / {inputs_of(function)}) {{ return; }}
  let r = {call};
{stores}
}}
"""


def fragment_es(language: Language, name: str, function: Function, text: str) -> str:
    """A fragment shader: one row of numbers a pixel, in a texture three texels of which are a pixel's."""
    call, type_, outs = calls(language, name, function, "numbers[{k}]")
    outs += ["0.0"] * (8 - len(outs))
    return f"""#version 300 es
{text}
precision highp sampler2D;
uniform sampler2D rows;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() {{
  ivec2 at = ivec2(gl_FragCoord.xy);
  float numbers[12];
  for (int k = 0; k < 3; ++k) {{
    vec4 four = texelFetch(rows, ivec2(3 * at.x + k, at.y), 0);
    numbers[4 * k] = four.x;
    numbers[4 * k + 1] = four.y;
    numbers[4 * k + 2] = four.z;
    numbers[4 * k + 3] = four.w;
  }}
  {type_} r = {call};
  first = vec4({", ".join(outs[:4])});
  second = vec4({", ".join(outs[4:])});
}}
"""


def osl_shader(name: str, function: Function) -> str:
    """A shader that calls the function and gives the sum of its results."""
    language = languages()["osl"]
    zeros = ", ".join("vector(0.5)" if count == 3 else "0.5" for _, _, count in function.parameters)
    parts = [field if count == 1 else f"dot({field}, {field})" for field, _, count in function.results]
    if len(function.results) == 1:
        type_ = function.results[0][1]
        body = [f"{type_} {function.results[0][0]} = {PREFIX}{name}({zeros});"]
    else:
        body = [f"{type_} {field} = 0;" for field, type_, _ in function.results]
        body += [f"{PREFIX}{name}({zeros}, {', '.join(field for field, _, _ in function.results)});"]
    assert language.out_several
    return (
        f"shader run_{name}(output float sum = 0) {{\n"
        + "\n".join([*body, f"sum = {' + '.join(parts)};"])
        + "\n}\n"
    )
