"""The list of forces of a cloth, one line each; forces that a scene does not need are left out."""

import numpy as np

from toile.collide.avatar_surface import AvatarSurface
from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.bend import Bending
from toile.engine.forces.force import Force
from toile.engine.forces.goal import GoalPull
from toile.engine.forces.hold import SewingHolds
from toile.engine.forces.laws.bend_damping import BendDamping
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
from toile.geometry.arrays import Float
from toile.geometry.normals import vertex_normals
from toile.geometry.stage_clock import StageClock


def cloth_forces(cloth: Cloth, options: StepOptions) -> list[Force]:
    """Return all forces of a cloth but contact: to add one, add its line, or give it in `more_forces`."""
    fabrics, faces = cloth.fabrics, cloth.face_nodes

    def per_face(name: str) -> Float:
        return np.array([getattr(fabric, name) for fabric in fabrics])[cloth.fabric]

    stretch, compression = (per_face("stretch_warp"), per_face("stretch_weft")), per_face("compression")
    laws = stretch_laws(fabrics, cloth.fabric, *stretch, compression)
    membrane = (
        Membrane(faces, cloth.rest_corners, *stretch, per_face("shear"), compression)
        if laws is None
        else CurvedMembrane(faces, cloth.rest_corners, stretch, per_face("shear"), compression, laws)
    )
    bends = any(max(f.bending_warp, f.bending_weft, f.bending_bias) > 0.0 for f in fabrics)
    bending = Bending.for_cloth(cloth) if bends else None
    sewn = len(cloth.stitches) > 0
    normals = vertex_normals(cloth.positions, faces) if sewn else None
    forces: list[Force | None] = [
        membrane,
        MembraneDamping(membrane, per_face("damping")) if any(f.damping > 0.0 for f in fabrics) else None,
        bending,
        BendDamping.for_cloth(cloth, bending),
        FoldHinges.for_cloth(cloth),
        Stitches(cloth.stitches, cloth.stitch_length) if sewn else None,
        SewingHolds(cloth.positions, normals, cloth.weld, cloth.stitches, cloth.held)
        if normals is not None
        else None,
        GoalPull.for_cloth(cloth),
        Wind(faces, len(cloth.positions), options.air) if options.air is not None else None,
        *(make(cloth) for make in options.more_forces),
    ]
    return [force for force in forces if force is not None]


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
