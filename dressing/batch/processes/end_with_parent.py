"""A process that ends as soon as the one that forked it has ended, however that came."""

import ctypes
import os
import signal
import sys
import threading
import time

PR_SET_PDEATHSIG = 1
"""Option of Linux's prctl: the signal that a process gets at the end of its parent."""
LOOKS = 1.0
"""Where no signal comes, how often a process looks whether its parent is still there [s]."""

_prctl = ctypes.CDLL(None).prctl if sys.platform == "linux" else None


def end_with(parent: int) -> None:
    """Have this process killed when its parent ends, or at once if that has happened.

    On Linux the kernel does it; a thread for it would cost each process a millisecond.
    """
    if _prctl is None:
        threading.Thread(target=_watch, args=(parent,), daemon=True).start()
        return
    _prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def _watch(parent: int) -> None:
    """End this process once its parent is another one."""
    while os.getppid() == parent:
        time.sleep(LOOKS)
    os._exit(1)
