"""How much do the families differ where it matters? Masking at grazing angles, at equal median slope.

python examples/python/compare_families.py
"""

import numpy as np

import microfacet as mf

SHAPES = {"gtr": (3.0,), "student_t": (2.5,), "bessel_k": (1.5,)}
MEDIAN_SLOPE = 0.25

# alpha that gives every family the same median slope: for all but GTR it is a stretch; there, bisect.
angles = np.radians([0, 45, 60, 75, 85, 89])
print("G1 at theta =", *(f"{angle:6.0f}" for angle in np.degrees(angles)))
for family in mf.families():
    shape = SHAPES.get(family.name, [own.examples[0] for own in family.parameters[1:]])
    low, high = 1e-4, 10.0
    for _ in range(60):
        alpha = np.sqrt(low * high)
        if family.kernels.sample_slope(0.5, alpha, *shape) < MEDIAN_SLOPE:
            low = alpha
        else:
            high = alpha
    masking = family.kernels.G1(np.cos(angles), alpha, *shape)
    print(f"{family.title:12}", *(f"{value:6.3f}" for value in masking), f"  alpha = {alpha:.3f}")
