"""Calls of graphs by the arguments that users give: functions of a cosine, materials, and what all share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from microfacet._export.arguments import UNIFORMS, Arguments
from microfacet._export.derivatives import Recipe, function, graph_of, tables_of
from microfacet._export.guard import Interval, cosines
from microfacet._export.libraries import Library
from microfacet._export.subject import Subject, optics_of

__all__ = ["Cosine", "Functions", "Material"]


class Functions:
    """Calls of graphs; a subclass says which."""

    def __init__(self, subject: Subject, library: Library) -> None:
        self._subject, self._library = subject, library

    def _recipe(self, quantity: str, parameters: dict[str, Any], precision: str, cosine: bool) -> Recipe:
        """How a call is recorded.

        Tables stand for the formulas if that is shorter and the parameters they are made for are numbers.
        Formulas that are accurate in double precision alone are evaluated in it.
        """
        density, given = self._subject.density, self._subject.given(quantity, parameters)
        if density.tables_alone or density.tabulated:
            known = dict(given)
            for name in density.tabulated:
                if isinstance(parameters.get(name), bool | int | float):
                    known[name] = float(parameters[name])
            recipe = self._formulas(quantity, known, precision, cosine)
            if tables_of(recipe) is not None:
                return recipe._replace(tabulated=True)
        return self._formulas(quantity, given, precision if density.exact else "float64", cosine)

    def _formulas(
        self, quantity: str, given: dict[str, float | None], precision: str, cosine: bool
    ) -> Recipe:
        subject = self._subject
        domains = {name: subject.domain(name, quantity) for name, value in given.items() if value is None}
        domains |= dict.fromkeys(UNIFORMS, Interval(0.0, 1.0, with_lower=True))
        if cosine:
            domains["u"] = cosines(precision)
        return Recipe(
            source=subject.source,
            quantity=quantity,
            parameters=tuple(given.items()),
            domains=tuple(domains.items()),
            float64=precision == "float64",
            cosine=cosine,
            native=self._library.native or precision == "float64",
            tabulated=False,
        )

    def _call(
        self,
        quantity: str,
        parameters: dict[str, Any],
        vectors: dict[str, Any],
        numbers: dict[str, Any] | None = None,
        *,
        cosine: bool = False,
    ) -> Any:
        """The results of a quantity: one array, one of directions, or several."""
        owner = f"array_functions.{quantity}"
        arguments = Arguments(owner, self._library, vectors, {**(numbers or {}), **parameters})
        recipe = self._recipe(quantity, parameters, arguments.precision, cosine)
        graph = graph_of(recipe)
        inputs = arguments.inputs(graph.inputs, graph.real)
        results = function(recipe, self._library)(inputs)
        if graph.real != arguments.precision:
            results = [arguments.converted(result, arguments.precision) for result in results]
        return self._gathered([name for name, _ in graph.results], results)

    def _gathered(self, names: Sequence[str], results: Sequence[Any]) -> Any:
        """The components of a direction as one array; several results as a tuple."""
        found: dict[str, list[Any]] = {}
        for name, result in zip(names, results, strict=True):
            found.setdefault(name.partition(".")[0], []).append(result)
        parts = [part[0] if len(part) == 1 else self._library.stack(part) for part in found.values()]
        return parts[0] if len(parts) == 1 else tuple(parts)

    def _uniforms(self, quantity: str) -> int:
        free = [*self._subject.names, *optics_of(quantity)]
        parameters = dict.fromkeys(name for name in free if name not in self._subject.fixed)
        inputs = graph_of(self._recipe(quantity, parameters, "float32", False)).inputs
        return sum(name in UNIFORMS for name in inputs)


class Cosine(Functions):
    """Functions of u = cos(theta), of isotropic distributions: D, sigma, Lambda and G1.

    `u` lies in [-1, 1]; beyond, results are nan. Parameters are those of `ArrayFunctions`.
    """

    def D(self, u: Any, **parameters: Any) -> Any:
        """Density of normals per steradian; 0 for u <= 0."""
        return self._call("D", parameters, {}, {"u": u}, cosine=True)

    def sigma(self, u: Any, **parameters: Any) -> Any:
        """Projected area of the microfacets, per unit area of surface."""
        return self._call("sigma", parameters, {}, {"u": u}, cosine=True)

    def Lambda(self, u: Any, **parameters: Any) -> Any:
        """Smith's Lambda, sigma(u)/u - 1; inf at u = 0."""
        return self._call("Lambda", parameters, {}, {"u": u}, cosine=True)

    def G1(self, u: Any, **parameters: Any) -> Any:
        """Smith's masking u/sigma(u), 0 for u <= 0."""
        return self._call("G1", parameters, {}, {"u": u}, cosine=True)


class Material(Functions):
    """A material of one event: `conductor` with `eta` and `k`, or `dielectric` with `eta`.

    All are parameters like those of the distribution: arrays that broadcast against the leading axes of the
    directions, and can be differentiated. For three channels, say, give directions (..., 1, 3) and `eta`
    (3,). Masking and shadowing are correlated, light that passes a dielectric is radiance, and `eta` is the
    index below the surface over that above: what `microfacet.Conductor` and `microfacet.Dielectric` are by
    default.
    """

    def __init__(self, subject: Subject, library: Library, name: str) -> None:
        super().__init__(subject, library)
        self._name = name

    def __repr__(self) -> str:
        return f"<{self._name} of {self._subject.source} on arrays of {self._library.name}>"

    @property
    def sample_dims(self) -> int:
        """How many uniform numbers `sample` takes."""
        return self._uniforms(f"{self._name}_sample")

    def eval(self, wi: Any, wo: Any, **parameters: Any) -> Any:
        """f |cos theta_o|: the light per steradian towards `wo` (..., 3), of light from `wi` (..., 3)."""
        return self._call(f"{self._name}_eval", parameters, {"wi": wi, "wo": wo})

    def pdf(self, wi: Any, wo: Any, **parameters: Any) -> Any:
        """Density per steradian of the directions that `sample` draws."""
        return self._call(f"{self._name}_pdf", parameters, {"wi": wi, "wo": wo})

    def sample(self, wi: Any, xi: Any, **parameters: Any) -> Any:
        """Directions drawn for `wi` (..., 3) from uniform numbers `xi` (..., sample_dims).

        Returns
        -------
        wo : array, shape (..., 3)
        weight : array, shape (...)
            ``eval/pdf``, without dividing.
        pdf : array, shape (...)
        """
        return self._call(f"{self._name}_sample", parameters, {"wi": wi, "xi": xi})
