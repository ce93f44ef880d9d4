"""The result of a drape, and its files."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.place import Place
from toile.dressing.files.palette import BODY, garment_colour, linear
from toile.dressing.files.writers.atomic import writable_folder, write_atomic
from toile.dressing.files.writers.field_mesh import FORMATS, FieldMesh, checked_formats, write_field_mesh
from toile.dressing.files.writers.glb import GlbMesh, glb_bytes
from toile.dressing.files.writers.obj import obj_bytes
from toile.dressing.files.writers.ply import ply_bytes
from toile.dressing.files.writers.png import png_bytes
from toile.dressing.run.output.result_view import result_page, save_view
from toile.dressing.run.report import report_bytes
from toile.dressing.view.view_page import framed
from toile.dressing.wear.drape_types import DrapedGarment, Failure, Status
from toile.engine.cloth.fabric import Fabric
from toile.geometry.arrays import Float, Int
from toile.geometry.by_value import ByValue
from toile.geometry.normals import drawn_normals

if TYPE_CHECKING:
    from toile.dressing.garment.trims import Trims
    from toile.engine.cloth.origin import Origin


@dataclass(frozen=True, kw_only=True, eq=False)
class DressedGarment(ByValue):
    """One garment after the drape.

    Attributes
    ----------
    name
        Name of the garment and of its files.
    fabric
        What it is made of.
    positions
        Nodes [m], Y up, where the avatar's file has the body, shape (n, 3); sewn seams are one node.
    faces
        Triangles into positions, shape (t, 3).
    uv
        Pattern coordinates [m], shape (m, 2).
    uv_faces
        The same triangles into uv, shape (t, 3).
    panel
        Panel of every face, shape (t,).
    panel_names
        One name per panel.
    velocities
        Of nodes [m/s], shape (n, 3); None is at rest.
    origin
        Which corners and faces of the garment's file all this comes from, or None.
    strain
        Along warp and weft of every face, shape (t, 2), or None.
    trims
        Rigid pieces among its faces, as they start, or None.
    """

    name: str
    fabric: Fabric
    positions: Float
    faces: Int
    uv: Float
    uv_faces: Int
    panel: Int
    panel_names: tuple[str, ...]
    velocities: Float | None = None
    origin: "Origin | None" = None
    strain: Float | None = None
    trims: "Trims | None" = None

    def now(self, part: DrapedGarment, place: Place) -> "DressedGarment":
        """Return the garment in another shape, which is in the frame of a body in that place."""
        return replace(
            self, positions=place.outward(part.positions), faces=part.faces, uv=part.uv,
            uv_faces=part.faces_material, panel=part.panel, origin=part.origin, strain=part.strain,
            velocities=None if part.velocities is None else place.turned_out(part.velocities),
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Result(ByValue):
    """A finished drape: its status, the report as in report.json, the avatar and the garments.

    `failure` says why it failed, if it did.
    """

    status: Status
    report: dict[str, Any]
    avatar: Avatar
    garments: tuple[DressedGarment, ...]
    failure: Failure | None = None

    def save(self, folder: str | Path, formats: Sequence[str] = ()) -> list[Path]:
        """Write all output files into a folder, garments in a scene's `formats` too; return their paths."""
        folder = writable_folder(folder)
        shapes = save_shapes(folder, self.avatar, self.garments, checked_formats(formats))
        return [*shapes, save_report(folder, self.report), save_view(folder, self)]

    def _repr_html_(self) -> str:
        """Return a view to turn, as notebooks show it."""
        return framed(result_page(self))


Record = Callable[[int, tuple[DressedGarment, ...]], None]
"""Called with the number of a frame and the garments in it."""


def save_shapes(
    folder: Path, avatar: Avatar, garments: tuple[DressedGarment, ...], formats: Sequence[str] = ()
) -> list[Path]:
    """Write dressed.glb, preview.png and a PLY, an OBJ and more formats per garment; return their paths."""
    written = [write_atomic(folder / "dressed.glb", dressed_glb(avatar, garments))]
    for garment in garments:
        positions = avatar.to_source(garment.positions)
        stem = file_stem(garment.name)
        written.append(write_atomic(folder / f"{stem}.ply", ply_bytes(positions, garment.faces)))
        has_uv = bool(garment.uv.any())
        content = obj_bytes(
            positions,
            garment.faces,
            comment=f"{garment.name}: vt = pattern coordinates in metres, one group per panel",
            metres_per_unit=avatar.metres_per_unit,
            uv=garment.uv if has_uv else None,
            uv_faces=garment.uv_faces if has_uv else None,
            panel=garment.panel,
            panel_names=garment.panel_names,
        )
        written.append(write_atomic(folder / f"{stem}.obj", content))
        fields = FieldMesh(
            positions=positions, faces=garment.faces, uv=garment.uv if has_uv else None,
            uv_faces=garment.uv_faces, panel=garment.panel, panel_names=garment.panel_names,
            strain=garment.strain,
        )  # fmt: skip
        written += [
            write_field_mesh(folder / f"{stem}.{kind}", fields) for kind in formats if kind in FORMATS
        ]
    written.append(write_atomic(folder / "preview.png", dressed_png(avatar, garments)))
    return written


def save_report(folder: Path, report: dict[str, Any]) -> Path:
    """Write report.json and return its path."""
    return write_atomic(folder / "report.json", report_bytes(report))


def dressed_png(avatar: Avatar, garments: tuple[DressedGarment, ...]) -> bytes:
    """Return a PNG of the body in its garments, from its front."""
    from toile.dressing.pictures.preview import PreviewMesh, render

    place = Place.of(avatar)
    meshes = [PreviewMesh(positions=place.inward(avatar.vertices), faces=avatar.faces, colour=BODY)]
    meshes += [
        PreviewMesh(
            positions=place.inward(garment.positions),
            faces=garment.faces,
            colour=garment_colour(index),
            double_sided=True,
        )
        for index, garment in enumerate(garments)
    ]
    return png_bytes(render(meshes))


def dressed_glb(avatar: Avatar, garments: tuple[DressedGarment, ...]) -> bytes:
    """Return a GLB file of the body and the garments as named nodes, in metres."""
    body = GlbMesh(
        name="body",
        positions=avatar.vertices,
        normals=drawn_normals(avatar.vertices, avatar.faces),
        faces=avatar.faces,
        colour=linear(BODY),
    )
    meshes = [body]
    for index, garment in enumerate(garments):
        # One vertex per material vertex, with the normal of the node, so that seams look sewn.
        node = np.zeros(len(garment.uv), dtype=np.int32)
        node[garment.uv_faces] = garment.faces
        meshes.append(
            GlbMesh(
                name=garment.name,
                positions=garment.positions[node],
                normals=drawn_normals(garment.positions, garment.faces)[node],
                faces=garment.uv_faces,
                colour=linear(garment_colour(index)),
                uv=garment.uv,
                double_sided=True,
            )
        )
    return glb_bytes(meshes)


def file_stem(name: str) -> str:
    """Return a garment's name as a file name that every system accepts."""
    return re.sub(r"[^\w.-]+", "_", name).strip("._") or "garment"
