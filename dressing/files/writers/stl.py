"""Binary STL: triangles without shared vertices."""

import numpy as np

from toile.geometry.arrays import Float, Int
from toile.geometry.normals import area_normals


def stl_bytes(positions: Float, faces: Int) -> bytes:
    """Return a binary STL file with unit normals."""
    corners = positions[faces]
    normals = area_normals(corners)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    rows = np.zeros(
        len(faces), dtype=[("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
    )
    rows["normal"] = normals / np.where(length > 0.0, length, 1.0)
    rows["corners"] = corners
    return b"toile".ljust(80, b" ") + np.uint32(len(faces)).tobytes() + rows.tobytes()
