"""Densities of one's own in the Mitsuba plugins: by their tables, here or in a file."""

from __future__ import annotations

import json
import pathlib

import numpy as np

import mitsuba_process

MAKE = """
import json
import numpy as np
import microfacet as mf
from microfacet.mitsuba import table, write_table
family = mf.StudentT(alpha=1.0, gamma=2.5)
ndf = mf.RadialNDF(lambda r: family.P22(r, 0.0))
"""
AGREES = (
    MAKE
    + """
write_table(sys.argv[1], ndf)
known = {"distribution": "student_t", "gamma": 2.5}
written = {"distribution": "table", "filename": sys.argv[1]}
rng = np.random.default_rng(1)

def directions(n):
    w = rng.normal(size=(n, 3))
    return w / np.linalg.norm(w, axis=1, keepdims=True)

wi, wo, xi = directions(300), directions(300), rng.random((300, 3))
wi[:, 2] = np.abs(wi[:, 2])
found = {}
for name, own in {"family": known, "here": table(ndf), "file": written}.items():
    for plugin, more in {
        "conductor": {"material": "none"},
        "dielectric": {"int_ior": 1.5, "ext_ior": 1.0},
        "all orders": {"material": "none", "scattering": "multiple"},
    }.items():
        kind = "conductor" if plugin == "all orders" else plugin
        bsdf = mi.load_dict({"type": f"microfacet_{kind}", "alpha_u": 0.3, "alpha_v": 0.2, **own, **more})
        si, values = mi.SurfaceInteraction3f(), []
        for a, b, x in zip(wi, wo, xi):
            si.wi = mi.Vector3f(*a)
            context = mi.BSDFContext()
            if plugin != "all orders":
                values.append(float(np.asarray(bsdf.eval(context, si, mi.Vector3f(*b))).ravel()[0]))
                values.append(float(bsdf.pdf(context, si, mi.Vector3f(*b))))
            sample, weight = bsdf.sample(context, si, float(x[0]), mi.Point2f(float(x[1]), float(x[2])))
            values += [*map(float, sample.wo), float(np.asarray(weight).ravel()[0])]
        found[f"{name} {plugin}"] = values
print(json.dumps(found))
"""
)
SENTENCES = (
    MAKE
    + """
good = table(ndf)["tables"]
cases = {
    "none": {},
    "both": {"tables": good, "filename": "own.tables"},
    "empty": {"tables": ""},
    "text": {"tables": "tables"},
    "cut": {"tables": good[:-40]},
    "longer": {"tables": good + "AAAA"},
    "letters": {"tables": good[:50] + "?" + good[51:]},
    "missing": {"filename": "no.tables"},
    "noise": {"tables": good[:20] + "".join("=" if c == "=" else "/" for c in good[20:])},
}
found = {}
for name, given in cases.items():
    try:
        mi.load_dict({"type": "microfacet_conductor", "distribution": "table", **given})
        found[name] = "accepted"
    except RuntimeError as error:
        found[name] = str(error)
print(json.dumps(found))
"""
)
REFUSALS = {
    "none": '"distribution" is "table", which needs one of "tables" and "filename"',
    "both": '"distribution" is "table", which needs one of "tables" and "filename"',
    "empty": "holds no tables",
    "text": "holds no tables",
    "cut": "holds tables of another version of microfacet, or a part of them",
    "longer": "holds tables of another version of microfacet, or a part of them",
    "letters": "holds tables of another version of microfacet, or a part of them",
    "missing": '"filename" is "no.tables", which cannot be read',
    "noise": "holds tables of a density that this plugin cannot sample",
}


def test_a_family_by_its_tables_is_the_family(tmp_path: pathlib.Path) -> None:
    mitsuba_process.require("scalar_rgb")
    found = json.loads(
        mitsuba_process.run(AGREES, "scalar_rgb", str(tmp_path / "own.tables")).splitlines()[-1]
    )
    for plugin in ("conductor", "dielectric", "all orders"):
        exact = np.array(found[f"family {plugin}"])
        assert found[f"here {plugin}"] == found[f"file {plugin}"]
        np.testing.assert_allclose(found[f"here {plugin}"], exact, rtol=2e-4, atol=2e-5)


def test_pictures_take_the_tables() -> None:
    """A look of a density is the material with its tables; nothing is rendered here."""
    mitsuba_process.require("scalar_rgb")
    code = """
from microfacet._render.look import Look
look = Look("own", {"alpha_x": 0.2, "alpha_y": 0.3, "rotation": 0.0}, "Cu", density=ndf)
print(mi.load_dict(look.bsdf()))
"""
    assert "distribution = table" in mitsuba_process.run(MAKE + code, "scalar_rgb")


def test_what_is_no_table_is_refused() -> None:
    mitsuba_process.require("scalar_rgb")
    found = json.loads(mitsuba_process.run(SENTENCES, "scalar_rgb").splitlines()[-1])
    for name, message in REFUSALS.items():
        assert message in found[name], name
        assert found[name].count("microfacet_conductor: ") <= 1


def test_a_density_with_corners_is_refused() -> None:
    code = MAKE + "\ntable(mf.RadialNDF(lambda r: np.exp(-5.0 * abs(r - 1.0))))"
    mitsuba_process.require("scalar_rgb")
    done = mitsuba_process.python("import mitsuba as mi\nmi.set_variant('scalar_rgb')\n" + code)
    assert "smooth only piece by piece" in done.stderr
