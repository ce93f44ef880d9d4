"""Pins of cloth that is sewn take hold once its seams are closed."""

from dataclasses import replace

import numpy as np

from tests.engine.drape.test_unpicking import stacked
from tests.engine.step.test_only_what_is_asked import options
from toile.engine.cloth.cloth import Cloth
from toile.engine.drape.drape import Drape
from toile.engine.drape.plan import DrapePlan, Frame
from toile.geometry.arrays import Bool


def drape(cloth: Cloth, pins: Bool) -> tuple[Drape, list[Frame]]:
    frames: list[Frame] = []

    def on_frame(frame: Frame) -> bool:
        frames.append(frame)
        return True

    run = Drape(cloth, None, [], DrapePlan(step=options(self_contact=True), max_steps=120), on_frame, pins)
    run.run()
    return run, frames


def test_seams_close_and_then_pins_hold_against_gravity() -> None:
    cloth = stacked(between=False)
    # The whole seam: pinned where it starts, 6 cm apart, it could not close.
    pins = np.zeros(len(cloth.node), bool)
    pins[cloth.stitches.ravel()] = True
    run, frames = drape(replace(cloth, pinned=cloth.pinned.copy()), pins)
    assert not len(run.cloth.stitches)
    held = np.unique(run.cloth.node[pins])
    assert run.cloth.pinned[held].all() and len(held) == len(cloth.stitches)
    settled = [frame.cloth.positions[held] for frame in frames if frame.phase == "settling"]
    assert len(settled) > 2 and all(np.array_equal(settled[0], later) for later in settled[1:])
    assert np.abs(settled[0][:, 2]).max() < 0.01, "the seam closed in the middle"
    others = np.setdiff1d(np.arange(len(run.cloth.positions)), np.flatnonzero(run.cloth.pinned))
    assert run.cloth.positions[others, 1].min() < -0.05, "the rest hangs"
