"""Bodies, motions and garments that are arrays in memory are checked and repaired as those of files are."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from tests.dressing.run.test_dress import square
from toile.dressing.body.avatar import Avatar, load_avatar
from toile.dressing.body.in_memory.body_in_memory import body
from toile.dressing.run.scene_avatar import load_scene_avatar
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError


def statue() -> tuple[Float, Int]:
    """A box 0.5 m wide, 1.8 m tall and 0.3 m deep, on the floor."""
    box = trimesh.creation.box((0.5, 1.8, 0.3))
    box.apply_translation([0.0, 0.9, 0.0])
    return np.asarray(box.vertices, np.float64), np.asarray(box.faces, np.int32)


def volume(avatar: Avatar) -> float:
    return float(trimesh.Trimesh(avatar.vertices, avatar.faces, process=False).volume)


@pytest.mark.parametrize(
    ("change", "units", "up"),
    [
        (lambda v, f: (v.astype(np.float32), f.astype(np.int64)), 1.0, "y"),
        (lambda v, f: (100.0 * v, f), 0.01, "y"),
        (lambda v, f: (v[:, [0, 2, 1]] * (1.0, -1.0, 1.0), f), 1.0, "z"),
        (lambda v, f: (v, f[:, ::-1]), 1.0, "y"),
        (lambda v, f: (v, f[1:]), 1.0, "y"),
        (lambda v, f: (v.tolist(), f.tolist()), 1.0, "y"),
    ],
    ids=["float32", "centimetres", "z up", "inside out", "a hole", "lists"],
)
def test_arrays_are_repaired_as_files_are(
    change: Callable[[Float, Int], tuple[Any, Any]], units: float, up: str, tmp_path: Path
) -> None:
    vertices, faces = change(*statue())
    made = body(vertices, faces, name="statue")
    assert (made.name, made.metres_per_unit, made.up_axis) == ("statue", units, up)
    assert volume(made) == pytest.approx(0.27) and np.ptp(made.vertices[:, 1]) == pytest.approx(1.8)
    trimesh.Trimesh(vertices, faces, process=False).export(tmp_path / "statue.obj")
    read = load_avatar(tmp_path / "statue.obj")
    assert np.abs(read.vertices - made.vertices).max() < 1e-6 and np.array_equal(read.faces, made.faces)
    assert load_scene_avatar(made) is made


def test_an_avatar_made_by_hand_is_repaired_when_it_is_dressed() -> None:
    vertices, faces = statue()
    made = load_scene_avatar(Avatar(name="a", vertices=vertices.astype(np.float32), faces=faces[:, ::-1]))
    assert volume(made) == pytest.approx(0.27, rel=1e-5) and made.vertices.dtype == np.float64
    assert "12 faces were turned outward." in made.notes
    large = load_scene_avatar(Avatar(name="a", vertices=100.0 * vertices, faces=faces))
    assert large.metres_per_unit == 0.01 and np.ptp(large.vertices[:, 1]) == pytest.approx(1.8)
    lying = load_scene_avatar(Avatar(name="a", vertices=vertices[:, [1, 2, 0]][:, [2, 1, 0]], faces=faces))
    assert any("if Z is up, make it with toile.body" in note for note in lying.notes)


def test_a_motion_in_memory_is_a_body_that_moves() -> None:
    vertices, faces = statue()
    frames = np.stack([vertices, vertices + np.array([0.0, 0.0, 0.1])]).astype(np.float32)
    made = body(100.0 * frames, faces[:, ::-1], fps=30, name="walk")
    assert made.motion is not None and made.motion.fps == 30.0 and made.metres_per_unit == 0.01
    assert made.motion.frames[1] - made.motion.frames[0] == pytest.approx(
        np.tile([0, 0, 0.1], (8, 1)), abs=1e-6
    )


BAD: list[tuple[Callable[[Float, Int], object], str]] = [
    (lambda v, f: body(v, f + 1), "body: faces name what does not exist: row .* of 0..7"),
    (lambda v, f: body(v, f - 1), "body: faces name what does not exist"),
    (lambda v, f: body(np.where(v > 1, np.nan, v), f), "vertices have NaN or infinite .*first: row"),
    (lambda v, f: body(v[:, :2], f), r"body: vertices must be numbers of shape \(n, 3\), got float64"),
    (lambda v, f: body(v, f.astype(float)), "body: faces must be whole numbers of shape"),
    (lambda v, f: body("a.obj", f), "body: vertices must be numbers of shape"),
    (lambda v, f: body(v, f, fps=24), "fps is for vertices over time"),
    (lambda v, f: body(v, f, units="ft"), "unknown unit 'ft'"),
    (lambda v, f: body(1e-6 * v, f), "not the size of a body in any unit"),
    (lambda v, f: Avatar(name="a", vertices=v, faces=f + 1), "a: faces name what does not exist"),
    (lambda v, f: Avatar(name="a", vertices=np.full_like(v, np.inf), faces=f), "a: vertices have NaN"),
    (
        lambda v, f: Avatar(
            name="a", vertices=v, faces=f, motion=VertexMotion(frames=np.zeros((2, 3, 3)), fps=1.0)
        ),
        "a: the motion is of 3 vertices, the body has 8",
    ),
    (lambda v, f: VertexMotion(frames=np.stack([v, v * np.nan]), fps=24.0), "frames have NaN or infinite"),
    (lambda v, f: VertexMotion(frames=v[None], fps=24.0), r"frames must be numbers of shape \(k, v, 3\)"),
    (lambda v, f: VertexMotion(frames=np.stack([v, v]), fps=0.0), "fps must be greater than zero, got 0"),
    (lambda v, f: replace(square(), faces=f), "garment 'square': faces name what does not exist"),
    (lambda v, f: replace(square(), panel=np.array([0, 1])), "panel name what does not exist"),
    (lambda v, f: replace(square(), uv=v), "garment 'square': uv must be numbers of shape"),
    (lambda v, f: replace(square(), positions=np.nan * square().positions), "positions have NaN or infinite"),
    (lambda v, f: replace(square(), stitches=np.array([[0.5, 1]])), "stitches must be whole numbers"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "said"), BAD)
def test_arrays_at_fault_are_named(make: Callable[[Float, Int], object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        make(*statue())


def test_garments_of_any_numeric_type_are_the_same() -> None:
    mesh = square()
    same = replace(mesh, positions=mesh.positions.astype(np.float32), faces=mesh.faces.astype(np.uint64))
    assert same.positions.dtype == np.float64 and same.faces.dtype == np.int32
    assert np.allclose(same.positions, mesh.positions)
