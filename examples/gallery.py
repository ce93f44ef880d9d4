"""Draws the pictures of docs/examples.md: python -m examples.gallery [FOLDER] [NAME...]."""

import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import trimesh

import toile
from toile.dressing.files.palette import BODY, garment_colour
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.files.writers.ply import read_own_ply
from toile.dressing.files.writers.png import png_bytes
from toile.dressing.pictures.preview import PreviewMesh, render_front
from toile.engine.cloth.cloth import Cloth
from toile.geometry.arrays import Float
from toile.studies.validation.cusick import DISC

PICTURES = Path(__file__).resolve().parents[1] / "docs" / "images" / "examples"
APART = 1.1
"""Distance of figures side by side [m]."""
MARGIN = 22
"""Around what a picture shows [pixels]."""
Meshes = list[PreviewMesh]
NOWHERE = (0.0, 0.0, 0.0)


def dressed(result: toile.Result, colour: int = 0, shift: Sequence[float] = NOWHERE) -> Meshes:
    """Return a body, drawn as one, and its garments."""
    meshes = [PreviewMesh(result.avatar.vertices + shift, result.avatar.faces, BODY)]
    for index, garment in enumerate(result.garments):
        meshes.append(cloth_mesh(garment.positions + shift, garment.faces, colour + index))
    return meshes


def cloth_mesh(positions: Float, faces: Any, colour: int) -> PreviewMesh:
    """Return cloth, of a colour of the palette."""
    return PreviewMesh(positions, np.asarray(faces, np.int32), garment_colour(colour), double_sided=True)


def side_by_side(results: Sequence[toile.Result], colour: int) -> Meshes:
    """Return several figures, from left to right."""
    row = ((index - 0.5 * (len(results) - 1)) * APART for index in range(len(results)))
    return [
        mesh for result, x in zip(results, row, strict=True) for mesh in dressed(result, colour, (x, 0, 0))
    ]


def on_sphere(frames: Sequence[Any]) -> Meshes:
    """Return the last frame of the sheet, and the sphere."""
    cloth: Cloth = frames[-1].cloth
    ball: tuple[Float, Any] = import_module("examples.sheet_on_sphere").ball()
    return [cloth_mesh(cloth.positions, cloth.face_nodes, 2), PreviewMesh(*ball, BODY)]


def drawn_out(cloth: Cloth) -> Meshes:
    """Return the curtain and the magnet."""
    magnet = trimesh.creation.icosphere(subdivisions=3, radius=0.02)
    centre = import_module("examples.own_force").PLACE + np.array([0.0, 0.0, 0.03])
    ball = PreviewMesh(np.asarray(magnet.vertices) + centre, np.asarray(magnet.faces, np.int32), BODY)
    return [cloth_mesh(cloth.positions, cloth.face_nodes, 4), ball]


def on_discs(cloths: dict[str, Cloth]) -> Meshes:
    """Return the cloths on their stands."""
    meshes = []
    for index, cloth in enumerate(cloths.values()):
        shift = np.array([0.34 * index, 0.0, 0.0])
        meshes.append(cloth_mesh(cloth.positions + shift, cloth.face_nodes, index))
        for radius, low, high in ((DISC, -0.003, -5e-4), (DISC, 5e-4, 0.003), (0.03, -0.14, -5e-4)):
            part = trimesh.creation.cylinder(radius=radius - 5e-4, height=high - low, sections=96)
            upright = np.asarray(part.vertices)[:, [0, 2, 1]] * (1.0, 1.0, -1.0) + (
                0.0,
                0.5 * (low + high),
                0.0,
            )
            meshes.append(PreviewMesh(upright + shift, np.asarray(part.faces, np.int32), BODY))
    return meshes


def moments(frames: Path, garment: str, numbers: Sequence[int]) -> Meshes:
    """Return some frames of a film, side by side."""
    meshes = []
    for place, number in enumerate(numbers):
        for name in ("body", garment):
            mesh = read_own_ply(frames / f"{name}.{number:04d}.ply")
            shifted = mesh.positions + np.array([place * 1.05, 0.0, 0.0])
            body = PreviewMesh(shifted, mesh.faces, BODY)
            meshes.append(body if name == "body" else cloth_mesh(shifted, mesh.faces, 1))
    return meshes


def of_batch(results: Sequence[toile.JobResult]) -> Meshes:
    """Return what the jobs wrote, side by side, in the order of their names."""
    meshes = []
    for index, result in enumerate(sorted(results, key=lambda one: one.name)):
        assert result.folder is not None
        for name, part in trimesh.load(result.folder / "dressed.glb").geometry.items():
            positions = np.asarray(part.vertices) + np.array([index * APART, 0.0, 0.0])
            body = PreviewMesh(positions, np.asarray(part.faces, np.int32), BODY)
            meshes.append(body if name == "body" else cloth_mesh(positions, part.faces, 3))
    return meshes


def in_blender(shirt: tuple[Float, Any]) -> Meshes:
    """Return the shirt as Blender shows it, Y up again, on the mannequin."""
    body = toile.mannequin()
    upright = shirt[0][:, [0, 2, 1]] * (1.0, 1.0, -1.0)
    return [PreviewMesh(body.vertices, body.faces, BODY), cloth_mesh(upright, shirt[1], 0)]


def strained(result: toile.Result) -> Meshes:
    """Return the shirt in bands of strain along the weft, from blue (shorter) over white to red (longer)."""
    (shirt,) = result.garments
    strain = import_module("examples.results_in_numpy").strain(shirt)[:, 1]
    share = np.clip(0.5 + strain / 0.02, 0.0, 0.999)
    meshes = dressed(result)[:1]
    for band in range(9):
        own = np.int32(9 * share) == band
        warm, cold = max(0.0, band / 4 - 1), max(0.0, 1 - band / 4)
        colour = (
            0.92 - 0.55 * cold - 0.12 * warm,
            0.90 - 0.38 * cold - 0.50 * warm,
            0.86 - 0.22 * cold - 0.55 * warm,
        )
        meshes.append(PreviewMesh(shirt.positions, shirt.faces[own], colour, double_sided=True))
    return meshes


DRAWN: dict[str, Callable[[Any, Path], Meshes]] = {
    "sheet_on_sphere": lambda frames, _: on_sphere(frames),
    "own_force": lambda film, _: drawn_out(film.cloth),
    "compare_fabrics": lambda cloths, _: on_discs(cloths),
    "own_fabric": lambda results, _: side_by_side(results, 4),
    "made_to_measure": lambda results, _: side_by_side(results, 0),
    "moving_body": lambda _, folder: moments(folder / "frames", "circle_skirt", (0, 5, 10)),
    "batch": lambda results, _: of_batch(results),
    "results_in_numpy": lambda result, _: strained(result),
    "dress_mannequin": lambda result, _: dressed(result, 0),
    "own_pattern": lambda result, _: dressed(result, 4),
    "own_draft": lambda result, _: dressed(result, 5),
    "gathered_skirt": lambda result, _: dressed(result, 1),
    "pleated_skirt": lambda result, _: dressed(result, 1),
    "own_garment_reader": lambda result, _: dressed(result, 2),
    "layers": lambda result, _: dressed(result, 5),
    "scene_file": lambda result, _: dressed(result, 3),
    "blender_scene": lambda shirt, _: in_blender(shirt),
}
"""Example to what is drawn of what its `main` returns and of the folder that it has written."""
VIEWS = {"sheet_on_sphere": (25.0, 0.0), "own_force": (-40.0, 0.0), "compare_fabrics": (0.0, 20.0)}
"""How far a scene is turned about the vertical, then tilted to the eye [degrees]; dressed bodies by 18, 0."""
HEIGHTS = {
    "sheet_on_sphere": 450, "own_force": 520, "moving_body": 700, "own_fabric": 740, "layers": 740,
    "batch": 620, "made_to_measure": 620,
}  # fmt: skip
"""Of a picture before it is cut [pixels]; of others 800."""
WHOLE = {"batch", "made_to_measure"}
"""Pictures that show bodies from head to toe; others are cut to what is cloth."""


def picture(meshes: Meshes, name: str) -> Any:
    """Return the picture of an example, shape (rows, columns, 3)."""
    turn, tilt = np.radians(VIEWS.get(name, (18.0, 0.0)))
    cosine, sine = np.cos(turn), np.sin(turn)
    about = np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])
    cosine, sine = np.cos(tilt), np.sin(tilt)
    about = about @ np.array([[1.0, 0.0, 0.0], [0.0, cosine, sine], [0.0, -sine, cosine]])
    turned = [mesh._replace(positions=mesh.positions @ about) for mesh in meshes]
    pixels, project = render_front(turned, HEIGHTS.get(name, 800))
    shown = [mesh for mesh in turned if mesh.double_sided or name in WHOLE]
    seen = np.concatenate([project(mesh.positions[np.unique(mesh.faces)]) for mesh in shown])
    (left, top), (right, bottom) = seen.min(axis=0) - MARGIN, seen.max(axis=0) + MARGIN
    rows, columns = slice(max(int(top), 0), int(bottom)), slice(max(int(left), 0), int(right))
    return np.ascontiguousarray(pixels[rows, columns])


def main(pictures: str | Path = PICTURES, names: Sequence[str] = ()) -> None:
    """Run the examples, all or some, and write their pictures; that of Blender only where it is installed."""
    for name in names or DRAWN:
        if name == "blender_scene" and find_spec("bpy") is None:
            print("blender_scene: Blender is not here (pip install bpy); its picture stays as it is")
            continue
        with TemporaryDirectory() as folder:
            returned = import_module(f"examples.{name}").main(folder)
            pixels = picture(DRAWN[name](returned, Path(folder)), name)
        Path(pictures).mkdir(parents=True, exist_ok=True)
        write_atomic(Path(pictures) / f"{name}.png", png_bytes(pixels))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else PICTURES, sys.argv[2:])
