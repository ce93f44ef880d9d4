"""Jobs that do next to nothing, for what a batch costs beside them; see batch.py."""

import hashlib
import time

from toile.dressing.batch.dress_job import JobRequest, load_dressing, run_job
from toile.dressing.batch.outcome import Outcome

BUSY = 0.3
"""Processor time of a busy job [s]."""


def load() -> None:
    """Load what real jobs need."""
    load_dressing()


def load_nothing() -> None:
    """Load nothing: starts at once."""


def tiny(request: JobRequest) -> Outcome:
    """Write one file."""
    return run_job(request, _write)


def busy(request: JobRequest) -> Outcome:
    """Compute for a while, then write one file."""
    return run_job(request, _compute)


def _write(request: JobRequest) -> Outcome:
    (request.work / "result.txt").write_text(hashlib.sha256(request.name.encode()).hexdigest())
    return Outcome(state="done", published=True, figures={"status": "converged"})


def _compute(request: JobRequest) -> Outcome:
    until = time.process_time() + BUSY
    while time.process_time() < until:
        hashlib.sha256(request.name.encode() * 1000).hexdigest()
    return _write(request)
