"""What runs under a pool."""

import subprocess

from toile.dressing.batch.processes.local_pool import LocalPool


def children_of(pid: int) -> list[int]:
    """Processes that a process has started."""
    done = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True)
    return [int(line) for line in done.stdout.split()]


def server_of(pool: LocalPool) -> int:
    """The process from which a pool's calls are forked."""
    assert pool._process is not None
    return pool._process.pid
