"""The time that stages of a run take: CPU and wall time side by side."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from time import perf_counter, process_time
from typing import NamedTuple


class Spent(NamedTuple):
    """CPU time of the process, all its threads together, and wall time [s]."""

    cpu: float = 0.0
    wall: float = 0.0

    def plus(self, other: "Spent") -> "Spent":
        """Return both together."""
        return Spent(self.cpu + other.cpu, self.wall + other.wall)

    def less(self, other: "Spent") -> "Spent":
        """Return what is left when the other is taken away."""
        return Spent(self.cpu - other.cpu, self.wall - other.wall)


def now() -> Spent:
    """Return what both clocks show."""
    return Spent(process_time(), perf_counter())


@dataclass
class StageClock:
    """Time spent per stage. Stages do not overlap: what one books no other books."""

    spent: dict[str, Spent] = field(default_factory=dict)

    def now(self) -> Spent:
        """Return what both clocks show."""
        return now()

    def add(self, stage: str, since: Spent) -> Spent:
        """Book the time since `since` under `stage`; return now."""
        shown = now()
        self.spent[stage] = self.spent.get(stage, Spent()).plus(shown.less(since))
        return shown

    def cpu(self, stage: str) -> float:
        """Return the CPU time of a stage so far [s], 0 if it has not come yet."""
        return self.spent.get(stage, Spent()).cpu


def together(*parts: Mapping[str, Spent]) -> dict[str, Spent]:
    """Return the sums of times per stage."""
    sums: dict[str, Spent] = {}
    for part in parts:
        for stage, spent in part.items():
            sums[stage] = sums.get(stage, Spent()).plus(spent)
    return sums
