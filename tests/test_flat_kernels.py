"""Kernels that are one chain of operations hold no call in their loops: disassembled, not believed.

A call for each pack passes its arguments through memory and takes half of the speed; whether
[[gnu::flatten]] leaves one depends on flags that no other test would miss.
"""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest

import microfacet as mf
from builds import BUILDS

OBJDUMP = shutil.which("objdump")
FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:\n((?: .*\n)*)", re.MULTILINE)
INSTRUCTION = re.compile(r"^ *([0-9a-f]+):\t([a-z0-9.]+) *(?:[^<\n]*?([0-9a-f]+) <(.*)>)?", re.MULTILINE)
JUMP = re.compile(r"j[a-z]+|b|b\..*|cbn?z|tbn?z")
CALL = re.compile(r"callq?|bl|blr")
ITERATION = "detail::solve_visible_slopes<"  # kept out of kernels on purpose, for few lanes


def has_call_in_loop(instructions: str) -> bool:
    """Whether a call lies between a jump backwards and where it goes to."""
    code = [(int(at, 16), *rest) for at, *rest in INSTRUCTION.findall(instructions)]
    calls = [at for at, name, _, symbol in code if CALL.fullmatch(name) and ITERATION not in symbol]
    loops = [(int(target, 16), at) for at, name, target, _ in code if target and JUMP.fullmatch(name)]
    return any(begin <= at <= end for at in calls for begin, end in loops)


@pytest.mark.skipif(OBJDUMP is None, reason="there is no objdump")
@pytest.mark.parametrize("build", BUILDS)
def test_no_flat_kernel_calls_in_its_loop(build: str) -> None:
    command = [str(OBJDUMP), "--disassemble", "--demangle", "--no-show-raw-insn", str(BUILDS[build].__file__)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    kernels = [(name, code) for name, code in FUNCTION.findall(text) if "bindings::evaluate_flat" in name]
    if not kernels:
        pytest.skip(f"{build} has no symbols")
    # All slopes of a ring are one number, which fills an array by a call.
    rings = [f"microfacet::{family.name}<" for family in mf.families() if family.singular]
    drawn = "slope_sample", "cosine_sample"
    calling = [
        name
        for name, code in kernels
        if has_call_in_loop(code) and not (any(map(name.count, rings)) and any(map(name.count, drawn)))
    ]
    assert not calling, f"{len(calling)} of {len(kernels)} call: {calling[0]}"
