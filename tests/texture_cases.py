"""Programs around the snippets of lookup textures, and the compilers that are here to try them."""

from __future__ import annotations

import ctypes
import importlib.util
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import export_tools as tools
import microfacet as mf
import texture_shims as shims

SIZE = (12, 10)
KINDS = ("albedo", "energy", "split_sum")


@cache
def texture(kind: str, slices: int) -> Any:
    """A small one, of one image or of several slices."""
    if slices == 1:
        return mf.lookup_texture(kind, "ggx", size=SIZE, check=0)
    shape = [1 / x for x in (0.5, 0.4, 0.3)]
    return mf.lookup_texture(
        kind, "student_t", size=SIZE, shape=shape, check=0, cosine_mapping="sqrt", roughness_mapping="linear"
    )


def compile_glsl(snippets: str, text: str, folder: Path) -> None:
    head = "#version 450\nlayout(binding = 0) uniform sampler2D t;\nlayout(location = 0) out vec4 o;\n"
    (folder / "t.frag").write_text(head + snippets + text)
    tools.run(tools.program("glslangValidator"), "-V", folder / "t.frag", "-o", folder / "t.spv")
    tools.run(tools.program("spirv-val"), folder / "t.spv")


def compile_glsl_es(snippets: str, text: str, folder: Path) -> None:
    # No default precision: the snippet must say what it needs.
    head = "#version 300 es\nuniform highp sampler2D t;\nlayout(location = 0) out highp vec4 o;\n"
    text = text.replace("vec3 L", "highp vec3 L").replace("vec2 Q", "highp vec2 Q")
    (folder / "t.frag").write_text(head + snippets + text)
    tools.run(tools.program("glslangValidator"), folder / "t.frag")


def compile_hlsl(snippets: str, text: str, folder: Path) -> None:
    (folder / "t.hlsl").write_text(
        "Texture2D t : register(t0);\nSamplerState s : register(s0);\n" + snippets + text
    )
    flags = ["-D", "-V", "-S", "frag", "-e", "main"]
    tools.run(tools.program("glslangValidator"), *flags, folder / "t.hlsl", "-o", folder / "t.spv")


def compile_slang(snippets: str, text: str, folder: Path) -> None:
    (folder / "t.slang").write_text("Texture2D t;\nSamplerState s;\n" + snippets + text)
    for target in ("glsl", "hlsl", "wgsl", "metal"):
        stage = ["-entry", "main", "-stage", "fragment", "-target", target]
        tools.run(tools.slangc(), folder / "t.slang", *stage, "-o", folder / f"out.{target}")


def compile_wgsl(snippets: str, text: str, folder: Path) -> None:
    head = "@group(0) @binding(0) var t: texture_2d<f32>;\n@group(0) @binding(1) var s: sampler;\n"
    adapters(folder)[0].request_device_sync().create_shader_module(code=head + snippets + text)


def compile_cuda(snippets: str, text: str, folder: Path) -> None:
    (folder / "t.cu").write_text(snippets + text)
    flags = ["-std=c++17", "-arch=sm_90", "-Werror", "all-warnings", "-cubin"]
    tools.run(tools.nvcc(), *flags, folder / "t.cu", "-o", folder / "t.cubin")


def compile_c(snippets: str, text: str, folder: Path) -> None:
    (folder / "t.h").write_text(snippets)
    flags = ["-Wconversion", "-pedantic", "-O2", "-c", "-o", folder / "t.o"]
    for compiler, standard, ending in (
        ("gcc", "c99", "c"), ("clang", "c11", "c"), ("g++", "c++17", "cpp"),
    ):  # fmt: skip
        path = folder / f"t.{ending}"
        path.write_text(f'#include "t.h"\n{text}')
        tools.run(tools.program(compiler), f"-std={standard}", *tools.FLAGS, *flags, path)


def compile_metal(snippets: str, text: str, folder: Path) -> None:
    run_as_cpp("metal", snippets, text, (12, 10), folder)


def compile_osl(snippets: str, text: str, folder: Path) -> None:
    path, to = folder / "t.osl", folder / "t.oso"
    path.write_text(snippets + text)
    tools.compiled_osl(path, to)


def run_as_cpp(
    language: str, snippets: str, text: str, size: tuple[int, int], folder: Path, *flags: str
) -> Any:
    """The function k of a program: C as it is, CUDA and Metal beside what stands in for their textures."""
    source = folder / f"t{language}.{'c' if language == 'c' else 'cpp'}"
    header = folder / f"t{language}.h"  # of which a program need not use all
    header.write_text(shims.HEADS[language] + snippets.replace("#include <metal_stdlib>", ""))
    source.write_text(f'#include "{header.name}"\n{text}')
    # Only clang has the vectors of Metal, whose components have names.
    compiler = tools.program("gcc" if language == "c" else "clang++")
    library = folder / f"t{language}{''.join(flags)}.so"
    extra = [f"-DWIDTH={size[0]}", f"-DHEIGHT={size[1]}", "-Wno-unused-parameter"]
    function = tools.loaded(source, library, compiler, *extra, *flags).k
    function.argtypes = [ctypes.c_void_p, *[ctypes.c_float] * 3, ctypes.c_void_p]
    return function


COMPILERS: dict[str, Callable[[str, str, Path], None]] = {
    "glsl": compile_glsl,
    "glsl-es": compile_glsl_es,
    "hlsl": compile_hlsl,
    "slang": compile_slang,
    "wgsl": compile_wgsl,
    "cuda": compile_cuda,
    "c": compile_c,
    "osl": compile_osl,
    "metal": compile_metal,
}

# How each language calls what a snippet has: READ, and the SUM of the other functions of F0 and that pair Q.
PROGRAMS = {
    "glsl": "void main() { float cosine = 0.4, alpha = 0.2; vec3 F0 = vec3(0.9, 0.6, 0.3);\n"
    "vec2 Q = READ; vec3 L = SUM; o = vec4(L, 1.0); }",
    "glsl-es": "void main() { highp float cosine = 0.4, alpha = 0.2; vec3 L, F0 = vec3(0.9, 0.6, 0.3);\n"
    "vec2 Q = READ; L = SUM; o = vec4(L, 1.0); }",
    "hlsl": "float4 main() : SV_Target { float cosine = 0.4, alpha = 0.2;\n"
    "float3 F0 = float3(0.9, 0.6, 0.3); float2 Q = READ; float3 L = SUM; return float4(L, 1.0); }",
    "wgsl": "@fragment fn main() -> @location(0) vec4<f32> { let cosine = 0.4; let alpha = 0.2;\n"
    "let F0 = vec3<f32>(0.9, 0.6, 0.3); let Q = READ; let L = SUM; return vec4<f32>(L, 1.0); }",
    "cuda": "extern \"C\" __global__ void k(cudaTextureObject_t table, float cosine, float alpha, float F0,\n"
    "float *o) { float2 Q = READ; o[0] = SUM; o[1] = Q.y; }",
    "c": "void k(const float *table, float cosine, float alpha, float F0, float *o);\n"
    "void k(const float *table, float cosine, float alpha, float F0, float *o)\n"
    "{ const PAIR Q = READ; o[0] = SUM; o[1] = Q.y; }",
    "osl": "surface t(string file = \"t.exr\", output color o = 0)\n"
    "{ float cosine = 0.4; float alpha = 0.2; color F0 = color(0.9, 0.6, 0.3);\n"
    "color Q = READ; o = SUM; }",
    "metal": "extern \"C\" void k(const float *table, float cosine, float alpha, float F, float *o)\n"
    "{ metal::texture2d<float> t{table}; metal::sampler s; float3 F0 = float3(F, F, F);\n"
    "float2 Q = READ; float3 L = SUM; o[0] = L.x; o[1] = Q.y; }",
}  # fmt: skip
PROGRAMS["slang"] = '[shader("fragment")] ' + PROGRAMS["hlsl"]


# The texture, where it is not t.
TABLES = {
    "hlsl": "t, s",
    "slang": "t, s",
    "wgsl": "t, s",
    "metal": "t, s",
    "cuda": "table",
    "c": "table",
    "osl": "file",
}


def program(language: str, kind: str, slices: int) -> str:
    """A program that calls every function of the snippet."""
    prefix = "ggx_" if slices == 1 else "student_t_"
    number = "2.2f" if language in ("cuda", "c", "metal") else "2.2"
    arguments = f"{TABLES.get(language, 't')}, cosine, alpha" + (f", {number}" if slices > 1 else "")
    first, second = ("Q[0]", "Q[1]") if language == "osl" else ("Q.x", "Q.y")
    if kind == "split_sum":
        read = f"{prefix}split_sum({arguments})"
        total = f"{prefix}ambient(F0, Q) + {prefix}ambient_compensated(F0, Q)"
    else:
        read = f"{prefix}missing_energy({arguments})"
        if kind == "albedo":
            read = f"{prefix}missing_energy({prefix}albedo({arguments}))"
        lobe = f"{prefix}kulla_conty({prefix}fresnel_average(F0), {first}, {first}, {second})"
        total = f"{prefix}turquin(F0, {first}) + {lobe}"
    text = PROGRAMS[language].replace("READ", read).replace("SUM", total)
    text = text.replace("PAIR", f"{prefix}{kind}_pair")
    return text + "\n"


def adapters(folder: Path) -> list[Any]:
    """What runs WGSL here."""
    if importlib.util.find_spec("wgpu") is None:
        tools.missing("the package wgpu")
    os.environ.setdefault("XDG_RUNTIME_DIR", str(folder))
    import wgpu

    return wgpu.gpu.enumerate_adapters_sync() or tools.missing("a Vulkan driver, such as lavapipe's")


def sampled_by_wgsl(table: Any, points: Any, folder: Path) -> Any:
    """What a compute shader reads from a float32 texture at cosine and alpha."""
    feature = "float32-filterable"
    adapter = next((adapter for adapter in adapters(folder) if feature in adapter.features), None)
    adapter = adapter or tools.missing(f"an adapter with {feature}")
    import wgpu

    device = adapter.request_device_sync(required_features=[feature])
    _, height, width, _ = table.values.shape
    size = (width, len(table.values) * height, 1)
    image = device.create_texture(
        size=size, format="rg32float", usage=wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_DST
    )
    texels = np.ascontiguousarray(table.values, np.float32)
    layout = {"offset": 0, "bytes_per_row": 8 * width, "rows_per_image": size[1]}
    device.queue.write_texture({"texture": image}, texels.tobytes(), layout, size)
    read = {"energy": "missing_energy"}.get(table.kind, table.kind)
    shape = ", 2.2" if len(table.values) > 1 else ""
    code = f"""{table.snippet("wgsl", "t_")}
@group(0) @binding(0) var table: texture_2d<f32>;
@group(0) @binding(1) var state: sampler;
@group(0) @binding(2) var<storage, read> points: array<vec2<f32>>;
@group(0) @binding(3) var<storage, read_write> found: array<vec2<f32>>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) at: vec3<u32>) {{
    found[at.x] = t_{read}(table, state, points[at.x].x, points[at.x].y{shape});
}}"""
    pipeline = device.create_compute_pipeline(
        layout="auto", compute={"module": device.create_shader_module(code=code), "entry_point": "main"}
    )
    edge = "clamp-to-edge"
    state = device.create_sampler(
        mag_filter="linear", min_filter="linear", address_mode_u=edge, address_mode_v=edge
    )
    given = device.create_buffer_with_data(data=points.tobytes(), usage=wgpu.BufferUsage.STORAGE)
    found = device.create_buffer(
        size=points.nbytes, usage=wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC
    )
    resources = [image.create_view(), state, *({"buffer": b, "size": points.nbytes} for b in (given, found))]
    group = device.create_bind_group(
        layout=pipeline.get_bind_group_layout(0),
        entries=[{"binding": k, "resource": resource} for k, resource in enumerate(resources)],
    )
    encoder = device.create_command_encoder()
    work = encoder.begin_compute_pass()
    work.set_pipeline(pipeline)
    work.set_bind_group(0, group)
    work.dispatch_workgroups(len(points) // 64)
    work.end()
    device.queue.submit([encoder.finish()])
    return np.frombuffer(device.queue.read_buffer(found), np.float32).reshape(points.shape)
