"""The state of all cloth in a scene as arrays, with nodes apart from material vertices.

A node moves; a material vertex lies in a panel. Where panels are sewn, one node has several material
vertices (the distinction of Narain, Samii and O'Brien 2012).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, diags_array

from toile.engine.cloth.creases import Creases
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fields.edge_runs import EdgeRun
from toile.engine.cloth.fields.fastenings import Fastening
from toile.engine.cloth.fields.fields import Fields
from toile.engine.cloth.fields.gas import Gas
from toile.engine.cloth.fields.timed_pins import RunHold, TimedPins
from toile.engine.cloth.folds import Folds
from toile.engine.cloth.goals import Goals
from toile.engine.cloth.origin import Origin
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected

RESTS = ("rest_warp", "rest_weft")
"""Quantities by which the rest shape is scaled."""


@dataclass(frozen=True, kw_only=True)
class Cloth:
    """Cloth of one scene, all garments together.

    Attributes
    ----------
    positions
        Node positions [m], shape (n, 3).
    velocities
        Node velocities [m/s], shape (n, 3).
    node
        Node of every material vertex, shape (m,).
    faces
        Material vertices of every face, shape (t, 3).
    rest_corners
        Rest shape of every face, (warp, weft) [m], shape (t, 3, 2).
    fabrics
        The fabrics in use.
    fabric
        Index into `fabrics` of every face, shape (t,).
    garment
        Garment index of every face, shape (t,).
    panel
        Panel of every face, counted within its garment, shape (t,).
    uv
        Pattern coordinates of every material vertex [m], shape (m, 2).
    stitches
        Node pairs still to be sewn, shape (s, 2).
    seam
        Seam index of every remaining stitch, shape (s,).
    stitch_length
        Length of every remaining stitch when sewing began [m], shape (s,).
    held
        Nodes kept at their height while seams close, shape (k,).
    waist
        Nodes kept at their start height until friction can hold the garment, shape (k,).
    pinned
        Nodes that no force moves, shape (n,).
    handles
        How pinned nodes, and goals of others, follow points that move: weight of every point in every such
        node, sparse (n, p); rows without entries, and all nodes where this is None, stay where they are.
    rest_curved
        Whether the face's rest shape is its curved start shape, shape (t,).
    start_positions
        Start position of every material vertex [m], shape (m, 3): the rest shape of curved faces.
    goals
        Where nodes that are not pinned are drawn to, or None.
    origin
        Which corners and faces of the garments' files all this was made of; None where nobody asks.
    folds
        Lines along which panels are folded at rest, or None.
    creases
        Curvature that its faces keep, or None.
    fields
        Values on regions that differ from their fabric's, or None.
    elastic
        Runs of edges with elastic along them.
    holds
        Where a film will hold it.
    timed_pins
        Pins of a film that come and go.
    gas
        Gas in closed garments.
    fastenings
        Points that are fastened to each other.
    now
        Time of the film at which keyed values count, until a step says another [s].
    """

    positions: Float
    velocities: Float
    node: Int
    faces: Int
    rest_corners: Float
    fabrics: tuple[Fabric, ...]
    fabric: Int
    garment: Int
    panel: Int
    uv: Float
    stitches: Int
    seam: Int
    stitch_length: Float
    held: Int
    waist: Int
    pinned: Bool
    rest_curved: Bool
    start_positions: Float
    goals: Goals | None = None
    handles: csr_array | None = None
    origin: Origin | None = None
    folds: Folds | None = None
    creases: Creases | None = None
    fields: Fields | None = None
    elastic: tuple[EdgeRun, ...] = ()
    holds: tuple[RunHold, ...] = ()
    timed_pins: tuple[TimedPins, ...] = ()
    gas: tuple[Gas, ...] = ()
    fastenings: tuple[Fastening, ...] = ()
    now: float = 0.0

    def per_face(self, name: str) -> Float:
        """Return a quantity of the fabric on every face, shape (t,), as fields have it now."""
        values = np.array([getattr(fabric, name) for fabric in self.fabrics])[self.fabric]
        return values if self.fields is None else self.fields.over(name, values, self.now)

    @property
    def is_curved(self) -> Bool:
        """Whether a material vertex has its start shape for a rest shape, shape (m,)."""
        curved = np.zeros(len(self.uv), bool)
        curved[self.faces[self.rest_curved].ravel()] = True
        return curved

    @property
    def rest_space(self) -> Float:
        """Material vertices in rest space [m], shape (m, 3): of a pattern (u, v, 0), or the start shape."""
        return np.where(self.is_curved[:, None], self.start_positions, np.pad(self.uv, ((0, 0), (0, 1))))

    def rest_scale(self, seconds: float) -> Float | None:
        """Scale of the rest shape along warp and weft on every face, shape (t, 2); None if it is 1.

        It is that at a time of the film [s], and acts once all seams are closed: panels are sewn as cut.
        """
        if self.fields is None or len(self.stitches) or not self.fields.names() & {*RESTS}:
            return None
        ones = np.ones(len(self.faces))
        return np.stack([self.fields.over(name, ones, seconds) for name in RESTS], axis=1)

    @property
    def natural_corners(self) -> Float:
        """Corners of faces without any force on them, in (warp, weft) [m], shape (t, 3, 2)."""
        scale = self.rest_scale(self.now)
        return self.rest_corners if scale is None else self.rest_corners * scale[:, None]

    @property
    def face_nodes(self) -> Int:
        """Nodes of every face, shape (t, 3)."""
        return np.ascontiguousarray(self.node[self.faces])

    @property
    def rest_area(self) -> Float:
        """Rest area of every face [m^2], shape (t,)."""
        u = self.rest_corners[:, 1] - self.rest_corners[:, 0]
        v = self.rest_corners[:, 2] - self.rest_corners[:, 0]
        return np.asarray(0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))

    def lumped(self, per_face: Float) -> Float:
        """Give a third of every face's value to each of its nodes, shape (n,)."""
        shares = np.repeat(per_face / 3.0, 3)
        count = len(self.positions)
        return np.asarray(np.bincount(self.face_nodes.ravel(), weights=shares, minlength=count), np.float64)

    @property
    def node_area(self) -> Float:
        """Rest area per node [m^2], shape (n,)."""
        return self.lumped(self.rest_area)

    @property
    def mass(self) -> Float:
        """Mass per node [kg], shape (n,): rest area times areal density, lumped."""
        return self.lumped(self.rest_area * self.per_face("areal_density"))

    @property
    def shortest_edge(self) -> Float:
        """Shortest rest edge at every node [m], shape (n,)."""
        shortest = np.full(len(self.positions), np.inf)
        faces, corners = self.face_nodes, self.natural_corners
        for k in range(3):
            edge = np.linalg.norm(corners[:, k] - corners[:, (k + 1) % 3], axis=1)
            np.minimum.at(shortest, faces[:, k], edge)
            np.minimum.at(shortest, faces[:, (k + 1) % 3], edge)
        return shortest

    @property
    def weld(self) -> Int:
        """Number of the future node of every node: stitched nodes share it, shape (n,)."""
        count = len(self.positions)
        if not len(self.stitches):
            return np.arange(count, dtype=np.int32)
        return connected(self.stitches, count)

    def led(self) -> "Cloth":
        """Return the cloth with a handle for every pin, in their order: see `handles`."""
        pins = np.flatnonzero(self.pinned)
        entries = (np.ones(len(pins)), (pins, np.arange(len(pins))))
        return replace(self, handles=csr_array(entries, shape=(len(self.positions), len(pins))))

    def merged(self, closed: Bool) -> "Cloth":
        """Merge the two nodes of every stitch marked in `closed`, shape (s,), at their current mean place.

        Momentum is kept; a node merged from several has their mass-weighted mean position and velocity.
        """
        count = len(self.positions)
        label = connected(self.stitches[closed], count)
        new_count = int(label.max(initial=-1)) + 1
        mass = self.mass
        total = np.bincount(label, weights=mass, minlength=new_count)

        def mean(values: Float) -> Float:
            sums = [np.bincount(label, weights=mass * values[:, k], minlength=new_count) for k in range(3)]
            return np.ascontiguousarray(np.stack(sums, axis=1) / total[:, None])

        rest = label[self.stitches[~closed]].astype(np.int32)
        open_ = rest[:, 0] != rest[:, 1]
        pinned = np.zeros(new_count, bool)
        pinned[label[self.pinned]] = True
        handles = self.handles
        if handles is not None:
            # A pin sewn to others takes them all to where the first one goes.
            own = np.flatnonzero(self.pinned)
            to, first = np.unique(label[own], return_index=True)
            led = csr_array((np.ones(len(to)), (to, own[first])), shape=(new_count, count))
            if self.goals is not None:
                led = led + diags_array((~pinned).astype(np.float64)) @ self.goals.mean(label, self.node_area)
            handles = csr_array(led @ handles)
        return replace(
            self,
            positions=mean(self.positions),
            velocities=mean(self.velocities),
            node=label[self.node].astype(np.int32),
            stitches=np.ascontiguousarray(rest[open_]),
            seam=self.seam[~closed][open_],
            stitch_length=self.stitch_length[~closed][open_],
            held=np.unique(label[self.held]).astype(np.int32),
            waist=np.unique(label[self.waist]).astype(np.int32),
            pinned=pinned,
            goals=None if self.goals is None else self.goals.merged(label, self.node_area),
            handles=handles,
        )
