"""Fields, elastic, holds and gas in scene files: read as they are meant, refused by line."""

from pathlib import Path

import pytest

import toile
from toile.dressing.run.scene_file import load_scene, scene_keys_help
from toile.geometry.errors import InputError

SCENE = """
[[garment]]
source = "circle_skirt"

[[garment.field]]
run = "waist"
width = 0.03
rest_weft = 0.9
stretch_weft = { times = [0, 2], values = [100, 50] }
shear = { image = "shade.png", low = 5, high = 50, box = [0, 0, 1, 1] }

[[garment.field]]
panels = ["left_front"]
pressure = 50
damping = { attribute = "wet", high = 0.2 }

[[garment.elastic]]
run = "waist"
rest = 0.8
stiffness = 20

[[garment.hold]]
run = "waist"
frames = [0, 10]
follow = false

[garment.gas]
pressure = 100
"""


def read(tmp_path: Path, text: str) -> toile.Garment:
    path = tmp_path / "scene.toml"
    path.write_text(text)
    return load_scene(path).garments[0]


def test_tables_become_parts(tmp_path: Path) -> None:
    garment = read(tmp_path, SCENE)
    band, panel = garment.fields
    assert (band.run, band.width) == ("waist", 0.03)
    assert band.values == {
        "rest_weft": 0.9,
        "stretch_weft": toile.Keyed((0, 2), (100, 50)),
        "shear": toile.Textured(tmp_path / "shade.png", 5.0, 50.0, (0.0, 0.0, 1.0, 1.0)),
    }
    assert panel.panels == ("left_front",)
    assert panel.values == {"pressure": 50.0, "damping": toile.Painted("wet", 0.0, 0.2)}
    assert garment.elastic == (toile.Elastic(run="waist", rest=0.8, stiffness=20),)
    assert garment.holds == (toile.Hold(run="waist", frames=(0, 10), follow=False),)
    assert garment.gas == toile.Filling(pressure=100)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("rest_weft = 0.9", "rest_wef = 0.9", "line [0-9]+.*unknown key 'rest_wef'.*rest_weft"),
        ("rest_weft = 0.9", 'rest_weft = "x"', "line [0-9]+.*rest_weft cannot be 'x'"),
        ("rest_weft = 0.9", "rest_weft = 9", "rest_weft must be between 0.1 and 5, got 9"),
        ("width = 0.03\n", "", "run and width belong together"),
        ("stiffness = 20\n", "", "lacks stiffness"),
        ("frames = [0, 10]", "frames = [10, 0]", "first that is free"),
        ("times = [0, 2]", "times = [2, 0]", "times of keys must rise"),
        ("times = [0, 2], ", "", "a table has times and values"),
        ("pressure = 100", "", "gas: give its pressure or its volume"),
        ("[[garment.elastic]]", "[garment.elastic]", "elastic must be a list"),
        ("box = [0, 0, 1, 1]", "box = [1, 0, 0, 1]", "box is left, lower, right, upper"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in SCENE
    with pytest.raises(InputError, match=said) as caught:
        read(tmp_path, SCENE.replace(old, new))
    assert "scene.toml" in str(caught.value) and "\n" not in str(caught.value)


def test_the_help_lists_their_keys() -> None:
    told = scene_keys_help()
    for heading in ("[[garment.field]]", "[[garment.elastic]]", "[[garment.hold]]", "[garment.gas]"):
        assert f"\n{heading}\n" in told
    assert "rest_warp" in told and "areal_density" in told
