"""Array libraries that tests import where they are, and miss out loud where they are not."""

from __future__ import annotations

import importlib
import importlib.util
import os
from typing import Any

import pytest


def required(name: str) -> Any:
    """The module; without it a whole file of tests is skipped, or fails where everything must be there."""
    if importlib.util.find_spec(name) is None:
        if os.environ.get("MICROFACET_REQUIRE_EXPORT_TOOLS"):
            pytest.fail(f"MICROFACET_REQUIRE_EXPORT_TOOLS is set, and {name} is missing")
        pytest.skip(f"{name} is missing", allow_module_level=True)
    return importlib.import_module(name)
