from collections.abc import Mapping, Sequence
from typing import Any

exact_in_float32: dict[str, bool]
shorter_from_tables: dict[str, bool]

def record(
    family: str,
    quantity: str,
    parameters: Mapping[str, float | None],
    *,
    float64: bool = False,
    derivatives: Sequence[str] = (),
    native: bool = True,
    cosine: bool = False,
    mixture: bool = False,
    retroreflective: bool = False,
    channels: int = 1,
    tables: bytes | None = None,
) -> dict[str, Any]: ...
