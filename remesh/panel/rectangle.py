"""A triangulated rectangle, the panel that most experiments begin with."""

import numpy as np

from toile.geometry.arrays import Float, Int
from toile.remesh.panel.panel_mesh import triangulate_panel


def rectangle(width: float, height: float, edge: float) -> tuple[Float, Int]:
    """Mesh a rectangle, one corner at the origin: points [m], shape (n, 2), and faces, shape (t, 3).

    Edges of triangles are about `edge` [m] long.
    """
    across, up = round(width / edge), round(height / edge)
    x, y = np.linspace(0.0, width, across + 1), np.linspace(0.0, height, up + 1)
    border = np.concatenate(
        (
            np.column_stack((x[:-1], np.zeros(across))),
            np.column_stack((np.full(up, width), y[:-1])),
            np.column_stack((x[:0:-1], np.full(across, height))),
            np.column_stack((np.zeros(up), y[:0:-1])),
        )
    )
    mesh = triangulate_panel(border, edge_length=edge)
    return mesh.vertices, mesh.faces
