"""How a command ends that is told to: as a block that cleans up, not at once."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn

__all__ = ["ending_on_sigterm"]


@contextmanager
def ending_on_sigterm() -> Iterator[None]:
    """Let blocks that clean up end when the process is terminated, which the main thread alone can do."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    timer = getattr(signal, "setitimer", None)
    numbers = [signal.SIGTERM, *([signal.SIGALRM] if timer else [])]

    def stop(*_: object) -> NoReturn:
        # Python drops an exception that is raised in a finaliser or a weak reference's callback: again, soon.
        if timer:
            timer(signal.ITIMER_REAL, 5.0)
        sys.exit(143)

    before = [signal.signal(number, stop) for number in numbers]
    try:
        yield
    finally:
        if timer:
            timer(signal.ITIMER_REAL, 0.0)
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, signal.SIG_DFL if handler is None else handler)  # None: not set by Python
