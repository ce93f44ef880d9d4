"""Measurements given by hand: read from files, used instead of those taken, completed by proportion."""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
import trimesh

import toile
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.given_measurements import measurements_of, read_measurements
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.cli.main import main
from toile.dressing.run.resolved_scene import resolve
from toile.dressing.run.scene_file import load_scene
from toile.geometry.errors import InputError

BODY = mannequin()


def fused(path: Path) -> Path:
    """A body with arms in one with its trunk: posts at the sides of the mannequin without its own."""
    lower = BODY.faces[(np.abs(BODY.vertices[BODY.faces][..., 0]) < 0.2).all(axis=1)]
    posts = [trimesh.creation.cylinder(radius=0.05, height=0.7, sections=16) for _ in range(2)]
    turn = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0])
    for sign, post in zip((1, -1), posts, strict=True):
        post.apply_transform(turn)
        post.apply_translation([sign * 0.19, 1.03, 0.0])
    body = trimesh.Trimesh(BODY.vertices, lower, process=False)
    trimesh.util.concatenate([body, *posts]).export(path)
    return path


def test_files_hold_centimetres_or_metres_and_degrees(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(
        "chest = 96\nwaist = 0.8\nwrist = 16.5\narm_angle = 45\ntorso_depth = [-11, 14.5]\n"
    )
    (tmp_path / "b.json").write_text('{"unit": "cm", "measurements": {"chest": 96.0, "height": 170.2}}')
    read = read_measurements(tmp_path / "a.toml")
    assert read["chest"] == 0.96 and read["waist"] == 0.8 and read["wrist"] == pytest.approx(0.165)
    assert read["arm_angle"] == pytest.approx(np.pi / 4) and read["torso_depth"] == (-0.11, 0.145)
    assert read_measurements(tmp_path / "b.json") == {"chest": 0.96, "height": pytest.approx(1.702)}


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.toml", "chst = 96", r"a\.toml: unknown measurement 'chst'; did you mean 'chest'"),
        ("a.toml", 'chest = "wide"', r"a\.toml: measurement chest is a number, got 'wide'"),
        ("a.toml", "chest = -3", r"a\.toml: measurement chest must be a length of a body, got -3"),
        ("a.toml", "chest = 900000", "must be a length of a body"),
        pytest.param("a.toml", "chest = 1" + 400 * "0", "measurement chest is a number, got 1000", id="huge"),
        ("a.toml", "torso_depth = [0.1, nan]", "measurement torso_depth is 2 numbers"),
        pytest.param("a.toml", "chest = " + 5000 * "[", "not valid TOML: its brackets", id="deep"),
        ("a.toml", "torso_depth = 3", "measurement torso_depth is 2 numbers"),
        ("a.toml", "", "holds no measurements"),
        ("a.json", "{", r"a\.json: not valid JSON"),
        ("a.json", "[1]", "holds no measurements"),
    ],
)
def test_what_is_wrong_in_a_file_is_named(name: str, text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=message):
        read_measurements(tmp_path / name)
    with pytest.raises(InputError, match="there is no such file"):
        read_measurements(tmp_path / "nowhere.toml")


def test_what_is_given_takes_the_place_of_what_was_measured() -> None:
    form, plain = DressForm(BODY, {"chest": 1.0}), measure(BODY)
    assert asdict(form.measurements) == {**asdict(plain), "chest": 1.0}
    assert form.notes == ()


def test_a_body_that_cannot_be_measured_takes_given_ones_and_proportions(tmp_path: Path) -> None:
    avatar = toile.load_avatar(fused(tmp_path / "fused.ply"))
    with pytest.raises(InputError, match=r"fused: cannot be measured.*by hand \(measurements = FILE\)"):
        assert DressForm(avatar).measurements
    form = DressForm(avatar, measurements_of({"chest": 97, "waist": 75, "arm_angle": 88}))
    found, usual = form.measurements, measure(BODY)
    scale = found.height / usual.height
    assert found.chest == 0.97 and found.waist == 0.75 and found.arm_angle == pytest.approx(np.radians(88))
    assert found.hip == pytest.approx(scale * usual.hip) and found.hip_height == pytest.approx(
        scale * usual.hip_height
    )
    assert found.torso_depth == pytest.approx(usual.torso_depth, abs=0.02)
    assert any("in proportion to the height: neck, hip" in note for note in form.notes)


def test_python_scene_file_and_command_take_them_alike(tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text("chest = 99\n")
    body = fused(tmp_path / "fused.ply")
    (tmp_path / "a.toml").write_text(
        '[avatar]\nfile = "fused.ply"\nmeasurements = "m.toml"\n[[garment]]\nsource = "tshirt"\n'
    )
    (tmp_path / "b.toml").write_text(
        '[avatar]\nfile = "fused.ply"\n[avatar.measurements]\nchest = 99\n[[garment]]\nsource = "tshirt"\n'
    )
    assert resolve(load_scene(tmp_path / "a.toml")).measurements == tmp_path / "m.toml"
    assert resolve(load_scene(tmp_path / "b.toml")).measurements == {"chest": 0.99}
    scene = toile.Scene(avatar=body, garments=[toile.Garment("tshirt")], measurements=measure(BODY))
    assert resolve(scene).measurements == asdict(measure(BODY))
    with pytest.raises(InputError, match="unknown measurement 'bust'"):
        resolve(toile.Scene(avatar=body, garments=[toile.Garment("tshirt")], measurements={"bust": 0.9}))
    (tmp_path / "c.toml").write_text('[avatar.measurements]\nchst = 99\n[[garment]]\nsource = "tshirt"\n')
    with pytest.raises(InputError, match=r"c\.toml, line 2: unknown measurement 'chst'"):
        load_scene(tmp_path / "c.toml")
    written = ["patterns", "--write", str(tmp_path / "out"), "--avatar", str(body)]
    assert main(written) == 2
    assert main([*written, "--measurements", str(tmp_path / "m.toml")]) == 0
    assert (tmp_path / "out" / "tshirt_specification.json").is_file()
