"""Run exported functions wherever they run here, beside the library, and write the tables of docs/export.md.

    python tools/measure_export.py [--sets 400] [--families student_t,gtr:free]

The points are those of `microfacet._export.points`: 512 for each of SETS values of the parameters. Exit
status 1 where an error lies outside its bound. Rows of families that are not named stay as they are.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "examples" / "shaders")]

import make as shaders  # noqa: E402

import export_tools as tools  # noqa: E402
import microfacet as mf  # noqa: E402
from export_targets import TARGETS  # noqa: E402
from microfacet._export.accuracy import error_of  # noqa: E402
from microfacet._export.choice import Choice, chosen  # noqa: E402
from microfacet._export.density import density_of  # noqa: E402
from microfacet._export.functions import FUNCTIONS  # noqa: E402
from test_export_families import choice_of  # noqa: E402
from textbook import TEXTBOOK  # noqa: E402
from textbook import operations as textbook_operations  # noqa: E402

NAMES = (
    *("D", "sigma", "Lambda", "G1", "G2", "pdf_visible", "sample_visible"),
    *("conductor_eval", "conductor_pdf", "conductor_sample"),
)
BEGIN, END = "<!-- measured -->\n", "<!-- end of what is measured -->"
SHADERS, MOST_OPERATIONS = ("WGSL", "WebGL 2"), 2000
CASES = [
    case
    for family in mf.families()
    for case in (family.name, *([f"{family.name}:free"] if density_of(family.name).tabulated else []))
]
COLUMNS = ("operations", "NumPy", "C -O0", "C -O2", "C -O3 -ffast-math", "WGSL", "WebGL 2")


def bound_of(name: str, target: str) -> float:
    return 1e-4 if "sample" in name else 5e-5 if "fast" in target else 2e-5


def choice_named(case: str) -> Choice:
    """Of a family: shapes that tables are made for have values, unless the case is FAMILY:free."""
    family, _, free = case.partition(":")
    if not free:
        return choice_of(family, True)
    density = density_of(family)
    return chosen(density, tuple(FUNCTIONS), {}, None, density.anisotropic)


def errors_of(choice: Choice, sets: int) -> dict[str, dict[str, float]]:
    """The error of each function on each target; graphics processors get none that is enormous."""
    columns: dict[str, Any] = {}
    graphs = {name: choice.graph(name, False) for name in NAMES}
    first = TARGETS["NumPy"]

    def kept(name: str, given: Mapping[str, Any]) -> Any:
        columns[name] = given
        return first(choice, {name: given})[name]

    found = {
        "NumPy": {
            name: error_of(name, graph, choice, lambda given, name=name: kept(name, given), sets)
            for name, graph in graphs.items()
        }
    }
    for target, run in TARGETS.items():
        if target in found:
            continue
        long = target in SHADERS and MOST_OPERATIONS
        given = {name: x for name, x in columns.items() if not long or graphs[name].operations <= long}
        found[target] = {
            name: error_of(name, graphs[name], choice, lambda _, values=values: values, sets)
            for name, values in run(choice, given).items()
        }
    return found


def said(error: float | None) -> str:
    return "–" if error is None or np.isnan(error) else f"{error:.1e}"


def title(case: str) -> str:
    """How the first cell of a row calls it."""
    return case.replace(":free", ", free shape")


def rows_of(case: str, sets: int) -> tuple[list[str], list[str]]:
    """Rows of the table, and what lies outside its bound."""
    choice = choice_named(case)
    errors = errors_of(choice, sets)
    beyond = [
        f"{case} {name} on {target}: {error:.1e}"
        for target, found in errors.items()
        for name, error in found.items()
        if error > bound_of(name, target)
    ]
    fast = "C -O3 -ffast-math"
    both = [errors[fast], errors.pop("clang -O3 -ffast-math")]
    errors[fast] = {name: float(np.fmax(*(found.get(name, np.nan) for found in both))) for name in NAMES}
    rows = []
    for name in NAMES:
        cells = [str(choice.graph(name, False).operations)]
        cells += [said(errors[target].get(name)) for target in COLUMNS[1:]]
        rows.append(f"| {title(case)} | `{name}` | {' | '.join(cells)} |")
    return rows, beyond


def fixed_of(case: str) -> dict[str, float]:
    return {name: x for name, x in choice_named(case).fixed.items() if name != "rotation"}


def first_compile(case: str) -> tuple[int, float | None]:
    """Operations of a whole conductor of three wavelengths, and seconds until a new browser has drawn it."""
    family, fixed = case.partition(":")[0], fixed_of(case)
    text = mf.export("glsl-es", family, shaders.FUNCTIONS, channels=3, **fixed)
    counted = text.split("Operations: ")[1].split(".")[0].replace("\n//", "")
    operations = sum(int(word.split()[-1]) for word in counted.split(","))
    if operations > 2 * MOST_OPERATIONS:
        return operations, None
    eval_, pdf, sample = (
        shaders.call_of(text, f"{family}_{function}", "glsl-es") for function in shaders.FUNCTIONS
    )
    main = f"""
precision highp sampler2D;
uniform sampler2D rows;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() {{
  vec4 xi = texelFetch(rows, ivec2(gl_FragCoord.xy), 0), more = texelFetch(rows, ivec2(gl_FragCoord.xy), 0);
  vec3 wi = normalize(vec3(xi.xy, 0.1 + xi.z)), wo = normalize(vec3(xi.yz, 0.1 + xi.w));
  vec3 eta = xi.xyz, k = more.xyz;
  float alpha = more.x, shape = 1.6 + more.y;
  {family}_conductor_sample_result drawn = {sample};
  first = vec4({eval_} + drawn.wo, {pdf});
  second = vec4(drawn.weight, drawn.pdf);
}}
"""
    rows = np.random.default_rng(3).random((64, 12), np.float32)
    _, seconds = tools.drawn({family: "#version 300 es\n" + text + main}, {family: rows})
    return operations, seconds[family]


def standing(text: str, cases: list[str]) -> dict[str, list[str]]:
    """Rows that stand in the document and are not measured now, by their first cell."""
    rows: dict[str, list[str]] = {}
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        if len(cells) > 2 and cells[1] not in [title(case) for case in cases]:
            rows.setdefault(cells[1], []).append(line)
    return rows


def page(text: str, cases: list[str], sets: int) -> tuple[str, list[str]]:
    """What stands between the marks, and what lies outside its bound."""
    errors, compiles, beyond = {}, {}, []
    for case in cases:
        click.echo(case, err=True)
        errors[case], found = rows_of(case, sets)
        beyond += found
        fixed = ", ".join(f"{name} = {x:g}" for name, x in fixed_of(case).items()) or "–"
        operations, seconds = first_compile(case)
        first = "not tried" if seconds is None else f"{seconds:.2f} s"
        compiles[case] = f"| {title(case)} | {fixed} | {operations} | {first} |"
    before = standing(text, cases)
    upper = [
        f"| family | function | {' | '.join(COLUMNS)} |",
        f"|---|---|{'---:|' * len(COLUMNS)}",
    ]
    lower = [
        "| family | fixed here | operations of a whole conductor | first compile |",
        "|---|---|---:|---:|",
    ]
    for case in CASES:
        rows = [*errors.get(case, []), *([compiles[case]] if case in compiles else [])]
        rows = rows or before.get(title(case), [])
        upper += rows[:-1]
        lower += rows[-1:]
    last = ["| isotropic GGX | textbook | for shaders | with library functions |", "|---|---:|---:|---:|"]
    choice = choice_of("ggx", False)
    for name in TEXTBOOK:
        counts = [choice.graph(name, native).operations for native in (False, True)]
        last.append(f"| `{name}` | {textbook_operations(name)} | {counts[0]} | {counts[1]} |")
    return "\n".join([*upper, "", *lower, "", *last]) + "\n", beyond


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option("--sets", default=400, show_default=True, help="Values of the parameters, 512 points each.")
@click.option("--families", default=",".join(CASES), show_default=True)
@click.option("--output", type=click.Path(path_type=Path), default=ROOT / "docs" / "export.md")
def main(sets: int, families: str, output: Path) -> None:
    """Write the tables between the marks of the document."""
    beyond = []
    for case in families.split(","):  # written at once: an interrupted run has what it measured
        before, _, rest = output.read_text("utf-8").partition(BEGIN)
        text, _, after = rest.partition(END)
        made, found = page(text, [case], sets)
        output.write_text(f"{before}{BEGIN}\n{made}\n{END}{after}", "utf-8")
        beyond += found
    for line in beyond:
        click.echo(line, err=True)
    sys.exit(bool(beyond))


if __name__ == "__main__":
    main()
