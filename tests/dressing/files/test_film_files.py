"""Films in one file: animated GLB, read back by toile's own reader, and MDD point caches."""

import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toile.dressing.files.gltf.animated_gltf import read_animated_gltf
from toile.dressing.files.writers.mdd import write_mdd
from toile.dressing.files.writers.moving_glb import MovingMesh, write_moving_glb
from toile.dressing.files.writers.ply import PlyMesh
from toile.geometry.arrays import Float

FPS, COUNT = 24.0, 5
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
ONE_WAY, OTHER_WAY = np.array([[0, 1, 2], [0, 2, 3]], np.int32), np.array([[0, 1, 3], [1, 2, 3]], np.int32)


def bent(frame: int) -> Float:
    """A square whose corner rises."""
    way = np.array([0.0, 0.1 * frame, 0.0]) + np.outer([0, 0, 0.05 * frame**2, 0], [0, 0, 1])
    return np.asarray(SQUARE + way)


def body() -> Iterator[PlyMesh]:
    return (PlyMesh(bent(frame) + 3.0, ONE_WAY) for frame in range(COUNT))


def cloth() -> Iterator[PlyMesh]:
    """Remeshed in its third frame; its two faces do not share texture coordinates."""
    uv = np.stack([SQUARE[ONE_WAY[0], :2], SQUARE[ONE_WAY[1], :2] + 5.0])
    for frame in range(COUNT):
        yield PlyMesh(bent(frame), ONE_WAY if frame < 2 else OTHER_WAY, uv)


def document(path: Path) -> dict[str, Any]:
    data = path.read_bytes()
    assert struct.unpack("<4sII", data[:12]) == (b"glTF", 2, len(data))
    length = struct.unpack("<I", data[12:16])[0]
    found: dict[str, Any] = json.loads(data[20 : 20 + length])
    return found


def test_a_mesh_that_stays_is_read_back_frame_by_frame(tmp_path: Path) -> None:
    path = write_moving_glb(tmp_path / "a.glb", FPS, [MovingMesh("body", (1, 0.5, 0.2), body())])
    assert path is not None
    read = read_animated_gltf(path, FPS)
    assert read.frames == pytest.approx(np.stack([frame.positions for frame in body()]), abs=1e-6)
    assert np.array_equal(read.surface.faces, ONE_WAY)
    found = document(path)
    assert [channel["target"]["path"] for channel in found["animations"][0]["channels"]] == ["weights"]
    assert "scale" not in found["nodes"][0] and found["nodes"][0]["name"] == "body"


def test_remeshed_cloth_shows_one_mesh_at_a_time(tmp_path: Path) -> None:
    meshes = [MovingMesh("body", (1, 1, 1), body()), MovingMesh("shirt", (0, 0, 1), cloth(), True)]
    path = write_moving_glb(tmp_path / "a.glb", FPS, meshes)
    assert path is not None
    read = read_animated_gltf(path, FPS)
    # Body 4 vertices; each mesh of the cloth 6 (the diagonal of its square is a seam).
    assert read.frames.shape == (COUNT, 4 + 6 + 6, 3)
    for frame in range(COUNT):
        assert read.frames[frame, :4] == pytest.approx(bent(frame) + 3.0, abs=1e-6)
        shown, hidden = (slice(4, 10), slice(10, 16))[:: 1 if frame < 2 else -1]
        there = np.unique(np.round(read.frames[frame, shown], 5), axis=0)
        assert there == pytest.approx(np.unique(np.round(bent(frame), 5), axis=0), abs=1e-5)
        assert np.ptp(read.frames[frame, hidden], axis=0).max() == 0.0, "it has no size"
    found = document(path)
    assert [node["name"] for node in found["nodes"]] == ["body", "shirt", "shirt"]
    assert "TEXCOORD_0" in found["meshes"][1]["primitives"][0]["attributes"]
    assert found["materials"][1]["doubleSided"]


def test_a_film_of_one_frame_does_not_move(tmp_path: Path) -> None:
    frames = [PlyMesh(SQUARE, ONE_WAY)]
    path = write_moving_glb(tmp_path / "a.glb", FPS, [MovingMesh("body", (1, 1, 1), frames)])
    assert path is not None and "animations" not in document(path)


def test_the_same_film_is_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.glb", "b.glb"):
        write_moving_glb(tmp_path / name, FPS, [MovingMesh("shirt", (0, 0, 1), cloth())])
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["a.glb", "b.glb"]


def test_point_caches_hold_vertices_over_time(tmp_path: Path) -> None:
    path = write_mdd(tmp_path / "a.mdd", FPS, COUNT, body())
    assert path is not None
    data = path.read_bytes()
    assert struct.unpack(">2i", data[:8]) == (COUNT, 4)
    numbers = np.frombuffer(data[8:], ">f4")
    assert numbers[:COUNT] == pytest.approx(np.arange(COUNT) / FPS)
    assert numbers[COUNT:].reshape(COUNT, 4, 3)[3] == pytest.approx(bent(3) + 3.0)
    assert write_mdd(tmp_path / "b.mdd", FPS, COUNT, cloth()) is None
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.mdd"], "nothing is left of it"
