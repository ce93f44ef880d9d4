"""Plan, growth, frames and record of a drape."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from toile.collide.audit import Crossings
from toile.engine.adapt.remeshing_record import Remeshing
from toile.engine.cloth.cloth import Cloth
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float
from toile.remesh.sizing.sizing import SizingOptions

STEPS_PER_FRAME = 10
Phase = Literal["sewing", "growing", "settling"]


@dataclass(frozen=True, kw_only=True)
class DrapePlan:
    """Numbers of the frame loop.

    Attributes
    ----------
    step
        Implicit step options.
    max_steps
        Steps after which the drape stops unconverged.
    steps_per_frame
        Steps between two audited output frames.
    sewing_step, settling_step, longest_step
        Step size while sewing, at the start of settling, and its upper limit [s].
    closing_per_step
        How much the longest seam gap shrinks per sewing step [m].
    zipper_per_step
        How far closing spreads along a seam from its junctions per step [m].
    stitch_stiffness
        Stiffness of one stitch [N/m] when sewing begins.
    stiffening
        Factor on it for every step after the seams should have met.
    sliding_steps, sliding_stiffness
        Steps at most, and hold stiffness [N/m], to slide panels in their planes before they close.
    hold_stiffness
        Stiffness that keeps a stitched node near the place where its seam should meet [N/m].
    late_stiffness
        Stiffness of a stitch that is still open after sewing [N/m].
    sewing_bending
        Factor on the bending rigidity while cloth is sewn and disentangled.
    closed_gap
        Sewing ends early when every stitch is shorter than this [m].
    merge_gap
        Gap at which the two nodes of a stitch merge [m].
    patience
        Sewing steps granted after the seams should have met.
    jam_radius
        Cloth this close to a stitch that cannot close, or to a crossing, may pass through itself until it is
        disentangled [m].
    untangle_stiffness
        Stiffness of the springs that draw tangled cloth apart where it crosses [N/m].
    tangle_frames
        Frames of steps that tangled cloth is drawn apart before the drape continues as it is.
    late_frames
        Frames of steps at most in which stitches that are still open when the garment hangs are closed.
    growth_lag
        How far a vertex of the growing avatar may lag before the rest waits [m].
    growth_patience
        Steps for which cloth may hold the avatar back before the rest grows on, and then before what is left
        takes its true shape.
    easing_steps, falling_steps
        Steps under gravity but without friction before the garment settles; steps more, at most, where limbs
        that were out of the way come back: what is to hang must hang by then.
    waist_stiffness
        Stiffness that keeps waistbands at their height meanwhile [N/m].
    rms_motion, peak_motion
        Equilibrium: largest RMS and 99.9th percentile node motion over a frame of longest steps [m].
    cg_tolerance
        Relative residual of the linear solver.
    sizing
        How fine the mesh should be once the garment is sewn; None keeps it as it is.
    persistent
        Whether seams that jam for good are left open. Otherwise the drape gives up: the caller may start it
        on another mesh.
    most_work
        Faces times Newton iterations after which a garment that is still being put on is given up, or None.
    """

    step: StepOptions
    max_steps: int
    steps_per_frame: int = STEPS_PER_FRAME
    sewing_step: float = 1.0 / 60.0
    settling_step: float = 1.0 / 60.0
    longest_step: float = 0.25
    closing_per_step: float = 0.03
    zipper_per_step: float = 0.02
    stitch_stiffness: float = 300.0
    stiffening: float = 1.05
    sliding_steps: int = 15
    sliding_stiffness: float = 30.0
    hold_stiffness: float = 30.0
    late_stiffness: float = 1000.0
    sewing_bending: float = 50.0
    closed_gap: float = 1e-3
    merge_gap: float = 6e-3
    patience: int = 12
    jam_radius: float = 0.03
    untangle_stiffness: float = 50.0
    tangle_frames: int = 15
    late_frames: int = 8
    easing_steps: int = 20
    falling_steps: int = 60
    waist_stiffness: float = 20.0
    growth_lag: float = 0.002
    growth_patience: int = 40
    rms_motion: float = 3e-4
    peak_motion: float = 3e-3
    cg_tolerance: float = 1e-2
    sizing: SizingOptions | None = None
    persistent: bool = True
    most_work: float | None = None


@dataclass(frozen=True, kw_only=True)
class Growth:
    """A shape the avatar takes on, vertices (v, 3) [m], and how far it may move in a step [m]."""

    vertices: Float
    per_step: float


@dataclass(frozen=True, kw_only=True)
class Frame:
    """One audited output frame."""

    index: int
    step: int
    phase: Phase
    cloth: Cloth
    contacts: int
    rms_motion: float
    peak_motion: float
    crossings: Crossings


@dataclass
class DrapeRecord:
    """Record of a drape.

    `crossings` counts crossing pairs (avatar, cloth) per audited frame; `settled_crossings` only those of
    output frames, in which the sewn garment settles. `node_counts` lists the sizes of its topologies. `pop`
    is how much farther a node moved in the step after a remeshing at rest than in the one before [m]; the
    first such remeshing does not count. `work` counts faces times Newton iterations until cloth settles.
    """

    steps: int = 0
    work: int = 0
    newton_iterations: int = 0
    cg_iterations: int = 0
    contacts_max: int = 0
    simulated_seconds: float = 0.0
    rms_motion: float = np.inf
    peak_motion: float = np.inf
    converged: bool = False
    cancelled: bool = False
    gave_up: bool = False
    crossings: list[tuple[int, int]] = field(default_factory=list)
    settled_crossings: list[tuple[int, int]] = field(default_factory=list)
    node_counts: list[int] = field(default_factory=list)
    first_faces: int = 0
    remeshings: list[Remeshing] = field(default_factory=list)
    pop: float = 0.0
