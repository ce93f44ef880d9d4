"""Wavefront OBJ: one `v` per node, one `vt` per material vertex, one group per panel."""

import math
from collections.abc import Sequence

import numpy as np

from toile.geometry.arrays import Float, Int


def obj_bytes(
    positions: Float,
    faces: Int,
    *,
    comment: str = "",
    metres_per_unit: float = 1.0,
    uv: Float | None = None,
    uv_faces: Int | None = None,
    panel: Int | None = None,
    panel_names: Sequence[str] = (),
) -> bytes:
    """Return an OBJ file.

    Parameters
    ----------
    positions
        Nodes in the file's units, shape (n, 3).
    faces
        Triangles into positions, shape (t, 3).
    comment
        One line for the top of the file.
    metres_per_unit
        Length of one file unit [m]: digits are kept down to 0.1 micrometres.
    uv
        Pattern coordinates [m], shape (m, 2), or None.
    uv_faces
        The same triangles into uv, shape (t, 3).
    panel, panel_names
        Panel of every face, shape (t,), and the panels' names.
    """
    digits = max(0, math.ceil(7.0 + math.log10(metres_per_unit)))
    row = f"v %.{digits}f %.{digits}f %.{digits}f\n"
    lines = [f"# {comment}\n"] if comment else []
    lines.append((row * len(positions)) % tuple((np.asarray(positions) + 0.0).ravel().tolist()))
    if uv is not None:
        lines.append(("vt %.7f %.7f\n" * len(uv)) % tuple((uv + 0.0).ravel().tolist()))
    if uv is not None and uv_faces is not None:
        corners, face_row = np.stack([faces, uv_faces], axis=-1), "f %d/%d %d/%d %d/%d\n"
    else:
        corners, face_row = faces, "f %d %d %d\n"
    owner = np.zeros(len(faces), dtype=np.int32) if panel is None else panel
    for number in np.unique(owner).tolist():
        if number < len(panel_names):
            lines.append(f"g {_group(panel_names[number])}\n")
        chosen = corners[owner == number].astype(np.int64) + 1
        lines.append((face_row * len(chosen)) % tuple(chosen.ravel().tolist()))
    return "".join(lines).encode()


def _group(name: str) -> str:
    """Return the name of a panel as one word that can be printed."""
    words = "".join(sign if sign.isprintable() else " " for sign in name).split()
    return "_".join(words) or "panel"
