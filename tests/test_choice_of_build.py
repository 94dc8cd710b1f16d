"""Which build of the kernels runs: the best one of this processor, or that which the environment names."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from builds import BUILDS


def start(program: str, isa: str | None) -> subprocess.CompletedProcess[str]:
    environment = {k: v for k, v in os.environ.items() if k != "MICROFACET_ISA"}
    if isa is not None:
        environment["MICROFACET_ISA"] = isa
    return subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)


@pytest.mark.parametrize("isa", [None, *BUILDS])
def test_the_environment_chooses_a_build(isa: str | None) -> None:
    program = "import microfacet as mf, microfacet._core as c; print(c.isa, mf.ggx.D is c.ggx.D)"
    assert start(program, isa).stdout.split() == [isa or list(BUILDS)[-1], "True"]


def test_an_unknown_build_is_refused() -> None:
    result = start("import microfacet", "avx3")
    assert result.returncode == 1
    sentence = f"MICROFACET_ISA must be one of {', '.join(BUILDS)} here, got 'avx3'"
    assert result.stderr.splitlines()[-1] == f"ImportError: {sentence}"
