"""Equilibrium of a patch under loads: no masses, no time.

Newton's method on all six numbers of all crossings together: places and slides in turns take a hundred times
as many rounds. Forces between yarns, which limit friction, are taken from the last equilibrium and found
again until they stay.
"""

from dataclasses import dataclass, field

import numpy as np

from toile.engine.solve.block_pattern import BlockPattern
from toile.engine.swatch.corner import shear_terms, touch_terms
from toile.engine.swatch.curvature import curvature_terms
from toile.engine.swatch.direct_solve import DirectSolve
from toile.engine.swatch.friction import follow, friction_energy
from toile.engine.swatch.net import Net
from toile.engine.swatch.piece import piece_terms, stretched_beyond
from toile.engine.swatch.terms import Terms, add_hessian, energy, gradient
from toile.engine.swatch.wave import wave_terms
from toile.engine.swatch.weight import weight_energy
from toile.geometry.arrays import Bool, Float, Int

ROUNDING = 1e-13
"""Force left over that is none, as a share of the axial stiffness of yarn, per square root of crossings."""
MOST_ITERATIONS = 400
NEARLY = 100.0
"""Of the forces that may be left over: what is enough where no step lowers the energy any more."""
MOST_ROUNDS = 20
STEADY = 1e-3
"""Change of the forces between yarns, as a share of the largest, that changes nothing."""
SHORTEST = 0.2
"""Least rest length between two crossings, in widths of the yarn: shorter ones stiffen endlessly."""
SUFFICIENT = 1e-4
"""Share of the decrease that a step promises which it must give (Armijo 1966)."""
FARTHEST = 0.3
"""Most that a step moves a crossing against its neighbour, in spacings."""
LESS_CAUTIOUS = 0.3
"""Share of the secant of sliding friction that is left after a step that went well, down to the tangent."""
CORRECTED = 4
"""Trials of a step that a second one corrects."""
LEAST_DAMPING, MOST_DAMPING = 1e-9, 1e3


class NoEquilibriumError(Exception):
    """Newton's method ended without one."""


@dataclass
class Patch:
    """A net, its state and what acts on it.

    Attributes
    ----------
    net
        The yarns.
    state
        Places [m], then (u, v, c) [m], shape (2 n, 3).
    free
        Which of these numbers may change, shape (2 n, 3).
    friction
        Coefficient mu.
    grip
        Stiffness k_f of yarns that stick [N/m].
    pull
        Force on every place [N], shape (n, 3).
    gravity
        Acceleration [m/s^2], shape (3,).
    anchors
        Where yarns stick, shape (n, 2).
    pressed
        Force between the yarns of every crossing as warp and weft feel it [N], shape (n, 2); both are one
        where the wave is free to pass from one to the other.
    given
        Whether `pressed` is given and not found.
    precise
        Forces left over in equilibrium, as a share of all that act on the nodes.
    """

    net: Net
    state: Float
    free: Bool
    friction: float = 0.0
    grip: float = 1e5
    pull: Float = field(default_factory=lambda: np.zeros((0, 3)))
    gravity: Float = field(default_factory=lambda: np.zeros(3))
    anchors: Float = field(default_factory=lambda: np.zeros((0, 2)))
    pressed: Float = field(default_factory=lambda: np.zeros((0, 2)))
    given: bool = False
    precise: float = 1e-6

    def __post_init__(self) -> None:
        """Copy what changes, and fill in what was not given."""
        count = self.net.crossings
        self.state, self.free = self.state.copy(), self.free.copy()
        if not len(self.pull):
            self.pull = np.zeros((count, 3))
        if not len(self.anchors):
            self.anchors = self.state[count:, :2].copy()
        if not len(self.pressed):
            self.pressed = np.zeros((count, 2))
        stencils = [one.nodes for one in _elements(self.net, self.state)]
        stencils = [*stencils[:3], self.net.corners]
        self._pattern = BlockPattern(2 * count, stencils)
        self._solver: DirectSolve | None = None
        self._solved_for = self.free
        self._damping = LEAST_DAMPING
        self._caution = 1.0

    def terms(self) -> list[Terms]:
        """Return the elements of the net as it is."""
        return _elements(self.net, self.state)

    def settle(self) -> int:
        """Find equilibrium; return Newton iterations. Raises NoEquilibriumError."""
        iterations = self._newton()
        if self.friction > 0.0 and not self.given:
            for _ in range(MOST_ROUNDS):
                before = self.pressed
                self.pressed = self.contact_forces()
                scale = float(self.pressed.max(initial=0.0))
                if np.abs(self.pressed - before).max(initial=0.0) <= STEADY * scale:
                    break
                iterations += self._newton()
        count = self.net.crossings
        if self.friction > 0.0:
            self.anchors = follow(
                self.anchors, self.state[count:, :2], self.friction * self.pressed, self.grip
            )
        return iterations

    def contact_forces(self) -> Float:
        """Return the force between the yarns of crossings, as warp and weft feel it [N], shape (n, 2)."""
        lift = np.zeros((self.net.crossings, 2))
        for one, axis in zip(self.terms()[:2], (self.net.piece_axis, self._wave_axis()), strict=True):
            assert one.lift is not None
            for k in range(one.nodes.shape[1]):
                here = one.nodes[:, k] < self.net.crossings
                np.add.at(lift, (one.nodes[here, k], axis[here]), one.lift[here, k])
        shared = self.free[self.net.crossings :, 2]
        both = lift.sum(axis=1, keepdims=True)
        return np.maximum(np.where(shared[:, None], both, 2.0 * lift), 0.0)

    def reactions(self) -> Float:
        """Return forces that hold the numbers which are not free [N], shape (2 n, 3); else what is left."""
        return self._gradient(self.terms())

    def stored(self) -> float:
        """Return the energy in the yarns [J], without friction, loads and weight."""
        return energy(self.terms())

    def _wave_axis(self) -> Int:
        return self.net.bend_axis[self.net.bend_rises.any(axis=1)]

    def _energy(self, terms: list[Terms]) -> float:
        count = self.net.crossings
        if (self._rest_lengths(self.state) <= 0.0).any():
            return np.inf
        total = energy(terms) - float((self.pull * self.state[:count]).sum())
        if self.gravity.any():
            total += weight_energy(self.net, self.state, self.gravity)[0]
        if self.friction > 0.0:
            total += float(self._held()[0].sum())
        return total

    def _held(self) -> tuple[Float, Float, Float, Float]:
        slides = self.state[self.net.crossings :, :2]
        return friction_energy(slides - self.anchors, self.friction * self.pressed, self.grip)

    def _gradient(self, terms: list[Terms]) -> Float:
        count = self.net.crossings
        total = gradient(terms, 2 * count)
        total[:count] -= self.pull
        if self.gravity.any():
            total += weight_energy(self.net, self.state, self.gravity)[1]
        if self.friction > 0.0:
            total[count:, :2] += self._held()[1]
        return total

    def _newton(self) -> int:
        """Find equilibrium with the friction limits as they are; return Newton iterations."""
        terms = self.terms()
        here = self._energy(terms)
        self._caution = 1.0
        none = ROUNDING * self.net.strands[0].stiffness * float(np.sqrt(self.net.crossings))
        for iteration in range(MOST_ITERATIONS):
            slope = np.where(self.free, self._gradient(terms), 0.0)
            scale = self._force_scale(terms)
            left = float(np.sqrt((slope * slope).sum()))
            if left <= max(self.precise * scale, none):
                return iteration
            moved = self._step(terms, slope, here)
            if moved is None:
                if left <= NEARLY * max(self.precise * scale, none):
                    return iteration
                continue
            terms, here = moved
        raise NoEquilibriumError(f"no equilibrium after {MOST_ITERATIONS} iterations")

    def _force_scale(self, terms: list[Terms]) -> float:
        """Return the size of the forces that act on the nodes, before they cancel [N]."""
        square = float((self.pull**2).sum())
        for one in terms:
            parts = np.matmul(one.gradient[:, None, :], one.jacobian)
            square += float((parts * parts).sum())
        return max(float(np.sqrt(square)), 1e-300)

    def _step(self, terms: list[Terms], slope: Float, here: float) -> tuple[list[Terms], float] | None:
        """Move the state along one Newton step; return its elements and energy, or None if none was found."""
        count = self.net.crossings
        blocks = self._pattern.zeros()
        touch = terms[4:]
        for one, slots in zip(terms[:4], self._pattern.slots, strict=True):
            add_hessian(one, self.free, slots, blocks)
        for one in touch:
            add_hessian(one, self.free, self._pattern.slots[3], blocks)
        diagonal = np.zeros((2 * count, 3))
        if self.friction > 0.0:
            _, _, tangent, secant = self._held()
            diagonal[count:, :2] = tangent + self._caution * (secant - tangent)
        mean = float(np.abs(np.einsum("nii->n", self._pattern.diagonal(blocks))).mean()) / 3.0
        diagonal = np.where(self.free, diagonal + self._damping * mean, mean)
        at = self._pattern.rank
        for k in range(3):
            blocks[at, k, k] += diagonal[:, k]
        if self._solver is None or (self.free != self._solved_for).any():
            self._solver, self._solved_for = DirectSolve(self._pattern, self.free), self.free.copy()
        self._solver.update(blocks)
        step = self._solver.solve(-slope)
        promised = float((slope * step).sum())
        share = self._longest_share(step)
        start = self.state
        for trial in range(12):
            self.state = start + share * step
            terms = self.terms()
            there = self._energy(terms)
            slack = 1e-13 * abs(here)
            limit = here + SUFFICIENT * share * promised + slack
            if there > limit and trial < CORRECTED:
                # Turning yarn stretches it, which a second step by the same matrix takes back.
                rest = stretched_beyond(self.net, start, share * step)
                back = self._solver.solve(-rest)
                self.state = start + share * step + back
                terms = self.terms()
                there = self._energy(terms)
            if there <= limit:
                if share > 0.5:
                    self._damping = max(0.1 * self._damping, LEAST_DAMPING)
                    self._caution *= LESS_CAUTIOUS
                else:
                    self._caution = 1.0
                return terms, there
            share *= 0.5
        self.state = start
        self._damping = min(10.0 * self._damping, MOST_DAMPING)
        return None

    def _rest_lengths(self, numbers: Float) -> Float:
        """Return the lengths of yarn between crossings in a state, or how a step changes them, shape (P,)."""
        a, b = self.net.slide(self.net.pieces[:, 0]), self.net.slide(self.net.pieces[:, 1])
        return np.asarray(numbers[b, self.net.piece_axis] - numbers[a, self.net.piece_axis])

    def _longest_share(self, step: Float) -> float:
        """Return how much of a step keeps yarn between crossings and moves none too far."""
        net = self.net
        share = 1.0
        turned = step[net.pieces[:, 1]] - step[net.pieces[:, 0]]
        most = float(np.sqrt((turned * turned).sum(axis=1)).max(initial=0.0))
        spacing = min(strand.spacing for strand in net.strands)
        if most > FARTHEST * spacing:
            share = FARTHEST * spacing / most
        rest, change = self._rest_lengths(self.state), self._rest_lengths(step)
        least = SHORTEST * net.of_axis("width", net.piece_axis)
        shrinking = change < 0.0
        if shrinking.any():
            room = np.maximum(rest - least, 0.0)[shrinking] / -change[shrinking]
            share = min(share, max(0.9 * float(room.min()), 1e-3))
        return share


def _elements(net: Net, state: Float) -> list[Terms]:
    return [
        piece_terms(net, state), wave_terms(net, state), curvature_terms(net, state), shear_terms(net, state),
        *touch_terms(net, state),
    ]  # fmt: skip
