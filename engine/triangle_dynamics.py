"""The triangle cloth without contact, for integrators."""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.dynamics import Dynamics, Elements
from toile.engine.forces.bend import Bending
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.membrane_damping import MembraneDamping
from toile.engine.forces.wind import AirFlow, Wind
from toile.geometry.arrays import Float


def triangle_dynamics(
    cloth: Cloth, *, gravity: float = 9.81, air: AirFlow | None = None, damping: float = 0.0
) -> Dynamics:
    """Return membrane, bending, weight [m/s^2] and wind of a sewn cloth.

    `damping` is the time [s] by which the damping of stretch and shear exceeds their stiffness, number for
    number. Raises ValueError where the cloth has open stitches, which are no concern of this model.
    """
    if len(cloth.stitches):
        raise ValueError(f"cloth has {len(cloth.stitches)} open stitches; sew it first")

    def per_face(name: str) -> Float:
        return np.array([getattr(fabric, name) for fabric in cloth.fabrics])[cloth.fabric]

    faces = cloth.face_nodes
    membrane = Membrane(
        faces, cloth.rest_corners, per_face("stretch_warp"), per_face("stretch_weft"), per_face("shear"),
        per_face("compression"),
    )  # fmt: skip
    damper = MembraneDamping(membrane, damping) if damping > 0.0 else None
    bends = any(max(f.bending_warp, f.bending_weft, f.bending_bias) > 0.0 for f in cloth.fabrics)
    return Dynamics(
        cloth.mass,
        cloth.pinned,
        [Elements(faces, membrane, damper)],
        gravity=gravity,
        bending=Bending.for_cloth(cloth) if bends else None,
        wind=None if air is None else Wind(faces, len(cloth.positions), air),
    )
