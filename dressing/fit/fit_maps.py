"""Fit as maps: pressure, strain, shear, tension and ease at every vertex of garments and body."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from toile.dressing.fit.cloth_state import cloth_state
from toile.dressing.fit.regions import Regions, regions_of
from toile.dressing.fit.spread_out import spread_pressure, vertex_areas
from toile.dressing.fit.worn import Worn
from toile.engine.cloth.cloth import Cloth
from toile.engine.step.contact_loads import ContactLoads, contact_loads
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.closest_point import closest_points

PERCENT, MILLIMETRES = 100.0, 1000.0
QUANTITIES = {
    "pressure_Pa": "pressure on the body",
    "ease_mm": "gap to the body",
    "stretch_warp_percent": "strain along warp",
    "stretch_weft_percent": "strain along weft",
    "shear_percent": "tangent of the angle by which warp and weft have left the right one",
    "tension_N_m": "largest tension in any direction",
}
"""What maps show, by the names of their attributes in files: each ends with its unit."""
COVERED = 0.05
"""Gap up to which cloth covers the body [m]."""


@dataclass(frozen=True, kw_only=True)
class GarmentFit:
    """Maps of one garment.

    Attributes
    ----------
    positions
        Nodes in the body's frame [m], shape (n, 3).
    faces, vertex_faces
        Triangles into nodes, and into material vertices, shape (t, 3).
    node
        Node of every material vertex, shape (m,).
    start, uv
        Where material vertices started [m], shape (m, 3): the same points on any mesh; and their pattern
        coordinates [m], shape (m, 2).
    panel
        Panel of every face, shape (t,).
    area
        Area of every face as it is [m^2], shape (t,).
    at_vertices, at_faces
        Quantities by the names of QUANTITIES at material vertices, (m,): those of cloth are means of the
        faces around, since single faces of a coarse mesh are now too stiff, now too soft. At faces, (t,), the
        means of their corners.
    region
        Region of the body under every face, shape (t,): a number into the names of all.
    waist
        Nodes by which the garment sits on the waist, shape (k,).
    """

    positions: Float
    faces: Int
    vertex_faces: Int
    node: Int
    start: Float
    uv: Float
    panel: Int
    area: Float
    at_vertices: dict[str, Float]
    at_faces: dict[str, Float]
    region: Int
    waist: Int


@dataclass(frozen=True, kw_only=True)
class BodyFit:
    """Maps of the body: pressure [Pa] and ease [mm] at its vertices, (v,), forces on them [N], (v, 3).

    `press` are the normal forces, (v,); `area` are the areas of vertices [m^2], `covered` marks those that
    cloth covers; `ease_mm` is infinite elsewhere.
    """

    vertices: Float
    faces: Int
    pressure_Pa: Float
    ease_mm: Float
    press: Float
    force: Float
    area: Float
    region: Int

    @cached_property
    def covered(self) -> Bool:
        """Whether cloth covers a vertex, shape (v,)."""
        return np.isfinite(self.ease_mm)


@dataclass(frozen=True, kw_only=True)
class FitMaps:
    """How all garments of a scene fit.

    Attributes
    ----------
    garments, body
        Their maps.
    regions
        Names of the regions of the body.
    weight, carried
        Weight of all garments, and the part of it that the body bears [N]; of cloth at rest that stands on
        nothing else and hangs from no pins they are the same.
    """

    garments: tuple[GarmentFit, ...]
    body: BodyFit
    regions: tuple[str, ...]
    weight: float
    carried: float


def fit_maps(worn: Worn) -> FitMaps:
    """Return the maps of garments as they are worn."""
    cloth, body = worn.cloth, (worn.vertices, worn.faces)
    loads = contact_loads(cloth, body, worn.step, worn.anchors)
    height = float(worn.vertices[:, 1].min()), float(worn.vertices[:, 1].max())
    on_cloth = closest_points(cloth.positions, *body)
    centres = cloth.positions[cloth.face_nodes].mean(axis=1)
    under = closest_points(centres, *body).take(worn.vertices, worn.faces)
    regions = regions_of(np.concatenate([under, worn.vertices]), worn.measured, height)
    at_nodes = {
        "pressure_Pa": spread_pressure(loads.press_nodes, cloth.positions, cloth.face_nodes),
        "ease_mm": MILLIMETRES * on_cloth.distance,
    }
    at_faces = _face_quantities(cloth)
    face_region = regions.of[: len(cloth.faces)]
    return FitMaps(
        garments=tuple(
            _garment(cloth, index, at_nodes, at_faces, face_region) for index in range(len(worn.garments))
        ),
        body=_body(worn, loads, Regions(regions.names, regions.of[len(cloth.faces) :])),
        regions=regions.names,
        weight=float(cloth.mass.sum() * worn.step.gravity),
        carried=-float(loads.on_avatar[:, 1].sum()),
    )


def _face_quantities(cloth: Cloth) -> dict[str, Float]:
    """Return the quantities of cloth at faces, shape (t,)."""
    state = cloth_state(cloth)
    return {
        "stretch_warp_percent": PERCENT * state.strain[:, 0],
        "stretch_weft_percent": PERCENT * state.strain[:, 1],
        "shear_percent": PERCENT * state.shear,
        "tension_N_m": state.tension,
    }


def _garment(
    cloth: Cloth, index: int, at_nodes: dict[str, Float], at_faces: dict[str, Float], region: Int
) -> GarmentFit:
    """Return the maps of one garment, its nodes and material vertices numbered as in its files."""
    own = cloth.garment == index
    vertices, local = np.unique(cloth.faces[own], return_inverse=True)
    nodes, node = np.unique(cloth.node[vertices], return_inverse=True)
    vertex_faces, node = local.reshape(-1, 3).astype(np.int32), node.ravel().astype(np.int32)
    positions = cloth.positions[nodes]
    faces = node[vertex_faces]
    at_vertices = {name: values[nodes][node] for name, values in at_nodes.items()} | {
        name: _at_vertices(values[own], cloth.rest_area[own], vertex_faces, len(vertices))
        for name, values in at_faces.items()
    }
    waist = np.flatnonzero(np.isin(nodes, cloth.waist)).astype(np.int32)
    return GarmentFit(
        positions=positions, faces=faces.astype(np.int32), vertex_faces=vertex_faces,
        node=node.astype(np.int32),
        start=cloth.start_positions[vertices], uv=cloth.uv[vertices], panel=cloth.panel[own],
        area=0.5 * np.linalg.norm(np.cross(*_sides(positions[faces])), axis=1),
        at_vertices=at_vertices,
        at_faces={name: values[vertex_faces].mean(axis=1) for name, values in at_vertices.items()},
        region=region[own], waist=waist,
    )  # fmt: skip


def _sides(corners: Float) -> tuple[Float, Float]:
    """Return two sides of triangles, each shape (t, 3)."""
    return corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]


def _at_vertices(of_faces: Float, area: Float, faces: Int, count: int) -> Float:
    """Return the mean of the faces around every vertex, weighted by area, shape (count,)."""
    flat = faces.ravel()
    total = np.bincount(flat, np.repeat(area * of_faces, 3), count)
    return np.asarray(total / np.maximum(np.bincount(flat, np.repeat(area, 3), count), 1e-300))


def _body(worn: Worn, loads: ContactLoads, regions: Regions) -> BodyFit:
    """Return the maps of the body: forces of its vertices, which meet the cloth at places of their own."""
    cloth = worn.cloth
    away = closest_points(worn.vertices, cloth.positions, cloth.face_nodes).distance
    return BodyFit(
        vertices=worn.vertices, faces=worn.faces,
        pressure_Pa=spread_pressure(loads.press_avatar, worn.vertices, worn.faces),
        ease_mm=np.where(away <= COVERED, MILLIMETRES * away, np.inf),
        press=loads.press_avatar, force=loads.on_avatar, area=vertex_areas(worn.vertices, worn.faces),
        region=regions.of,
    )  # fmt: skip
