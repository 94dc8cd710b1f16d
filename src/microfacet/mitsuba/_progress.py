"""What a first use waits for, on stderr."""

from __future__ import annotations

import sys
from contextlib import suppress

__all__ = ["progress"]


def progress(what: str) -> None:
    """Print a line, wherever stderr leads."""
    if sys.stderr is not None:
        with suppress(OSError, ValueError):  # nobody reads it, or it is closed
            print(f"microfacet: {what}", file=sys.stderr, flush=True)
