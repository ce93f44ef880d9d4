"""Calls on the workers of a Dask cluster, each in a process of its own.

Dask decides which worker takes a call, and gives it to another if a worker is lost. A worker passes it on to
a warm server process (local_pool.py), so limits and isolation are the same as without Dask.
"""

import asyncio
import queue
import time
import uuid
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any

from toile.dressing.batch.processes.isolated_call import Ended, Limits, PoolFailed
from toile.dressing.batch.processes.local_pool import LocalPool
from toile.geometry.errors import InputError

LOCAL = "local"
"""Instead of an address: a cluster on this machine, for this batch only."""
PATIENCE = 10.0
"""Time in which a scheduler must answer [s]."""
AHEAD = 2
"""Calls at Dask per thread of its workers: the next is there when one ends."""
LOOK_EVERY = 1.0
"""How often the number of workers is looked up [s]."""


class DaskPool:
    """Calls on the workers of a Dask scheduler, twice as many as they have threads."""

    def __init__(
        self, address: str, workers: int, load: Callable[[], None], say: Callable[[str], None] | None
    ) -> None:
        """Connect.

        `workers` counts for a local cluster; `load` is called in the servers, see `LocalPool`. Raises
        InputError if Dask is not installed, or no scheduler answers at the address.
        """
        try:
            from distributed import Client, LocalCluster
        except ImportError:
            raise InputError("running on Dask needs it installed: pip install 'toile[dask]'") from None
        connect: Any = Client
        make_cluster: Any = LocalCluster
        self._cluster: Any = None
        if address == LOCAL:
            self._cluster = make_cluster(
                n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None
            )
        try:
            if self._cluster is None:
                _knock(address)
            self._client: Any = connect(self._cluster or address, timeout=PATIENCE, set_as_default=False)
        except (OSError, TimeoutError, ValueError, TypeError) as error:
            reason = " ".join(str(error).split())[:100] or type(error).__name__
            raise InputError(
                f"--dask {address}: no Dask scheduler answers there ({reason}); check the address, "
                "such as tcp://host:8786, and that the scheduler runs"
            ) from None
        self._address, self._load, self._say = address, load, say
        self._batch = uuid.uuid4().hex
        self._count = 0
        self._running: dict[int, tuple[Any, Any]] = {}
        self._ended: queue.SimpleQueue[int] = queue.SimpleQueue()
        self._threads, self._looked, self._said = 0, -LOOK_EVERY, False

    @property
    def room(self) -> int:
        """Number of calls that it can take now."""
        now = time.monotonic()
        if now - self._looked > LOOK_EVERY:
            self._looked = now
            self._threads = sum(self._client.nthreads().values())
            if not self._threads and not self._said and self._say is not None:
                self._say(f"waiting for workers of the Dask scheduler at {self._address}")
                self._said = True
        return AHEAD * self._threads - len(self._running)

    @property
    def unfinished(self) -> int:
        """Calls that have not ended yet."""
        return len(self._running)

    @property
    def running(self) -> int:
        """Those of them that run, if every thread of the workers has one; the others wait."""
        return min(len(self._running), self._threads)

    def start(self, key: Any, function: Callable[[Any], Any], argument: Any, limits: Limits) -> None:
        """Have a function called with an argument; `wait` reports its end under `key`."""
        self._count += 1
        number = self._count
        call = self._batch, function, argument, limits, self._load
        future: Any = self._client.submit(call_here, *call, pure=False)
        self._running[number] = key, future
        future.add_done_callback(lambda _: self._ended.put(number))

    def wait(self, seconds: float) -> list[tuple[Any, Ended]]:
        """Return the calls that have ended, with their keys; after some time, perhaps none."""
        found: list[tuple[Any, Ended]] = []
        while True:
            try:
                number = self._ended.get(block=not found, timeout=seconds)
            except queue.Empty:
                if self._client.status != "running":
                    raise PoolFailed(f"the Dask scheduler at {self._address} is gone") from None
                return found
            key, future = self._running.pop(number)
            found.append((key, self._end_of(future)))

    def _end_of(self, future: Any) -> Ended:
        """Return how a call ended that Dask has done with."""
        from distributed import KilledWorker

        if future.status == "finished":
            ended: Ended = future.result()
            return ended
        error = future.exception() if future.status == "error" else None
        if isinstance(error, KilledWorker):
            return Ended(how="lost")
        if error is None:
            raise PoolFailed(f"the Dask scheduler at {self._address} has dropped a job")
        raise PoolFailed(
            f"a Dask worker cannot run jobs ({type(error).__name__}: {error}); all workers need the same "
            "version of toile as this machine"
        )

    def withdraw(self) -> list[Any]:
        """Take back nothing: only the scheduler knows which calls have begun."""
        return []

    def close(self) -> None:
        """End every call that still runs, and the servers on the workers."""
        futures = [future for _, future in self._running.values()]
        self._running.clear()
        # A scheduler that is gone has nothing to end.
        with suppress(OSError, RuntimeError, TimeoutError):
            if self._client.status == "running":
                self._client.cancel(futures)
                self._client.run(end_calls, self._batch)
        self._client.close(timeout=PATIENCE)
        if self._cluster is not None:
            self._cluster.close(timeout=PATIENCE)


def _knock(address: str) -> None:
    """Raise OSError or TimeoutError unless a scheduler answers: a client waits for a mute one for ever."""
    from distributed.comm import connect
    from distributed.security import Security

    async def greet() -> None:
        arguments = Security().get_connection_args("client")
        comm = await asyncio.wait_for(connect(address, timeout=PATIENCE, **arguments), PATIENCE)
        await comm.close()

    # In a thread of its own, since the caller's may run an event loop.
    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, greet()).result()


_idle: list[LocalPool] = []
_busy: dict[LocalPool, str] = {}
"""On a worker: servers that wait for a call, and those that carry one out, with their batch."""


def call_here(
    batch: str, function: Callable[[Any], Any], argument: Any, limits: Limits, load: Callable[[], None]
) -> Ended:
    """On a worker, carry out a call in a process of its own and return how it ended."""
    pool = _idle.pop() if _idle else LocalPool(1, load)
    _busy[pool] = batch
    try:
        pool.start(None, function, argument, limits)
        while not (ended := pool.wait(60.0)):
            pass
    finally:
        del _busy[pool]
    _idle.append(pool)
    return ended[0][1]


def end_calls(batch: str) -> None:
    """On a worker, kill a batch's calls, and end the servers that wait."""
    for pool, whose in list(_busy.items()):
        if whose == batch:
            pool.kill()
    while _idle:
        _idle.pop().close()
