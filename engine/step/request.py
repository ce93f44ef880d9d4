"""What a step is asked to do and what it did."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np

from toile.engine.forces.contact import ContactLaw
from toile.engine.forces.wind import AirFlow
from toile.engine.step.stages import Stage
from toile.geometry.arrays import Float


@dataclass(frozen=True, kw_only=True)
class StepOptions:
    """Numbers of the implicit step that do not change during a drape.

    Attributes
    ----------
    gravity
        Downward acceleration [m/s^2].
    radius_body, radius_self
        Contact radius against the avatar and within the cloth [m], at least: thicker fabrics have more.
    law_body, law_self
        Contact laws against the avatar and within the cloth.
    friction
        Coulomb coefficients of named pairs, where they are not those of the fabrics: see `pair_friction`.
    growth_radius
        Contact radius against the avatar while it grows [m]: the farther the cloth keeps ahead of the
        growing body, the faster the body may grow.
    slip
        Elastic slip of friction [m]: how far a sticking contact gives before it slides.
    self_contact
        Whether the cloth can touch itself.
    air
        Wind, or still air that brakes the cloth; None is a vacuum.
    """

    gravity: float
    radius_body: float
    radius_self: float
    law_body: ContactLaw
    law_self: ContactLaw
    growth_radius: float
    slip: float
    self_contact: bool
    air: AirFlow | None = None
    friction: Mapping[frozenset[str], float] = field(default_factory=dict)


MOTION_MAX = 0.03
"""Longest motion of a node in one Newton iteration, unless told [m]."""


@dataclass(frozen=True, kw_only=True)
class StepRequest:
    """What one step is to do.

    Attributes
    ----------
    h
        Step size [s].
    at_rest
        Start from zero velocity and return none: the step seeks equilibrium.
    gravity
        Share of gravity that acts, 0 to 1.
    stitch_share
        Share of their first length that open stitches shall keep, 0 to 1, one for all or shape (s,).
    stitch_stiffness
        Stiffness of a stitch [N/m].
    stitch_reach
        Largest elongation of a stitch [m]: bounds its force.
    hold_stiffness
        Stiffness of a hold [N/m]; 0 lets go.
    untangle_stiffness
        Stiffness of the springs that draw tangled cloth apart where it crosses [N/m].
    bending_factor
        Factor on the bending rigidity: while it is sewn, stiffer cloth crumples less.
    friction
        Whether friction acts.
    newton
        Newton iterations at most.
    move_share
        Share of every Newton displacement that is carried out: less than 1 calms steps that undo each other.
    newton_tolerance
        Stop iterating when no node moved farther than this [m].
    cg_tolerance, cg_iterations
        Relative residual and iteration limit of the linear solver.
    motion_max
        Longest motion of a node in one Newton iteration [m].
    avatar_target
        Where the avatar's vertices shall be after a step in motion [m], shape (v, 3); None leaves them.
    pin_target
        Where pinned nodes shall be after it, and others are drawn to where they have goals [m], shape (n, 3),
        of which only their rows count; None leaves them.
    seconds
        Time at which it ends [s]: gusts depend on it.
    stage
        What the step is a stage of, for nodes without contact; None is a backward Euler step.
    """

    h: float
    at_rest: bool
    gravity: float = 1.0
    stitch_share: Float | float = 0.0
    stitch_stiffness: float = 0.0
    stitch_reach: float = 0.02
    hold_stiffness: float = 0.0
    untangle_stiffness: float = 0.0
    bending_factor: float = 1.0
    friction: bool = True
    newton: int = 1
    move_share: float = 1.0
    newton_tolerance: float = 1e-5
    cg_tolerance: float = 1e-2
    cg_iterations: int = 300
    motion_max: float = MOTION_MAX
    avatar_target: Float | None = None
    pin_target: Float | None = None
    seconds: float = 0.0
    stage: Stage | None = None


@dataclass
class StepOutcome:
    """What one step did: motion [m] of the nodes, iterations, how much the guard held back.

    `converged` says whether the linear solver reached its tolerance in every iteration and the last iteration
    moved no node farther than the Newton tolerance, where more than one was allowed.
    """

    moved: Float
    converged: bool = True
    newton_iterations: int = 0
    cg_iterations: int = 0
    contacts: int = 0
    limited: int = 0
    min_gap: float = np.inf


@dataclass
class StageClock:
    """Seconds spent per stage, by `now`: of wall time, or of any other clock."""

    seconds: dict[str, float] = field(default_factory=dict)
    now: Callable[[], float] = perf_counter

    def add(self, stage: str, since: float) -> float:
        """Book the time since `since` under `stage`; return now."""
        now = self.now()
        self.seconds[stage] = self.seconds.get(stage, 0.0) + now - since
        return now
