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
    results = mf.fit(surface, lag=lag, max_slopes=50_000)
    for result in results:
        behind = result.held_out - results[0].held_out  # of slopes that the fit had not seen
        values = ", ".join(
            f"{name} {value:.3g} ± {result.standard_errors[name]:.1g}"
            for name, value in result.params.items()
        )
        print(f"  {result.family:23} {result.symmetry:12} {behind:+.4f} nats per slope   {values}")
