"""OBJ as programs write it: relative numbers, tabs, comments, long lines, faces before vertices."""

from pathlib import Path

import numpy as np
import pytest

from toile.dressing.body.animated_avatar import load_animated_avatar
from toile.dressing.body.avatar import load_avatar
from toile.dressing.body.reading import Reading
from toile.dressing.files.read_obj import read_obj
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.geometry.errors import InputError

QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
VOLUME = 0.262


def box(low: tuple[float, ...], high: tuple[float, ...]) -> list[tuple[float, ...]]:
    return [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]


TRUNK, HEAD = box((-0.3, 0.0, -0.15), (0.3, 1.4, 0.15)), box((-0.1, 1.45, -0.1), (0.1, 1.7, 0.1))


def two_boxes(*, relative: bool = False, sep: str = " ", indent: str = "", end: str = "") -> str:
    """A trunk and a head, one after the other."""
    lines, first = [], 1
    for points in (TRUNK, HEAD):
        lines += [sep.join(["v", *(f"{x:g}" for x in point)]) + end for point in points]
        for quad in QUADS:
            numbers = [k - len(points) if relative else k + first for k in quad]
            lines.append(sep.join(["f", *map(str, numbers)]) + end)
        first += len(points)
    return "\n".join(indent + line for line in lines) + "\n"


WRITTEN = {
    "plain": two_boxes(),
    "relative": two_boxes(relative=True),
    "tabs": two_boxes(sep="\t"),
    "indented": two_boxes(indent=" \t "),
    "comments": two_boxes(end=" # side"),
    "comments without a gap": two_boxes(end="#side"),
    "continued": two_boxes(sep=" \\\n  "),
    "windows": two_boxes().replace("\n", "\r\n"),
    "mark": "\ufeff" + two_boxes(),
    "weights and colours": two_boxes().replace("v -0.3 0 -0.15\n", "v -0.3 0 -0.15 1 0.5 0.5 0.5\n"),
    "faces first": "".join(sorted(two_boxes().splitlines(keepends=True), key=lambda line: line[0] == "v")),
    "normals": two_boxes().replace("f 1 2 4 3\n", "vn 1 0 0\nvn 0 1 0\nf 1//2 2//1 4//-1 3//1\n"),
    "other statements": "mtllib gone.mtl\nusemtl skin\ns off\nl 1 2\n" + two_boxes() + "p 1\nl 1 2\n",
}


def volume(path: Path) -> float:
    avatar = load_avatar(path, units="m")
    a, b, c = avatar.vertices[avatar.faces].swapaxes(0, 1)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize("name", WRITTEN)
def test_bodies_are_the_same_however_written(name: str, tmp_path: Path) -> None:
    path = tmp_path / "body.obj"
    path.write_text(WRITTEN[name], encoding="utf-8", newline="")
    assert volume(path) == pytest.approx(VOLUME)
    plain = tmp_path / "plain.obj"
    plain.write_text(WRITTEN["plain"])
    assert np.array_equal(read_obj(path).positions, read_obj(plain).positions)
    if name != "faces first":
        assert np.array_equal(read_obj(path).faces, read_obj(plain).faces)


def test_a_comment_is_no_part_of_a_group_but_a_sign_within_its_name_is(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\ng front#2 # the front\nf 1 2 3\n")
    assert read_obj(path).panel_names == ("front#2",)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n 4\n", "line 4: index 4 of 3 vertices"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", "line 4: index -4 of 3 vertices"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n", "line 4: index 1 of 0 texture vertices"),
        ("v 0 0 0\nf 0 1 1\n", "line 2: index 0 of 1 vertices"),
        ("v 0 0\n", "line 1: a vertex needs three coordinates"),
        ("v 0 0 0\nf 1 1\n", "line 2: a face needs three corners"),
    ],
)
def test_what_is_wrong_is_named_by_its_line(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.obj"
    path.write_text(text)
    for read in (load_avatar, read_mesh_garment):
        with pytest.raises(InputError, match=f"bad.obj, {message}"):
            read(path)


def frame(k: int, order: list[int]) -> str:
    """A trunk whose top moves; its normals are numbered in an order of their own, its sides bend."""
    lines = [f"v {x + 0.02 * k * (y > 1)} {y} {z * (1.0 + 0.1 * k * (x > 0))}" for x, y, z in TRUNK]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
    lines += [f"vn 0 {np.cos(i):.4f} {np.sin(i):.4f}" for i in order]
    for j, quad in enumerate(QUADS):
        corners = [f"{v + 1}/{c + 1}/{order.index(4 * j + c) + 1}" for c, v in enumerate(quad)]
        lines.append("f " + " ".join(corners))
    return "\n".join(lines) + "\n"


def test_frames_whose_normals_are_numbered_otherwise_are_one_mesh(tmp_path: Path) -> None:
    """As Blender writes a sequence; quads are split in every frame as in the first, however they bend."""
    for k in range(3):
        order = list(range(24))
        (tmp_path / f"body_{k}.obj").write_text(frame(k, order[k:] + order[:k]))
    avatar = load_animated_avatar(tmp_path, reading=Reading(units="m"))
    assert avatar.motion is not None and avatar.motion.frames.shape == (3, 8, 3)
    top = avatar.vertices[:, 1] > 1.0
    moved = avatar.motion.frames[2] - avatar.motion.frames[0]
    assert moved[top, 0] == pytest.approx(0.04, abs=1e-6) and np.abs(moved[~top, 0]).max() < 1e-6


def test_a_panel_of_one_polygon_gives_its_area_of_cloth(tmp_path: Path) -> None:
    """An L from any first corner, and a rectangle with a vertex in the middle of a side."""
    shapes = {
        3.0: [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)],
        2.0: [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)],
    }
    for area, points in shapes.items():
        for first in range(len(points)):
            numbers = [str((first + k) % len(points) + 1) for k in range(len(points))]
            path = tmp_path / "panel.obj"
            path.write_text(
                "".join(f"v {x} {1 + y} 0.2\n" for x, y in points) + "f " + " ".join(numbers) + "\n"
            )
            corners = read_mesh_garment(path).rest_corners
            a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
            cloth = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()
            assert cloth == pytest.approx(area)
