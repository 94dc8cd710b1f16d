"""Arbitrary-precision truth: P22 of each family typed once, everything else integrated from it.

``value(family, quantity, *arguments)`` takes the arguments of the ufunc ``microfacet.<family>.<quantity>`` in
the same order, as exact floating-point numbers, and returns a python-flint ball with at least ``DIGITS``
correct digits, or raises ``ArithmeticError``. The integrals below are single integrals of P22 over the half
plane beyond a line (P2, slope_cdf, sigma, Lambda, G1) or beyond a circle (survival), substituted so that r^2
= p^2 + q^2:

    P2(p)          = int_0^inf 2 P22(p^2 + q^2) dq
    Pr(slope > p)  = int_0^inf 2 atan(q/p) P22(p^2 + q^2) q dq                    (p > 0)
    J(mu)          = int_0^inf 2 (q - mu atan(q/mu)) P22(mu^2 + q^2) q dq  = E[(slope - mu)+]
    survival(r)    = int_0^inf 2 pi P22(r^2 + q^2) q dq
    1 - survival   = int_0^inf pi P22(r^2 exp(-v)) r^2 exp(-v) dv

All integrands are positive, so nothing cancels; quadrature.py measures its own error, and the balls enclose
what rounding does.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from inspect import signature

from flint import arb, ctx

from quadrature import TOLERANCE, NotConverged, between, half_line

DIGITS = 20
PRECISIONS = (128, 256, 512)  # bits, tried in turn

Density = Callable[[arb], arb]


# The densities P22 as functions of y = r^2: the only formulas typed here.


def beckmann(alpha: arb) -> Density:
    scale = 1 / (arb.pi() * alpha**2)
    return lambda y: scale * (-y / alpha**2).exp()


def ggx(alpha: arb) -> Density:
    return lambda y: alpha**2 / (arb.pi() * (y + alpha**2) ** 2)


def gtr(alpha: arb, gamma: arb) -> Density:
    scale = _gtr_scale(alpha, gamma)
    return lambda y: scale * (1 + y) ** (gamma - 2) * (y + alpha**2) ** -gamma


def _gtr_scale(alpha: arb, gamma: arb) -> arb:
    if alpha == 1:
        return 1 / arb.pi()
    with ctx.workprec(3 * ctx.prec):  # both differences cancel near alpha = 1 and gamma = 1
        if gamma == 1:
            return (alpha**2 - 1) / (2 * arb.pi() * alpha.log())
        return (gamma - 1) * (alpha**2 - 1) / (arb.pi() * (1 - alpha ** (2 - 2 * gamma)))


def student_t(alpha: arb, gamma: arb) -> Density:
    scale, width = 1 / (arb.pi() * alpha**2), alpha**2 * (gamma - 1)
    return lambda y: scale * (1 + y / width) ** -gamma


def k0(alpha: arb) -> Density:
    return bessel_k(alpha, arb(1))


def bessel_k(alpha: arb, a: arb) -> Density:
    scale = 2 / (arb.pi() * alpha**2 * a.gamma())

    def density(y: arb) -> arb:
        if y == 0:
            return 1 / (arb.pi() * alpha**2 * (a - 1)) if a > 1 else arb.pos_inf()
        x = y.sqrt() / alpha
        return scale * x ** (a - 1) * _bessel_k(a - 1, 2 * x)

    return density


def _bessel_k(nu: arb, z: arb) -> arb:
    """K_nu(z), z > 0. The series loses 3 z bits; given the negative order, flint takes no slow detour."""
    order, middle = abs(nu), z.mid()
    lost = 0 if z > 0.55 * ctx.prec + order else int(3 * float(z))
    with ctx.workprec(ctx.prec + lost):
        result = middle.bessel_k(-order)
    return result * (1 + arb(0, 1) * z.rad() * (2 + 4 * (order + 1) / middle))  # bound of abs((log K)')


def ei(alpha: arb) -> Density:
    scale = 1 / (arb.pi() * alpha**2)
    return lambda y: scale * (y / alpha**2).expint(arb(1)) if y != 0 else arb.pos_inf()


def erfc(alpha: arb) -> Density:
    """erfc(r)/r is E_{1/2}(r^2)/sqrt(pi)."""
    scale = 1 / (2 * arb.pi() * alpha**2)
    return lambda y: scale * (y / alpha**2).expint(arb(0.5)) if y != 0 else arb.pos_inf()


def double_ggx(alpha: arb) -> Density:
    """The mean of GGX is w^2 U(2, 1, w), w = alpha^2/y: Tricomi's (1 + w) exp(w) E_1(w) - 1."""
    scale = 1 / (arb.pi() * alpha**2)

    def tricomi(w: arb) -> arb:
        middle = w.mid()
        if w > 64:
            value = middle.hypgeom_u(arb(2), arb(1))
        else:
            with ctx.workprec(ctx.prec + 40 + int(3 * float(middle))):  # both cancel
                value = (1 + middle) * middle.exp() * middle.expint(arb(1)) - 1
        return value * (1 + arb(0, 1) * w.rad() * 3 / middle)  # bound of abs(d log U/d log w), which is 2

    def density(y: arb) -> arb:
        if y == 0:
            return scale
        w = alpha**2 / y
        return scale * w**2 * tricomi(w)

    return density


def exponential(alpha: arb) -> Density:
    scale = 2 / (arb.pi() * alpha**2)
    return lambda y: scale * (-2 * y.sqrt() / alpha).exp()


def generalised_exponential(alpha: arb, g: arb) -> Density:
    scale = 1 / (arb.pi() * alpha**2 * (1 + 2 / g).gamma())
    return lambda y: scale * (-((y / alpha**2) ** (g / 2))).exp()


def dirac(alpha: arb) -> Density:
    """All slopes have the length alpha: no function, so that `Ring` has the rest."""
    return lambda y: arb.pos_inf() if y == alpha**2 else arb(0)


_DENSITIES = {
    "beckmann": beckmann,
    "ggx": ggx,
    "gtr": gtr,
    "student_t": student_t,
    "k0": k0,
    "bessel_k": bessel_k,
    "ei": ei,
    "erfc": erfc,
    "double_ggx": double_ggx,
    "dirac": dirac,
    "exponential": exponential,
    "generalised_exponential": generalised_exponential,
}
FAMILIES: dict[str, int] = {
    name: len(signature(f).parameters) for name, f in _DENSITIES.items()
}  # parameters


class Reference:
    """The functions of one density at the working precision ``ctx.prec``; arguments are balls."""

    def __init__(self, family: str, *parameters: float) -> None:
        if len(parameters) != FAMILIES[family]:
            raise TypeError(f"{family} takes {FAMILIES[family]} parameters")
        balls = [arb(float(x)) for x in parameters]
        self.density = _DENSITIES[family](*balls)
        self._scales = [balls[0]] + ([arb(1)] if family == "gtr" else [])
        if family == "student_t":
            self._scales.append(balls[0] * (balls[1] - 1).sqrt())
        if family == "bessel_k":
            self._scales.append(balls[0] * balls[1].sqrt())
        self._excess: dict[tuple[object, ...], arb] = {}  # sigma, Lambda and G1 need the same integral
        self._radius: dict[arb, arb] = {}  # sample_u needs that of sample_slope
        self._infinite_marginal = (family == "bessel_k" and balls[1] <= 0.5) or family == "erfc"

    def _beyond(self, kernel: Callable[[arb], arb], p: arb, tolerance: float = TOLERANCE) -> arb:
        """int_0^inf kernel(q) P22(p^2 + q^2) dq."""
        square = p * p
        scales = list(self._scales)
        if p > 0:  # features at p itself and, for exponential tails, at the geometric mean of p and alpha
            scales += [min(max(p, min(scales)), max(scales) * 10**6)]
            scales += [(p * scales[0]).sqrt()] if p > scales[0] else [p]
        return half_line(lambda q: kernel(q) * self.density(square + q * q), scales, tolerance)

    # Slopes.

    def P22(self, p: arb, q: arb) -> arb:
        return self.density(p * p + q * q)

    def P2(self, p: arb) -> arb:
        if p == 0 and self._infinite_marginal:
            return arb.pos_inf()
        return self._beyond(lambda q: arb(2), abs(p))

    def slope_sf(self, p: arb) -> arb:
        """Pr(slope > p), p >= 0."""
        return arb(0.5) if p == 0 else self._beyond(lambda q: 2 * (q / p).atan() * q, p)

    def slope_cdf(self, p: arb) -> arb:
        return 1 - self.slope_sf(p) if p > 0 else self.slope_sf(-p)

    def excess(self, mu: arb) -> arb:
        """J(mu) = E[(slope - mu)+], mu >= 0."""
        key = mu.mid().man_exp() if mu != 0 else ()
        if key not in self._excess:
            arm = (lambda q: mu * (q / mu).atan()) if mu != 0 else (lambda q: arb(0))
            self._excess[key] = self._beyond(lambda q: 2 * (q - arm(q)) * q, mu)
        return self._excess[key]

    # Directions.

    def D(self, u: arb) -> arb:
        return arb(0) if u <= 0 else self.density((1 - u) * (1 + u) / u**2) / u**4

    def sigma(self, u: arb) -> arb:
        sine = ((1 - u) * (1 + u)).sqrt()
        below = arb(0) if sine == 0 else sine * self.excess(abs(u) / sine)
        return u + below if u > 0 else below

    def Lambda(self, u: arb) -> arb:
        if u == 0:
            return arb.pos_inf()
        if u < 0:
            return -1 - self.Lambda(-u)
        return self.sigma(-u) / u

    def G1(self, u: arb) -> arb:
        return 1 / (1 + self.Lambda(u)) if u > 0 else arb(0)

    # Radius.

    def survival(self, r: arb, tolerance: float = TOLERANCE) -> arb:
        return arb(1) if r == 0 else self._beyond(lambda q: 2 * arb.pi() * q, r, tolerance)

    def inside(self, r: arb, tolerance: float = TOLERANCE) -> arb:
        """1 - survival(r)."""
        square = r * r

        def integrand(v: arb) -> arb:
            y = square * (-v).exp()
            return arb.pi() * self.density(y) * y

        return half_line(integrand, [arb(1)], tolerance)

    def sample_slope(self, xi: arb) -> arb:
        """The radius with survival 1 - xi: Newton on the smaller tail, in logarithms of tail and radius."""
        if xi == 0:
            return arb(0)
        if xi not in self._radius:
            self._radius[xi] = self._inverse(xi)
        return self._radius[xi]

    def _inverse(self, xi: arb) -> arb:
        tail, target, sign = (self.inside, xi, 1) if xi < 0.5 else (self.survival, 1 - xi, -1)

        def density(r: arb) -> arb:  # of log r
            return 2 * arb.pi() * r * r * self.density(r * r)

        def newton(r: arb, mass: arb) -> arb:
            return (target / mass).log() * mass / (sign * density(r))

        r, limit, previous = self._scales[-1], 1.0, 0.0
        for _ in range(100):  # coarse: a step may grow as long as its direction lasts
            step = float(newton(r, tail(r, 1e-5)))
            limit = 2 * limit if step * previous > 0 else min(1.0, abs(previous) / 2 or 1.0)
            step = previous = math.copysign(min(abs(step), limit), step)
            r = (r * arb(step).exp()).mid()
            if abs(step) < 1e-3:
                break
        mass = tail(r)
        for _ in range(20):  # fine: the tail follows its own derivative over the small distance left
            step = newton(r, mass)
            if abs(step) < 1e-2 * TOLERANCE:
                return r * (1 + arb(0, TOLERANCE * (1 + mass / density(r))))
            moved = (r * step.exp()).mid()
            mass, r = mass + sign * between(density, r, moved), moved
        raise NotConverged("the inverse of the survival function was not found")

    def sample_u(self, xi: arb) -> arb:
        return (1 + self.sample_slope(xi) ** 2).rsqrt()


class Ring(Reference):
    """Dirac, by the azimuth at which a slope of the length alpha has the component p along an axis."""

    def __init__(self, family: str, *parameters: float) -> None:
        super().__init__(family, *parameters)
        self._length = self._scales[0]

    def _azimuth(self, p: arb) -> arb:
        return (p / self._length).acos()

    def P2(self, p: arb) -> arb:  # -d(azimuth)/dp over pi
        size = abs(p)
        if size >= self._length:
            return arb.pos_inf() if size == self._length else arb(0)
        return 1 / (arb.pi() * self._length * self._azimuth(size).sin())

    def slope_sf(self, p: arb) -> arb:
        return self._azimuth(p) / arb.pi() if p < self._length else arb(0)

    def excess(self, mu: arb) -> arb:
        if mu >= self._length:
            return arb(0)
        azimuth = self._azimuth(mu)
        return (self._length * azimuth.sin() - mu * azimuth) / arb.pi()

    def survival(self, r: arb, tolerance: float = TOLERANCE) -> arb:
        return arb(1 if r < self._length else 0)

    def inside(self, r: arb, tolerance: float = TOLERANCE) -> arb:
        return 1 - self.survival(r)

    def sample_slope(self, xi: arb) -> arb:
        return self._length


@lru_cache(maxsize=1000)
def _reference(precision: int, family: str, parameters: tuple[float, ...]) -> Reference:
    return (Ring if family == "dirac" else Reference)(family, *parameters)


_ARGUMENTS = {"P22": 2}  # number of arguments before the parameters, 1 unless stated


@lru_cache(maxsize=100_000)
def value(family: str, quantity: str, *arguments: float) -> arb:
    """The true value at the exact floating-point arguments, which are those of the ufunc, in its order."""
    numbers = [float(x) for x in arguments]
    n = _ARGUMENTS.get(quantity, 1)
    failure: ArithmeticError | None = None
    for precision in PRECISIONS:
        with ctx.workprec(precision):
            try:
                result = getattr(_reference(precision, family, tuple(numbers[n:])), quantity)(
                    *map(arb, numbers[:n])
                )
            except NotConverged as error:
                failure = error
                continue
            if result == 0 or result == arb.pos_inf() or result == arb.neg_inf():
                return result
            if result.rel_accuracy_bits() > DIGITS * math.log2(10):
                return result
            failure = NotConverged(f"only {result.rel_accuracy_bits()} correct bits")
    raise NotConverged(f"{family}.{quantity}{tuple(numbers)}: {failure}")


def relative_error(result: float, truth: arb) -> float:
    """abs(result/truth - 1); 0 for the same zero or infinity, inf where only one is either, or for nan."""
    result = float(result)
    if math.isnan(result):
        return math.inf
    if math.isinf(result) or not truth.is_finite() or truth == 0:
        return 0.0 if truth == arb(result) else math.inf
    return float(abs(arb(result) / truth - 1))
