import json
import os
import struct
from pathlib import Path

import meshio
import numpy as np
import pytest
import trimesh

from toile.dressing.files.read_obj import read_obj
from toile.dressing.files.writers.atomic import writable_folder, write_atomic
from toile.dressing.files.writers.glb import GlbMesh, glb_bytes
from toile.dressing.files.writers.obj import obj_bytes
from toile.dressing.files.writers.ply import ply_bytes
from toile.dressing.files.writers.png import png_bytes
from toile.dressing.files.writers.stl import stl_bytes
from toile.geometry.errors import InputError

BOX = trimesh.creation.box((0.2, 0.3, 0.4))
POSITIONS = np.array(BOX.vertices)
FACES = np.array(BOX.faces, dtype=np.int32)


def test_ply_is_read_by_others_bit_by_bit(tmp_path: Path) -> None:
    path = write_atomic(tmp_path / "a.ply", ply_bytes(POSITIONS / 3.0, FACES))
    read = meshio.read(path)
    assert np.array_equal(read.points, POSITIONS / 3.0)
    assert np.array_equal(read.cells_dict["triangle"], FACES)
    assert np.array_equal(trimesh.load(path, process=False).faces, FACES)


def test_stl_is_read_by_others(tmp_path: Path) -> None:
    path = write_atomic(tmp_path / "a.stl", stl_bytes(POSITIONS, FACES))
    assert trimesh.load(path).volume == pytest.approx(0.024)


def test_obj_keeps_nodes_texture_and_panels(tmp_path: Path) -> None:
    uv = np.random.default_rng(1).random((36, 2))
    uv_faces = np.arange(36, dtype=np.int32).reshape(-1, 3)
    panel = np.array([0] * 5 + [1] * 7, dtype=np.int32)
    content = obj_bytes(
        POSITIONS,
        FACES,
        comment="box",
        uv=uv,
        uv_faces=uv_faces,
        panel=panel,
        panel_names=("left front", "back"),
    )
    path = write_atomic(tmp_path / "a.obj", content)
    text = content.decode().splitlines()
    assert sum(line.startswith("v ") for line in text) == 8
    assert sum(line.startswith("vt ") for line in text) == 36
    back = read_obj(path)
    assert back.panel_names == ("left_front", "back")
    assert np.array_equal(back.panel, panel)
    assert np.array_equal(back.faces, FACES)
    assert np.allclose(back.positions, POSITIONS, atol=5e-8)
    assert np.allclose(back.uv[back.uv_faces], uv[uv_faces], atol=5e-8)
    assert trimesh.load(path).volume == pytest.approx(0.024)


def test_names_of_panels_add_no_lines_to_an_obj() -> None:
    """Nor signs that cannot be printed."""
    faces = np.array([[0, 1, 2]], np.int32)
    names = ["a\0b\nf 1 2 3"]
    text = obj_bytes(np.zeros((3, 3)), faces, panel=np.zeros(1, np.int32), panel_names=names).decode()
    assert text.count("\nf ") == 1 and "\0" not in text and "\ng a_b_f_1_2_3\n" in text


def test_obj_digits_follow_the_unit() -> None:
    assert obj_bytes(POSITIONS * 1e3, FACES, metres_per_unit=1e-3).splitlines()[0].count(b"0000") == 3
    assert b"v 0.1000000 " in obj_bytes(POSITIONS, FACES)


def test_glb_follows_the_specification(tmp_path: Path) -> None:
    normals = POSITIONS / np.linalg.norm(POSITIONS, axis=1, keepdims=True)
    uv = POSITIONS[:, :2] * 1.5
    body = GlbMesh(name="body", positions=POSITIONS, normals=normals, faces=FACES, colour=(0.5, 0.4, 0.3))
    shirt = GlbMesh(
        name="shirt",
        positions=POSITIONS * 2.0,
        normals=normals,
        faces=FACES[:5],
        colour=(0.1, 0.2, 0.9),
        uv=uv,
        double_sided=True,
    )
    content = glb_bytes([body, shirt])
    magic, version, length = struct.unpack("<4sII", content[:12])
    assert (magic, version, length) == (b"glTF", 2, len(content))
    json_length, kind = struct.unpack("<I4s", content[12:20])
    assert kind == b"JSON"
    assert json_length % 4 == 0
    document = json.loads(content[20 : 20 + json_length])
    assert [node["name"] for node in document["nodes"]] == ["body", "shirt"]
    for accessor in document["accessors"]:
        view = document["bufferViews"][accessor["bufferView"]]
        size = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]] * 4
        assert view["byteLength"] == size * accessor["count"]
        assert view["byteOffset"] % 4 == 0
    last = document["bufferViews"][-1]
    assert last["byteOffset"] + last["byteLength"] == document["buffers"][0]["byteLength"]

    path = write_atomic(tmp_path / "a.glb", content)
    scene = trimesh.load_scene(path, process=False)
    assert set(scene.geometry) == {"body", "shirt"}
    assert np.allclose(scene.geometry["shirt"].vertices, POSITIONS * 2.0, atol=1e-6)
    assert np.allclose(scene.geometry["shirt"].visual.uv, uv, atol=1e-6)
    assert np.allclose(scene.geometry["body"].vertex_normals, normals, atol=1e-3)


def test_png_is_read_back_exactly() -> None:
    image = np.random.default_rng(0).integers(0, 256, (7, 5, 3), dtype=np.uint8)
    content = png_bytes(image)
    import zlib

    data = content[content.index(b"IDAT") + 4 : content.index(b"IEND") - 8]
    rows = np.frombuffer(zlib.decompress(data), dtype=np.uint8).reshape(7, 16)
    assert (rows[:, 0] == 1).all()
    decoded = np.cumsum(rows[:, 1:].reshape(7, 5, 3), axis=1, dtype=np.uint8)
    assert np.array_equal(decoded, image)
    assert struct.unpack(">II", content[16:24]) == (5, 7)


def test_a_failed_write_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.bin"
    write_atomic(path, b"old")

    def broken(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", broken)
    with pytest.raises(OSError, match="disk full"):
        write_atomic(path, b"new")
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a.bin"]


def test_unwritable_folders_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot write into the output folder"):
        writable_folder(tmp_path / "file" / "out")

    def refused(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "write_bytes", refused)
    with pytest.raises(InputError, match="Permission denied"):
        writable_folder(tmp_path)
