"""The files of a fit: fit.json, fit.png and meshes that carry its maps."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.files.palette import BODY, linear
from toile.dressing.files.writers.atomic import writable_folder, write_atomic
from toile.dressing.files.writers.field_mesh import FieldMesh, write_field_mesh
from toile.dressing.files.writers.glb import GlbMesh, glb_bytes
from toile.dressing.files.writers.ply import ply_bytes
from toile.dressing.fit.colour_scale import ColourScale
from toile.dressing.fit.fit_maps import FitMaps, GarmentFit, fit_maps
from toile.dressing.fit.fit_picture import LEAST, fit_png
from toile.dressing.fit.fit_tables import fit_tables
from toile.dressing.fit.read_fit import TABLES
from toile.dressing.fit.spread_of_meshes import body_spread, garment_spread, spread_tables
from toile.dressing.fit.worn import Worn
from toile.geometry.arrays import Float
from toile.geometry.normals import drawn_normals

PICTURE, FOLDER = "fit.png", "fit"
"""Names in the output folder of the picture and the folder of meshes."""
SPREAD_SUFFIX = "_spread"
"""End of the names of error bars."""


def write_fit(folder: Path, worn: Worn, stems: list[str], check: Worn | None = None) -> dict[str, Any]:
    """Write the files of a fit into a folder and return its tables.

    `stems` are the names of the garments' files. `check` are the same garments on another mesh: how far they
    are from the first is the error bar.
    """
    maps = fit_maps(worn)
    tables = fit_tables(worn, maps)
    on_body: dict[str, Float] = {}
    on_garments: list[dict[str, Float]] = [{} for _ in stems]
    if check is not None:
        others = fit_maps(check)
        spread = body_spread(maps, others)
        on_body = {f"pressure_Pa{SPREAD_SUFFIX}": spread}
        on_garments = [
            {f"{name}{SPREAD_SUFFIX}": values for name, values in garment_spread(one, other).items()}
            for one, other in zip(maps.garments, others.garments, strict=True)
        ]
        tables["spread"] = spread_tables(tables, fit_tables(check, others), spread)
    meshes = writable_folder(folder / FOLDER)
    _write_body(meshes, worn, maps, on_body)
    for stem, garment, spread_of in zip(stems, maps.garments, on_garments, strict=True):
        _write_garment(meshes, stem, worn, garment, garment.at_vertices | spread_of)
    _write_glb(meshes, worn, maps)
    write_atomic(folder / PICTURE, fit_png(maps))
    write_atomic(folder / TABLES, (json.dumps(tables, indent=1, allow_nan=False) + "\n").encode())
    return tables


def _write_body(folder: Path, worn: Worn, maps: FitMaps, more: dict[str, Float]) -> None:
    """Write the body with its maps; vertices without cloth have the ease -1."""
    body = maps.body
    fields = {
        "pressure_Pa": body.pressure_Pa,
        "ease_mm": np.where(body.covered, body.ease_mm, -1.0),
        "region": body.region.astype(np.float64),
        **more,
    }
    positions = worn.avatar.to_source(worn.place.outward(body.vertices))
    write_atomic(folder / "body.ply", ply_bytes(positions, body.faces, fields=fields))


def _write_garment(
    folder: Path, stem: str, worn: Worn, garment: GarmentFit, fields: dict[str, Float]
) -> None:
    """Write a garment as PLY, seams closed, and as VTU, with a point per material vertex."""
    positions = worn.avatar.to_source(worn.place.outward(garment.positions))
    count = np.maximum(np.bincount(garment.node, minlength=len(positions)), 1)
    at_nodes = {
        name: np.bincount(garment.node, values, len(positions)) / count for name, values in fields.items()
    }
    write_atomic(folder / f"{stem}.ply", ply_bytes(positions, garment.faces, fields=at_nodes))
    mesh = FieldMesh(
        positions=positions, faces=garment.faces, uv=garment.uv,
        uv_faces=garment.vertex_faces, panel=garment.panel, panel_names=(), strain=None, fields=fields,
    )  # fmt: skip
    write_field_mesh(folder / f"{stem}.vtu", mesh)


def _write_glb(folder: Path, worn: Worn, maps: FitMaps) -> None:
    """Write body and garments in metres, coloured by pressure, with all maps as attributes."""
    body, outward = maps.body, worn.place.outward
    scale = ColourScale.of(body.pressure_Pa[body.pressure_Pa > 1.0], LEAST["pressure"])

    def mesh(name: str, part: tuple[Float, Any, Any], fields: dict[str, Float], cloth: bool) -> GlbMesh:
        positions, faces, node = part
        place = outward(positions)
        return GlbMesh(
            name=name, positions=place[node], normals=drawn_normals(place, faces[0])[node], faces=faces[1],
            colour=linear(BODY), double_sided=cloth, fields=fields,
            vertex_colours=scale.linear_colours(fields["pressure_Pa"]),
        )  # fmt: skip

    every = np.arange(len(body.vertices))
    meshes = [
        mesh(
            "body", (body.vertices, (body.faces, body.faces), every), {"pressure_Pa": body.pressure_Pa}, False
        )
    ]
    for names, part in zip(worn.garments, maps.garments, strict=True):
        of = (part.positions, (part.faces, part.vertex_faces), part.node)
        meshes.append(mesh(names.name, of, part.at_vertices, True))
    write_atomic(folder / "fit.glb", glb_bytes(meshes))
