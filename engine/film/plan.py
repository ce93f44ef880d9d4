"""Plan, frames and record of a film."""

from dataclasses import dataclass, field

from toile.collide.audit import Crossings
from toile.engine.adapt.remeshing_record import Remeshing
from toile.engine.cloth.cloth import Cloth
from toile.engine.film.advance import StepCounts
from toile.engine.film.integrators.baraff_witkin import baraff_witkin
from toile.engine.film.integrators.integrator import Integrator
from toile.engine.step.memory import Memory
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float
from toile.remesh.sizing.sizing import SizingOptions

LONGEST_STEP = 1.0 / 60.0
"""Time steps that a body in motion drives, at most [s]: of two stages each."""
PUSHED_NEWTON, PUSHED_TOLERANCE = 4, 2e-3
"""Newton iterations of a step, and the motion [m] that ends them, for cloth that a moving body pushes.

One iteration, in which contacts keep their first direction, leaves fast cloth to the guard: a ball of 10 m/s
then stretches cotton to three times its length (6 % with these).
"""
PUSHED_RISE = 0.1
"""Rise of the largest stretch that undoes a step of TR-BDF2.

Threads of millimetres vibrate within a millisecond. Longer steps calm them, steps that resolve them keep them
up; undone at 2 %, which is what they do, a film stays in steps of 0.4 ms, a hundred per frame.
"""


@dataclass(frozen=True, kw_only=True)
class FilmPlan:
    """Numbers of the frame loop of cloth in motion.

    Attributes
    ----------
    step
        Implicit step options.
    integrator
        How a time step is made: one of engine.film.integrators, such as `baraff_witkin` or `tr_bdf2`.
    frame_seconds
        Time between two audited output frames [s].
    longest_step, shortest_step
        Limits of the step size [s].
    stretch_rise
        A step that raises the largest stretch of the cloth by more than this is tried again, halved.
    motion_max
        Longest motion of a node in one step at its present speed [m]: faster cloth takes shorter steps.
    newton
        Newton iterations per step at most; 1 is the linearly implicit step, which brakes turning cloth: a
        swinging strip loses most of its energy in a second, with 4 only what backward Euler takes. `tr_bdf2`
        needs more than one: nothing takes away what one leaves of a turn, and fine cloth tears itself up.
    newton_tolerance
        Motion [m] below which the iterations of a step have converged.
    cg_tolerance
        Relative residual of the linear solver.
    sizing
        How fine the mesh should be as the cloth moves; None keeps it as it is.
    remesh_frames
        Frames between two remeshings at least.
    speed_max
        Speed of an avatar's vertex above which it jumps rather than moves [m/s]: the film ends.
    lag_max
        How far cloth may hold an avatar's vertex back [m]: beyond, the film ends.
    """

    step: StepOptions = field(default_factory=StepOptions)
    integrator: Integrator = baraff_witkin
    frame_seconds: float = 1.0 / 30.0
    longest_step: float = 1.0 / 120.0
    shortest_step: float = 1.0 / 1920.0
    stretch_rise: float = 0.02
    motion_max: float = 0.02
    newton: int = 1
    newton_tolerance: float = 1e-5
    cg_tolerance: float = 1e-2
    sizing: SizingOptions | None = None
    remesh_frames: int = 5
    speed_max: float = 40.0
    lag_max: float = 0.05


@dataclass(frozen=True, kw_only=True)
class FilmFrame:
    """One audited output frame.

    Attributes
    ----------
    index, seconds
        Number of the frame, 0 at the start, and its time [s].
    cloth
        The cloth, with its velocities.
    crossings
        What crosses.
    steps
        Steps taken since the last frame.
    contacts
        Contacts in the last step.
    min_gap
        Smallest gap of a contact since the last frame [m]; infinite if there was none.
    stretch_max
        Largest stretch along warp or weft.
    avatar
        The avatar's vertices as cloth met them [m], shape (v, 3), or None.
    lag
        How far one of them is from where the motion wants it [m]: cloth caught between skins holds it back.
    """

    index: int
    seconds: float
    cloth: Cloth
    crossings: Crossings
    steps: int
    contacts: int
    min_gap: float
    stretch_max: float
    avatar: Float | None
    lag: float


@dataclass(frozen=True, kw_only=True)
class FilmState:
    """All that is needed to resume a film after a frame, with the same result.

    Attributes
    ----------
    cloth
        The cloth, with its velocities.
    memory
        What its steps remember, or None.
    anchors
        Friction anchors of its nodes [m], shape (n, 3), or None without contact.
    avatar
        The avatar's vertices [m], shape (v, 3), or None.
    poses
        Poses of the avatar that are worked out already [m], by frame.
    meshed_at
        Nodes when the mesh was adapted last [m], shape (n, 3).
    longest_step
        Step size that went well [s].
    record
        What was done.
    """

    cloth: Cloth
    memory: Memory | None
    anchors: Float | None
    avatar: Float | None
    poses: dict[int, Float]
    meshed_at: Float
    longest_step: float
    record: "FilmRecord"


@dataclass
class FilmRecord(StepCounts):
    """Record of a film, beside its counts of steps.

    Lists have one entry per frame: crossing pairs (avatar, cloth), faces, steps since the last frame, largest
    stretch, smallest gap [m], avatar's lag [m]; `remeshings` one per remeshing. `failure` says why a film
    ended early, empty if it did not.
    """

    cancelled: bool = False
    failure: str = ""
    crossings: list[tuple[int, int]] = field(default_factory=list)
    faces: list[int] = field(default_factory=list)
    steps_per_frame: list[int] = field(default_factory=list)
    stretch_max: list[float] = field(default_factory=list)
    min_gap: list[float] = field(default_factory=list)
    lag: list[float] = field(default_factory=list)
    remeshings: list[Remeshing] = field(default_factory=list)
