"""A crossing is named by garment, panels, faces of the file and place."""

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array, eye_array

from toile.collide.audit import Auditor
from toile.dressing.garment.fabrics import fabric
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.assemble_cloth import assemble_cloth
from toile.dressing.wear.fault import faces_at_fault, place_of
from toile.engine.cloth.origin import Origin


def square(name: str, height: float, panels: tuple[str, ...]) -> GarmentMesh:
    """Square of 1 m whose two faces are a panel each, both given at once as they are numbered in a file."""
    flat = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
    faces = np.array([(0, 1, 2), (1, 3, 2)], np.int32)
    positions = np.column_stack((flat[:, 0], np.full(4, height), flat[:, 1]))
    return GarmentMesh(
        name=name, positions=positions, uv=flat, faces=faces, panel=np.arange(2, dtype=np.int32),
        panel_names=panels, rest_corners=np.ascontiguousarray(flat[faces]),
        stitches=np.empty((0, 2), np.int32), seam=np.empty(0, np.int32), seam_names=(), minimum_angle=45.0,
        origin=Origin(
            weights=csr_array(eye_array(4)), face=np.array([7, 9], np.int32), first=np.array([0, 4], np.int32)
        ),
    )  # fmt: skip


def test_a_crossing_is_named_by_garment_panel_face_and_place() -> None:
    coat, shirt = square("coat", 0.0, ("front", "back")), square("shirt", 0.1, ("left", "right"))
    poked = shirt.positions.copy()
    poked[0, 1] = -0.1  # Only the left triangle of the shirt reaches through the front of the coat.
    meshes = [coat, replace(shirt, positions=poked)]
    cloth = assemble_cloth([(mesh, fabric("cotton-poplin")) for mesh in meshes], [])
    found = Auditor(None, None).audit(cloth.positions, cloth.face_nodes, cloth.weld)
    assert [faces.tolist() for faces in faces_at_fault(cloth, found)] == [[7], [7]]
    assert place_of(cloth, found, meshes) == (
        "garment coat: front, faces 7 of its file; garment shirt: left, faces 7 of its file; "
        "near (0.33, 0.02, 0.33) m"
    )
