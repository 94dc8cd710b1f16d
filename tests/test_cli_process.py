"""The command line as a process among others: closed streams, termination."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from limits import HANG, wait_for


def test_closed_streams_are_no_traceback() -> None:
    shell = f'{sys.executable} -c "from microfacet.cli import main; main()"'
    for line in (f"{shell} eval ggx D - --alpha 0.3 <&-", f"{shell} families >&-"):
        done = subprocess.run(["bash", "-c", line], capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")


def test_a_terminated_sample_leaves_no_part(tmp_path: Path) -> None:
    code = "from microfacet.cli import main; main()"
    arguments = ["sample", "ggx", "--alpha", "0.3", "-n", "500000000", "-o", str(tmp_path / "b.npy")]
    process = subprocess.Popen([sys.executable, "-c", code, *arguments], stderr=subprocess.DEVNULL)
    wait_for(lambda: list(tmp_path.iterdir()), process)
    process.terminate()
    assert process.wait(timeout=HANG) == 143
    assert not list(tmp_path.iterdir())
