"""Isolation, resuming and honesty of a batch, with jobs that do what their names say."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.dressing.batch.conftest import Play, act
from tests.dressing.batch.processes import children_of, server_of
from tests.dressing.batch.stand_in_jobs import missing, nothing, stand_in
from toile.dressing.batch.batch import JobResult, batch, run_batch
from toile.dressing.batch.batch_stopped import BatchStopped
from toile.dressing.batch.job import BadJob, Job
from toile.dressing.batch.ledger import rows, standing
from toile.dressing.batch.processes.isolated_call import Limits
from toile.dressing.batch.processes.local_pool import LocalPool
from toile.geometry.errors import InputError


def by_name(results: list[JobResult]) -> dict[str, JobResult]:
    return {result.name: result for result in results}


def test_what_happens_to_one_job_happens_to_no_other(play: Play, tmp_path: Path) -> None:
    parts = ("ok", "hang", "crash", "exit", "eat", "fault", "tangled", "killed")
    jobs = [act(part, part) for part in parts] + [act(f"good{k}") for k in range(5)]
    results = by_name(play(jobs, seconds=3.0, memory=1_000_000_000))
    classes = {name: result.outcome.failure_class for name, result in results.items()}
    assert classes == {
        "ok": "", "hang": "timeout", "crash": "crashed", "exit": "crashed", "eat": "memory", "fault": "fault",
        "tangled": "tangled", "killed": "killed", **{f"good{k}": "" for k in range(5)},
    }  # fmt: skip
    assert all(result.outcome.message for result in results.values() if result.outcome.state == "failed")
    out = tmp_path / "out"
    assert sorted(os.listdir(out / "jobs")) == sorted(["ok", "tangled", *(f"good{k}" for k in range(5))])
    assert (out / "jobs/good3/result.txt").read_text() == "good3"
    assert "ZeroDivisionError" in (out / "logs/fault.txt").read_text()
    assert "Segmentation fault" in (out / "logs/crash.txt").read_text()
    assert not os.listdir(out / "work")
    table = {row["name"]: row for row in rows(out)}
    assert table["killed"]["attempts"] == 3, "a kill from outside is not the job's fault: it is tried again"
    assert table["crash"]["attempts"] == 1
    assert table["good0"]["frames"] == 3 and table["good0"]["state"] == "done"
    assert table["hang"]["wall_seconds"] == pytest.approx(3.0, abs=1.0)
    again = by_name(play([act("killed", "killed"), act("crash", "crash")]))
    assert not again["killed"].skipped and again["crash"].skipped, "nor is it when the same call resumes"
    state = standing(out, active=False)
    assert state.states == {"done": 6, "failed": 7}
    assert state.failures["crashed"] == 2


def test_the_same_call_again_runs_only_what_is_left(play: Play, tmp_path: Path) -> None:
    jobs = [act("a"), act("b", "fault"), act("c")]
    play(jobs)
    again = by_name(play(jobs))
    assert all(result.skipped for result in again.values())
    assert again["b"].outcome.failure_class == "fault"
    assert again["a"].folder == tmp_path / "out/jobs/a"
    retried = by_name(play(jobs, retry_failed=True))
    assert [name for name, result in retried.items() if not result.skipped] == ["b"]
    changed = by_name(play([act("a", friction=0.3), act("b", "fault"), act("c")]))
    assert [name for name, result in changed.items() if not result.skipped] == ["a"]
    shutil.rmtree(tmp_path / "out/jobs/c")
    lost = by_name(play([act("a", friction=0.3), act("b", "fault"), act("c")]))
    assert [name for name, result in lost.items() if not result.skipped] == ["c"]


def test_results_are_known_without_the_ledger(play: Play, tmp_path: Path) -> None:
    """A job whose folder is in place has ended, whatever the ledger was told before the power went."""
    jobs = [act("a"), act("b"), act("c", "tangled")]
    play(jobs)
    for name in ("ledger.sqlite", "ledger.sqlite-wal", "ledger.sqlite-shm"):
        (tmp_path / "out" / name).unlink(missing_ok=True)
    again = by_name(play(jobs))
    assert all(result.skipped for result in again.values())
    assert again["c"].outcome.failure_class == "tangled"
    assert [row["state"] for row in rows(tmp_path / "out")] == ["done", "done", "failed"]


def test_jobs_are_taken_one_by_one_and_an_end_of_interest_ends_the_run(tmp_path: Path) -> None:
    taken = 0

    def endless() -> Iterator[Job]:
        nonlocal taken
        while True:
            taken += 1
            yield act(f"job{taken}")

    results = run_batch(
        endless(), tmp_path, lambda lock: LocalPool(1, nothing, inherited=[lock]), Limits(), False, None,
        work=stand_in,
    )  # fmt: skip
    first = [next(results) for _ in range(3)]
    results.close()
    assert [result.name for result in first] == ["job1", "job2", "job3"]
    assert taken <= 7
    assert Counter(row["state"] for row in rows(tmp_path)).keys() <= {"done", "pending"}
    assert not os.listdir(tmp_path / "work") or taken


def test_stop_waits_for_what_runs(play: Play, tmp_path: Path) -> None:
    started = time.monotonic()
    results = play([act(f"job{k}", "slow") for k in range(50)], stop=lambda: time.monotonic() > started + 1.5)
    assert 0 < len(results) < 50
    assert all(result.outcome.state == "done" for result in results)
    assert not os.listdir(tmp_path / "out/work")
    assert len(play([act(f"job{k}") for k in range(3)])) == 3


def test_stop_ends_jobs_that_wait(play: Play, tmp_path: Path) -> None:
    """One job runs and another waits for it: the one that waits never starts."""
    asked = False

    def stop() -> bool:
        nonlocal asked
        asked = asked or any(tmp_path.glob("out/work/*"))
        return asked

    results = play([act(f"job{k}", "slow") for k in range(5)], workers=1, stop=stop)
    assert [result.name for result in results] == ["job0"]
    states = {row["name"]: row["state"] for row in rows(tmp_path / "out")}
    assert states.pop("job0") == "done" and set(states.values()) <= {"pending"}


def test_a_bad_job_fails_and_others_run(play: Play, tmp_path: Path) -> None:
    jobs: list[Any] = [act("a"), BadJob("line_2", "jobs.csv, line 2: fabric must be a text, got 3"), act("b")]
    results = by_name(play(jobs))
    assert results["a"].outcome.state == results["b"].outcome.state == "done"
    bad = results["line_2"].outcome
    assert (bad.state, bad.failure_class) == ("failed", "bad_input") and "line 2: fabric" in bad.message
    assert {row["name"]: row["state"] for row in rows(tmp_path / "out")}["line_2"] == "failed"
    assert by_name(play(jobs))["a"].skipped


def test_a_full_disk_stops_the_batch_and_the_same_call_goes_on(play: Play, tmp_path: Path) -> None:
    with pytest.raises(BatchStopped, match="out: the disk is full; finished jobs are kept"):
        play([act("a"), act("b", "full"), *(act(f"c{k}", "slow") for k in range(20))], workers=1)
    states = {row["name"]: row["state"] for row in rows(tmp_path / "out")}
    assert states["a"] == "done" and states["b"] == "pending"
    assert len(states) < 22
    results = by_name(play([act("a"), act("b"), *(act(f"c{k}") for k in range(3))]))
    assert results["a"].skipped and results["b"].outcome.state == "done"


def test_two_jobs_of_one_name(play: Play) -> None:
    with pytest.raises(InputError, match="two jobs are named 'a'"):
        play([act("a"), act("a")])
    with pytest.raises(InputError, match="two jobs are named 'a'"):
        play([act("a"), act("a", friction=0.2)])


def test_one_batch_at_a_time_in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("toile.dressing.batch.folder_lock.PATIENCE", 0.2)
    results = run_batch(
        [act("a"), act("b")], tmp_path, lambda lock: LocalPool(1, nothing, inherited=[lock]), Limits(), False,
        None, work=stand_in,
    )  # fmt: skip
    next(results)
    with pytest.raises(InputError, match="another toile batch is running here"):
        next(batch([act("c")], tmp_path))
    results.close()


def test_bad_limits(tmp_path: Path) -> None:
    for options, message in (
        ({"workers": 0}, "workers must lie between"),
        ({"job_timeout": 0.0}, "job_timeout must be greater than zero"),
        ({"job_memory": 0.1}, "job_memory must be at least 0.5 GB"),
    ):
        with pytest.raises(InputError, match=message):
            batch([], tmp_path, **options)


def test_the_process_that_starts_jobs_may_die(tmp_path: Path) -> None:
    """Kill it while jobs run: they die with it, another takes its place, and every job ends once."""
    pool: list[LocalPool] = []

    def open_pool(lock: int) -> LocalPool:
        pool.append(LocalPool(2, nothing, inherited=[lock]))
        return pool[0]

    results = run_batch(
        [act(f"job{k}", "slow") for k in range(12)], tmp_path, open_pool, Limits(), False, None, work=stand_in
    )
    names = [next(results).name]
    server = server_of(pool[0])
    orphans = children_of(server)
    os.kill(server, signal.SIGKILL)
    names += [result.name for result in results if result.outcome.state == "done"]
    assert sorted(names) == sorted(f"job{k}" for k in range(12))
    assert max(row["attempts"] for row in rows(tmp_path)) == 2
    # They are dead at once, but a machine that is busy takes a while to clear them away.
    until = time.monotonic() + 20.0
    while any(Path(f"/proc/{pid}").exists() for pid in orphans) and time.monotonic() < until:
        time.sleep(0.05)
    assert not [pid for pid in orphans if Path(f"/proc/{pid}").exists()]


def test_a_server_that_cannot_start_is_said(tmp_path: Path) -> None:
    results = run_batch(
        [act("a")], tmp_path, lambda lock: LocalPool(1, missing, inherited=[lock]), Limits(),
        False, None, work=stand_in,
    )  # fmt: skip
    with pytest.raises(BatchStopped, match="the process that starts the jobs ended 3 times"):
        list(results)


SCRIPT = """
import sys
from pathlib import Path
from typing import Any
from tests.dressing.batch.conftest import act
from tests.dressing.batch.stand_in_jobs import nothing, stand_in
from toile.dressing.batch.batch import run_batch
from toile.dressing.batch.batch_stopped import BatchStopped
from toile.dressing.batch.processes.isolated_call import Limits
from toile.dressing.batch.processes.local_pool import LocalPool
jobs = [act(f"job{k:02d}", "slow") for k in range(16)]
for result in run_batch(
    jobs, Path(sys.argv[1]), lambda lock: LocalPool(2, nothing, inherited=[lock]), Limits(), False, None,
    work=stand_in,
):
    print(result.name, result.skipped, result.outcome.state, flush=True)
"""


def test_killed_coordinator_loses_nothing_and_repeats_nothing(tmp_path: Path) -> None:
    """SIGKILL at several moments; what was reported or put into place is never run again."""
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).resolve().parents[3])}
    command = [sys.executable, "-c", SCRIPT, str(tmp_path / "out")]
    reported: dict[str, float] = {}
    for moment in (0.3, 0.9, 1.3, 1.6, None):
        process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
        killer = None
        assert process.stdout is not None
        for line in process.stdout:
            name, skipped, state = line.split()
            assert state == "done"
            assert (skipped == "True") or name not in reported, f"{name} ran twice"
            result = tmp_path / "out/jobs" / name / "result.txt"
            changed = result.stat().st_mtime_ns
            assert reported.setdefault(name, changed) == changed, f"{name} was written twice"
            if moment is not None and killer is None:
                killer = threading.Timer(moment, process.kill)
                killer.start()
        process.wait()
    assert len(reported) == 16
    assert process.returncode == 0
    assert {row["state"] for row in rows(tmp_path / "out")} == {"done"}
    assert not os.listdir(tmp_path / "out/work")
