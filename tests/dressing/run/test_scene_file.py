import re
from pathlib import Path

import pytest

from toile.dressing.files.toml_lines import LineNumbers
from toile.dressing.run.scene import AvatarFile, MannequinSize
from toile.dressing.run.scene_file import load_scene, scene_keys_help
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError

FULL = """\
quality = "preview"
edge_length = 0.02
max_frames = 50
gravity = 1.62
friction = 0.5
friction_between = [["my denim", "body", 0.6], ["canvas", "my denim", 0.2]]
default_fabric = "canvas"

[avatar]
file = "bodies/eve.obj"
units = "cm"
up = "z"

[[garment]]
source = "tshirt"
name = "shirt"
fabric = "my denim"
self_contact = false
pins = ["lower_interface", 3]
warp_angle = { front = 45.0 }

[[garment]]
source = "skirt.obj"

[fabric."my denim"]
like = "denim-12oz"
shear = 99
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "scene.toml"
    path.write_text(text)
    return path


def test_every_key_arrives(tmp_path: Path) -> None:
    scene = load_scene(write(tmp_path, FULL))
    assert (scene.quality, scene.edge_length, scene.max_frames) == ("preview", 0.02, 50)
    assert (scene.gravity, scene.friction, scene.fabric) == (1.62, 0.5, "canvas")
    assert scene.friction_between == {("my denim", "body"): 0.6, ("canvas", "my denim"): 0.2}
    assert scene.avatar == AvatarFile(path=tmp_path / "bodies/eve.obj", units="cm", up="z")
    shirt, skirt = scene.garments
    assert (shirt.source, shirt.name, shirt.fabric, shirt.self_contact) == (
        "tshirt",
        "shirt",
        "my denim",
        False,
    )
    assert shirt.pins == ("lower_interface", 3)
    assert shirt.warp_angle == {"front": 45.0}
    assert skirt.source == tmp_path / "skirt.obj"
    assert scene.fabrics["my denim"].shear == 99.0
    assert scene.fabrics["my denim"].areal_density == 0.36


def test_a_body_that_moves_is_taken_at_a_time_of_a_clip(tmp_path: Path) -> None:
    """The file begins with the mark that some editors write."""
    text = '[avatar]\nfile = "eve.glb"\ntime = 2\nclip = "walk"\n[[garment]]\nsource = "tshirt"\n'
    scene = load_scene(write(tmp_path, "\ufeff" + text))
    assert scene.avatar == AvatarFile(path=tmp_path / "eve.glb", time=2, clip="walk")
    with pytest.raises(InputError, match="line 2: clip needs a file") as caught:
        load_scene(write(tmp_path, '[avatar]\nclip = "walk"\n[[garment]]\nsource = "tshirt"\n'))
    assert caught.value.field == "avatar.clip"


def test_mannequin_sizes_and_defaults(tmp_path: Path) -> None:
    scene = load_scene(write(tmp_path, '[[garment]]\nsource = "tshirt"\n[avatar]\nheight = 1.8\n'))
    assert scene.avatar == MannequinSize(height=1.8)
    assert load_scene(write(tmp_path, '[[garment]]\nsource = "tshirt"\n')).avatar is None


GARMENT = '[[garment]]\nsource = "tshirt"\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('qualty = "preview"\n' + GARMENT, "line 1: unknown key 'qualty'; did you mean 'quality'"),
        (GARMENT + GARMENT + 'fabrik = "canvas"\n', "line 5: unknown key 'fabrik'; did you mean 'fabric'"),
        (GARMENT + 'fabric = "denm"\n', "line 3: unknown fabric 'denm'; did you mean 'denim-12oz'"),
        (GARMENT + "[fabric.a]\nlike = 'canvas'\n\nstretch_warp = -4\n", "line 6: .*stretch_warp.*zero.*-4"),
        (
            GARMENT + "[fabric.a]\nlike = 'canvass'\n",
            "line 4: unknown fabric 'canvass'; did you",
        ),
        (GARMENT + "[fabric.a]\nshear = 4\n", "line 3: fabric 'a' lacks areal_density, "),
        (GARMENT + 'self_contact = "no"\n', "line 3: self_contact must be true or false, got 'no'"),
        ("max_frames = true\n" + GARMENT, "line 1: max_frames must be a whole number"),
        ("threads = 0\n" + GARMENT, "line 1: threads must lie between 1 and"),
        ('fabric = "canvas"\n' + GARMENT, "line 1: .*default_fabric = 'canvas'"),
        ('friction_between = [["denim", 0.5]]\n' + GARMENT, "line 1: friction_between: each entry is two"),
        (
            'friction_between = [["a", "b", 11]]\n' + GARMENT,
            "line 1: friction_between a and b must lie",
        ),
        ('quality = "hight"\n' + GARMENT, "line 1: unknown quality 'hight'; known are: preview"),
        ("edge_length = -1\n" + GARMENT, "line 1: edge_length must lie between"),
        ("[[garment]]\nname = 'a'\n", r"line 1: a \[\[garment\]\] needs a source"),
        ("[avatar]\nheight = 1.7\nfile = 'a.obj'\n" + GARMENT, "line 2: height sizes the built-in mannequin"),
        ("quality = 'preview'\n", r"no \[\[garment\]\] table"),
        ("quality = \n", "not valid TOML: .*line 1"),
    ],
)
def test_mistakes_name_their_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        load_scene(write(tmp_path, text))
    assert str(caught.value).startswith(str(tmp_path / "scene.toml"))
    assert "\n" not in str(caught.value)


def test_own_fabric_needs_only_what_has_no_default(tmp_path: Path) -> None:
    table = (
        "areal_density = 0.1\nthickness = 2e-4\n"
        "bending_warp = 5e-6\nbending_weft = 5e-6\nbending_bias = 5e-6\n"
        "stretch_warp = 3000\nstretch_weft = 3000\nshear = 60\n"
    )
    path = tmp_path / "scene.toml"
    path.write_text(GARMENT + "[fabric.a]\n" + table)
    assert load_scene(path).fabrics["a"].compression == Fabric.compression
    path.write_text(GARMENT + "[fabric.a]\n" + table + "compression = 0.5\n")
    assert load_scene(path).fabrics["a"].compression == 0.5
    path.write_text(GARMENT + "[fabric.a]\n" + table + "compression = 2\n")
    with pytest.raises(InputError, match="compression is a share and must not exceed 1, got 2"):
        load_scene(path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[remesh]\nsize_min = {}", "size_min must be a finite number"),
        ('[[garment.field]]\npanels = ["front"]\npressure = {}', "pressure"),
        ("[garment.gas]\npressure = {}", "pressure"),
        ("folds = {{ front = [{{ points = [[0, 0], [1, 1]], degrees = {} }}] }}", "folds of 'front'"),
        (
            'fabric = "a"\n[fabric.a]\n'
            'yarn = {{ warp = "cotton:20tex", ends_per_cm = {}, picks_per_cm = 25 }}',
            "ends_per_cm of yarn must be a number",
        ),
    ],
)
def test_whole_numbers_beyond_all_bounds_are_named(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text('[[garment]]\nsource = "tshirt"\n' + text.format(10**400))
    with pytest.raises(InputError, match=said) as caught:
        load_scene(path)
    assert len(str(caught.value)) < 500


def test_missing_file() -> None:
    with pytest.raises(InputError, match=r"nowhere\.toml: there is no such scene file"):
        load_scene("nowhere.toml")


def test_line_numbers_of_every_spelling() -> None:
    lines = LineNumbers('a.b = 1\n\n["x y"]\nc = 2 # c\n[[t]]\nd = 1\n[[t]]\n d = 2\n[t.u]\ne = 1\n')
    assert lines.of(("a", "b")) == 1
    assert lines.of(("x y", "c")) == 4
    assert [lines.of(("t", number, "d")) for number in (0, 1)] == [6, 8]
    assert lines.of(("t", 1, "u", "e")) == 10
    assert lines.of(("t", 0, "missing")) == 5
    assert lines.of(("missing",)) is None


def test_no_key_runs_into_its_meaning() -> None:
    rows = [line for line in scene_keys_help().splitlines() if line.startswith("  ") and line[2] != " "]
    keys = {row.split()[0] for row in rows}
    assert {"friction_between", "refine_compression", "warp_angle"} <= keys
    assert all(re.match(r"  [a-z_0-9]+ +\S", row) and len(row.split()) > 1 for row in rows)


def test_all_keys_are_documented() -> None:
    text = scene_keys_help()
    assert "[fabric.NAME]" in text
    assert "warp_angle" in text
    assert "bending_bias" in text
