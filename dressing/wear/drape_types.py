"""Input and output of a drape: the contract between scene, frame loop and writers."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.forces.contact_pairs import SkinPart
from toile.geometry.arrays import Float, Int
from toile.geometry.by_value import ByValue
from toile.geometry.stage_clock import Spent, together
from toile.remesh.sizing.sizing import SizingOptions

if TYPE_CHECKING:
    # They import kernels, which are loaded when they are needed.
    from toile.engine.cloth.cloth import Cloth
    from toile.engine.cloth.origin import Origin
    from toile.engine.step.options import StepOptions

Status = Literal["converged", "frame_limit", "cancelled", "failed"]
Phase = Literal["sewing", "growing", "settling", "leading in", "film"]
"""What a frame belongs to: seams close; the body takes on its shape; the garment finds rest; the motion that
leads into a clip; the clip."""
FailureKind = Literal[
    "open_seams", "tangled", "not_sewn", "numerical", "motion", "crossing", "overstretched", "fell_off"
]
"""What may go wrong; `batch.failure_classes` says in words what each means."""


@dataclass(frozen=True, kw_only=True)
class DrapeOptions:
    """Options of a drape.

    Attributes
    ----------
    edge_length
        Edge length of the mesh in which the garment is sewn [m].
    sizing
        How fine the mesh becomes once it is sewn, or None to keep it.
    max_frames
        Frames after which the drape stops with status frame_limit.
    tolerance
        Residual below which the drape is converged.
    gravity
        Downward acceleration [m/s^2].
    friction
        Coulomb coefficient against the avatar for all garments, or None for each fabric's own.
    friction_between
        Coefficients of pairs of fabrics, or of a fabric and "body", by their names.
    pins
        Material vertices held where they start, one array per garment.
    self_contact
        Per garment: may it touch itself and other garments? The search is left out when none may.
    persistent
        Whether seams that jam for good are left open; or the drape gives up.
    ground
        Height of the floor [m], or None.
    most_work
        As in `DrapePlan`.
    obstacles
        Vertices of the avatar that belong to obstacles beside the body.
    """

    edge_length: float
    max_frames: int
    tolerance: float
    sizing: SizingOptions | None = None
    gravity: float = 9.81
    friction: float | None = None
    friction_between: Mapping[frozenset[str], float] = field(default_factory=dict)
    pins: tuple[Int, ...] = ()
    self_contact: tuple[bool, ...] = ()
    persistent: bool = True
    ground: float | None = None
    most_work: float | None = None
    obstacles: tuple[SkinPart, ...] = ()


@dataclass(frozen=True, kw_only=True)
class FrameState:
    """State of a drape after a frame; residual as in DrapeOptions.tolerance, seconds of wall time.

    `phase` is what it belongs to, and `doing` says in words what is being done, and how far it is.
    """

    frame: int
    faces: int
    contacts: int
    residual: float
    seconds: float
    max_frames: int
    doing: str = ""
    phase: Phase = "settling"


@dataclass(frozen=True, kw_only=True, eq=False)
class Failure(ByValue):
    """A failure of a drape: its kind, one sentence, and where (panels, faces, frame).

    `faces` are the faces at fault by their numbers in the file of each garment, shape (k,), where both are
    known.
    """

    kind: FailureKind
    message: str
    where: str = ""
    faces: tuple[Int, ...] = ()


@dataclass(frozen=True, kw_only=True)
class StrainedPlace:
    """A panel that is stretched a lot: largest strain [%], how many faces, and where, in words."""

    percent: float
    faces: int
    where: str


@dataclass(frozen=True, kw_only=True)
class DrapeFigures:
    """Figures of a drape, as they enter report.json.

    Attributes
    ----------
    frames, steps, newton_iterations, cg_iterations
        Counts; the start is not a frame.
    simulated_seconds
        Simulated time [s].
    nodes, faces
        (initial, final, max) counts over all garments.
    contacts_max
        Largest number of active contacts in a step.
    avatar_intersections, self_intersections
        Crossing triangle pairs in the final frame.
    worst_frame_intersections
        Crossing triangle pairs, avatar and self together, in the worst output frame. Output frames are
        those in which the sewn garment settles; while seams still close there is nothing to put out.
    min_gap_mm
        Smallest distance between cloth and avatar or cloth in the final frame [mm], None without contact.
    warp_strain_max, weft_strain_max, strain_p99
        Strain along the threads in the final frame: largest, and 99th percentile of both [%].
    areas
        Area of every garment as it hangs, and as it was cut [m^2].
    strained
        Panels with the largest strains over 50 %, the most first.
    residual
        How far from rest: RMS node motion over the last output frame [m].
    remeshings, splits, flips, collapses
        How often the mesh was adapted, and what was done in all.
    energy_jump_max
        Largest rise of the elastic energy in a remeshing, as a share of it; 0 if there was none.
    pop
        How much farther a node moved in the step after a remeshing of cloth at rest than in the one before,
        at which the drape counted as settled [m].
    stages
        CPU and wall time per stage; stages that a scene did not need are missing.
    """

    frames: int
    simulated_seconds: float
    steps: int
    newton_iterations: int
    cg_iterations: int
    nodes: tuple[int, int, int]
    faces: tuple[int, int, int]
    contacts_max: int
    avatar_intersections: int
    self_intersections: int
    worst_frame_intersections: int
    min_gap_mm: float | None
    warp_strain_max: float
    weft_strain_max: float
    strain_p99: float
    areas: tuple[tuple[float, float], ...]
    strained: tuple[StrainedPlace, ...]
    residual: float
    remeshings: int
    splits: int
    flips: int
    collapses: int
    energy_jump_max: float
    pop: float
    stages: Mapping[str, Spent] = field(default_factory=dict)


def in_all(parts: list[DrapeFigures], last: DrapeFigures) -> DrapeFigures:
    """Return the figures of a drape in parts, the last one of all garments together."""
    every = [*parts, last]
    summed = (
        "frames", "simulated_seconds", "steps", "newton_iterations", "cg_iterations", "remeshings", "splits",
        "flips", "collapses",
    )  # fmt: skip
    most = ("contacts_max", "worst_frame_intersections", "energy_jump_max", "pop")

    def counts(name: str) -> tuple[int, int, int]:
        first, _, largest = (sum(getattr(part, name)[k] for part in parts) for k in range(3))
        return first, getattr(last, name)[1], max(largest, getattr(last, name)[2])

    return replace(
        last, nodes=counts("nodes"), faces=counts("faces"), stages=together(*(part.stages for part in every)),
        **{name: sum(getattr(part, name) for part in every) for name in summed},
        **{name: max(getattr(part, name) for part in every) for name in most},
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class DrapedGarment:
    """One garment after the drape.

    Attributes
    ----------
    positions
        Welded nodes [m], shape (n, 3).
    faces
        Triangles into nodes, shape (t, 3).
    faces_material
        The same triangles into material vertices, shape (t, 3).
    uv
        Pattern coordinates of material vertices [m], shape (m, 2).
    panel
        Panel of every face, shape (t,).
    velocities
        Of nodes [m/s], shape (n, 3); None is at rest.
    origin
        Which corners and faces of the garment's file all this comes from, or None.
    strain
        Along warp and weft of every face, shape (t, 2), or None.
    """

    positions: Float
    faces: Int
    faces_material: Int
    uv: Float
    panel: Int
    velocities: Float | None = None
    origin: "Origin | None" = None
    strain: Float | None = None


@dataclass(frozen=True, kw_only=True)
class DrapeOutcome:
    """A drape's end: status, why it failed if it did, figures, garments in scene order, repairs made.

    `gave_up`: its seams jammed, and on another mesh they may not; `work`: faces times Newton iterations until
    it settled. `cloth`, `step` and `pin_motion` are what a film continues with; `anchors` are where friction
    holds the nodes of the cloth [m], shape (n, 3).
    """

    status: Status
    failure: Failure | None
    figures: DrapeFigures
    garments: list[DrapedGarment]
    cloth: "Cloth"
    step: "StepOptions"
    notes: tuple[str, ...] = ()
    gave_up: bool = False
    work: int = 0
    pin_motion: VertexMotion | None = None
    anchors: Float | None = None
