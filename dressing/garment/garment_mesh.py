"""A garment ready for the engine, made from a pattern, a built-in draft or a 3-D mesh."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from toile.dressing.pattern.roles import EdgeRole, PanelRole
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int
from toile.geometry.by_value import ByValue
from toile.geometry.given_arrays import floats, indices

if TYPE_CHECKING:
    # They need scipy, which is loaded when it is needed.
    from toile.dressing.garment.fields.layer import Layers
    from toile.dressing.garment.trims import Trims
    from toile.engine.cloth.fields.edge_runs import EdgeRun
    from toile.engine.cloth.fields.fastenings import Fastening
    from toile.engine.cloth.fields.fields import Fields
    from toile.engine.cloth.fields.gas import Gas
    from toile.engine.cloth.fields.timed_pins import RunHold
    from toile.engine.cloth.folds import Folds
    from toile.engine.cloth.origin import Origin


class Border(NamedTuple):
    """An edge of a panel, or a piece of one, on the mesh.

    Attributes
    ----------
    panel, edge
        Name of the panel and number of the edge in its pattern.
    start, end
        Where the piece starts and ends, as fractions of the edge's length.
    label, role
        Those of the edge.
    vertices
        Material vertices along it, shape (k + 1,).
    """

    panel: str
    edge: int
    start: float
    end: float
    label: str
    role: EdgeRole | None
    vertices: Int


@dataclass(frozen=True, kw_only=True, eq=False)
class GarmentMesh(ByValue):
    """Triangulated panels placed around the body, seams still open.

    Attributes
    ----------
    name
        Name of the garment, used for output files.
    positions
        Start position of every material vertex [m], shape (m, 3).
    uv
        Pattern coordinates of every material vertex [m], shape (m, 2): the panel's own x and y.
    faces
        Triangles, shape (t, 3), counter-clockwise seen from the right side of the fabric.
    panel
        Panel index of every face, shape (t,).
    panel_names
        One name per panel.
    panel_roles
        One role per panel, None where it is not known; empty if none is.
    rest_corners
        Rest shape of every face in its (warp, weft) frame [m], shape (t, 3, 2), counter-clockwise.
    stitches
        Pairs of material vertices to be sewn together, shape (s, 2).
    seam
        Seam index of every stitch pair, shape (s,): the stitch of the pattern it belongs to.
    seam_names
        One name per seam, such as "left_sleeve_f.0 - left_sleeve_b.5".
    held
        Edge label (such as "lower_interface") to the material vertices on edges that carry it.
    edges
        Role of edges to the material vertices on those that play it.
    flat
        True if the rest shape is flat fabric; False if it is the curved start shape itself.
    minimum_angle
        Smallest triangle angle [degrees].
    pinned
        Material vertices that no force moves, shape (k,), beside those that a scene pins.
    pull
        Stiffness per area with which material vertices are drawn to their places [N/m^3], shape (m,); None:
        not at all.
    origin
        Corners and faces of the file that material vertices and faces come from, or None.
    motion
        Where the file's corners go [m]: pinned and drawn vertices follow it where the avatar moves. None:
        they stay.
    trims
        Rigid pieces that ride along, or None.
    thickness
        Thickness of the cloth as the file shows it [m], whatever the fabric's is; None: it does not.
    panel_fabrics
        Fabric of panels that are of another than the garment, by their names.
    folds
        Part of every face between folds, numbered throughout the garment, and the folds, whose stiffness is
        NaN where it is to be the fabric's; None: no panel is folded.
    notes
        What was noticed in the file, one sentence each.
    borders
        Edges of a pattern's panels.
    attributes
        Numbers of the file at material vertices by their names, shape (m,) each.
    fields
        Values on regions of it, or None.
    elastic, holds
        Elastic along runs, and where a film holds it, as its only garment: each with the sides that it lies
        on, pairs of material vertices (k, 2); None of a whole panel. Lines are set where it is placed.
    gas
        Gas in it.
    fastenings
        Points that are fastened to each other, as of its only garment.
    layers
        Layers of its faces beneath their fabric, or None.

    Raises InputError if an array is of a wrong shape, not finite, or names what does not exist.
    """

    name: str
    positions: Float
    uv: Float
    faces: Int
    panel: Int
    panel_names: tuple[str, ...]
    panel_roles: tuple[PanelRole | None, ...] = ()
    rest_corners: Float
    stitches: Int
    seam: Int
    seam_names: tuple[str, ...]
    held: dict[str, Int] = field(default_factory=dict)
    edges: dict[EdgeRole, Int] = field(default_factory=dict)
    flat: bool = True
    minimum_angle: float
    pinned: Int = field(default_factory=lambda: np.empty(0, np.int32))
    pull: Float | None = None
    origin: "Origin | None" = None
    motion: VertexMotion | None = None
    trims: "Trims | None" = None
    thickness: float | None = None
    panel_fabrics: Mapping[str, Fabric] = field(default_factory=dict)
    folds: "Folds | None" = None
    notes: tuple[str, ...] = ()
    borders: tuple[Border, ...] = ()
    attributes: Mapping[str, Float] = field(default_factory=dict)
    fields: "Fields | None" = None
    elastic: "tuple[tuple[EdgeRun, Int], ...]" = ()
    holds: "tuple[tuple[RunHold, Int | None], ...]" = ()
    gas: "tuple[Gas, ...]" = ()
    fastenings: "tuple[Fastening, ...]" = ()
    layers: "Layers | None" = None

    def __post_init__(self) -> None:
        """Take arrays of any numeric type, checked."""
        name = f"garment '{self.name}'"

        def floating(entry: str, *shape: int | None) -> Float:
            return floats(getattr(self, entry), f"{name}: {entry}", shape, entry)

        def naming(entry: str, count: int, *shape: int | None) -> Int:
            return indices(getattr(self, entry), f"{name}: {entry}", shape, count, entry)

        positions = floating("positions", None, 3)
        corners = len(positions)
        faces = naming("faces", corners, None, 3)
        stitches = naming("stitches", corners, None, 2)
        checked = {
            "positions": positions,
            "faces": faces,
            "uv": floating("uv", corners, 2),
            "panel": naming("panel", len(self.panel_names), len(faces)),
            "rest_corners": floating("rest_corners", len(faces), 3, 2),
            "stitches": stitches,
            "seam": naming("seam", len(self.seam_names), len(stitches)),
            "pinned": naming("pinned", corners, None),
        }
        if self.pull is not None:
            checked["pull"] = floating("pull", corners)
        for entry, array in checked.items():
            object.__setattr__(self, entry, array)
