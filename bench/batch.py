"""What a batch costs beside its jobs, and whether it survives being killed.

python bench/batch.py overhead OUT [--jobs 10000] [--workers 1]
python bench/batch.py speedup OUT
python bench/batch.py kill OUT [--kills 20] [--seed 1]

overhead: tiny jobs, started by a process that holds all kernels as it does for real ones; wall and CPU time
per job, and the coordinator's memory on the way. speedup: jobs of 0.3 CPU s on one and on two workers. kill:
the coordinator, the process that starts jobs, or a job is killed (SIGKILL) at random moments, and the same
run is given again until it ends by itself; then every job must have its whole result, written once.
"""

import argparse
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import tiny_jobs

from toile.dressing.batch.batch import JobResult, run_batch
from toile.dressing.batch.dress_job import JobRequest
from toile.dressing.batch.job import Job
from toile.dressing.batch.ledger import rows
from toile.dressing.batch.outcome import Outcome
from toile.dressing.batch.processes.isolated_call import Limits
from toile.dressing.batch.processes.local_pool import LocalPool
from toile.dressing.run.scene import Garment, Scene


def jobs(count: int) -> Iterator[Job]:
    """Jobs that differ only in their names."""
    return (Job(f"job{k:05d}", Scene(garments=[Garment("tshirt")])) for k in range(count))


def results(
    folder: Path,
    count: int,
    workers: int,
    work: Callable[[JobRequest], Outcome],
    load: Callable[[], None] = tiny_jobs.load,
) -> Iterator[JobResult]:
    """Run jobs in a folder."""

    def open_pool(lock: int) -> LocalPool:
        return LocalPool(workers, load, inherited=[lock])

    return run_batch(jobs(count), folder, open_pool, Limits(), False, None, work=work)


def memory() -> float:
    """Resident memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


def overhead(out: Path, count: int, workers: int) -> None:
    """Print what a job costs that does nothing."""
    folder = out / "overhead"
    shutil.rmtree(folder, ignore_errors=True)
    started = own = 0.0
    ended = 0
    for result in results(folder, count, workers, tiny_jobs.tiny):
        assert result.outcome.state == "done", result
        if not ended:
            # The first one has waited for the kernels.
            started, own = time.perf_counter(), time.process_time()
        ended += 1
        if ended in (100, 1000, count):
            print(f"{ended} jobs: coordinator's resident memory {memory():.1f} MB", flush=True)
    wall, own = time.perf_counter() - started, time.process_time() - own
    below = resource.getrusage(resource.RUSAGE_CHILDREN)
    per_job = 1e3 / (count - 1)
    print(
        f"{count} tiny jobs, {workers} workers: {wall * per_job:.2f} ms wall per job; CPU: coordinator "
        f"{own * per_job:.2f} ms, processes {(below.ru_utime + below.ru_stime) * per_job:.2f} ms per job"
    )


def speedup(out: Path, count: int = 60) -> None:
    """Print how much faster two workers are than one."""
    walls = {}
    for workers in (1, 2, 1, 2):
        folder = out / "speedup"
        shutil.rmtree(folder, ignore_errors=True)
        started, ended = 0.0, 0
        for _ in results(folder, count, workers, tiny_jobs.busy):
            started = started or time.perf_counter()
            ended += 1
        wall = (time.perf_counter() - started) / (ended - 1)
        walls[workers] = min(wall, walls.get(workers, wall))
        print(
            f"{workers} workers: {wall * 1e3:.0f} ms per job of {1e3 * tiny_jobs.BUSY:.0f} CPU ms", flush=True
        )
    print(f"two workers are {walls[1] / walls[2]:.2f} times as fast as one (best of two runs each)")


def descendants(pid: int) -> list[int]:
    """Processes that a process has started, and they in turn, the first ones first."""
    found = [int(name) for name in os.listdir("/proc") if name.isdigit()]
    parents: dict[int, int] = {}
    for other in found:
        try:
            parents[other] = int(Path(f"/proc/{other}/stat").read_text().rpartition(")")[2].split()[1])
        except (OSError, ValueError):
            continue
    below, wanted = [], [pid]
    while wanted:
        wanted = [other for other, parent in parents.items() if parent in wanted]
        below += wanted
    return below


def shoot(pid: int, stop: threading.Event, chance: random.Random, kills: int, victims: Counter[str]) -> None:
    """Kill a process of a batch now and then, until enough were killed or it has ended."""
    while victims.total() < kills and not stop.wait(chance.uniform(0.1, 4.0)):
        # Its child starts the jobs; the child's children are jobs.
        below = descendants(pid)
        target = chance.choice(["coordinator", "starter", "job", "job"])
        victim = {"coordinator": [pid], "starter": below[:1], "job": below[1:]}[target]
        if victim and not stop.is_set():
            os.kill(chance.choice(victim), signal.SIGKILL)
            victims[target] += 1


def kill(out: Path, kills: int, seed: int) -> None:
    """Kill what runs at random moments until a run ends by itself; check what is there."""
    folder, count = out / "kill", 150
    shutil.rmtree(folder, ignore_errors=True)
    chance = random.Random(seed)
    command = [sys.executable, __file__, "run", str(folder), "--jobs", str(count)]
    written: dict[str, int] = {}
    reported: Counter[str] = Counter()
    victims: Counter[str] = Counter()
    while True:
        again = False
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        stop = threading.Event()

        gun = partial(shoot, process.pid, stop, chance, kills, victims)
        thread = threading.Thread(target=gun)
        thread.start()
        assert process.stdout is not None
        for line in process.stdout:
            if not line.endswith("\n"):
                continue
            name, skipped, state = line.split()
            if state == "failed":
                again = True  # killed three times within one run: it says so, and the next run tries again
                continue
            result = (folder / "jobs" / name / "result.txt").stat().st_mtime_ns
            assert written.setdefault(name, result) == result, f"{name} was written twice"
            if skipped == "False":
                reported[name] += 1
        code = process.wait()
        stop.set()
        thread.join()
        if code == 0 and not again:
            break
    assert all(times == 1 for times in reported.values()), "a job ran twice that had ended"
    table = list(rows(folder))
    assert len(table) == count and {row["state"] for row in table} == {"done"}
    for row in table:
        note = json.loads((folder / "jobs" / row["name"] / "job.json").read_text())
        assert note["fingerprint"] == row["fingerprint"]
        assert len((folder / "jobs" / row["name"] / "result.txt").read_text()) == 64
    assert not list((folder / "work").iterdir())
    most = max(row["attempts"] for row in table)
    print(f"{sum(victims.values())} kills (seed {seed}): {dict(victims)}")
    print(f"{count} jobs done, each once, all results whole; most attempts {most}")


def run(folder: Path, count: int) -> None:
    """Run busy jobs and print them as they end."""
    for result in results(folder, count, 2, tiny_jobs.busy, tiny_jobs.load_nothing):
        print(result.name, result.skipped, result.outcome.state, flush=True)


def main() -> None:
    """Run one study."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("study", choices=("overhead", "speedup", "kill", "run"))
    parser.add_argument("out", type=Path)
    parser.add_argument("--jobs", type=int, default=10_000)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    match options.study:
        case "overhead":
            overhead(options.out, options.jobs, options.workers)
        case "speedup":
            speedup(options.out)
        case "kill":
            kill(options.out, options.kills, options.seed)
        case "run":
            run(options.out, options.jobs)


if __name__ == "__main__":
    main()
