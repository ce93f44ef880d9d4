"""What a job's process does in tests instead of dressing: known results, failures and deaths."""

import os
import signal
import time

from toile.dressing.batch.dress_job import JobRequest, run_job
from toile.dressing.batch.outcome import Outcome
from toile.dressing.run.scene import AvatarFile


def nothing() -> None:
    """Load nothing."""


def missing() -> None:
    """Fail to load."""
    raise ImportError("no such kernel")


def stand_in(request: JobRequest) -> Outcome:
    """Do what the name of the job's first garment says, and write a file."""
    return run_job(request, _act)


def _act(request: JobRequest) -> Outcome:
    """Act out the job."""
    match request.scene.garments[0].name:
        case "hang":
            time.sleep(600.0)
        case "slow":
            time.sleep(0.3)
        case "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        case "killed":
            os.kill(os.getpid(), signal.SIGKILL)
        case "exit":
            os._exit(7)
        case "eat":
            eaten = bytearray(b"x" * 2_000_000_000)
            return Outcome(state="failed", message=f"ate {len(eaten)}")
        case "fault":
            raise ZeroDivisionError("division by zero")
        case "tangled":
            (request.work / "report.json").write_text("{}")
            return Outcome(state="failed", failure_class="tangled", message="2 pairs", published=True)
        case "shipped":
            body = request.scene.avatar
            assert isinstance(body, AvatarFile) and body.path.is_relative_to(request.folder)
            text = f"{body.path.name}: {body.path.read_text()}"
            (request.work / "result.txt").write_text(text)
            return Outcome(state="done", published=True)
        case "full":
            raise OSError(28, "No space left on device")
    (request.work / "result.txt").write_text(request.name)
    return Outcome(state="done", published=True, figures={"status": "converged", "frames": 3})
