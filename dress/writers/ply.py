"""Binary PLY: nodes and triangles."""

import numpy as np

from toile.geometry.arrays import Float, Int


def ply_bytes(positions: Float, faces: Int) -> bytes:
    """Return a binary little-endian PLY file; float64 keeps gaps that float32 would round away."""
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(positions)}\n"
        "property double x\nproperty double y\nproperty double z\n"
        f"element face {len(faces)}\n"
        "property list uchar int vertex_indices\n"
        "end_header\n"
    )
    rows = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", (3,))])
    rows["count"] = 3
    rows["corners"] = faces
    return header.encode() + np.ascontiguousarray(positions, dtype="<f8").tobytes() + rows.tobytes()
