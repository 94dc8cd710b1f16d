"""How far lookup textures are off between texels: prints the tables of docs/textures.md (some minutes)."""

from __future__ import annotations

import numpy as np

import microfacet as mf
from microfacet._bake.texture.rows import row

CHOSEN = {"student_t": 2.5}  # where it is not the value of pictures
SHAPES = {
    family.name: {own.name: CHOSEN.get(family.name, own.pictured) for own in family.parameters[1:]}
    for family in mf.families()
}
FORMS = ((64, "linear"), (32, "linear"), (64, "sqrt"))
MANY = ("beckmann", "ggx", "gtr")  # in all of these, the others in the first
ROUGHNESSES, COSINES = 48, 64


def compared(table: mf.LookupTexture, shape: dict[str, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What is read, the integrals, and whether the cosine lies beyond the first texel of a linear axis."""
    cls = next(family.cls for family in mf.families() if family.name == table.family)
    v = (np.arange(ROUGHNESSES) + 0.37) / ROUGHNESSES
    cosine = (np.arange(COSINES) + 0.37) / COSINES
    exact = np.stack([row(table.kind, cls(alpha=a, **shape), cosine).values for a in v**2])
    read = table.lookup(cosine, v[:, np.newaxis] ** 2, *shape.values())
    return read, exact, np.broadcast_to(cosine > 0.5 / len(table.cosine.values), exact.shape[:-1])


def main() -> None:
    print("| family | texels | cosine | missing | furnace | scale | bias |\n|---|---|---|---|---|---|---|")
    for family in mf.families():
        shape = SHAPES[family.name]
        for size, mapping in FORMS if family.name in MANY else FORMS[:1]:
            options = {"size": (size, size), "cosine_mapping": mapping, "check": 0, "dtype": "float16"}
            if shape:
                options["shape"] = next(iter(shape.values()))
            cells = []
            for kind in ("energy", "split_sum"):
                table = mf.lookup_texture(kind, family.name, **options)
                read, exact, inside = compared(table, shape)
                wrong = np.abs(read - exact)
                for k in range(1 if kind == "energy" else 2):
                    one = wrong[..., k]
                    cells.append(f"{one.mean():.1e}, {one[inside].max():.1e}, {one.max():.1e}")
                if kind == "energy":
                    furnace = np.abs((1 - exact[..., 0]) / (1 - read[..., 0]) - 1)
                    cells.append(f"{furnace.mean():.1e}, {furnace[inside].max():.1e}, {furnace.max():.1e}")
            print("|", " | ".join((family.name, f"{size}x{size}", mapping, *cells)), "|", flush=True)
    print("\n| steps of gamma | mean | largest |\n|---|---|---|")
    grids = {
        "linear": np.linspace(1.6, 20, 8),
        "log": np.geomspace(1.6, 20, 8),
        "reciprocal": 1 / np.linspace(1 / 1.6, 1 / 20, 8),
    }
    for name, shape in grids.items():
        table = mf.lookup_texture("energy", "student_t", size=(32, 16), shape=shape, check=24)
        found = table.errors["lookup"]["missing"]
        print(f"| {name} | {found['mean']:.1e} | {found['largest']:.1e} |", flush=True)


if __name__ == "__main__":
    main()
