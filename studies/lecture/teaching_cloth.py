"""A square of cloth under one model and one integrator, with its energies and its error."""

from dataclasses import replace
from math import ceil, inf

import numpy as np

from toile.dressing.live.sheet import BALL, surface_of
from toile.dressing.run.air import Air
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.film.integrators.baraff_witkin import baraff_witkin
from toile.engine.film.integrators.bdf2 import bdf2
from toile.engine.film.integrators.explicit_euler import explicit_euler
from toile.engine.film.integrators.integrator import Integrator
from toile.engine.film.integrators.symplectic_euler import symplectic_euler
from toile.engine.forces.step_request import StepRequest
from toile.engine.live.push import Push
from toile.engine.step.cloth_run import ClothRun
from toile.engine.step.options import StepOptions
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.errors import InputError
from toile.geometry.stage_clock import StageClock
from toile.remesh.panel.grid import grid_mesh
from toile.remesh.sizing.sizing import SizingOptions
from toile.studies.lecture.setup import PINS, Setup
from toile.studies.lecture.stable_step import fastest, longest_step
from toile.studies.scenes.motion import Solving, free_options
from toile.studies.scenes.spring_cloth import SpringNet, grid_springs, spring_stepper

INTEGRATORS: dict[str, Integrator] = {
    "explicit": explicit_euler, "symplectic": symplectic_euler, "implicit": baraff_witkin, "bdf2": bdf2,
}  # fmt: skip
FAR = 20.0
"""Distance from the start beyond which cloth has exploded [m]."""
REMESH_EVERY = 6
"""Steps from one remeshing to the next."""
FINEST, COARSEST, TURN = 0.035, 0.14, 0.5
"""Edges of adaptive meshes [m], and the turn along one [rad]."""
FINE = 1.0 / 240.0
"""Steps of what errors are measured against [s]: BDF2 is then right to a few tenths of a millimetre."""
SOLVING = Solving(iterations=1, cg_tolerance=1e-5)
"""One Newton iteration, solved so far that errors are those of the steps."""
PULL, REACH = 2.0, 0.1
"""Force of a hand per distance [N/m], and the radius of the patch that it holds [m]."""


class TeachingCloth:
    """Cloth that explodes where its integrator does.

    Attributes
    ----------
    setup
        What it is.
    seconds
        Time [s].
    exploded
        When it exploded [s], or None.
    version
        Grows with every new mesh.
    x, v
        Nodes [m], [m/s], shapes (n, 3).
    faces
        Triangles, shape (t, 3).
    limit
        Longest stable step of the method [s]; infinite where there is none.
    """

    def __init__(self, setup: Setup, at: tuple[Float, Float] | None = None, seconds: float = 0.0) -> None:
        self.setup = setup
        self.seconds = seconds
        self.exploded: float | None = None
        self.version = 0
        self._steps = 0
        self._run: ClothRun | None = None
        self._net: SpringNet | None = None
        grid = grid_mesh(1.0, 1.0, setup.cells, setup.cells)
        self.uv, self.faces = grid.points, grid.faces
        middle = grid.points - 0.5
        start = np.column_stack([middle[:, 0], np.full(len(middle), BALL + 0.05), -middle[:, 1]])
        self.start = start
        self.pinned = _pinned(middle, setup.pins)
        x, v = (start, np.zeros_like(start)) if at is None else at
        self.stepper = self._made(x, v)
        self.x, self.v = self.stepper.x.copy(), self.stepper.v.copy()
        self.limit = inf
        if setup.fabric is None and not setup.ball and setup.model != "adaptive":
            # Triangles of the same numbers are about as fast as the springs.
            net = grid_springs(1.0, 1.0, setup.cells, setup.cells, setup.made_of)
            frequency = fastest(net, start, self.pinned)
            self.limit = longest_step(setup.method, frequency, setup.lag)

    def _made(self, x: Float, v: Float) -> ClothStepper:
        """Return the stepper of the setup, at places [m] and velocities [m/s], shapes (n, 3)."""
        setup = self.setup
        fabric = setup.made_of
        air = None
        if setup.wind > 0.0:
            air = Air(velocity=(0.3 * setup.wind, 0.0, 0.95 * setup.wind), gusts=setup.gusts).flow()
        options = free_options(setup.gravity, air)
        self.push = Push(len(x))
        if setup.model == "springs":
            self._net = grid_springs(1.0, 1.0, setup.cells, setup.cells, fabric)
            stepper = spring_stepper(self._net, x.copy(), self.pinned, options, setup.lag)
            stepper.forces.append(self.push)
            stepper.put(x, v)
            return stepper
        cloth = flat_cloth(self.uv, self.faces, x, fabric, self.pinned)
        cloth = replace(cloth, velocities=v.copy(), start_positions=self.start.copy())
        if setup.ball:
            options = StepOptions(gravity=setup.gravity, air=air)
        options = replace(options, more_forces=(self._pushed,))
        self._run = ClothRun(cloth, surface_of("ball") if setup.ball else None, options, StageClock())
        return self._run.stepper

    def _pushed(self, cloth: object) -> Push:
        """Return the force of the hand, for as many nodes as there are."""
        count = len(getattr(cloth, "positions"))  # noqa: B009
        if len(self.push.force) != count:
            self.push = Push(count)
        return self.push

    def changed(self, setup: Setup) -> "TeachingCloth":
        """Return the cloth as it is and moves, of another setup; from the start where meshes differ."""
        same = (setup.cells, setup.pins, setup.ball) == (self.setup.cells, self.setup.pins, self.setup.ball)
        if not same or "adaptive" in (setup.model, self.setup.model) or self.exploded is not None:
            return TeachingCloth(setup)
        return TeachingCloth(setup, (self.x, self.v), self.seconds)

    def twin(self) -> "TeachingCloth | None":
        """Return the same cloth in fine steps, what errors are measured against; None beside a ball."""
        if self.setup.ball or self.setup.model == "adaptive":
            return None
        exact = replace(self.setup, method="bdf2", step=FINE)
        return TeachingCloth(exact, (self.x, self.v), self.seconds)

    def advance(self, until: float, exactly: bool = False) -> None:
        """Make all steps that end by a time [s]; or `exactly` until then, in equal shorter steps."""
        h = self.setup.step
        if exactly:
            h = (until - self.seconds) / max(1, ceil((until - self.seconds) / h - 1e-9))
        while h > 0.0 and self.exploded is None and self.seconds + h <= until + 1e-9:
            self._step(h)

    def _step(self, h: float) -> None:
        """Make a step of h [s]."""
        now = self.seconds

        def ask(length: float, share: float) -> StepRequest:
            return SOLVING.request(length, now + share * h)

        with np.errstate(all="ignore"):
            try:
                INTEGRATORS[self.setup.method](self.stepper, h, ask)
            except (FloatingPointError, np.linalg.LinAlgError, ValueError, ZeroDivisionError):
                self.exploded = now
                return
        self.seconds, self._steps = now + h, self._steps + 1
        x = self.stepper.x
        if not np.isfinite(x).all() or float(np.abs(x - x[0]).max()) > FAR:
            self.exploded = self.seconds
            return
        if self.setup.model == "adaptive" and self._steps % REMESH_EVERY == 0:
            self._remesh()
        self.x, self.v = self.stepper.x.copy(), self.stepper.v.copy()

    def _remesh(self) -> None:
        """Fit the mesh to the shape."""
        from toile.engine.adapt.remeshing import remesh_run

        assert self._run is not None
        sizing = SizingOptions(size_min=FINEST, size_max=COARSEST, refine_angle=TURN)
        relax = StepRequest(h=0.01, at_rest=True, gravity=0.0, cg_tolerance=1e-2, seconds=self.seconds)
        if remesh_run(self._run, sizing, relax, self._steps, keep_energy=True) is not None:
            self.stepper, self.faces = self._run.stepper, self._run.cloth.face_nodes
            self.version += 1

    # What it shows.

    @property
    def pairs(self) -> Int:
        """Two nodes of every spring, shape (s, 2); none of triangles."""
        return np.empty((0, 2), np.int32) if self._net is None else self._net.pairs

    def kinds(self) -> Int:
        """Return what every spring is: 0 structural, 1 shear, 2 bending; shape (s,)."""
        if self._net is None:
            return np.empty(0, np.int32)
        lengths = self._net.lengths * self.setup.cells
        return np.digitize(lengths, (1.2, 1.7)).astype(np.int32)

    def energies(self) -> tuple[float, float, float]:
        """Kinetic, elastic and gravitational energy now [J]; the last from the start on."""
        if self.exploded is not None:
            return inf, inf, inf
        mass = self.stepper.mass
        kinetic = 0.5 * float(mass @ (self.v * self.v).sum(axis=1))
        height = float(mass @ (self.x[:, 1] - self.start[0, 1]))
        return kinetic, self.stepper.elastic_energy(), self.setup.gravity * height

    def distance(self, other: "TeachingCloth") -> float:
        """Return the root mean square distance of its nodes to those of another [m]; infinite if exploded.

        What is a part of a step behind is carried on by its velocity.
        """
        if self.exploded is not None or other.exploded is not None or self.x.shape != other.x.shape:
            return inf
        x = self.x + (other.seconds - self.seconds) * self.v
        return float(np.sqrt(((x - other.x) ** 2).sum(axis=1).mean()))

    def pattern_place(self, node: int) -> Float:
        """Return where a node lies in the pattern [m], shape (2,). Raises InputError if there is none."""
        if not 0 <= node < len(self.x):
            raise InputError(f"there is no node {node}; they go from 0 to {len(self.x) - 1}", field="node")
        uv = self.uv if self._run is None else self._run.cloth.uv
        return np.asarray(uv[node])

    def node_at(self, place: Float) -> int:
        """Return the node that is nearest to a place of the pattern [m], shape (2,)."""
        uv = self.uv if self._run is None else self._run.cloth.uv
        return int(np.argmin(((uv - place) ** 2).sum(axis=1)))

    def pull(self, node: int, target: Float) -> None:
        """Pull the patch around a node towards a place [m], shape (3,), until it is released."""
        self.push.force[:] = 0.0
        near = np.linalg.norm(self.x - self.x[node], axis=1) <= REACH
        way = np.asarray(target, np.float64) - self.x[node]
        # Whatever the mass of a node, the same acceleration.
        share = self.stepper.mass[near] / self.stepper.mass[near].sum()
        self.push.force[near] = PULL * share[:, None] * way

    def release(self) -> None:
        """Let go."""
        self.push.force[:] = 0.0


def _pinned(middle: Float, pins: str) -> Bool:
    """Mark pinned nodes at places from the middle [m], shape (n, 2)."""
    assert pins in PINS
    back = middle[:, 1] > 0.5 - 1e-9
    if pins == "one edge":
        return np.asarray(back)
    if pins == "corners":
        return np.asarray(back & (np.abs(middle[:, 0]) > 0.5 - 1e-9))
    return np.zeros(len(middle), bool)
