"""Make whole metals in shading languages, and the programs around them, from the library.

    python examples/shaders/make.py [--output shaders] [--families ggx,student_t] [--fix gamma=2.5]
        [--fresnel conductor|schlick] [--retroreflective] [--size 16x16] [--slices 8]

For each family a folder: metal.glsl, metal.wgsl, metal.cuh, metal.slang, metal.h (for OSL) and metal.mtlx,
with energy.raw, the lookup texture of the energy that one order of scattering misses. Each file is what
`microfacet export` and `microfacet bake --snippet` print, and below that the same few functions, whatever the
family is: metal_eval, metal_pdf, metal_sample and metal_energy. The programs of this folder include the one
file, so they change their metal by taking it from another folder. page.html holds the metals of all families.
"""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

import click
import numpy as np

import microfacet as mf

HERE = Path(__file__).resolve().parent
FUNCTIONS = ("conductor_eval", "conductor_pdf", "conductor_sample")
ENDINGS = {"glsl-es": "glsl", "wgsl": "wgsl", "cuda": "cuh", "slang": "slang", "osl": "h"}
# Programs that include the metal.
PROGRAMS = ("furnace.wgsl", "furnace.slang", "million.cu", "metal.osl")


def parameters_of(text: str, name: str) -> list[tuple[str, str]]:
    """The parameters of a function in its text: names, and types."""
    found = re.search(rf"\b{name}\s*\(([^)]*)\)[^;{{]*\{{", text)
    assert found, name
    parts = [part.strip() for part in found[1].split(",")]
    if ":" in parts[0]:
        return [(part.split(":")[0], part.split(":")[1].strip()) for part in parts]
    return [(part.split()[-1], part.split()[-2]) for part in parts]


def call_of(text: str, name: str, language: str) -> str:
    """A call of it where there are wi, wo, xi of four numbers, alpha, shape, eta, k and a texture."""
    arguments = []
    for parameter, type_ in parameters_of(text, name):
        stem, _, component = parameter.partition("_")
        if parameter == "xi" and "4" not in type_:
            letters = "xyz"[: int(re.sub(r"\D", "", type_.removesuffix("f")))]
            parts = ", ".join(f"xi.{letter}" for letter in letters)
            arguments.append(f"make_float{len(letters)}({parts})" if language == "cuda" else f"xi.{letters}")
        elif stem == "f0":
            arguments.append("metal_f0(eta, k)" + (f".{component}" if component else ""))
        elif stem in ("eta", "k"):
            arguments.append(f"{stem}.{component}" if component else stem)
        elif parameter in ("wi", "wo", "xi", "alpha", "state"):
            arguments.append(parameter)
        else:
            arguments.append({"table": "energy", "cosine": "wi.z"}.get(parameter, "shape"))
    return f"{name}({', '.join(arguments)})"


def filled(template: str, values: dict[str, str]) -> str:
    """The template with what stands for each @word@."""
    return re.sub(r"@(\w+)@", lambda found: values[found[1]], template)


def metal(language: str, functions: str, snippet: str, prefix: str) -> str:
    """One file: the exported functions, those that read the texture, and the common names."""
    values = {part: call_of(functions, f"{prefix}conductor_{part}", language) for part in ("eval", "pdf")}
    if language != "osl":
        values["sample"] = call_of(functions, f"{prefix}conductor_sample", language)
    values["missing"] = call_of(snippet, f"{prefix}missing_energy", language)
    values |= {"functions": functions, "snippet": snippet, "prefix": prefix}
    return filled((HERE / f"metal.{ENDINGS[language]}.in").read_text("utf-8"), values)


def texture_of(family: str, fixed: dict[str, float], size: tuple[int, int], slices: int) -> mf.LookupTexture:
    """The missing energy; in slices of the shape, in even steps of its reciprocal, where it is free."""
    parameters = next(known.parameters for known in mf.families() if known.name == family)[1:]
    shape = [fixed[p.name] for p in parameters if p.name in fixed] or None
    if parameters and shape is None:
        ends = (parameters[0].lower + 0.1, parameters[0].lower + 20.0)
        shape = list(1 / np.linspace(1 / ends[0], 1 / ends[1], slices))
    return mf.lookup_texture("energy", family, size=size, shape=shape, check=0, cosine_mapping="sqrt")


def _document(family: str, nodes: str) -> str:
    """A document that uses the node conductor_eval: directions in the local frame, and gold."""
    (own,) = re.findall(rf'<nodedef name="ND_{family}_conductor_eval".*?</nodedef>', nodes, flags=re.DOTALL)
    gold = {"eta": "0.143, 0.375, 1.442", "k": "3.983, 2.386, 1.603", "f0": "1, 0.77, 0.34", "alpha": "0.1"}
    given = [
        f'      <input name="{name}" type="{type_}" value="{gold.get(name, value)}" />'
        for name, type_, value in re.findall(r'<input name="(\w+)" type="(\w+)" value="([^"]*)"', own)
        if name not in ("wi", "wo")
    ]
    frame = []
    for name, direction in (("wi", "view"), ("wo", "lamp")):
        for axis in "tbn":
            ends = zip(("in1", "in2"), (direction, axis), strict=True)
            inputs = "".join(f'<input name="{i}" type="vector3" nodename="{node}" />' for i, node in ends)
            frame.append(f'    <dotproduct name="{name}_{axis}" type="float">{inputs}</dotproduct>')
        ends = zip(("in1", "in2", "in3"), "tbn", strict=True)
        inputs = "".join(f'<input name="{i}" type="float" nodename="{name}_{axis}" />' for i, axis in ends)
        frame.append(f'    <combine3 name="{name}" type="vector3">{inputs}</combine3>')
    values = {"family": family, "frame": "\n".join(frame), "values": "\n".join(given)}
    return filled((HERE / "metal.mtlx.in").read_text("utf-8"), values)


def make_family(
    folder: Path, family: str, fixed: dict[str, float], texture: mf.LookupTexture, how: dict
) -> str:
    """All files of a family; returns that of the page."""
    folder.mkdir(parents=True, exist_ok=True)
    texture.save(folder / "energy.raw")
    texts = {}
    for language, ending in ENDINGS.items():
        functions = mf.export(language, family, FUNCTIONS, channels=3, **how, **fixed)
        texts[language] = metal(language, functions, texture.snippet(language), f"{family}_")
        (folder / f"metal.{ending}").write_text(texts[language], "utf-8")
    nodes = folder / "metal_nodes.mtlx"
    mf.export("materialx", family, FUNCTIONS, channels=3, path=nodes, **how, **fixed)
    (folder / "metal.mtlx").write_text(_document(family, nodes.read_text("utf-8")), "utf-8")
    for name in PROGRAMS:
        (folder / name).write_bytes((HERE / name).read_bytes())
    return texts["glsl-es"]


def make(
    output: Path,
    families: list[str],
    fixed: dict[str, float] | None = None,
    size: tuple[int, int] = (16, 16),
    slices: int = 8,
    **how: Any,
) -> None:
    """All families, and the page."""
    scripts, tables = [], {}
    for family in families:
        known = next((known for known in mf.families() if known.name == family), None)
        if known is None:
            raise ValueError(
                f"families must be of {', '.join(f.name for f in mf.families())}, got {family!r}"
            )
        own = {p.name: x for p in known.parameters if (x := (fixed or {}).get(p.name)) is not None}
        texture = texture_of(family, own, size, slices)
        text = make_family(output / family, family, own, texture, how)
        scripts.append(f'<script type="x-shader" id="{family}">\n{text}</script>')
        values = np.ascontiguousarray(texture.values, np.float16)
        tables[family] = {
            "title": known.title,
            "shape": known.parameters[1].name if len(known.parameters) > 1 and len(own) == 0 else "",
            "width": values.shape[2],
            "height": values.shape[0] * values.shape[1],
            "texels": base64.b64encode(values.tobytes()).decode(),
        }
    page = (HERE / "page.html.in").read_text("utf-8")
    values = {"metals": "\n".join(scripts), "tables": json.dumps(tables)}
    (output / "page.html").write_text(filled(page, values), "utf-8")


def _fixed(_: click.Context, __: click.Parameter, given: tuple[str, ...]) -> dict[str, float]:
    try:
        return {text.split("=")[0]: float(text.split("=")[1]) for text in given}
    except (IndexError, ValueError):
        raise click.BadParameter(f"must look like gamma=2.5, got {' '.join(given)}") from None


def _size(_: click.Context, __: click.Parameter, text: str) -> tuple[int, int]:
    if not re.fullmatch(r"[1-9]\d*x[1-9]\d*", text):
        raise click.BadParameter(f"must look like 16x16, got {text}")
    width, height = text.split("x")
    return int(width), int(height)


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option("--output", type=click.Path(path_type=Path), default=Path("shaders"), show_default=True)
@click.option("--families", default="ggx,student_t", show_default=True)
@click.option(
    "--fix", multiple=True, callback=_fixed, metavar="NAME=X", help="A shape that shall not be free."
)
@click.option("--fresnel", type=click.Choice(["conductor", "schlick"]), default="conductor")
@click.option("--retroreflective", is_flag=True, help="Metals that send light back whence it came.")
@click.option("--size", callback=_size, default="16x16", show_default=True, help="Of the lookup textures.")
@click.option("--slices", type=click.IntRange(3), default=8, show_default=True, help="Of a free shape.")
def main(output: Path, families: str, fix: dict[str, float], **how: Any) -> None:
    """Make them and say where they are."""
    try:
        make(output, families.split(","), fix, **how)
    except ValueError as error:
        raise click.ClickException(str(error)) from None
    click.echo(f"Wrote {output}: page.html, and a folder for each of {families}.")


if __name__ == "__main__":
    main()
