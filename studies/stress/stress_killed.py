"""A run killed at random moments and resumed, which must give the files of an undisturbed run."""

import random
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from time import monotonic

from toile.dressing.run.result import Result

KILLS = 3
"""How often a run is killed."""


def run_killed(arguments: list[str], folder: Path, seconds: float) -> list[str]:
    """Dress by command into a folder, killed at random moments of `seconds` [s]; return what was done.

    `arguments` are those of `toile dress`, without output. The moments are not the same from call to call.
    """
    done = []
    for kill in range(KILLS + 1):
        started = (folder / ".resume" / "scene").exists()
        command = ["--resume", str(folder)] if started else [*arguments, "-o", str(folder)]
        process = subprocess.Popen(
            [sys.executable, "-m", "toile", "dress", "--quiet", *command],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        )  # fmt: skip
        moment = random.SystemRandom().uniform(0.0, seconds)
        begun = monotonic()
        try:
            _, said = process.communicate(timeout=moment if kill < KILLS else None)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            done.append(f"killed after {monotonic() - begun:.1f} s")
            continue
        if process.returncode:
            done.append(f"exit code {process.returncode}: {said.decode(errors='replace').strip()[-300:]}")
        else:
            done.append("came to its end")
        break
    return done


def differing_files(one: Path, other: Path, names: Iterable[str]) -> list[str]:
    """Return the names of files that are missing in one of two folders, or not the same."""

    def content(folder: Path, name: str) -> bytes | None:
        return (folder / name).read_bytes() if (folder / name).is_file() else None

    return [
        name for name in names if content(one, name) is None or content(one, name) != content(other, name)
    ]


def with_failure(result: Result, message: str) -> Result:
    """Return a result that has failed with a message."""
    failure = {"class": "resume", "message": message, "where": "output files"}
    return Result(
        status="failed", report=result.report | {"failure": failure}, avatar=result.avatar,
        garments=result.garments,
    )  # fmt: skip
