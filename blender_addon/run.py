"""A run in progress: steps that each take a moment, so that Blender stays responsive."""

import time
from collections.abc import Iterator

TICK = 0.03
"""Seconds of work at most before Blender has its turn again; a single step may take longer."""

LISTEN = 0.02
"""Seconds between two looks at what the engine has said, where Blender waits for it."""

Steps = Iterator[bool]
"""Work in small steps: True where there is more to do at once, False where the engine is waited for."""


class Run:
    """State of a run, as panels show it; `notes` are for the user to read when it is over."""

    def __init__(self, steps: Steps) -> None:
        self._steps = steps
        self.cancelled = False
        self.reading = False
        self.text = "starting"
        self.share = 0.0
        self.notes: list[str] = []

    def progress(
        self, frame: int, frames: int, faces: int, contacts: int, seconds_left: float | None
    ) -> None:
        """Note where the engine is."""
        left = "" if seconds_left is None else f", {_clock(seconds_left)} left"
        self.text = f"frame {frame} of {frames}: {faces} faces, {contacts} contacts{left}"
        self.share = frame / max(frames, 1)

    def tick(self) -> bool:
        """Work for a moment; return whether there is more. Raises Problem where something is wrong."""
        started = last = time.perf_counter()
        while True:
            try:
                if not next(self._steps):
                    return True
            except StopIteration:
                return False
            # Another step like this one must fit in.
            now = time.perf_counter()
            if 2.0 * now - last - started > TICK:
                return True
            last = now

    def finish(self) -> None:
        """Work to the end."""
        while self.tick():
            time.sleep(LISTEN)

    def close(self) -> None:
        """Stop, and clean up."""
        close = getattr(self._steps, "close", None)
        if close is not None:
            close()


class Current:
    """The one run that there may be."""

    run: Run | None = None


def cancel_current() -> None:
    """Stop the run in progress, if there is one."""
    if Current.run is not None:
        Current.run.cancelled = True
        Current.run.close()
        Current.run = None


def _clock(seconds: float) -> str:
    """Return minutes:seconds."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"
