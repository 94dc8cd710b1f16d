"""The compiled core: one namespace per family, each with its ufuncs and the facts its header states."""

from types import ModuleType

import numpy as np

beckmann: ModuleType
ggx: ModuleType
gtr: ModuleType
student_t: ModuleType
k0: ModuleType
bessel_k: ModuleType
ei: ModuleType
erfc: ModuleType
double_ggx: ModuleType
generalised_exponential: ModuleType
exponential: ModuleType
dirac: ModuleType
radial: ModuleType  # densities of the user's own, by handle: with tables that are searched,
prepared: ModuleType  # and with tables like a family's
slopes: ModuleType  # densities on grids of slopes, by handle
families: tuple[str, ...]
roughness: tuple[float, float]  # the open interval of alpha

isa: str  # the build in use
available: tuple[str, ...]  # the builds that this processor runs, the best one last
exp: np.ufunc  # through the same loops as the kernels, which are measured against it
fresnel_dielectric: np.ufunc
fresnel_conductor: np.ufunc
