"""CPU seconds to compile every kernel from nothing.

Run: python bench/compile_time.py
"""

import os
import subprocess
import sys
import tempfile

from toile.dressing.run.kernels import (
    DRAPE_KERNELS,
    INTEGRATOR_KERNELS,
    PANEL_KERNELS,
    PICTURE_KERNELS,
    REMESH_KERNELS,
)

KERNELS = (*DRAPE_KERNELS, *PANEL_KERNELS, *REMESH_KERNELS, *INTEGRATOR_KERNELS, *PICTURE_KERNELS)
SCRIPT = """
import sys, time
from importlib import import_module
from numba.core.dispatcher import Dispatcher

compile_one, depth = Dispatcher.compile, 0

def timed(self, signature):
    # Helpers are compiled inside the first kernel that calls them.
    global depth
    depth += 1
    start = time.process_time()
    try:
        return compile_one(self, signature)
    finally:
        depth -= 1
        if depth == 0:
            name = f"{self.py_func.__module__}.{self.py_func.__name__}"
            print(f"{time.process_time() - start:.3f} {name}")

Dispatcher.compile = timed
for name in sys.argv[1:]:
    import_module(name)
"""


def main() -> None:
    """Import all kernels in one process with an empty cache and print what each took."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
        environment["TOILE_CACHE_DIR"] = folder
        command = [sys.executable, "-c", SCRIPT, *KERNELS]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    rows = [(float(seconds), name) for seconds, name in map(str.split, done.stdout.splitlines())]
    for seconds, name in sorted(rows, reverse=True):
        print(f"{seconds:6.2f} s  {name}")
    print(f"{sum(seconds for seconds, _ in rows):6.2f} s  {len(rows)} kernels")


if __name__ == "__main__":
    main()
