"""PLY in every order of bytes, with polygons of mixed sizes, strips and texture."""

import struct
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.body.animated_avatar import load_animated_avatar
from toile.dressing.body.avatar import load_avatar
from toile.dressing.body.reading import Reading
from toile.dressing.files.read_ply import read_ply
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

CORNERS = [(x, y, z) for x in (-0.3, 0.3) for y in (0.0, 1.6) for z in (-0.15, 0.15)]
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4]]
MIXED = [*QUADS, [1, 5, 7], [1, 7, 3]]
FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


def ply(
    kind: str, faces: list[list[int]] = MIXED, points: list[tuple[float, float, float]] = CORNERS,
    *, real: str = "float", length: str = "uchar", index: str = "int", name: str = "vertex_indices",
) -> bytes:  # fmt: skip
    """A PLY file with a byte of colour behind every vertex and every face."""
    header = (
        f"ply\nformat {kind} 1.0\ncomment made by a test\nelement vertex {len(points)}\nproperty {real} x\n"
        f"property {real} y\nproperty {real} z\nproperty uchar red\nelement face {len(faces)}\n"
        f"property list {length} {index} {name}\nproperty uchar red\nend_header\n"
    )
    if kind == "ascii":
        rows = [f"{x:g} {y:g} {z:g} 255" for x, y, z in points]
        rows += [" ".join(map(str, [len(face), *face, 7])) for face in faces]
        return (header + "\n".join(rows) + "\n").encode()
    codes = {"float": "f", "double": "d", "uchar": "B", "int": "i", "uint": "I", "ushort": "H", "uint8": "B"}
    order = FORMATS[kind]
    data = b"".join(struct.pack(f"{order}3{codes[real]}B", *point, 255) for point in points)
    for face in faces:
        data += struct.pack(f"{order}{codes[length]}{len(face)}{codes[index]}B", len(face), *face, 7)
    return header.encode() + data


def volume(vertices: Float, faces: Int) -> float:
    a, b, c = vertices[faces].swapaxes(0, 1)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize(
    "faces", [MIXED, [*QUADS, [1, 5, 7, 3]], [[0, 1, 3, 2]]], ids=["mixed", "quads", "one"]
)
@pytest.mark.parametrize(
    "types",
    [
        {},
        {"real": "double", "index": "uint"},
        {"length": "uint8", "index": "ushort", "name": "vertex_index"},
    ],
    ids=["plain", "double", "short"],
)
def test_mixed_polygons_in_every_order_of_bytes(
    kind: str, faces: list[list[int]], types: dict[str, str], tmp_path: Path
) -> None:
    path = tmp_path / "body.ply"
    path.write_bytes(ply(kind, faces, **types))  # type: ignore[arg-type]
    surface = read_ply(path)
    assert np.abs(surface.positions - CORNERS).max() < 1e-7
    if faces == [[0, 1, 3, 2]]:
        assert len(surface.faces) == 2
    else:
        assert len(surface.faces) == 12
        assert abs(volume(surface.positions, surface.faces)) == pytest.approx(0.288)
        assert len(load_avatar(path).faces) == 12
        assert sorted(set(read_ply(path).file_face)) == list(range(len(faces)))


@pytest.mark.parametrize("kind", FORMATS)
def test_polygons_of_many_corners_are_covered_once(kind: str, tmp_path: Path) -> None:
    """A panel that is an L in one polygon, beside a triangle."""
    ring = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    points = [(0.3 * x, 1.0 + 0.3 * y, 0.2) for x, y in ring] + [(2.0, 1.0, 0.2)] * 3
    points[-2], points[-1] = (2.3, 1.0, 0.2), (2.0, 1.3, 0.2)
    path = tmp_path / "panel.ply"
    path.write_bytes(ply(kind, [[3, 4, 5, 0, 1, 2], [6, 7, 8]], points))
    corners = read_mesh_garment(path).rest_corners
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    cloth = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()
    assert cloth == pytest.approx(0.09 * 3.5, rel=1e-6)


@pytest.mark.parametrize("kind", FORMATS)
def test_frames_are_split_as_the_first(kind: str, tmp_path: Path) -> None:
    """Sides that bend one way and then the other would be split along the other diagonal."""
    for k, bend in enumerate((-0.05, 0.05, 0.1)):
        points = [(x, y, z + (bend if n == 7 else 0.0)) for n, (x, y, z) in enumerate(CORNERS)]
        (tmp_path / f"body{k}.ply").write_bytes(ply(kind, [*QUADS, [1, 5, 7, 3]], points))
    avatar = load_animated_avatar(tmp_path, reading=Reading(units="m"))
    assert avatar.motion is not None and avatar.motion.frames.shape == (3, 8, 3)
    assert np.ptp(avatar.motion.frames[:, :, 2], axis=0).max() == pytest.approx(0.15, abs=1e-6)
    (tmp_path / "body3.ply").write_bytes(ply(kind, MIXED))
    with pytest.raises(InputError, match=r"body3\.ply: its faces differ from those of body0\.ply"):
        load_animated_avatar(tmp_path, reading=Reading(units="m"))


def test_texture_of_vertices_and_of_corners(tmp_path: Path) -> None:
    head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    path = tmp_path / "a.ply"
    path.write_text(
        head + "property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\n"
        "end_header\n0 0 0 0.1 0.2\n1 0 0 0.3 0.4\n0 1 0 0.5 0.6\n3 2 0 1\n"
    )
    surface = read_ply(path)
    assert surface.uv[surface.uv_faces[0]] == pytest.approx(np.array([[0.5, 0.6], [0.1, 0.2], [0.3, 0.4]]))
    path.write_text(
        head + "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
        "end_header\n0 0 0\n1 0 0\n0 1 0\n3 2 0 1 6 0.5 0.6 0.1 0.2 0.3 0.4\n"
    )
    surface = read_ply(path)
    assert surface.uv[surface.uv_faces[0]] == pytest.approx(np.array([[0.5, 0.6], [0.1, 0.2], [0.3, 0.4]]))


def test_strips_begin_anew_at_minus_one(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
        "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
        + "".join(f"{k // 2} {k % 2} 0\n" for k in range(8)) + "9 0 1 2 3 -1 4 5 6 7\n"
    )  # fmt: skip
    surface = read_ply(path)
    a, b, c = surface.positions[surface.faces].swapaxes(0, 1)
    normals = np.cross(b - a, c - a)[:, 2]
    assert len(normals) == 4 and np.abs(normals + 1.0).max() < 1e-12


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ((b"format ascii 1.0\n", b""), "its header does not say the format"),
        ((b"property float y\n", b""), "cannot be read as a mesh|have no x, y and z|does not exist"),
        ((b"element vertex 8", b"element vertex 999999999999"), "it is cut off"),
        ((b"element vertex 8", b"element vertex many"), "line 'element vertex many' of its header"),
        ((b"property float x", b"property half x"), "line 'property half x' of its header"),
        ((b"4 0 1 3 2 7", b"4 0 1 3 99 7"), "face 0 refers to a vertex that does not exist"),
        ((b"4 0 1 3 2 7", b"-4 0 1 3 2 7"), "a list has -4 entries"),
        ((b"0.3 1.6 0.15", b"0.3 one 0.15"), "could not convert"),
        ((b"end_header", b"header_end"), "it is no PLY file"),
    ],
)
def test_what_is_wrong_is_named(change: tuple[bytes, bytes], message: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.ply"
    text = ply("ascii")
    assert change[0] in text
    path.write_bytes(text.replace(*change, 1))
    with pytest.raises(InputError, match=message) as caught:
        load_avatar(path)
    assert "bad.ply" in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", FORMATS)
def test_files_that_are_cut_off_are_named(kind: str, tmp_path: Path) -> None:
    whole = ply(kind)
    path = tmp_path / "cut.ply"
    for share in (0.1, 0.5, 0.7, 0.95):
        path.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(InputError, match=r"cut\.ply: cannot be read as a mesh"):
            load_avatar(path)
