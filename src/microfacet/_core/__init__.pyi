"""The compiled core: one namespace per family, each with its ufuncs and the facts its header states."""

from types import ModuleType

beckmann: ModuleType
ggx: ModuleType
gtr: ModuleType
student_t: ModuleType
k0: ModuleType
bessel_k: ModuleType
families: tuple[str, ...]
