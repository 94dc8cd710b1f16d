"""What is rendered: a distribution of normals, and what its facets are made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

__all__ = ["GLASS", "Look", "metals"]

GLASS = 1.5  # index of refraction


def metals() -> list[str]:
    """The names of metals (and some crystals) that Mitsuba has indices for."""
    import mitsuba

    folder = Path(mitsuba.__file__).parent / "data" / "ior"
    return sorted(path.name.removesuffix(".eta.spd") for path in folder.glob("*.eta.spd"))


@dataclass(frozen=True)
class Look:
    """A rough material.

    Attributes
    ----------
    family : str
        Name of the family.
    parameters : mapping
        Those of the family's class: alpha, or alpha_x, alpha_y and rotation (radians); its shape parameter.
    material : str
        A name of `metals()`, "none" for a metal that absorbs nothing, or "glass".
    ior : float
        Of glass.
    scattering : str
        "single" or "multiple".
    """

    family: str
    parameters: Mapping[str, float]
    material: str = "Au"
    ior: float = GLASS
    scattering: str = "single"
    density: Any = None  # a RadialNDF in place of a family

    @property
    def clear(self) -> bool:
        """Whether light passes through."""
        return self.material == "glass"

    @property
    def rotation(self) -> float:
        """The angle of the axes, in radians; 0 where there is none to see."""
        same = self.parameters.get("alpha_x") == self.parameters.get("alpha_y")
        return 0.0 if same else self.parameters.get("rotation", 0.0)

    def bsdf(self) -> dict[str, Any]:
        """As Mitsuba takes it."""
        names = {"alpha_x": "alpha_u", "alpha_y": "alpha_v"}
        shape = {names.get(k, k): float(v) for k, v in self.parameters.items() if k != "rotation"}
        what = {"distribution": self.family, **shape, "scattering": self.scattering}
        if self.density is not None:
            from microfacet.mitsuba import table

            what |= table(self.density)
        if self.clear:
            return {"type": "microfacet_dielectric", "int_ior": self.ior, "ext_ior": 1.0, **what}
        return {"type": "microfacet_conductor", "material": self.material, **what}

    def check(self) -> None:
        """ValueError, in one sentence, for a material that there is not."""
        if not (self.clear or self.material == "none" or self.material in (known := metals())):
            raise ValueError(
                f"material must be glass, none or one of {', '.join(known)}, got {self.material!r}"
            )

    def record(self) -> dict[str, Any]:
        """For JSON."""
        glass = {"ior": self.ior} if self.clear else {}
        return {
            "family": self.family,
            "parameters": dict(self.parameters),
            "material": self.material,
            **glass,
            "scattering": self.scattering,
        }
