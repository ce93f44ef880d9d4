"""Closed parts of a moving body that touch from its first frame on: cloth between them has room."""

import itertools
from pathlib import Path

import numpy as np
import pytest
import trimesh

from toile.collide.audit import crossings_within
from toile.dressing.body.animated_avatar import load_animated_avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.reading import Reading
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.run.dress import dress
from toile.dressing.run.result import Result
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.dressing.wear.skins_apart import ROOM, skins_apart
from toile.geometry.arrays import Float, Int
from toile.geometry.connected import connected_vertices

FRAMES = 5
RADIUS, HIP, ARM = 0.16, 0.2, 0.05
"""Radii of trunk, hips and arms [m]."""


def revolved(profile: list[tuple[float, float]]) -> trimesh.Trimesh:
    """A closed upright shape through (radius, height) [m], with rings 3 cm apart at most."""
    rings = []
    for (r, h), (s, g) in itertools.pairwise(profile):
        count = max(int(np.ceil(np.hypot(s - r, g - h) / 0.03)), 1)
        rings += [(r + (s - r) * k / count, h + (g - h) * k / count) for k in range(count)]
    shape = trimesh.creation.revolve(np.array([*rings, profile[-1]]), sections=28)
    shape.apply_transform(trimesh.transformations.rotation_matrix(-0.5 * np.pi, (1, 0, 0)))
    return shape


TRUNK = [
    *[(0.0, 0.0), (0.1, 0.0), (0.1, 0.4), (HIP, 0.6), (HIP, 0.75)],
    *[(RADIUS, 0.85), (RADIUS, 1.4), (0.07, 1.5), (0.08, 1.7), (0.0, 1.72)],
]
UPPER_ARM = [(0.0, 0.9), (0.04, 0.91), (ARM, 0.95), (ARM, 1.3), (0.04, 1.34), (0.0, 1.35)]


def body(overlap: float) -> tuple[Float, Int]:
    """Frames [m], (k, v, 3), and faces of a trunk and two arms in it by a depth, which turn outwards."""
    x = RADIUS + ARM - overlap
    parts = [revolved(TRUNK), revolved(UPPER_ARM), revolved(UPPER_ARM)]
    parts[1].apply_translation((x, 0.0, 0.0))
    parts[2].apply_translation((-x, 0.0, 0.0))
    whole = trimesh.util.concatenate(parts)
    first = np.asarray(whole.vertices)
    arm = np.arange(len(first)) >= len(parts[0].vertices)
    frames = []
    for angle in np.radians(np.linspace(0.0, 12.0, FRAMES)):
        side = np.sign(first[:, 0])
        about = np.column_stack((side * x, np.full(len(first), 1.3), np.zeros(len(first))))
        away = first - about
        turned = away.copy()
        turned[:, 0] = np.cos(angle) * away[:, 0] - side * np.sin(angle) * away[:, 1]
        turned[:, 1] = np.cos(angle) * away[:, 1] + side * np.sin(angle) * away[:, 0]
        frames.append(np.where(arm[:, None], about + turned, first))
    return np.stack(frames), np.asarray(whole.faces, np.int32)


def tube() -> str:
    """An OBJ of a tube around the trunk, through the arms."""
    angles, heights = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False), np.linspace(0.95, 1.2, 9)
    lines = [
        f"v {(RADIUS + 0.006) * np.cos(a):.6f} {h:.6f} {(RADIUS + 0.006) * np.sin(a):.6f}"
        for h in heights
        for a in angles
    ]
    for row in range(8):
        for k in range(40):
            a, b = 40 * row + k, 40 * row + (k + 1) % 40
            lines.append(f"f {a + 1} {b + 1} {b + 41} {a + 41}")
    return "\n".join(lines) + "\n"


def dressed(folder: Path, overlap: float) -> tuple[Result, list[str]]:
    frames, faces = body(overlap)
    np.savez(folder / "body.npz", vertices=frames, faces=faces, fps=24.0)
    (folder / "tube.obj").write_text(tube())
    said: list[str] = []
    scene = Scene(
        garments=[Garment(folder / "tube.obj")], avatar=AvatarFile(path=folder / "body.npz"),
        quality="preview", remesh=False,
    )  # fmt: skip
    return dress(scene, folder / "out", say=said.append), said


def test_a_tube_between_trunk_and_arms_is_dressed(tmp_path: Path) -> None:
    result, said = dressed(tmp_path, 0.012)
    assert result.failure is None, result.failure
    animation = result.report["animation"]
    assert animation["frames"] == FRAMES - 1 and animation["intersections_max"] == 0
    assert animation["strain_percent_max"] < 40.0
    # It hangs on the hips, between trunk and arms, and not on or around them.
    (garment,) = result.garments
    away = np.linalg.norm(garment.positions[:, [0, 2]], axis=1)
    assert RADIUS - 0.02 < away.min() and np.abs(garment.positions[:, 0]).max() < RADIUS + ARM
    assert garment.positions[:, 1].min() > 0.6
    (line,) = [line for line in said if "so that cloth has room" in line]
    assert "its parts touch in the first frame" in line and not any("come off" in line for line in said)


def form_of(folder: Path, overlap: float) -> DressForm:
    frames, faces = body(overlap)
    np.savez(folder / "body.npz", vertices=frames, faces=faces, fps=24.0)
    return DressForm(load_animated_avatar(folder / "body.npz", reading=Reading(units="m", up="y")))


def garment_of(folder: Path) -> GarmentMesh:
    (folder / "tube.obj").write_text(tube())
    return read_mesh_garment(folder / "tube.obj")


@pytest.mark.parametrize("overlap", [0.01, 0.0, -0.003], ids=["in each other", "touching", "3 mm apart"])
def test_skins_leave_room_for_cloth(overlap: float, tmp_path: Path) -> None:
    """Trunk and arms are 6 mm apart at the tube, but for what smoothing takes, and cross nowhere there."""
    form = form_of(tmp_path, overlap)
    apart, said = skins_apart(form, [garment_of(tmp_path)])
    assert said is not None and "its parts touch" in said
    skin, faces = apart.avatar.vertices, apart.avatar.faces
    part = connected_vertices(faces, len(skin))
    beside = (np.abs(skin[:, 2]) < 0.03) & (np.abs(skin[:, 1] - 1.1) < 0.1) & (skin[:, 0] > 0.0)
    arm = part == part[skin[:, 0].argmax()]
    gap = skin[beside & arm, 0].min() - skin[beside & ~arm, 0].max()
    assert 0.6 * ROOM < gap < 1.4 * ROOM
    assert not len(crossings_within(skin, faces, np.arange(len(skin), dtype=np.int32)))


def test_parts_that_are_apart_keep_their_skin(tmp_path: Path) -> None:
    form = form_of(tmp_path, -0.03)
    apart, said = skins_apart(form, [garment_of(tmp_path)])
    assert apart is form and said is None
