"""How fast the library is, beside a copy of the same array, its own exp, NumPy, SciPy and Mitsuba 3.

``make bench`` runs all and writes docs/performance.md; ``make bench-check`` is the gate of continuous
integration. ``python -m benchmarks --help`` lists the options.
"""
