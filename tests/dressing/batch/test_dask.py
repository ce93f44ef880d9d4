"""The same batch on Dask: several worker processes, one of them killed; schedulers that do not answer."""

import os
import signal
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.dressing.batch.conftest import act
from tests.dressing.batch.stand_in_jobs import nothing, stand_in
from toile.dressing.batch.batch import JobResult, batch, run_batch
from toile.dressing.batch.job import Job
from toile.dressing.batch.ledger import rows
from toile.dressing.batch.processes.dask_pool import DaskPool
from toile.dressing.batch.processes.isolated_call import Limits
from toile.dressing.batch.shipping_pool import ShippingPool
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.geometry.errors import InputError

distributed = pytest.importorskip("distributed", reason="Dask is not installed (pip install 'toile[dask]')")


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """A scheduler with two worker processes."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as found:
        yield found


def run(address: str, jobs: list[Job], folder: Path, *, ship: bool = False) -> Iterator[JobResult]:
    def open_pool(lock: int) -> DaskPool | ShippingPool:
        pool = DaskPool(address, 2, nothing, None)
        return ShippingPool(pool) if ship else pool

    return run_batch(jobs, folder, open_pool, Limits(seconds=4.0), False, None, work=stand_in)


def test_jobs_on_workers_end_as_they_do_here(cluster: Any, tmp_path: Path) -> None:
    jobs = [act(part, part) for part in ("ok", "hang", "crash", "fault", "tangled")]
    results = {result.name: result for result in run(cluster.scheduler_address, jobs, tmp_path)}
    assert {name: result.outcome.failure_class for name, result in results.items()} == {
        "ok": "", "hang": "timeout", "crash": "crashed", "fault": "fault", "tangled": "tangled",
    }  # fmt: skip
    assert (tmp_path / "jobs/ok/result.txt").read_text() == "ok"
    assert not os.listdir(tmp_path / "work")


def test_a_killed_worker_loses_no_job_and_repeats_none_that_ended(cluster: Any, tmp_path: Path) -> None:
    jobs = [act(f"job{k:02d}", "slow") for k in range(20)]
    results = run(cluster.scheduler_address, jobs, tmp_path)
    names = [next(results).name for _ in range(3)]
    written = {name: (tmp_path / "jobs" / name / "result.txt").stat().st_mtime_ns for name in names}
    victim = next(iter(cluster.workers.values()))
    os.kill(victim.pid, signal.SIGKILL)
    rest = [result for result in results]
    assert not [result for result in rest if result.outcome.state != "done"]
    assert sorted([*names, *(result.name for result in rest)]) == [job.name for job in jobs]
    for name, changed in written.items():
        assert (tmp_path / "jobs" / name / "result.txt").stat().st_mtime_ns == changed
    assert {row["state"] for row in rows(tmp_path)} == {"done"}


def test_input_is_shipped_and_results_come_back(cluster: Any, tmp_path: Path) -> None:
    body = tmp_path / "in" / "body.ply"
    body.parent.mkdir()
    body.write_bytes(b"a body")
    scene = Scene(avatar=AvatarFile(path=body), garments=[Garment("tshirt", name="shipped")])
    jobs = [Job("a", scene), act("b", "fault"), act("c", "crash")]
    out = tmp_path / "out"
    results = {result.name: result for result in run(cluster.scheduler_address, jobs, out, ship=True)}
    assert results["a"].outcome.state == "done"
    # The job has read its body in a folder of its own, with the same name and content.
    assert (out / "jobs/a/result.txt").read_text() == "body.ply: a body"
    assert "ZeroDivisionError" in (out / "logs/b.txt").read_text()
    assert results["c"].outcome.failure_class == "crashed"
    again = {result.name: result for result in run(cluster.scheduler_address, jobs, out, ship=True)}
    assert all(result.skipped for result in again.values())


@pytest.mark.parametrize("listens", [False, True], ids=["nobody", "silence"])
def test_an_address_that_does_not_answer(
    listens: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("toile.dressing.batch.processes.dask_pool.PATIENCE", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        if not listens:
            server.close()
        started = time.monotonic()
        with pytest.raises(InputError, match=f"--dask {address}: no Dask scheduler answers there"):
            list(batch([act("a")], tmp_path, dask=address))
    assert time.monotonic() - started < 20.0
    assert not list(rows(tmp_path))


def test_an_address_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no Dask scheduler answers there"):
        list(batch([act("a")], tmp_path, dask="ftp://nowhere"))
