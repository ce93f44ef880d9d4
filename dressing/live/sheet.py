"""A square of cloth to play with, and the things around it."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import trimesh

from toile.dressing.garment.fabrics import DEFAULT_FABRIC, fabric
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.live.obstacles import Surface
from toile.geometry.arrays import Bool, Float
from toile.geometry.errors import InputError
from toile.remesh.panel.grid import grid_mesh

FEWEST, MOST = 2, 100
"""Cells along a side."""
PINS = ("none", "corners", "one edge", "two edges", "four edges")
OBJECTS = ("none", "ball", "table")
BALL = 0.2
"""Radius of the ball [m]."""
TABLE = (0.4, 0.16, 0.4)
"""Sides of the table's top [m]."""
ABOVE, ARC = 0.06, 0.55
"""Height of the cloth above what lies under it [m]; half the turn of cloth with slack [rad]: 5 % of it."""

Pins = Literal["none", "corners", "one edge", "two edges", "four edges"]
Object = Literal["none", "ball", "table"]


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """A square of cloth, level at first, above a ball or a table whose middle is the origin.

    Attributes
    ----------
    cells
        Cells along a side, 2 to 100.
    side
        Length of a side [m].
    fabric
        Preset name.
    grain
        Angle of the warp against the side [degrees]: 45 is cut on the bias.
    pins
        "none", "corners", "one edge", "two edges" or "four edges".
    object
        "none", "ball" or "table".

    Raises InputError naming the field that is at fault.
    """

    cells: int = 50
    side: float = 1.0
    fabric: str = DEFAULT_FABRIC
    grain: float = 0.0
    pins: Pins = "corners"
    object: Object = "ball"

    def __post_init__(self) -> None:
        """Check every field."""
        if (
            isinstance(self.cells, bool)
            or not isinstance(self.cells, int)
            or not FEWEST <= self.cells <= MOST
        ):
            raise InputError(
                f"cells must be a whole number from {FEWEST} to {MOST}, got {self.cells!r}", field="cells"
            )
        if not isinstance(self.side, int | float) or not 0.05 <= self.side <= 5.0:
            raise InputError(f"side must lie between 0.05 and 5 m, got {self.side!r}", field="side")
        if self.pins not in PINS:
            raise InputError(f"pins must be one of {', '.join(PINS)}, got {self.pins!r}", field="pins")
        if self.object not in OBJECTS:
            raise InputError(
                f"object must be one of {', '.join(OBJECTS)}, got {self.object!r}", field="object"
            )
        fabric(self.fabric)

    def cloth(self) -> Cloth:
        """Return the cloth where it starts."""
        grid = grid_mesh(self.side, self.side, self.cells, self.cells)
        turn = np.radians(self.grain)
        flat = grid.points @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        middle = grid.points - 0.5 * self.side
        height = {"none": 0.0, "ball": BALL, "table": 0.5 * TABLE[1]}[self.object] + ABOVE
        positions = np.column_stack([middle[:, 0], np.full(len(middle), height), -middle[:, 1]])
        pinned = self._pinned(middle)
        if pinned.any() and self.pins != "one edge":
            # With slack it hangs.
            positions = self._slack(positions)
        return flat_cloth(flat, grid.faces, positions, fabric(self.fabric), pinned)

    def obstacles(self) -> dict[str, Surface]:
        """Return what the cloth meets."""
        return {} if self.object == "none" else {self.object: surface_of(self.object)}

    def _pinned(self, middle: Float) -> Bool:
        """Mark pinned nodes at places from the middle [m], shape (n, 2)."""
        edge = np.abs(middle) > 0.5 * self.side - 1e-9
        if self.pins == "corners":
            return np.asarray(edge.all(axis=1))
        if self.pins == "four edges":
            return np.asarray(edge.any(axis=1))
        if self.pins == "two edges":
            return edge[:, 0]
        if self.pins == "one edge":
            return edge[:, 0] & (middle[:, 0] < 0.0)
        return np.zeros(len(middle), bool)

    def _slack(self, positions: Float) -> Float:
        """Return places [m], shape (n, 3), on an arc as long as the level sheet [m], shape (n, 3)."""
        bent = positions.copy()
        radius = 0.5 * self.side / ARC
        turn = positions[:, 0] / radius
        bent[:, 0] = radius * np.sin(turn)
        bent[:, 1] += radius * (np.cos(turn) - np.cos(ARC))
        return bent


def surface_of(name: str) -> Surface:
    """Return a ball or a table about the origin, closed: vertices [m], shape (v, 3), and faces, (t, 3)."""
    if name == "ball":
        mesh = trimesh.creation.icosphere(subdivisions=3, radius=BALL)
    else:
        mesh = trimesh.creation.box(extents=TABLE)
        for _ in range(3):
            mesh = mesh.subdivide()
    return np.ascontiguousarray(mesh.vertices, np.float64), np.ascontiguousarray(mesh.faces, np.int32)
