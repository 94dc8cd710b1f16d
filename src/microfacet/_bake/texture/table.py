"""The lookup texture: its texels, what they mean, and what is read from it between them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import microfacet as mf
from microfacet._bake.texture.axes import Axis
from microfacet._bake.texture.files import write
from microfacet._bake.texture.rows import CHANNELS
from microfacet._bake.texture.snippets import snippet
from microfacet._family import families
from microfacet._value import Value

__all__ = ["LookupTexture"]

Array = NDArray[Any]

_MEANING = {
    "albedo": "E, the part of the light from a direction that a rough perfect mirror returns in one "
    "order of scattering; its average over light from all sides, 2 int E(c) c dc",
    "energy": "1 - E, the part of the light from a direction that a rough perfect mirror loses in one "
    "order of scattering; its average over light from all sides",
    "split_sum": "A and B of the albedo F0 A + B of one order of scattering by a metal with Schlick's "
    "reflectance F0 + (1 - F0) (1 - wi.m)^5",
}


class LookupTexture(Value):
    """Texels over cosine, roughness and shape, made by `lookup_texture`.

    Attributes
    ----------
    kind, family : str
        What it holds, and of which family.
    values : ndarray, shape (slices, height, width, channels)
        Texels in float32 or float16. The cosine grows along a row, the roughness from row to row, the shape
        from slice to slice.
    cosine, roughness, shape : Axis
        Where they lie; `shape` is None for a family without a shape parameter.
    errors : dict
        What was measured: `quadrature`, of the integrals, and `lookup`, of what is read between the texels.

    Examples
    --------
    >>> import microfacet as mf
    >>> table = mf.lookup_texture("energy", "ggx", size=(32, 32), check=16)
    >>> missing, average = table.lookup(0.8, 0.36)
    >>> print(f"{missing:.3f} {1 - mf.Conductor(mf.GGX(alpha=0.36)).albedo([0.6, 0.0, 0.8]):.3f}")
    0.196 0.196
    """

    __slots__ = ("cosine", "errors", "family", "kind", "roughness", "shape", "values")

    kind: str
    family: str
    values: Array
    cosine: Axis
    roughness: Axis
    shape: Axis | None
    errors: dict[str, Any]

    def __init__(self, **parts: Any) -> None:
        self._keep(**parts)

    def __repr__(self) -> str:
        slices, height, width, _ = self.values.shape
        size = f"{width}x{height}" + (f"x{slices}" if slices > 1 else "")
        return f"<LookupTexture {self.kind} of {self.family}: {size}, {self.values.dtype}>"

    def _with_errors(self, errors: dict[str, Any]) -> LookupTexture:
        """The same texels, with what was measured of them."""
        return LookupTexture(**{**self._state(), "errors": errors})

    @property
    def channels(self) -> tuple[str, ...]:
        """What the last axis of the values holds."""
        return CHANNELS[self.kind]

    def lookup(self, cosine: ArrayLike, alpha: ArrayLike, shape: ArrayLike | None = None) -> Array:
        """Channels (..., 2) at any point: linear between texels and slices, the outermost texel beyond them.

        This is what a graphics processor returns with linear filtering and coordinates that are clamped to
        the edge. Textures of several slices need a `shape`.
        """
        from scipy.ndimage import map_coordinates

        slices, height, width, count = self.values.shape
        if shape is None and slices > 1:
            raise ValueError(f"lookup: this texture has {slices} slices: shape must say where to look")
        along = np.broadcast_arrays(
            0.0 if self.shape is None or shape is None else self.shape.coordinate(shape) * (slices - 1),
            self.roughness.coordinate(alpha) * height - 0.5,
            self.cosine.coordinate(cosine) * width - 0.5,
        )
        texels, places = self.values.astype(np.float64), np.reshape(along, (3, -1))
        read = [map_coordinates(texels[..., k], places, order=1, mode="nearest") for k in range(count)]
        return np.stack(read, -1).reshape(*along[0].shape, count)

    @property
    def command(self) -> str:
        """What makes it again on the command line."""
        _, height, width, _ = self.values.shape
        known = any(self.family == family.name for family in families())
        words = ["microfacet bake", self.kind.replace("_", "-"), self.family if known else "--density FILE"]
        words.append(f"--size {width}x{height}")
        if self.shape is not None:
            words.append(f"--{self.shape.name} {','.join(map(repr, self.shape.values))}")
        for axis, default in ((self.cosine, "linear"), (self.roughness, "sqrt")):
            if axis.mapping != default:
                name = "cosine" if axis is self.cosine else "roughness"
                words.append(f"--{name}-mapping {axis.mapping}")
        if self.values.dtype == np.float16:
            words.append("--half")
        return " ".join([*words, "-o FILE"])

    @property
    def metadata(self) -> dict[str, Any]:
        """All that one has to know in order to read the texels, as it is written with them."""
        slices, height, width, _ = self.values.shape
        axes = [self.cosine, self.roughness, *([] if self.shape is None else [self.shape])]
        return {
            "microfacet_lookup_texture": 1,
            "made_by": f"microfacet {mf.__version__}",
            "command": self.command,
            "kind": self.kind,
            "family": self.family,
            "channels": list(self.channels),
            "meaning": _MEANING[self.kind],
            "type": self.values.dtype.name,
            "width": width,
            "height": height,
            "slices": slices,
            "layout": "slice by slice, row by row, texel by texel, channel by channel; slices are below each "
            "other in an image",
            "axes": [
                {
                    "quantity": axis.name,
                    "along": along,
                    "mapping": axis.mapping,
                    "low": axis.low,
                    "high": axis.high,
                    "values": list(axis.values),
                }
                for axis, along in zip(axes, ("width", "height", "slices"), strict=False)
            ],
            "errors": self.errors,
        }

    def save(self, output: str | Path, format: str | None = None) -> None:
        """Write it: NAME.exr, or NAME.raw with NAME.raw.json beside it.

        Parameters
        ----------
        output : path
            It appears when it is whole.
        format : {"exr", "raw"}, optional
            By default as the name says.
        """
        write(self.values, self.metadata, output, format)

    def snippet(self, language: str, prefix: str | None = None) -> str:
        """Source text that reads this texture and adds the energy, or the ambient light, to a lobe.

        Parameters
        ----------
        language : {"glsl", "glsl-es", "hlsl", "wgsl", "slang", "metal", "cuda", "c", "osl"}
            CUDA's text is HIP's as well.
        prefix : str, optional
            Of all names in the text; the family's name and an underscore by default.
        """
        return snippet(self, language, f"{self.family}_" if prefix is None else prefix)
