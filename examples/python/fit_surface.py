"""Which family describes a measured surface? The terrain that ships with matplotlib, at three lags.

python examples/python/fit_surface.py [FILE]
"""

import sys

import microfacet as mf

surface = mf.read_surface(sys.argv[1]) if len(sys.argv) > 1 else mf.sample_terrain()
surface = surface.level()
print(*surface.steps, sep="\n")

for lag in (2, 4, 8):
    print(f"\nlag {lag} px")
    results = mf.fit(surface, lag=lag, max_slopes=10_000)
    for result in results:
        behind = (result.log_likelihood - results[0].log_likelihood) / result.n
        values = ", ".join(f"{name} {value:.3g}" for name, value in result.params.items())
        print(f"  {result.family:10} {behind:+.4f} nats per slope   {values}")
