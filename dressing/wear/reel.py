"""Frames of all drapes of a scene as a caller sees them, with what is being done in words."""

import time
from collections.abc import Callable

import numpy as np

from toile.dressing.wear.drape_types import FrameState
from toile.dressing.wear.watch import Watch
from toile.engine.drape.plan import Frame

SHUT = 1e-3
"""Gap below which a stitch is shut, as progress counts [m]."""


class Reel:
    """Frames of all drapes of a scene, numbered through."""

    def __init__(self, on_frame: Callable[[FrameState], bool], max_frames: int) -> None:
        self._on_frame = on_frame
        self._max_frames = max_frames
        self._started = time.perf_counter()
        self._frames = 0

    def showing(self, watch: Watch) -> Callable[[Frame], bool]:
        """Return the callback of a drape that is watched: it shows a frame, and may end the drape."""
        return lambda frame: self._show(frame) and watch.see(frame)

    def _show(self, frame: Frame) -> bool:
        state = FrameState(
            frame=self._frames, faces=len(frame.cloth.faces), contacts=frame.contacts,
            residual=frame.rms_motion, seconds=time.perf_counter() - self._started,
            max_frames=self._max_frames, doing=_doing(frame), phase=frame.phase,
        )  # fmt: skip
        self._frames += 1
        return self._on_frame(state)


def _doing(frame: Frame) -> str:
    """Say what a drape is doing in a frame, and how far it is."""
    cloth = frame.cloth
    if frame.phase == "sewing" and len(cloth.stitches):
        ends = cloth.positions[cloth.stitches]
        gaps = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
        apart = int(np.count_nonzero(gaps > SHUT))
        return f"sewing, {apart} of {len(gaps)} stitches apart by up to {1e3 * gaps.max():.0f} mm"
    if frame.phase == "settling":
        return "settling"
    if sum(map(len, (frame.crossings.avatar, frame.crossings.cloth))):
        return f"untangling {len(frame.crossings.avatar) + len(frame.crossings.cloth)} crossings"
    return "growing the body to its shape" if frame.phase == "growing" else "sewing"
