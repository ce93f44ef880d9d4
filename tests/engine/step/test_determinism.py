"""The same scene gives the same bytes, run after run, whatever number of threads it and its libraries use."""

import os
import subprocess
import sys

CODE = """
import hashlib, sys, toile
scene = toile.Scene(garments=["tshirt"], edge_length=0.03, max_frames=9, threads=int(sys.argv[1]))
result = toile.dress(scene)
digest = hashlib.sha256()
for garment in result.garments:
    digest.update(garment.positions.tobytes())
    digest.update(garment.faces.tobytes())
print(result.report["steps"], digest.hexdigest())
"""


def drape(threads: str) -> str:
    """Return the number of steps and the hash of what a process of its own computes."""
    environment = os.environ | {
        f"{name}_NUM_THREADS": threads for name in ("NUMBA", "OMP", "OPENBLAS", "MKL")
    }
    done = subprocess.run(
        [sys.executable, "-c", CODE, threads], env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout


def test_two_processes_with_one_and_two_threads_agree() -> None:
    first = drape("1")
    assert first.startswith("90 ")
    assert drape("2") == first
