"""What BSDFs of Mitsuba answer to the same questions: asked here, answered in a process of its own.

A query is a dictionary that survives JSON:

- `bsdf`: what `mitsuba.load_dict` takes; `{"grid": [[...], ...]}` stands for a texture of these values;
- `xml`: instead of it, text for `mitsuba.load_string`;
- `mode` ("radiance" or "importance"), `component` and `types` (a bit mask): the context; all by default;
- `set`: values of `mitsuba.traverse` by name, before the questions;
- `derivative`: the name of a parameter; then the answer is `eval`, `wo`, `sample_pdf`, and the derivatives
  `d_eval`, `d_pdf`, `d_weight` by it (only where arrays are differentiated).

The answer holds arrays of one entry per pair of directions: `eval` (n, channels), `pdf`, and of `sample` for
the same wi: `wo`, `weight`, `sample_pdf`, `eta`, `type`, `component`, and `eval_at`, `pdf_at` of that wo; and
`flags`, (1 + components).
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import mitsuba_process

TESTS = Path(__file__).parent
CODE = """
sys.path.insert(0, sys.argv[1])
import mitsuba_answers
mitsuba_answers.answer(*sys.argv[2:])
"""
WAVELENGTHS = (450.0, 520.0, 580.0, 640.0)


def ask(
    queries: dict[str, dict[str, Any]], variant: str, folder: Path, **inputs: Any
) -> dict[str, dict[str, Any]]:
    """Answers by name; inputs are `wi`, `wo` (n, 3), `xi` (n, 3) and `uv` (n, 2)."""
    given, found = folder / f"{variant}-given.npz", folder / f"{variant}-found.npz"
    np.savez(given, queries=json.dumps(queries), **inputs)
    mitsuba_process.run(CODE, variant, str(TESTS), str(given), str(found))
    answers: dict[str, dict[str, Any]] = {name: {} for name in queries}
    with np.load(found) as arrays:
        for key in arrays:
            name, _, quantity = key.rpartition("/")
            answers[name][quantity] = arrays[key]
    return answers


def answer(given: str, found: str) -> None:
    """The other side of `ask`."""
    import mitsuba as mi

    with np.load(given) as arrays:
        inputs = dict(arrays)
    queries = json.loads(str(inputs.pop("queries")))
    answers = {}
    usual = _one_at_a_time if mi.variant().startswith("scalar") else _all_at_once
    for name, query in queries.items():
        if "derivative" in query:
            made = _derivatives(_bsdf(query), query["derivative"], inputs)
        else:
            made = usual(_bsdf(query), _context(query), inputs)
        answers.update({f"{name}/{quantity}": values for quantity, values in made.items()})
    np.savez(found, **answers)


def _bsdf(query: dict[str, Any]) -> Any:
    import mitsuba as mi

    bsdf = mi.load_string(query["xml"]) if "xml" in query else mi.load_dict(_textured(query["bsdf"]))
    if "set" in query:
        parameters = mi.traverse(bsdf)
        for name, value in query["set"].items():
            parameters[name] = value
        parameters.update()
    return bsdf


def _textured(entry: Any) -> Any:
    import mitsuba as mi

    if not isinstance(entry, dict):
        return entry
    if "grid" in entry:
        data = mi.TensorXf(np.asarray(entry["grid"], np.float32)[:, :, None])
        return {"type": "bitmap", "data": data, "raw": True, "filter_type": "nearest"}
    return {name: _textured(value) for name, value in entry.items()}


def _context(query: dict[str, Any]) -> Any:
    import mitsuba as mi

    mode = getattr(mi.TransportMode, query.get("mode", "radiance").capitalize())
    return mi.BSDFContext(mode, query.get("types", 0xFFFFFFFF), query.get("component", 0xFFFFFFFF))


def _interaction(wi: Any, uv: Any, n: int) -> Any:
    import drjit as dr
    import mitsuba as mi

    interaction = dr.zeros(mi.SurfaceInteraction3f, n) if n else mi.SurfaceInteraction3f()
    interaction.wi, interaction.uv = wi, uv
    if mi.is_spectral:
        interaction.wavelengths = (
            mi.Color0f() if mi.is_monochromatic else mi.UnpolarizedSpectrum(*WAVELENGTHS)
        )
    return interaction


def _flags(bsdf: Any) -> Any:
    return np.array([bsdf.flags(), *(bsdf.flags(k) for k in range(bsdf.component_count()))], np.uint32)


def _traced(inputs: dict[str, Any]) -> tuple[Any, Any, Any]:
    import mitsuba as mi

    wi, wo, xi, uv = (
        [mi.Float(np.ascontiguousarray(column, np.float32)) for column in inputs[name].T]
        for name in ("wi", "wo", "xi", "uv")
    )
    return _interaction(mi.Vector3f(wi), mi.Point2f(uv), len(inputs["wi"])), mi.Vector3f(wo), xi


def _derivatives(bsdf: Any, parameter: str, inputs: dict[str, Any]) -> dict[str, Any]:
    import drjit as dr
    import mitsuba as mi

    si, towards, xi = _traced(inputs)
    parameters, n = mi.traverse(bsdf), len(inputs["wi"])
    dr.enable_grad(parameters[parameter])
    parameters.update()
    value, density = bsdf.eval_pdf(mi.BSDFContext(), si, towards)
    drawn, weight = bsdf.sample(mi.BSDFContext(), si, xi[2], mi.Point2f(xi[:2]))
    dr.forward(parameters[parameter])
    found = {"eval": value, "wo": drawn.wo, "sample_pdf": drawn.pdf}
    found |= {"d_eval": dr.grad(value), "d_pdf": dr.grad(density), "d_weight": dr.grad(weight)}
    return {name: _by_pair(dr.detach(value), n) for name, value in found.items()}


def _all_at_once(bsdf: Any, context: Any, inputs: dict[str, Any]) -> dict[str, Any]:
    import drjit as dr
    import mitsuba as mi

    n = len(inputs["wi"])
    si, towards, xi = _traced(inputs)
    value, density = bsdf.eval_pdf(context, si, towards)
    alone = bsdf.eval(context, si, towards), bsdf.pdf(context, si, towards)
    drawn, weight = bsdf.sample(context, si, xi[2], mi.Point2f(xi[:2]))
    again, density_again = bsdf.eval_pdf(context, si, drawn.wo)
    found = {
        "eval": value, "pdf": density, "eval_alone": alone[0], "pdf_alone": alone[1],
        "wo": drawn.wo, "weight": weight, "sample_pdf": drawn.pdf, "eta": drawn.eta,
        "type": drawn.sampled_type, "component": drawn.sampled_component,
        "eval_at": again, "pdf_at": density_again,
    }  # fmt: skip
    dr.eval(found)
    arrays = {name: _by_pair(value, n) for name, value in found.items()}
    return {**arrays, "flags": _flags(bsdf)}


def _by_pair(value: Any, n: int) -> Any:
    array = np.array(value)
    array = array.reshape(-1, array.shape[-1]) if array.ndim > 1 else array
    return np.broadcast_to(array.T, (n, *array.T.shape[1:]))


def _one_at_a_time(bsdf: Any, context: Any, inputs: dict[str, Any]) -> dict[str, Any]:
    rows: dict[str, list[Any]] = {}
    for wi, wo, xi, uv in zip(*(inputs[name].tolist() for name in ("wi", "wo", "xi", "uv")), strict=True):
        si = _interaction(wi, uv, 0)
        value, density = bsdf.eval_pdf(context, si, wo)
        drawn, weight = bsdf.sample(context, si, xi[2], xi[:2])
        again, density_again = bsdf.eval_pdf(context, si, drawn.wo)
        found = {
            "eval": np.ravel(value), "pdf": density, "eval_alone": np.ravel(bsdf.eval(context, si, wo)),
            "pdf_alone": bsdf.pdf(context, si, wo), "wo": np.ravel(drawn.wo), "weight": np.ravel(weight),
            "sample_pdf": drawn.pdf, "eta": drawn.eta, "type": drawn.sampled_type,
            "component": drawn.sampled_component, "eval_at": np.ravel(again), "pdf_at": density_again,
        }  # fmt: skip
        for name, entry in found.items():
            rows.setdefault(name, []).append(entry)
    return {**{name: np.array(entries) for name, entries in rows.items()}, "flags": _flags(bsdf)}
