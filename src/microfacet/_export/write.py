"""The public function: a family in a language, as text or as a file."""

from __future__ import annotations

import re
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path

from microfacet._export.choice import chosen
from microfacet._export.density import density_of
from microfacet._export.file import Content, plain_file
from microfacet._export.functions import expanded, meaning
from microfacet._export.head import head
from microfacet._export.language import Language
from microfacet._export.languages import languages
from microfacet._files import replacing
from microfacet._frozen import Distribution

__all__ = ["export", "language_named"]

_PREFIX = re.compile(r"([A-Za-z][A-Za-z0-9]*_?)*")


def language_named(name: str) -> Language:
    """The language of that name; ValueError lists those that there are."""
    if name not in languages():
        raise ValueError(f"language must be one of {', '.join(languages())}, got {name!r}")
    return languages()[name]


def export(
    language: str,
    family: str | Distribution,
    functions: Iterable[str] = ("D", "G1", "sample_visible", "pdf_visible"),
    *,
    free: Iterable[str] | None = None,
    anisotropic: bool = False,
    prefix: str = "",
    path: str | Path | None = None,
    fresnel: str = "conductor",
    channels: int = 1,
    retroreflective: bool = False,
    scheme: str = "mixture",
    **parameters: float,
) -> str:
    """Write a family as source text of another language: the formulas of the library, in single precision.

    Parameters
    ----------
    language : str
        "c", "cuda" (also for HIP), "glsl" (4.50), "glsl-es" (3.00), "hlsl", "materialx", "metal", "osl",
        "slang" or "wgsl".
    family : str or distribution
        The name of a family, whose parameters are arguments of the functions unless they are given; or a
        distribution, whose parameters are fixed unless they are free.
    functions : iterable of str
        Quantities under the names that distributions give them (`D`, `sigma`, `sample_visible`, ...),
        and "conductor" or "dielectric" for the eval, pdf and sample of such a material, of which each can be
        named alone ("conductor_eval").
    free : iterable of str, optional
        The parameters that are arguments; all that are not given otherwise.
    anisotropic : bool
        Whether roughness is alpha_x and alpha_y rather than alpha.
    prefix : str
        What the names of all functions begin with, before the name of the family.
    path : path-like, optional
        A file to write the text to. MaterialX needs one: the text for each target goes into files beside it.
    fresnel : {"conductor", "schlick"}
        Whether a conductor reflects by its indices `eta` and `k`, or by Schlick's approximation from `f0`.
    channels : {1, 3}
        How many wavelengths a conductor has: its parameters, values and weights are vectors of three.
    retroreflective : bool
        Whether a conductor sends light back whence it came: wi is turned about the normal.
    scheme : {"mixture", "continuous"}
        How `sample_visible` and materials draw normals, both exactly: with fewer operations, or so that they
        are continuous in the random numbers, for quasi-Monte Carlo points.
    **parameters : float
        Fixed parameters, for instance ``gamma=2.5``; of materials `eta`, `k` or `f0`.

    Returns
    -------
    str
        The text of a file that stands alone: one function a quantity. The same call gives the same text.

    Raises
    ------
    ValueError
        If a language, function or parameter does not exist, if a parameter lies outside its domain, or if
        the language cannot express a function. Nothing is written then.

    Examples
    --------
    >>> import microfacet as mf
    >>> text = mf.export("glsl", "ggx", ["D"])
    >>> [line for line in text.splitlines() if line.startswith("float")]
    ['float ggx_D(vec3 m, float alpha) {']
    """
    described = language_named(language)
    names = expanded([functions] if isinstance(functions, str) else functions)
    density = density_of(family)
    own = density.own
    if not _PREFIX.fullmatch(prefix):
        raise ValueError(f"prefix must be letters, digits and single underscores, got {prefix!r}")
    freed = None if free is None else tuple([free] if isinstance(free, str) else free)
    values = {name: value for name, value in own.items() if name not in (freed or ())} | parameters
    if (
        own and freed is not None
    ):  # what a distribution does not know, such as eta, is free unless it is given
        freed = None
    choice = chosen(density, names, values, freed, anisotropic, fresnel, channels, retroreflective, scheme)
    if described.document and path is None:
        raise ValueError(f"{language} needs a path: what it makes is several files")
    graphs = {name: choice.graph(name, described.native) for name in names}
    content = Content(
        f"{prefix}{density.name}_",
        graphs,
        {name: meaning(name) for name in names},
        head(described, choice, graphs, prefix),
        choice.intervals,
    )
    if path is None:
        return plain_file(described, content)
    path = Path(path)
    make = described.document
    files = make(content, path.stem) if make else {path.name: plain_file(described, content)}
    first = next(iter(files))
    _write({path if name == first else path.parent / name: text for name, text in files.items()})
    return files[first]


def _write(files: dict[Path, str]) -> None:
    """All files, or none."""
    with ExitStack() as stack:
        for path, text in files.items():
            stack.enter_context(replacing(path)).write(text.encode())
