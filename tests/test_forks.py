"""Processes that fork while threads compute: no lock goes to the child with its owner left behind."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from limits import HANG

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="nothing forks here")

# Each thread asks for densities that no cache holds, so that tables are built, kept and dropped all the time.
PROGRAM = """
import os, signal, sys, threading, time, warnings
import numpy as np
import microfacet as mf

warnings.simplefilter("ignore")  # Python warns of forks of threaded processes
u = np.linspace(-1, 1, 9000)
xi = np.random.default_rng(1).random((64, 4))
profile = mf.RadialNDF(lambda r: np.exp(-(r**3)), alpha=0.2)
stop = threading.Event()

def work(k):
    for i in range(10**9):
        if stop.is_set():
            return
        mf.student_t.Lambda(u, 0.3, 2 + 1e-3 * ((7 * i + k) % 500))
        mf.BesselK(alpha=0.3, a=0.6 + 1e-3 * ((3 * i + k) % 300)).sample_visible([0.6, 0, 0.8], xi)
        profile.Lambda([0.6, 0, 0.8])

threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
for t in threads:
    t.start()
children = []
for i in range(40):
    time.sleep(0.01)
    child = os.fork()
    if child == 0:
        signal.alarm(120)  # ends a child that hangs
        mf.student_t.Lambda(u, 0.3, 3.5 + i)
        mf.GTR(alpha=0.4, gamma=1.5).sigma([0.6, 0, 0.8])
        if i % 8 == 0:
            mf.RadialNDF(lambda r: np.exp(-(r**4)), alpha=0.3)
        mf.Beckmann(alpha=0.3).sample_visible([0.6, 0, 0.8], np.float32(xi), scheme="mixture")
        os._exit(0)
    children.append(child)
stop.set()
for t in threads:
    t.join()
status = [os.waitpid(child, 0)[1] for child in children]
sys.exit(f"{sum(s != 0 for s in status)} of 40 children ended badly: {status}" if any(status) else 0)
"""


def test_children_of_a_busy_process_compute() -> None:
    result = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, timeout=HANG)
    assert result.returncode == 0, result.stderr
