"""Progress of a batch, as one line."""

import time
from collections import Counter, deque

from toile.dressing.run.progress import clock

WINDOW = 200
"""Jobs that the rate looks back."""


class BatchProgress:
    """Counts results, and estimates the rate and the time left."""

    def __init__(self, total: int | None) -> None:
        self.states: Counter[str] = Counter()
        self.failures: Counter[str] = Counter()
        self.skipped = 0
        self._total = total
        self._started = time.monotonic()
        self._times: deque[float] = deque([self._started], maxlen=WINDOW)

    @property
    def seconds(self) -> float:
        """Time since the beginning [s]."""
        return time.monotonic() - self._started

    def count(self, state: str, failure_class: str, *, skipped: bool) -> None:
        """Count a result."""
        self.states[state] += 1
        if failure_class:
            self.failures[failure_class] += 1
        if skipped:
            self.skipped += 1
        else:
            self._times.append(time.monotonic())

    def line(self, running: int) -> str:
        """Return jobs done, failed, running, rate and time left."""
        ended = sum(self.states.values())
        of = "" if self._total is None else f"/{self._total}"
        done, failed = self.states["done"], self.states["failed"]
        word = "job" if (self._total if of else ended) == 1 else "jobs"
        text = f"{ended}{of} {word}: {done} done, {failed} failed, {running} running"
        if len(self._times) < 2:
            return text
        rate = (len(self._times) - 1) / max(time.monotonic() - self._times[0], 1e-9)
        text += f"  {rate_text(rate)}"
        if self._total is not None:
            text += f"  about {clock((self._total - ended) / rate)} left"
        return text


def jobs_text(count: int) -> str:
    """Return how many jobs there are, in words."""
    return f"{count} job" if count == 1 else f"{count} jobs"


def rate_text(per_second: float) -> str:
    """Return a rate in jobs per second, minute or hour, whichever gives a number above one."""
    for unit, seconds in (("s", 1.0), ("min", 60.0)):
        if per_second * seconds >= 1.0:
            return f"{per_second * seconds:.1f} jobs/{unit}"
    return f"{per_second * 3600.0:.1f} jobs/h"


def failures_text(failures: Counter[str]) -> str:
    """Return how many failed of each class: `2 bad_input, 1 timeout`."""
    return ", ".join(f"{count} {name}" for name, count in failures.most_common())
