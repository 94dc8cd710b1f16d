"""The library's functions outside of it: graphs of them, printed in other languages and run on arrays."""

from __future__ import annotations

from microfacet._export.write import export

__all__ = ["export"]
