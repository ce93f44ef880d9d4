"""Callbacks that follow a run."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from toile.dressing.run.interrupt import CancelOnInterrupt
from toile.dressing.run.progress import Progress, ProgressState, TimeLeft
from toile.dressing.run.result import Record
from toile.dressing.wear.drape_types import FrameState

if TYPE_CHECKING:
    from toile.dressing.fit.fit_maps import FitMaps

Say = Callable[[str], None]
"""Called with one sentence."""


class FitListener(Protocol):
    """Called with the maps of a fit."""

    def __call__(self, maps: "FitMaps", /) -> object:
        """Hear of them."""


class Listener:
    """The functions that a caller of `dress` gave, each perhaps None.

    Attributes
    ----------
    say
        Says a sentence to the caller.
    record
        Gives it a frame's number and garments.
    fit
        Gives it how garments fit; None where nobody wants to know, since that is work.
    """

    def __init__(
        self, progress: Progress | None = None, say: Say | None = None, record: Record | None = None,
        fit: FitListener | None = None,
    ) -> None:  # fmt: skip
        self._progress = progress
        self._interrupt: CancelOnInterrupt | None = None
        self.say: Say = say or _nothing
        self.record: Record = record or _nothing
        self.fit = fit

    @contextmanager
    def heeding_interrupts(self) -> Iterator[None]:
        """Let a first Ctrl-C, or the stop of a notebook, cancel as `progress` does, unless others do.

        A second one stops at once.
        """
        of_python = signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if threading.current_thread() is not threading.main_thread() or not of_python:
            yield
            return
        with CancelOnInterrupt() as self._interrupt:
            yield

    def _interrupted(self) -> bool:
        """Whether the user has pressed Ctrl-C."""
        return self._interrupt is not None and self._interrupt.requested

    def on_frame(self, tolerance: float) -> Callable[[FrameState], bool]:
        """Return the engine's callback: estimates the time left and passes the frame on.

        It returns False if the caller cancels. `tolerance` [m] is where the drape counts as converged.
        """
        clock = TimeLeft(tolerance)

        def on_frame(state: FrameState) -> bool:
            left = clock.update(state)
            if self._progress is None:
                return not self._interrupted()
            answer = self._progress(
                ProgressState(
                    frame=state.frame,
                    max_frames=state.max_frames,
                    faces=state.faces,
                    contacts=state.contacts,
                    residual=state.residual,
                    tolerance=tolerance,
                    seconds=state.seconds,
                    seconds_left=left,
                    doing=state.doing,
                    phase=state.phase,
                )
            )
            return answer is not False and not self._interrupted()

        return on_frame


def _nothing(*_: object) -> None:
    """Do nothing, where nobody listens."""
