"""A density of one's own as a family: what fits, pictures and commands ask of a family, it answers too."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from typing import Any

import numpy as np

from microfacet import _core
from microfacet._densities.standard import Standard
from microfacet._family import Family, Parameter, families
from microfacet._family.registry import searched
from microfacet._radial import RadialNDF

__all__ = ["UserFamily", "family_of"]

_KEPT = 8  # densities of a family, of so many shapes


class _Kernels:
    """The functions of a family: quantities of (x, alpha, *shape), of which P22 takes two slopes.

    What directions see comes from the tables of the density at that shape, which are made at first use; what
    fits ask for again and again comes from quadratures.
    """

    def __init__(self, standard: Callable[..., Standard], ndf: Callable[..., RadialNDF]) -> None:
        self._standard = lru_cache(_KEPT)(standard)
        self._ndf = lru_cache(_KEPT)(ndf)

    def P22(self, p: Any, q: Any, alpha: Any, *shape: float) -> Any:
        return self._standard(*shape).P22(np.hypot(p, q) / alpha) / alpha**2

    def survival(self, r: Any, alpha: Any, *shape: float) -> Any:
        return self._standard(*shape).survival(np.asarray(r) / alpha)

    def sample_slope(self, xi: Any, alpha: Any, *shape: float) -> Any:
        return alpha * self._standard(*shape).quantile(xi)

    def sample_u(self, xi: Any, alpha: Any, *shape: float) -> Any:
        return 1.0 / np.hypot(1.0, self.sample_slope(xi, alpha, *shape))

    def slope_cdf(self, p: Any, alpha: Any, *shape: float) -> Any:
        return self._standard(*shape).slope_cdf(np.asarray(p) / alpha)

    def D(self, u: Any, alpha: Any, *shape: float) -> Any:
        u = np.asarray(u, dtype=np.float64)
        with np.errstate(all="ignore"):
            slope = np.sqrt((1.0 - u) * (1.0 + u)) / u
            return np.where(u > 0.0, self.P22(slope, 0.0, alpha, *shape) / u**4, 0.0)

    def P2(self, p: Any, alpha: Any, *shape: float) -> Any:
        return self._standard(*shape).P2(np.asarray(p) / alpha) / alpha

    def sigma(self, u: Any, alpha: Any, *shape: float) -> Any:
        return self._at(alpha, shape).sigma(_directions(u))

    def Lambda(self, u: Any, alpha: Any, *shape: float) -> Any:
        return self._at(alpha, shape).Lambda(_directions(u))

    def G1(self, u: Any, alpha: Any, *shape: float) -> Any:
        return self._at(alpha, shape).G1(_directions(u))

    def _at(self, alpha: Any, shape: tuple[float, ...]) -> RadialNDF:
        return self._ndf(*shape).with_roughness(float(alpha))


def _directions(u: Any) -> Any:
    u = np.asarray(u, dtype=np.float64)
    return np.stack((np.sqrt((1.0 - u) * (1.0 + u)), np.zeros_like(u), u), -1)


class _OwnKernels(_Kernels):
    """Those of one density: its tables have the densities too."""

    def P22(self, p: Any, q: Any, alpha: Any, *shape: float) -> Any:
        return self._at(alpha, shape).P22(p, q)

    def D(self, u: Any, alpha: Any, *shape: float) -> Any:
        return self._at(alpha, shape).D(_directions(u))

    def P2(self, p: Any, alpha: Any, *shape: float) -> Any:
        return self._at(alpha, shape).P2(p)

    def slope_cdf(self, p: Any, alpha: Any, *shape: float) -> Any:
        return self._at(alpha, shape).slope_cdf(p)


class UserFamily(Family):
    """A family of one's own: a density of slopes with parameters, for `fit` and `fit_table`.

    Parameters
    ----------
    name : str
        What results call it: a word that no family has.
    P22 : callable
        P22(r, parameter, ...), the density of slopes of length r at alpha = 1, up to a factor: a function of
        arrays r and of numbers that are the parameters in their order.
    parameters : mapping of str to (lower, upper, start), optional
        The interval of each parameter, open and with a finite lower end, and a value inside, from which the
        search starts.
    title : str, optional
        As people write it.

    Examples
    --------
    >>> import numpy as np
    >>> import microfacet as mf
    >>> mine = mf.UserFamily("mine", lambda r, k: np.exp(-(r**k)), {"k": (0.5, 8.0, 2.0)})
    >>> slopes = np.random.default_rng(1).normal(size=(4000, 2))
    >>> result = mf.fit(slopes, families=[mine, "beckmann"])[1]
    >>> result.family, round(result.params["k"], 1), result.ndf.family
    ('mine', 2.0, 'radial')
    """

    #: The roughness that a density brings, where it is not free.
    roughness: Mapping[str, float] = {}

    def __init__(
        self,
        name: str,
        P22: Callable[..., Any],
        parameters: Mapping[str, tuple[float, float, float]] | None = None,
        *,
        title: str | None = None,
    ) -> None:
        _check_name(name)
        if not callable(P22):
            raise ValueError(f"UserFamily: P22 must be callable, got {type(P22).__name__}")
        own = tuple(_parameter(*item) for item in (parameters or {}).items())
        make = partial(_made, name, P22, tuple(one.name for one in own))
        kernels = _Kernels(
            lambda *shape: _said(name, lambda: Standard(lambda r: P22(r, *shape))),
            lambda *shape: RadialNDF(lambda r: P22(r, *shape)),
        )
        self._state(name, title, make, kernels, own, (name, P22, dict(parameters or {}), title))

    def _state(
        self,
        name: str,
        title: str | None,
        make: Any,
        kernels: Any,
        own: tuple[Parameter, ...],
        made_of: tuple[Any, ...],
    ) -> None:
        pictured = tuple(one.pictured for one in own)
        values = {
            "name": name,
            "title": title or name,
            "cls": make,
            "kernels": kernels,
            "parameters": (Parameter("alpha", *_core.roughness, meaning="Roughness"), *own),
            "sources": (),
            "anisotropic": True,
            "singular": False,
            "shapes": (pictured,),
            "figures": tuple((alpha, *pictured) for alpha in (0.5, 0.7, 1.2)),
            "_made_of": made_of,
        }
        for field, value in values.items():
            object.__setattr__(self, field, value)

    @property
    def ndf(self) -> RadialNDF | None:
        """The density, if its roughness alone is free."""
        first = self.__dict__["_made_of"][0]
        return first if isinstance(first, RadialNDF) else None

    def __reduce__(self) -> tuple[Any, ...]:
        made_of: tuple[Any, ...] = self.__dict__["_made_of"]
        if isinstance(made_of[0], RadialNDF):
            return family_of, made_of
        name, P22, parameters, title = made_of
        return partial(UserFamily, title=title), (name, P22, parameters)

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self.__dict__["_made_of"] == other.__dict__["_made_of"]

    def __hash__(self) -> int:
        return hash(self.name)

    def __repr__(self) -> str:
        return f"<UserFamily {self.name}: {', '.join(one.name for one in self.parameters)}>"


def family_of(ndf: RadialNDF, name: str = "density", title: str = "Own density") -> UserFamily:
    """The family of one density, whose roughness alone is free."""
    _check_name(name)
    family = UserFamily.__new__(UserFamily)
    standard = ndf.with_roughness(1.0)
    kernels = _OwnKernels(lambda: Standard(lambda r: standard.P22(r, 0.0)), lambda: standard)
    family._state(name, title, ndf.with_roughness, kernels, (), (ndf, name, title))
    x, y, turn = ndf._values
    axes = {"alpha": x} if x == y and turn == 0.0 else {"alpha_x": x, "alpha_y": y, "rotation": turn}
    object.__setattr__(family, "roughness", axes)
    return family


def _made(name: str, P22: Callable[..., Any], names: tuple[str, ...], **values: Any) -> RadialNDF:
    shape = tuple(values.pop(own) for own in names)
    found: RadialNDF = _said(name, lambda: RadialNDF(lambda r: P22(r, *shape), **values))
    return found


def _said(name: str, make: Callable[[], Any]) -> Any:
    """What is made; a density that is none is reported under the family's name."""
    try:
        return make()
    except ValueError as error:
        raise ValueError(f"{name}: {str(error).removeprefix('RadialNDF: ')}") from None


def _check_name(name: object) -> None:
    if not isinstance(name, str) or not name.isidentifier() or len(name) > 40:
        raise ValueError(f"UserFamily: name must be a word, got {name!r:.60}")
    if name in {family.name for family in families()}:
        raise ValueError(f"UserFamily: {name} is a family of the library, choose another name")


def _parameter(name: str, interval: Any) -> Parameter:
    try:
        lower, upper, start = (float(value) for value in interval)
    except (TypeError, ValueError):
        raise ValueError(f"UserFamily: {name} must be (lower, upper, start), got {interval!r:.60}") from None
    if not name.isidentifier() or name in ("alpha", "alpha_x", "alpha_y", "rotation", "r"):
        raise ValueError(f"UserFamily: {name!r:.40} cannot be the name of a parameter")
    if not (math.isfinite(lower) and lower < start < upper):
        raise ValueError(
            f"UserFamily: {name} needs a finite lower end, and a start inside of its interval, "
            f"got {lower:g}, {upper:g}, {start:g}"
        )
    return Parameter(name, lower, upper, name, (start,), start, searched(lower, upper))
