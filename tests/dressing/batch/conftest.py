"""A batch whose jobs do what their names say; see stand_in_jobs.py."""

from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

from tests.dressing.batch.stand_in_jobs import nothing, stand_in
from toile.dressing.batch.batch import JobResult, run_batch
from toile.dressing.batch.job import Job
from toile.dressing.batch.processes.isolated_call import Limits
from toile.dressing.batch.processes.local_pool import LocalPool
from toile.dressing.run.scene import Garment, Scene

Play = Callable[..., list[JobResult]]


def act(name: str, part: str = "ok", *, friction: float | None = None) -> Job:
    """Return a job that plays a part."""
    return Job(name, Scene(garments=[Garment("tshirt", name=part)], friction=friction))


@pytest.fixture
def play(tmp_path: Path) -> Play:
    """Return a function that runs stand-in jobs in a folder and returns what became of them."""

    def run(
        jobs: Iterable[Job], *, workers: int = 2, seconds: float | None = None, memory: int | None = None,
        retry_failed: bool = False, stop: Callable[[], bool] | None = None,
    ) -> list[JobResult]:  # fmt: skip
        return list(
            run_batch(
                jobs,
                tmp_path / "out",
                lambda lock: LocalPool(workers, nothing, inherited=[lock]),
                Limits(seconds=seconds, memory=memory),
                retry_failed,
                stop,
                work=stand_in,
            )
        )

    return run
