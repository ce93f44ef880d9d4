"""Where a body stands and which way it faces: recognised, and without a trace in what is drafted to it."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from toile.dressing.body.avatar import Avatar, load_avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.facing import recognised_facing
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.body.place import GRID, Place
from toile.dressing.pattern.drafts import built_in
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

BODY = mannequin()
PELVIS = np.array([0.0, -0.94, 0.07])


def turned(degrees: float, positions: Float = BODY.vertices) -> Float:
    """Positions turned about Y, from +Z towards +X."""
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.asarray(positions @ np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]]))


def in_room(positions: Float, **rest: object) -> Avatar:
    """The mannequin as a file might have it."""
    return Avatar(name="body", vertices=positions, faces=BODY.faces, **rest)  # type: ignore[arg-type]


@pytest.mark.parametrize("degrees", [0.0, 5.0, 37.0, 90.0, 123.0, 180.0, -90.0, -160.0])
def test_any_turn_is_recognised(degrees: float) -> None:
    found = recognised_facing(turned(degrees) + np.array([3.0, -2.0, 7.0]), BODY.faces)
    assert found.sure and found.degrees == pytest.approx(degrees, abs=0.1)
    if degrees % 90.0 == 0.0:
        assert found.degrees == degrees


def test_a_body_without_feet_keeps_the_way_it_faces_and_a_ball_has_none() -> None:
    above = BODY.faces[(BODY.vertices[BODY.faces][..., 1] > 0.5).all(axis=1)]
    used, faces = np.unique(above, return_inverse=True)
    found = recognised_facing(turned(30.0, BODY.vertices[used]), faces.reshape(-1, 3).astype(np.int32))
    assert not found.sure and found.degrees == pytest.approx(30.0, abs=1.0)
    ball = trimesh.creation.icosphere(subdivisions=3)
    assert recognised_facing(np.asarray(ball.vertices), np.asarray(ball.faces, np.int32)).degrees == 0.0


@pytest.mark.parametrize(
    "name", "anny_f_apose anny_m_sit anny_m_walk anny_f_heavy_twist mh_m_heavy mean_male".split()
)
def test_real_bodies_face_plus_z_however_they_stand(data_dir: Path, name: str) -> None:
    avatar = load_avatar(data_dir / "bodies" / f"{name}.ply")
    assert avatar.front == 0.0
    found = recognised_facing(turned(180.0, avatar.vertices), avatar.faces)
    assert found.sure and found.degrees == 180.0


@pytest.mark.parametrize(
    ("front", "up", "degrees"), [("x", "y", 90.0), ("-x", "z", -90.0), ("-z", "y", 180.0), ("-y", "z", 0.0)]
)
def test_the_front_may_be_given(front: str, up: str, degrees: float, tmp_path: Path) -> None:
    trimesh.Trimesh(BODY.vertices, BODY.faces, process=False).export(tmp_path / "b.ply")
    avatar = load_avatar(tmp_path / "b.ply", units="m", up=up, front=front)
    assert avatar.front == degrees and not any("faces" in note for note in avatar.notes)


def test_a_front_that_is_none_is_named(tmp_path: Path) -> None:
    trimesh.Trimesh(BODY.vertices, BODY.faces, process=False).export(tmp_path / "b.ply")
    with pytest.raises(InputError, match=r"b\.ply: unknown front 'left'; give the axis .*: x, -x"):
        load_avatar(tmp_path / "b.ply", front="left")
    with pytest.raises(InputError, match=r"b\.ply: a body whose up axis is y does not face -y"):
        load_avatar(tmp_path / "b.ply", front="-y")


def test_what_faces_back_is_said(tmp_path: Path) -> None:
    """VRM 0.x faces -Z."""
    trimesh.Trimesh(turned(180.0), BODY.faces, process=False).export(tmp_path / "b.ply")
    avatar = load_avatar(tmp_path / "b.ply")
    assert "The body faces -Z, Y up (recognised from trunk and feet)." in avatar.notes
    own = DressForm(avatar).avatar
    assert own.vertices[:, 1].min() == 0.0
    assert np.abs(own.vertices - DressForm(in_room(BODY.vertices)).avatar.vertices).max() < 2e-6


@pytest.mark.parametrize(
    "move", [[3.0, 0.0, 0.0], [0.0, -0.87, 0.0], [120.3, 14.7, -85.1], [-2.34567, 1e-3, 0.1]]
)
def test_elsewhere_the_body_is_the_same_to_the_last_bit(move: list[float]) -> None:
    here, there = DressForm(in_room(BODY.vertices)), DressForm(in_room(BODY.vertices + move))
    assert np.array_equal(here.avatar.vertices, there.avatar.vertices)
    assert here.measurements == there.measurements
    assert np.abs(there.place.outward(there.avatar.vertices) - BODY.vertices - move).max() < GRID


def test_a_quarter_turn_is_the_same_to_the_last_bit() -> None:
    x, y, z = BODY.vertices.T
    here = DressForm(in_room(BODY.vertices))
    there = DressForm(in_room(np.column_stack([z, y, -x]), front=90.0))
    assert np.array_equal(here.avatar.vertices, there.avatar.vertices)


def test_room_and_frame_are_each_others_inverse() -> None:
    place = Place(origin=(1.0, 2.0, 3.0), turn=33.0)
    points = np.random.default_rng(1).normal(size=(50, 3))
    assert np.abs(place.outward(place.inward(points)) - points).max() < GRID
    assert np.abs(place.turned_out(place.turned_in(points)) - points).max() < 1e-12
    ahead = [np.sin(np.radians(33.0)), 0.0, np.cos(np.radians(33.0))]
    assert np.allclose(place.turned_in(np.array(ahead)), (0.0, 0.0, 1.0))


def test_a_far_walk_is_the_walk_at_the_origin() -> None:
    ahead = np.array([[0.0, 0.0, 0.0], [0.0, 0.01, 0.1], [0.0, 0.0, 0.2]])[:, None, :]
    far = np.array([120.0, 14.0, -85.0])
    forms = [
        DressForm(in_room(frames[0], motion=VertexMotion(frames=frames, fps=24.0)))
        for frames in (BODY.vertices + ahead, BODY.vertices + ahead + far)
    ]
    motions = [form.avatar.motion for form in forms]
    assert motions[0] is not None and motions[1] is not None
    assert np.array_equal(motions[0].frames, motions[1].frames)


@pytest.mark.parametrize("size", [{}, {"height": 1.52, "chest": 1.0, "waist": 0.9}, {"height": 1.88}])
@pytest.mark.parametrize("garment", ["tshirt", "circle_skirt", "trousers"])
def test_panels_of_a_body_with_its_origin_at_the_pelvis_are_those_with_feet_at_zero(
    size: dict[str, float], garment: str, tmp_path: Path
) -> None:
    body = mannequin(**size)
    drafted = []
    for name, off in (("feet", np.zeros(3)), ("pelvis", PELVIS)):
        trimesh.Trimesh(body.vertices + off, body.faces, process=False).export(tmp_path / f"{name}.glb")
        drafted.append(built_in(garment, measure(load_avatar(tmp_path / f"{name}.glb"))))
    for one, other in zip(*(pattern.panels for pattern in drafted), strict=True):
        assert np.abs(np.array(one.vertices) - other.vertices).max() < 1e-6
        assert np.abs(np.array(one.translation) - other.translation).max() < 1e-6
