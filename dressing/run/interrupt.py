"""Ctrl-C as a request: the first press finishes the frame and keeps the result, the second stops at once."""

import signal
from types import FrameType, TracebackType


class CancelOnInterrupt:
    """Context in which the first SIGINT only sets `requested`."""

    def __init__(self) -> None:
        self.requested = False
        self._before: signal.Handlers | object = signal.SIG_DFL

    def __enter__(self) -> "CancelOnInterrupt":
        """Take over SIGINT."""
        self._before = signal.signal(signal.SIGINT, self._on_interrupt)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give SIGINT back."""
        signal.signal(signal.SIGINT, self._before)  # type: ignore[arg-type]

    def _on_interrupt(self, number: int, frame: FrameType | None) -> None:
        """Note the request; a second press interrupts for good."""
        self.requested = True
        signal.signal(signal.SIGINT, signal.default_int_handler)
