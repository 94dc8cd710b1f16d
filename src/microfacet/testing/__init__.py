"""Statistical tests of samplers, ours or yours.

`chi2` compares sampled directions with a density per steradian; `ks_visible_slope` compares the slopes of
sampled visible normals with their distribution function. Both return a result that is true where the sampler
passed.

Examples
--------
>>> import microfacet as mf
>>> ndf = mf.GGX(alpha=0.3)
>>> mf.testing.chi2(ndf.sample, ndf.pdf, n=100_000)
Chi2Result(passed: p = 0.4... against 0.01, chi-square 103... of 1023 degrees, 100,000 samples)
>>> bool(mf.testing.chi2(ndf.sample, mf.GGX(alpha=0.31).pdf, n=100_000))
False
"""

from __future__ import annotations

from microfacet.testing._chi2 import Chi2Result, chi2
from microfacet.testing._slope import SlopeResult, ks_visible_slope, visible_slope_cdf
from microfacet.testing._threshold import sidak

__all__ = ["Chi2Result", "SlopeResult", "chi2", "ks_visible_slope", "sidak", "visible_slope_cdf"]
