"""All that one run measured, and its file."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from .suite import Measurement


@dataclass
class Results:
    """Measurements of one run with what they depend on."""

    machine: dict[str, Any]
    date: str
    measurements: list[Measurement] = field(default_factory=list)
    mitsuba: list[Measurement] = field(default_factory=list)
    deviations: dict[str, float | None] = field(default_factory=dict)  # of Mitsuba's values from ours
    arrays: list[Measurement] = field(default_factory=list)  # through array_functions
    scaling: dict[str, Any] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)  # what was left out, and why

    def find(self, kernel: str, dtype: str, length: int) -> Measurement | None:
        """The measurement of a kernel at a length, if there is one."""
        wanted = (kernel, dtype, length)
        return next((m for m in self.measurements if (m.kernel, m.dtype, m.length) == wanted), None)

    def lengths(self) -> list[int]:
        """Lengths of the arrays, ascending."""
        return sorted({m.length for m in self.measurements})

    def write(self, path: Path) -> None:
        """As JSON, whole or not at all."""
        write_whole(path, json.dumps(asdict(self), indent=1) + "\n")

    @classmethod
    def read(cls, path: Path) -> Results:
        """What `write` wrote."""
        record = json.loads(path.read_text(encoding="utf-8"))
        for key in ("measurements", "mitsuba", "arrays"):
            record[key] = [Measurement.from_dict(m) for m in record.get(key, [])]
        return cls(**record)


def write_whole(path: Path, text: str) -> None:
    """Write a file that nobody finds half written."""
    temporary = path.with_name(f".{path.name}.part")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)
