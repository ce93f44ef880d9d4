"""The list of forces of a cloth, one line each; forces that a scene does not need are left out."""

from toile.collide.avatar_surface import AvatarSurface
from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.added.edge_elastic import EdgeElastic
from toile.engine.forces.added.enclosed_gas import EnclosedGas
from toile.engine.forces.added.fastening_pull import FasteningPull
from toile.engine.forces.added.keyed_membrane import KEYED, KeyedCurvedMembrane, KeyedMembrane
from toile.engine.forces.added.surface_pressure import SurfacePressure
from toile.engine.forces.added.timed_pull import TimedPull
from toile.engine.forces.bend import Bending
from toile.engine.forces.force import Force
from toile.engine.forces.goal import GoalPull
from toile.engine.forces.hold import SewingHolds
from toile.engine.forces.laws.bend_damping import BendDamping
from toile.engine.forces.laws.creasing_bending import CreasingBending
from toile.engine.forces.laws.curved_membrane import CurvedMembrane
from toile.engine.forces.laws.fold_hinges import FoldHinges
from toile.engine.forces.laws.stretch_laws import stretch_laws
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.membrane_damping import MembraneDamping
from toile.engine.forces.stitch import Stitches
from toile.engine.forces.wind import Wind
from toile.engine.step.collisions import Collisions
from toile.engine.step.nodes import Nodes
from toile.engine.step.options import StepOptions
from toile.engine.step.step import ClothStepper
from toile.geometry.normals import vertex_normals
from toile.geometry.stage_clock import StageClock


def cloth_forces(cloth: Cloth, options: StepOptions) -> list[Force]:
    """Return all forces of a cloth but contact: to add one, add its line, or give it in `more_forces`."""
    faces, per_face = cloth.face_nodes, cloth.per_face
    membrane = _membrane(cloth)
    bends = any(per_face(name).any() for name in ("bending_warp", "bending_weft", "bending_bias"))
    bending = (Bending if cloth.creases is None else CreasingBending).for_cloth(cloth) if bends else None
    damping = per_face("damping")
    sewn = len(cloth.stitches) > 0
    normals = vertex_normals(cloth.positions, faces) if sewn else None
    forces: list[Force | None] = [
        membrane,
        MembraneDamping(membrane, damping) if damping.any() else None,
        bending,
        BendDamping.for_cloth(cloth, bending),
        FoldHinges.for_cloth(cloth),
        Stitches(cloth.stitches, cloth.stitch_length) if sewn else None,
        SewingHolds(cloth.positions, normals, cloth.weld, cloth.stitches, cloth.held)
        if normals is not None
        else None,
        GoalPull.for_cloth(cloth),
        Wind(faces, len(cloth.positions), options.air) if options.air is not None else None,
        EdgeElastic.for_cloth(cloth) if cloth.elastic else None,
        FasteningPull.for_cloth(cloth) if cloth.fastenings else None,
        SurfacePressure.for_cloth(cloth) if cloth.fields is not None else None,
        *(EnclosedGas.all_of(cloth) if cloth.gas else ()),
        *(TimedPull(pins, cloth) for pins in cloth.timed_pins),
        *(make(cloth) for make in options.more_forces),
    ]
    return [force for force in forces if force is not None]


def _membrane(cloth: Cloth) -> Membrane:
    """Return the membrane of a cloth, with its fields."""
    keyed = cloth.fields is not None and cloth.fields.is_keyed(KEYED)
    per_face = cloth.per_face
    faces, corners = cloth.face_nodes, cloth.natural_corners
    stretch, shear = (per_face("stretch_warp"), per_face("stretch_weft")), per_face("shear")
    compression = per_face("compression")
    laws = stretch_laws(cloth.fabrics, cloth.fabric, *stretch, compression)
    if keyed:
        return KeyedMembrane(cloth) if laws is None else KeyedCurvedMembrane(cloth, laws)
    if laws is None:
        return Membrane(faces, corners, *stretch, shear, compression)
    return CurvedMembrane(faces, corners, stretch, shear, compression, laws)


def cloth_stepper(
    cloth: Cloth, avatar: AvatarSurface | None, options: StepOptions, clock: StageClock
) -> ClothStepper:
    """Return the stepper of a cloth beside an avatar, or without one."""
    started = clock.now()
    touches = avatar is not None or options.self_contact
    stepper = ClothStepper(
        Nodes(cloth.positions, cloth.velocities, cloth.mass, cloth.pinned),
        cloth_forces(cloth, options),
        Collisions(cloth, avatar, options) if touches else None,
        options,
        clock,
    )
    clock.add("assembly", started)
    return stepper
