"""Settings for all tests: property tests are the same in every run, and BLAS keeps to one thread."""

import os

from hypothesis import settings

settings.register_profile("microfacet", deadline=None, derandomize=True, database=None)
settings.load_profile("microfacet")

# Where the workers of pytest-xdist fill the cores, the threads of a small eigenvalue problem wait for each
# other: a hundredth of a second becomes three. NumPy, which is not yet imported, reads it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
