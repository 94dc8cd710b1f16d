"""Whether compiled plugins agree with Mitsuba's own, found out in a process of its own.

A library that does not fit Mitsuba's renders wrong images without a word, or ends the process; so it is not
loaded here before it has passed.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

__all__ = ["COMPARISON", "environment", "objection"]

COMPARISON = Path(__file__).with_name("_compare.py")
# Relative. A sampled direction is rounded, and the facet that is computed from it with it.
TOLERANCE = {"eval": 1e-5, "pdf": 1e-5, "sample": 1e-3}
SECONDS = 1800  # it may hang; how long it takes depends on what else the machine does


def environment() -> dict[str, str]:
    """For a Python that is to find the packages that this one finds."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(path or os.getcwd() for path in sys.path)}


def objection(library: Path, variant: str, compiler: str) -> str:
    """One sentence on what the plugins of `library` do wrong, "" where they agree.

    Raises ImportError where that could not be found out.
    """
    command = [sys.executable, "-P", str(COMPARISON), str(library), variant]
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=environment(), timeout=SECONDS)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ImportError(f"the plugins for {variant} could not be checked: {error}") from None
    lines = done.stdout.splitlines()
    if done.returncode == 0 and lines:
        return _verdict(json.loads(lines[-1]), variant, compiler)
    said = done.stderr.strip().splitlines()[-1:] or ["no message"]
    raise ImportError(
        f"the check of the plugins for {variant} ended with status {done.returncode}: {said[0].strip()}"
    )


def _verdict(deviations: dict[str, float], variant: str, compiler: str) -> str:
    for name, deviation in deviations.items():
        quantity = name.split()[0]
        if not deviation <= TOLERANCE[quantity]:  # nan is no agreement
            return (
                f"the plugins compiled for {variant} are not used: their {name} is off Mitsuba's own by "
                f"{deviation:.2g} (relative), so what {compiler} makes does not fit its libraries"
            )
    return ""
