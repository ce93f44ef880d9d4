"""Obstacles beside a body: where keys have them, their friction, one surface with the body, mistakes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.obstacles.beside import beside, without_obstacles
from toile.dressing.body.obstacles.obstacle import Obstacle, ObstacleKey, given_obstacles
from toile.dressing.body.obstacles.solid import EDGE, Solid, placed, read_obstacle
from toile.dressing.body.place import ROOM, Place
from toile.dressing.cli.main import command_parser
from toile.dressing.cli.scene_of_options import scene_of
from toile.dressing.garment.fabrics import fabrics
from toile.dressing.run.scene_file import load_scene
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.forces.contact_pairs import BODY, SkinPart, pair_friction
from toile.geometry.errors import InputError

BOX = trimesh.creation.box((0.4, 0.2, 0.3))


def crate(**given: object) -> Avatar:
    """A crate [m], its middle at (1, 0, 0)."""
    corners = np.asarray(BOX.vertices) + np.array([1.0, 0.0, 0.0])
    return Avatar(name="crate", vertices=corners, faces=np.asarray(BOX.faces), **given)  # type: ignore[arg-type]


def test_a_solid_keeps_its_shape_and_has_edges_fine_enough_for_contact() -> None:
    solid = read_obstacle(Obstacle(crate()), crate())
    mesh = trimesh.Trimesh(solid.vertices, solid.faces, process=False)
    assert mesh.is_watertight and mesh.volume == pytest.approx(0.4 * 0.2 * 0.3, rel=1e-12)
    assert mesh.edges_unique_length.max() <= 2.0 * EDGE
    assert solid.at is None and solid.seconds == 0.0


def test_keys_move_straight_and_turn_evenly_also_by_more_than_half_a_turn() -> None:
    keys = (ObstacleKey(time=1.0), ObstacleKey(time=3.0, move=(0.2, 0.4, 0.0), turn=(0.0, 540.0, 0.0)))
    solid = read_obstacle(Obstacle(crate(), keys=keys), crate())
    assert solid.at is not None and solid.seconds == 3.0
    assert np.allclose(solid.at(0.5), solid.vertices) and np.allclose(solid.at(9.0), solid.at(3.0))
    # After a sixth of the way it has turned by 90 degrees about its middle: from ahead along X to -Z.
    point, middle = np.array([[1.2, 0.1, 0.0]]), np.array([1.0, 0.0, 0.0])
    there = placed(point, keys, middle, 1.0 + 2.0 / 6.0)
    assert np.allclose(there, [[1.0 + 0.2 / 6.0, 0.1 + 0.4 / 6.0, -0.2]], atol=1e-12)


def test_turns_about_two_axes_take_the_shortest_way() -> None:
    keys = (ObstacleKey(time=0.0, turn=(90.0, 0.0, 0.0)), ObstacleKey(time=1.0, turn=(0.0, 90.0, 0.0)))
    points, middle = np.eye(3), np.zeros(3)
    for time in (0.0, 0.3, 0.5, 1.0):
        there = placed(points, keys, middle, time)
        assert np.allclose(there @ there.T, np.eye(3), atol=1e-12)
    # The two are 120 degrees apart, so that half-way is 60 degrees from either.
    half = placed(points, keys, middle, 0.5)
    ends = placed(points, keys, middle, 0.0), placed(points, keys, middle, 1.0)
    away = [np.arccos((np.trace(end.T @ half) - 1.0) / 2.0) for end in ends]
    assert away[0] == pytest.approx(away[1], rel=1e-9) and away[0] == pytest.approx(np.pi / 3.0, rel=1e-9)


def test_one_surface_with_the_body_in_its_film_and_after_its_lead_in() -> None:
    body = crate()
    frames = np.stack([body.vertices + 0.01 * k for k in range(5)])
    moving = crate(motion=VertexMotion(frames=frames, fps=10.0, lead=2))
    solid = Solid(
        name="ball", friction=0.3, vertices=body.vertices + 5.0, faces=body.faces,
        at=lambda time: body.vertices + 5.0 + time, seconds=9.0,
    )  # fmt: skip
    both = beside(moving, [solid], ROOM)
    motion = both.motion
    assert motion is not None and motion.lead == 2 and motion.fps == 10.0 and len(motion.frames) == 5
    assert np.array_equal(motion.frames[:, :8], frames)
    for frame, time in enumerate((0.0, 0.0, 0.0, 0.1, 0.2)):
        assert np.allclose(motion.frames[frame, 8:], body.vertices + 5.0 + time)
    assert both.obstacles == (SkinPart("ball", 8, 16, 0.3),)
    assert np.array_equal(both.alone.vertices, body.vertices) and np.array_equal(both.alone.faces, body.faces)
    assert both.alone.motion is not None and np.array_equal(both.alone.motion.frames, frames)
    assert beside(moving, [], ROOM) is moving


def test_garments_start_around_the_body_and_what_it_wears_without_obstacles() -> None:
    """A worn garment comes after the obstacles."""
    body = crate()
    solid = Solid(name="ball", friction=None, vertices=body.vertices + 5.0, faces=body.faces)
    both = beside(body, [solid], ROOM)
    worn = np.concatenate([both.vertices, body.vertices + 9.0])
    faces = np.concatenate([both.faces, body.faces + np.int32(16)])
    vertices, left = without_obstacles(worn, faces, both.obstacles)
    assert np.array_equal(vertices, np.concatenate([body.vertices, body.vertices + 9.0]))
    assert np.array_equal(left, np.concatenate([body.faces, body.faces + 8]))
    assert without_obstacles(worn, faces, ())[0] is worn


def test_beside_a_body_that_stands_the_film_lasts_as_long_as_an_obstacle_moves() -> None:
    body = crate()
    solid = Solid(
        name="ball", friction=None, vertices=body.vertices, faces=body.faces,
        at=lambda time: body.vertices + time, seconds=0.5,
    )  # fmt: skip
    turned = Place(origin=(1.0, 0.0, 0.0), turn=90.0)
    motion = beside(body, [solid], turned).motion
    assert motion is not None and len(motion.frames) == 13 and motion.fps == 24.0
    assert np.allclose(
        turned.outward(np.asarray(motion.frames[-1, 8:], np.float64)), body.vertices + 0.5, atol=1e-6
    )
    assert beside(body, [solid], turned, still=True).motion is None


def test_friction_of_an_obstacle_is_its_own_or_that_of_a_pair_or_that_on_the_body() -> None:
    fabric = replace(fabrics()["cotton-poplin"], name="cloth", friction_body=0.6)
    points = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    cloth = flat_cloth(points, np.array([(0, 1, 2)], np.int32), np.eye(3), fabric)
    parts = (SkinPart("table", 4, 6, 0.2), SkinPart("chair", 6, 8, None))
    found = pair_friction(cloth, 8, {}, parts)
    on = [float(found.table[found.material[0], kind]) for kind in found.material[3:]]
    assert on == [0.6] * 4 + [0.2] * 2 + [0.6] * 2
    # A film meets a piece of the avatar: rows say which.
    piece = pair_friction(cloth, 2, {frozenset(("cloth", "table")): 0.9}, parts, np.array([5, 1], np.int32))
    assert [float(piece.table[piece.material[0], kind]) for kind in piece.material[3:]] == [0.9, 0.6]
    assert len(pair_friction(cloth, 8, {frozenset(("cloth", BODY)): 0.5}).table) == 2


def test_the_body_is_measured_without_what_stands_beside_it() -> None:
    from toile.dressing.body.mannequin import mannequin

    alone = DressForm(mannequin())
    solid = Solid(name="crate", friction=None, vertices=crate().vertices, faces=crate().faces)
    both = alone.with_avatar(beside(alone.avatar, [solid], alone.place))
    assert both.measurements == alone.measurements
    assert DressForm(both.avatar).measurements == alone.measurements


def test_keys_of_a_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(
        '[[garment]]\nsource = "tshirt"\n[[obstacle]]\nfile = "chair.obj"\nfriction = 0.4\n'
        "keys = [{ time = 0 }, { time = 1, move = [0.1, 0, 0] }]\n"
    )
    (one,) = load_scene(path).obstacles
    assert one.called == "chair" and one.friction == 0.4 and one.path == tmp_path / "chair.obj"
    assert one.keys == (ObstacleKey(time=0.0), ObstacleKey(time=1.0, move=(0.1, 0.0, 0.0)))


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("friction = 0.4", "line 3: an [[obstacle]] needs a file"),
        ('file = "a.obj"\nfricton = 0.4', "line 5: unknown key"),
        ('file = "a.obj"\nfriction = -1', "line 5: friction of an obstacle must"),
        ('file = "a.obj"\nkeys = [{ time = 1 }, { time = 0 }]', "obstacle a: times of keys must rise"),
        ('file = "a.obj"\nkeys = [{ move = [1, 0, 0] }]', "line 5: a key of an obstacle is a table"),
        ('file = "a.obj"\nname = "body"', "obstacle body: that name is taken"),
    ],
)  # fmt: skip
def test_mistakes_are_told_in_a_line(tmp_path: Path, table: str, said: str) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(f'[[garment]]\nsource = "tshirt"\n[[obstacle]]\n{table}\n')
    with pytest.raises(InputError, match=r"scene\.toml") as caught:
        load_scene(path)
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_a_missing_file_and_two_of_one_name_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="obstacle file not found"):
        read_obstacle(Obstacle(tmp_path / "none.obj"), crate())
    with pytest.raises(InputError, match="that name is taken"):
        given_obstacles([crate(), crate()])


def test_a_file_that_deforms_is_where_its_frames_have_it_and_keys_move_it_on(tmp_path: Path) -> None:
    """It is in centimetres, Z up; its third frame is twice as high as its first."""
    box = trimesh.creation.box((40.0, 30.0, 20.0))
    low = np.asarray(box.vertices) + np.array([0.0, 0.0, 10.0])
    frames = np.stack([low, low * [1.0, 1.0, 1.5], low * [1.0, 1.0, 2.0]])
    np.savez(tmp_path / "cushion.npz", vertices=frames, faces=np.asarray(box.faces), fps=10.0)
    given = Obstacle(tmp_path / "cushion.npz", units="cm", up="z")
    solid = read_obstacle(given, crate())
    assert solid.at is not None and solid.fps == 10.0 and solid.seconds == pytest.approx(0.2)
    for time, height in ((0.0, 0.2), (0.1, 0.3), (0.2, 0.4), (5.0, 0.4)):
        assert np.ptp(solid.at(time), axis=0) == pytest.approx([0.4, height, 0.3], abs=1e-6)
    keys = (ObstacleKey(time=0.0), ObstacleKey(time=0.4, move=(0.0, 1.0, 0.0)))
    both = read_obstacle(replace(given, keys=keys), crate())
    assert both.at is not None and both.seconds == 0.4
    assert np.allclose(both.at(0.1), solid.at(0.1) + np.array([0.0, 0.25, 0.0]))


def test_options_of_the_command_line_come_after_those_of_a_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text('[[garment]]\nsource = "tshirt"\n[[obstacle]]\nfile = "chair.obj"\n')
    options = command_parser().parse_args(
        ["dress", str(path), "--obstacle", "ball.obj", "--obstacle", "bed.obj"]
    )
    assert [one.called for one in scene_of(options).obstacles] == ["chair", "ball", "bed"]
