"""The scene `swing`: a level square of 1 m, pinned along one edge, swings for a second without contact."""

import numpy as np

from toile.dressing.garment.fabrics import fabric
from toile.engine.cloth.cloth import Cloth
from toile.geometry.arrays import Float
from toile.remesh.panel.grid import grid_mesh
from toile.studies.scenes.scenes import sheet

SECONDS = 1.0


def swing(cells: int) -> Cloth:
    """Return the cloth of cotton poplin on a grid of cells x cells, pinned along x = 0."""
    grid = grid_mesh(1.0, 1.0, cells, cells)
    positions = np.column_stack((grid.points[:, 0], np.zeros(len(grid.points)), -grid.points[:, 1]))
    return sheet(grid.points, grid.faces, positions, grid.points[:, 0] < 1e-9, fabric("cotton-poplin"))


def rms_distance(a: Float, b: Float) -> float:
    """Root of the mean squared distance of nodes [m], shapes (n, 3)."""
    return float(np.sqrt(((a - b) ** 2).sum(axis=1).mean()))
