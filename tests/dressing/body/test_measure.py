"""Measurements: girths of known sections, real bodies against their tables, and bodies that do not stand."""

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh

from toile.dressing.body.avatar import Avatar, load_avatar
from toile.dressing.body.avatar_sections import cut, level_cut
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.body.place import Place
from toile.geometry.errors import InputError


def table(path: Path) -> dict[str, float]:
    """Body measurements [cm] of a GarmentCode body file."""
    return {key: float(value) for key, value in re.findall(r"^\s+(\w+): ([\d.]+)", path.read_text(), re.M)}


def test_girth_of_a_cylinder() -> None:
    mesh = trimesh.creation.cylinder(radius=0.3, height=2.0, sections=64)
    sections = cut(np.asarray(mesh.vertices), np.asarray(mesh.faces), np.zeros(3), np.array([0.0, 0.0, 1.0]))
    assert len(sections) == 1
    assert sections[0].girth == pytest.approx(2.0 * 64 * 0.3 * np.sin(np.pi / 64), rel=1e-9)
    slanted = np.array([0.0, np.sin(0.5), np.cos(0.5)])
    oval = cut(np.asarray(mesh.vertices), np.asarray(mesh.faces), np.zeros(3), slanted)[0]
    np.testing.assert_allclose((oval.points @ slanted), 0.0, atol=1e-12)
    assert np.ptp(oval.points[:, 0]) == pytest.approx(0.6, rel=1e-2)


def test_girth_bridges_hollows_and_tells_outlines_apart() -> None:
    boxes = [trimesh.creation.box(extents=(0.1, 1.0, 0.3)) for _ in range(2)]
    boxes[1].apply_translation((0.5, 0.0, 0.0))
    both = trimesh.util.concatenate(boxes)
    sections = level_cut(np.asarray(both.vertices), np.asarray(both.faces), 0.1)
    assert [section.girth for section in sections] == pytest.approx([0.8, 0.8])
    assert sorted(section.centre[0] for section in sections) == pytest.approx([0.0, 0.5])


def test_no_section_outside_the_body() -> None:
    box = trimesh.creation.box()
    assert level_cut(np.asarray(box.vertices), np.asarray(box.faces), 2.0) == []


def test_measurements_do_not_depend_on_where_the_body_stands() -> None:
    body = mannequin()
    moved = Avatar(name="moved", vertices=body.vertices + np.array([0.3, -0.85, 0.2]), faces=body.faces)
    here, there = measure(body), measure(moved)
    assert there.chest == pytest.approx(here.chest, rel=5e-3)
    assert there.waist_height == pytest.approx(here.waist_height, abs=3e-3)
    # Armpits, by which shoulders are found, lie on one level of cuts or on the next.
    assert there.shoulder_width == pytest.approx(here.shoulder_width, rel=5e-2)
    # Points are in the body's own frame, whose origin is below the trunk; the mannequin has it 1 cm off.
    off = Place.of(Avatar(name="", vertices=body.vertices, faces=body.faces)).origin
    np.testing.assert_allclose(np.array(there.shoulder_point) + off, here.shoulder_point, atol=1e-2)
    np.testing.assert_allclose(np.array(there.torso_depth) + off[2], here.torso_depth, atol=5e-3)


def test_levels_are_in_order() -> None:
    m = measure(mannequin())
    levels = [
        m.crotch_height,
        m.hip_height,
        m.waist_height,
        m.chest_height,
        m.armpit_height,
        m.shoulder_height,
        m.neck_height,
        m.height,
    ]
    assert levels == sorted(levels)
    assert m.inseam == m.crotch_height
    assert 0.09 < m.wrist / m.height < 0.12
    assert m.wrist < m.upper_arm < m.thigh < m.waist
    assert m.neck_width < m.shoulder_width


@pytest.mark.parametrize("name", ["mean_all.obj", "mean_female.ply", "mean_male.ply"])
def test_real_bodies_measure_as_their_tables_say(data_dir: Path, name: str) -> None:
    path = data_dir / "bodies" / name
    measured, known = measure(load_avatar(path)), table(path.with_suffix(".yaml"))
    for ours, theirs, tolerance in [
        (measured.height, "height", 0.1),
        (measured.chest, "bust", 1.0),
        (measured.waist, "waist", 1.0),
        (measured.hip, "hips", 1.0),
        (measured.thigh, "leg_circ", 1.0),
        (measured.wrist, "wrist", 1.0),
        (measured.arm_length, "arm_length", 1.5),
        (measured.shoulder_width, "shoulder_w", 1.5),
    ]:
        assert 100.0 * ours == pytest.approx(known[theirs], abs=tolerance), theirs
    assert np.degrees(measured.arm_angle) == pytest.approx(known["arm_pose_angle"], abs=5.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    "mean_all_apart f_smpl_average_A40 anny_child_apose anny_f_apose anny_m_tpose mh_child_8 mh_f_average "
    "mh_f_heavy_short mh_f_pregnant mh_f_slim_tall mh_m_average mh_m_heavy mh_m_muscular mh_m_old".split(),
)
def test_every_standing_body_can_be_measured(data_dir: Path, name: str) -> None:
    m = measure(load_avatar(data_dir / "bodies" / f"{name}.ply"))
    assert 0.33 < m.waist / m.height < 0.7
    assert m.waist < m.hip < 1.6 * m.waist
    assert 0.24 < m.arm_length / m.height < 0.36
    assert 0.16 < m.shoulder_width / m.height < 0.26


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("anny_m_sit", "does not stand"),
        ("anny_m_walk", "does not stand"),
        ("anny_f_armsup", "arms raised"),
    ],
)
def test_other_poses_are_refused(data_dir: Path, name: str, reason: str) -> None:
    avatar = load_avatar(data_dir / "bodies" / f"{name}.ply")
    with pytest.raises(InputError, match=rf"{name}: cannot be measured.*{reason}.*by hand"):
        measure(avatar)


def test_a_ball_is_refused() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.8)
    avatar = Avatar(
        name="ball", vertices=np.asarray(ball.vertices), faces=np.asarray(ball.faces, dtype=np.int32)
    )
    with pytest.raises(InputError, match="ball: cannot be measured"):
        measure(avatar)
