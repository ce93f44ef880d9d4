"""Status of a batch, as text."""

from pathlib import Path

from toile.dressing.batch.batch_progress import failures_text, rate_text
from toile.dressing.batch.folder_lock import is_locked
from toile.dressing.batch.ledger import standing
from toile.dressing.run.progress import clock

SHOWN = 20
"""Running jobs that are listed."""


def status_text(folder: Path) -> str:
    """Return the status of a folder's batch, also while it runs. Raises InputError if there is none."""
    where = standing(folder, active=is_locked(folder))
    states = where.states
    known = sum(states.values())
    total = max(where.total or 0, known)
    failures = f" ({failures_text(where.failures)})" if where.failures else ""
    left = total - states["done"] - states["failed"] - len(where.running)
    lines = [
        f"{folder}: {'running' if where.active else 'not running'} ({clock(where.seconds)})",
        f"jobs     {total}",
        f"done     {states['done']}",
        f"failed   {states['failed']}{failures}",
        f"started  {len(where.running)}",
        f"left     {left}",
    ]
    if where.active and where.finished and where.seconds > 0.0:
        rate = where.finished / where.seconds
        unfinished = left + len(where.running)
        lines.append(f"rate     {rate_text(rate)}, about {clock(unfinished / rate)} left")
    lines += [f"  {name}  {clock(seconds)}" for name, seconds in where.running[:SHOWN]]
    if len(where.running) > SHOWN:
        lines.append(f"  and {len(where.running) - SHOWN} more")
    if not where.active and left:
        lines.append("the command that started it resumes it")
    return "\n".join(lines)
