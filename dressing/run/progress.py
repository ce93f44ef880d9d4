"""Progress of a drape, and its display on a terminal."""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import TextIO

from toile.dressing.wear.drape_types import FrameState, Phase


@dataclass(frozen=True, kw_only=True)
class ProgressState:
    """State after a frame.

    Attributes
    ----------
    frame, max_frames
        Frames done, and frames after which the drape stops.
    faces, contacts
        Triangles of cloth and active contacts.
    residual, tolerance
        Distance from equilibrium, and where the drape counts as converged.
    seconds
        Wall time so far [s].
    seconds_left
        Estimated wall time to the end [s], None while there is nothing to go by.
    doing
        What is being done, and how far it is, in words.
    phase
        What the frame belongs to: "sewing", "growing" or "settling" of a drape; "leading in" or "film" where
        garments then follow their body. Frames count from 0 in the drape, and again in the motion.
    """

    frame: int
    max_frames: int
    faces: int
    contacts: int
    residual: float
    tolerance: float
    seconds: float
    seconds_left: float | None
    doing: str = ""
    phase: Phase = "settling"


Progress = Callable[[ProgressState], bool | None]
"""Called after every frame; returning False cancels the drape."""


class TimeLeft:
    """Estimates the remaining time from the residual's decay, or from the frame limit if that is nearer."""

    WINDOW = 12
    """Frames that the estimate looks back."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self._seen: deque[tuple[float, float]] = deque(maxlen=self.WINDOW)

    def update(self, state: FrameState) -> float | None:
        """Return the estimate [s] after a frame, None if there is nothing to go by yet."""
        if math.isfinite(state.residual) and state.residual > 0.0:
            self._seen.append((state.seconds, math.log(state.residual)))
        if state.frame < 1 or state.max_frames <= 0:
            return None
        to_limit = state.seconds / state.frame * max(state.max_frames - state.frame, 0)
        to_rest = self._to_tolerance()
        return to_limit if to_rest is None else min(to_rest, to_limit)

    def _to_tolerance(self) -> float | None:
        """Return the time until a line through the logarithms of the last residuals meets the tolerance."""
        if len(self._seen) < 4 or self.tolerance <= 0.0:
            return None
        count = len(self._seen)
        mean_time = sum(time for time, _ in self._seen) / count
        mean_log = sum(value for _, value in self._seen) / count
        spread = sum((time - mean_time) ** 2 for time, _ in self._seen)
        trend = sum((time - mean_time) * (value - mean_log) for time, value in self._seen)
        if trend >= 0.0 or spread <= 0.0:
            return None
        slope = trend / spread
        now = self._seen[-1][0]
        return max((math.log(self.tolerance) - mean_log) / slope + mean_time - now, 0.0)


class LinePrinter:
    """Writes where something stands: one line that is overwritten on a terminal, else a line now and then."""

    LINES_EVERY = 5.0
    """Without a terminal, at most one line in this time [s]."""

    def __init__(self, stream: TextIO, *, quiet: bool = False) -> None:
        self._stream = stream
        self._quiet = quiet
        self._terminal = stream.isatty()
        self._last = -math.inf
        self._width = 0

    def show(self, text: str, seconds: float) -> None:
        """Show a line, `seconds` [s] after the beginning."""
        if self._quiet:
            return
        if self._terminal:
            self._stream.write("\r" + text.ljust(self._width))
            self._width = len(text)
        elif seconds - self._last >= self.LINES_EVERY:
            self._last = seconds
            self._stream.write(text + "\n")
        self._stream.flush()

    def close(self) -> None:
        """End the overwritten line."""
        if self._width:
            self._stream.write("\n")
            self._width = 0


class ProgressPrinter(LinePrinter):
    """Writes the progress of a drape."""

    def __call__(self, state: ProgressState) -> None:
        """Show the state."""
        self.show(progress_text(state), state.seconds)


def progress_text(state: ProgressState) -> str:
    """Return one line: frame, faces, contacts, residual or what is being done, time left."""
    left = "" if state.seconds_left is None else f"  about {clock(state.seconds_left)} left"
    known = math.isfinite(state.residual)
    # Before it settles the way to equilibrium is not measured yet: what it waits for is.
    waits = f"residual {state.residual:.2g} (goal {state.tolerance:.2g})" if known else state.doing
    film = " of the film" if state.phase == "film" else ""
    where = f"frame {state.frame}/{state.max_frames}{film}  faces {state.faces}  contacts {state.contacts}"
    return f"{where}  {waits}{left}"


def clock(seconds: float) -> str:
    """Return minutes:seconds, or hours:minutes:seconds."""
    total = round(seconds)
    minutes, rest = divmod(total, 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
