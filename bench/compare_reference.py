"""Dress the two reference patterns and compare the drapes with those of another solver.

python bench/compare_reference.py DATA OUT [--pictures docs/images]

DATA/reference holds tee_sim.obj, skirt_sim.obj, their patterns and body. OUT gets one folder per drape of
ours, with and without friction against the body; folders that are there already are not computed again.
Prints a Markdown table; with --pictures writes reference_tee.png and reference_skirt.png (needs Pillow).
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import trimesh
from scipy.spatial import cKDTree

import toile
from toile.collide.audit import Auditor
from toile.dressing.files.palette import BODY, garment_colour
from toile.dressing.pictures.preview import PreviewMesh, render
from toile.dressing.pictures.rasterizer import rasterize

SAMPLES = 1_500_000
PIXEL = 0.001
"""Pixel of the silhouettes [m]."""
NAMES = ("tee", "skirt")
PICTURE_HEIGHT = 470
"""Height of the pictures below their labels [pixels]."""
THEIRS, OURS, BOTH, OUTLINE = (214, 96, 60), (46, 98, 170), (205, 205, 208), (232, 226, 220)
"""Colours of the silhouettes: only in theirs, only in ours, in both, the body."""


def strains(positions: np.ndarray, faces: np.ndarray, uv: np.ndarray, uv_faces: np.ndarray) -> np.ndarray:
    """Edge strain of every face's sides, shape (3 t,)."""
    three = [positions[faces[:, k]] - positions[faces[:, (k + 1) % 3]] for k in range(3)]
    flat = [uv[uv_faces[:, k]] - uv[uv_faces[:, (k + 1) % 3]] for k in range(3)]
    lengths = [np.linalg.norm(side, axis=1) for side in three]
    rest = [np.linalg.norm(side, axis=1) for side in flat]
    return np.concatenate(lengths) / np.maximum(np.concatenate(rest), 1e-9) - 1.0


def read_obj(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Positions, faces, texture coordinates and texture faces of a triangle OBJ."""
    v, vt, f, ft = [], [], [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            v.append([float(word) for word in words[1:4]])
        elif words[0] == "vt":
            vt.append([float(word) for word in words[1:3]])
        elif words[0] == "f":
            corners = [word.split("/") for word in words[1:]]
            for k in range(1, len(corners) - 1):
                f.append([int(corners[i][0]) - 1 for i in (0, k, k + 1)])
                ft.append([int(corners[i][1]) - 1 for i in (0, k, k + 1)])
    return np.array(v), np.array(f, dtype=np.int32), np.array(vt), np.array(ft, dtype=np.int32)


def dressed(data: Path, name: str, out: Path, friction: float | None) -> Path:
    """The OBJ of our drape, computed if it is not there yet."""
    path = out / f"{name}.obj"
    if not path.exists():
        garment = toile.Garment(data / f"reference/{name}_specification.json", name=name)
        scene = toile.Scene(
            avatar=data / "reference/f_smpl_template.ply",
            garments=[garment],
            quality="standard",
            friction=friction,
        )
        result = toile.dress(scene, output=out)
        report = result.report
        print(
            f"{out.name}: {result.status}, {report['steps']} steps, {report['cpu_seconds']:.0f} CPU s, "
            f"intersections {report['intersections']}",
            file=sys.stderr,
        )
    return path


def silhouette(positions: np.ndarray, faces: np.ndarray, axis: int, box: np.ndarray) -> np.ndarray:
    """Pixels of PIXEL size within a box (low, high) that a mesh covers, seen along +z (axis 0) or +x (2)."""
    low, high = box
    width = int((high[axis] - low[axis]) / PIXEL) + 1
    height = int((high[1] - low[1]) / PIXEL) + 1
    screen = np.column_stack(
        [
            (positions[:, axis] - low[axis]) / PIXEL,
            (high[1] - positions[:, 1]) / PIXEL,
            np.ones(len(positions)),
        ]
    )
    _, face_at = rasterize(screen, np.ascontiguousarray(faces, dtype=np.int32), width, height, far=0.0)
    return face_at >= 0


def difference(mine: np.ndarray, theirs: np.ndarray) -> float:
    """Area that only one silhouette covers, over the area of theirs [%]."""
    return 100.0 * np.count_nonzero(mine != theirs) / np.count_nonzero(theirs)


def overlay(body: np.ndarray, theirs: np.ndarray, ours: np.ndarray) -> np.ndarray:
    """A picture of two silhouettes before the body's: what only one covers is coloured."""
    image = np.full((*body.shape, 3), 250, dtype=np.uint8)
    image[body] = OUTLINE
    image[theirs & ours] = BOTH
    image[theirs & ~ours] = THEIRS
    image[ours & ~theirs] = OURS
    return image


def picture(
    path: Path,
    body: trimesh.Trimesh,
    theirs: tuple[np.ndarray, np.ndarray],
    ours: tuple[np.ndarray, np.ndarray],
    colour: tuple[float, float, float],
) -> None:
    """Write their drape, ours and both silhouettes side by side, all drawn by the same camera."""
    from PIL import Image, ImageDraw, ImageFont

    # Corners of one box in all scenes, as faces without area: the camera frames what is in the scene.
    everything = np.concatenate([body.vertices, theirs[0], ours[0]])
    corners = np.array([everything.min(axis=0), everything.max(axis=0)])
    frame = PreviewMesh(corners, np.array([[0, 1, 1]], dtype=np.int32), (0.0, 0.0, 0.0))
    bare = PreviewMesh(np.array(body.vertices), np.array(body.faces, dtype=np.int32), BODY)
    height = 1200
    empty = render([bare, frame], height)
    drawn = [
        render([bare, PreviewMesh(mesh[0], mesh[1].astype(np.int32), colour, True), frame], height)
        for mesh in (theirs, ours)
    ]
    half = empty.shape[1] // 2
    # Crop to where any picture differs clearly from the bare body, in both halves alike.
    changed = np.any([np.abs(image.astype(int) - empty).max(axis=2) > 60 for image in drawn], axis=0)
    changed = changed[:, :half] | changed[:, half:]
    rows, columns = np.flatnonzero(changed.sum(axis=1) > 3), np.flatnonzero(changed.sum(axis=0) > 3)
    pad = 30
    top, bottom = max(rows[0] - pad, 0), min(rows[-1] + pad // 3, height)
    left, right = max(columns[0] - pad, 0), min(columns[-1] + pad, half)
    parts: list[tuple[str, np.ndarray]] = []
    for label, image in zip(("other solver", "toile"), drawn, strict=True):
        for side, start in (("front", 0), ("back", half)):
            parts.append((f"{label}, {side}", image[top:bottom, start + left : start + right]))
    cloth = np.concatenate([theirs[0], ours[0]])
    box = np.array([cloth.min(axis=0) - 0.06, cloth.max(axis=0) + 0.06])
    for label, axis in (("silhouettes, front", 0), ("silhouettes, side", 2)):
        masks = [silhouette(np.array(body.vertices), np.array(body.faces), axis, box)]
        masks += [silhouette(*mesh, axis, box) for mesh in (theirs, ours)]
        parts.append((label, overlay(*masks)))
    font = ImageFont.load_default(size=17)
    cells = []
    for label, image in parts:
        scale = PICTURE_HEIGHT / image.shape[0]
        cell = Image.fromarray(image).resize((round(scale * image.shape[1]), PICTURE_HEIGHT), Image.LANCZOS)
        cells.append((label, cell))
    gap, head = 8, 28
    # Columns: theirs, ours, silhouettes; the front above, the other side below.
    columns = [cells[0:2], cells[2:4], cells[4:6]]
    widths = [max(cell.width for _, cell in column) for column in columns]
    size = sum(widths) + 4 * gap, 2 * (head + PICTURE_HEIGHT) + head
    sheet = Image.new("RGB", size, (255, 255, 255))
    pen = ImageDraw.Draw(sheet)
    x = gap
    for column, width in zip(columns, widths, strict=True):
        for row, (label, cell) in enumerate(column):
            top = row * (head + PICTURE_HEIGHT)
            pen.text((x + 4, top + 4), label, fill=(40, 40, 40), font=font)
            sheet.paste(cell, (x, top + head))
        x += width + gap
    key = size[0] - widths[2] - gap
    for word, colour_of, shift in (
        ("only other solver", THEIRS, 4),
        ("only toile", OURS, 160),
        ("both", (130, 130, 130), 255),
    ):
        pen.text((key + shift, size[1] - head + 4), word, fill=colour_of, font=font)
    path.parent.mkdir(parents=True, exist_ok=True)
    sheet.quantize(256, dither=Image.Dither.NONE).save(path, optimize=True)


def main() -> int:
    """Print the comparison as a Markdown table and draw it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--pictures", type=Path, metavar="DIR")
    options = parser.parse_args()
    body = trimesh.load(options.data / "reference/f_smpl_template.ply", process=False)
    surface = cKDTree(trimesh.sample.sample_surface(body, SAMPLES, seed=0)[0])
    auditor = Auditor(np.ascontiguousarray(body.vertices), np.ascontiguousarray(body.faces, dtype=np.int32))
    rows = [
        "| drape | vertices | gap median / p5 mm | edge strain median / p5 / p95 / p99 % | lowest point m "
        "| width m | crossings with the body | silhouette difference front / side % |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for index, name in enumerate(NAMES):
        drapes = [
            ("other solver", options.data / f"reference/{name}_sim.obj"),
            ("toile", dressed(options.data, name, options.out / name, None)),
            ("toile, no friction", dressed(options.data, name, options.out / f"{name}_frictionless", 0.0)),
        ]
        meshes = [read_obj(path) for _, path in drapes]
        cloth = np.concatenate([mesh[0] for mesh in meshes])
        box = np.array([cloth.min(axis=0) - 0.01, cloth.max(axis=0) + 0.01])
        masks = [[silhouette(*mesh[:2], axis, box) for axis in (0, 2)] for mesh in meshes]
        for (label, _), (positions, faces, uv, uv_faces), mask in zip(drapes, meshes, masks, strict=True):
            crossing = len(auditor.audit(positions, faces, np.arange(len(positions), dtype=np.int32)).avatar)
            gap = 1e3 * surface.query(positions)[0]
            strain = 100.0 * strains(positions, faces, uv, uv_faces)
            quantiles = " / ".join(f"{value:+.1f}" for value in np.quantile(strain, [0.5, 0.05, 0.95, 0.99]))
            shares = " / ".join(
                f"{difference(mine, theirs):.1f}" for mine, theirs in zip(mask, masks[0], strict=True)
            )
            rows.append(
                f"| {name}, {label} | {len(positions)} | {np.median(gap):.1f} / {np.quantile(gap, 0.05):.1f} "
                f"| {quantiles} | {positions[:, 1].min():.3f} | {np.ptp(positions[:, 0]):.3f} | {crossing} "
                f"| {'' if mask is masks[0] else shares} |"
            )
        if options.pictures:
            path = options.pictures / f"reference_{name}.png"
            picture(path, body, meshes[0][:2], meshes[1][:2], garment_colour(index))
    print("\n".join(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
