"""The request for one step: size, targets, tolerances."""

from dataclasses import dataclass

from toile.geometry.arrays import Float

MOTION_MAX = 0.03
"""Longest motion of a node in one Newton iteration, unless told [m]."""


@dataclass(frozen=True, kw_only=True)
class StepRequest:
    """Request for one step.

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
