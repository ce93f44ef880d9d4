"""The film of cloth in motion on a still obstacle: implicit steps with velocities, frames at a fixed rate."""

from collections.abc import Callable
from math import ceil, inf
from time import process_time

import numpy as np

from toile.engine.cloth import Cloth
from toile.engine.cloth_run import ClothRun
from toile.engine.film_plan import FilmFrame, FilmPlan, FilmRecord
from toile.engine.step_request import StageClock, StepOutcome, StepRequest
from toile.geometry.arrays import Float, Int

GROWTH = 1.2
"""Factor on the step size after a step that went well."""
MOVED = 1.0
"""RMS motion since the last remeshing, drift aside, at which a mesh is adapted again, in shortest edges."""
RELAXING = 0.01
"""Step size in which the nodes around remeshed faces find their places [s]."""


class Simulation(ClothRun):
    """A film in progress: call `run`.

    The avatar is given as (vertices, faces) and does not move. `on_frame` is called with every audited frame
    and ends the film by returning False.
    """

    def __init__(
        self, cloth: Cloth, avatar: tuple[Float, Int] | None, plan: FilmPlan,
        on_frame: Callable[[FilmFrame], bool],
    ) -> None:  # fmt: skip
        super().__init__(cloth, avatar, plan.step, StageClock(now=process_time))
        self.plan = plan
        self.on_frame = on_frame
        self.record = FilmRecord()
        self._meshed_at = cloth.positions
        self._h = plan.longest_step
        self._contacts = 0
        self._min_gap = inf
        self._steps = 0

    def run(self, seconds: float) -> FilmRecord:
        """Advance by `seconds`, rounded to whole frames, or until on_frame returns False."""
        if not self.record.crossings:
            self._close_frame()
        for _ in range(round(seconds / self.plan.frame_seconds)):
            if self.record.cancelled:
                break
            self._remesh()
            self._advance(self.plan.frame_seconds)
            self._close_frame()
        return self.record

    def _remesh(self) -> None:
        """Adapt the mesh to the cloth's shape and motion, where the plan says so and both have changed.

        Cloth that has not moved yet keeps its mesh: a flat one would lose what its first folds need.
        """
        plan, record = self.plan, self.record
        if plan.sizing is None or not record.steps or (len(record.crossings) - 1) % plan.remesh_frames:
            return
        away = self.stepper.x - self._meshed_at
        away -= away.mean(axis=0)
        if float(np.sqrt((away**2).sum() / len(away))) < MOVED * plan.sizing.size_min:
            return
        # Its kernels are compiled for scenes that ask for it only.
        from toile.engine.remeshing import remesh_run

        now = self.clock.now()
        request = StepRequest(h=RELAXING, at_rest=True, gravity=0.0, cg_tolerance=plan.cg_tolerance)
        done = remesh_run(self, plan.sizing, request, record.steps, keep_energy=True)
        if done is not None:
            record.remeshings.append(done)
        self._meshed_at = self.stepper.x.copy()
        self.clock.add("remesh", now)

    def _advance(self, seconds: float) -> None:
        """Step until `seconds` have passed, in steps as equal as the adaptive size allows."""
        plan, record = self.plan, self.record
        left = seconds
        while left > 1e-9 * seconds:
            speed = float(np.linalg.norm(self.stepper.v, axis=1).max())
            wished = min(self._h, plan.motion_max / max(speed, 1e-300))
            h = left / ceil(left / wished - 1e-9)
            outcome, good = self._attempt(h)
            if outcome is None:
                self._h = 0.5 * h
                continue
            if good:
                self._h = min(GROWTH * self._h, plan.longest_step)
            left -= h
            record.steps += 1
            record.simulated_seconds += h
            self._steps += 1
            self._contacts = outcome.contacts
            self._min_gap = min(self._min_gap, outcome.min_gap)

    def _attempt(self, h: float) -> tuple[StepOutcome | None, bool]:
        """Try a step of size h [s]: its outcome or, undone, None; and whether it went well."""
        plan, stepper, record = self.plan, self.stepper, self.record
        before = self.stretch_max()
        saved = stepper.save()
        outcome = stepper.step(
            StepRequest(
                h=h, at_rest=False, newton=plan.newton, newton_tolerance=plan.newton_tolerance,
                cg_tolerance=plan.cg_tolerance, motion_max=inf,
            )
        )  # fmt: skip
        record.newton_iterations += outcome.newton_iterations
        record.cg_iterations += outcome.cg_iterations
        rise = self.stretch_max() - before
        if outcome.converged and rise <= plan.stretch_rise:
            return outcome, rise <= 0.5 * plan.stretch_rise
        if h > plan.shortest_step:
            record.retries += 1
            stepper.restore(saved)
            return None, False
        record.forced += 1
        return outcome, False

    def stretch_max(self) -> float:
        """Largest stretch along warp or weft now."""
        return float(self.warp_weft_strain().max())

    def _close_frame(self) -> None:
        """Audit the cloth as it is, hand it out and book it."""
        record = self.record
        crossings = self.audited_cloth()
        frame = FilmFrame(
            index=len(record.crossings), seconds=record.simulated_seconds, cloth=self.cloth,
            crossings=crossings, steps=self._steps, contacts=self._contacts, min_gap=self._min_gap,
            stretch_max=self.stretch_max(),
        )  # fmt: skip
        record.crossings.append((len(crossings.avatar), len(crossings.cloth)))
        record.faces.append(len(self.cloth.faces))
        record.steps_per_frame.append(frame.steps)
        record.stretch_max.append(frame.stretch_max)
        record.min_gap.append(frame.min_gap)
        self._steps, self._contacts, self._min_gap = 0, 0, inf
        if not self.on_frame(frame):
            record.cancelled = True
