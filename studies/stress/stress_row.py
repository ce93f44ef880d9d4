"""The outcome of a hard case, and the table of all."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, kw_only=True)
class StressRow:
    """Outcome of one case.

    Attributes
    ----------
    case, remesh
        Its name, and whether the mesh adapted.
    outcome, expected
        "valid", "message", "crossing", "not finite" or "out of time"; and what it should be.
    intersections
        Crossing pairs of triangles, sum over all frames.
    min_gap_mm
        Smallest gap of a contact [mm], None without contact.
    strain_percent
        Largest strain along warp or weft in a frame.
    frames, steps, cpu
        Counts, and CPU time [s].
    message
        Why it ended early.
    """

    case: str
    remesh: bool
    outcome: str
    expected: str
    intersections: int
    min_gap_mm: float | None
    strain_percent: float
    frames: int
    steps: int
    cpu: float
    message: str

    @property
    def fell_short(self) -> bool:
        """Whether it did not end as expected."""
        return self.outcome != self.expected


def outcome_of(*, finite: bool, crossings: int, late: bool, broken_off: bool) -> str:
    """Return how a case ended: what it crossed counts before why it ended."""
    if not finite:
        return "not finite"
    if crossings:
        return "crossing"
    if late:
        return "out of time"
    return "message" if broken_off else "valid"


def picture_path(folder: Path, case: str, remesh: bool) -> Path:
    """Return where the picture of a case is."""
    return folder / f"{case}{'_remesh' if remesh else ''}.png"


def stress_table(rows: list[StressRow]) -> str:
    """Return the rows as text, cases that fell short marked with a star."""
    lines = [
        f"{'case':18}{'mesh':>10}{'outcome':>13} {'crossings':>10}{'gap mm':>9}{'strain %':>9}{'frames':>7}"
        f"{'steps':>7}{'CPU s':>8}"
    ]
    for row in rows:
        gap = "-" if row.min_gap_mm is None else f"{row.min_gap_mm:.3f}"
        lines.append(
            f"{row.case:18}{'adaptive' if row.remesh else 'own':>10}{row.outcome:>13}"
            f"{'*' if row.fell_short else ' '}{row.intersections:>10}{gap:>9}{row.strain_percent:>9.1f}"
            f"{row.frames:>7}{row.steps:>7}{row.cpu:>8.1f}"
        )
        if row.message:
            lines.append(f"    {row.message}")
    return "\n".join([*lines, "* not as expected"])
