"""Errors say as data, too, what they are about: the same from Python, from the command and to Blender."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
import trimesh

import toile
from toile.blender_addon.engine_side import worker
from toile.dressing.batch.failure_classes import FAILURE_CLASSES, FailureClass
from toile.dressing.cli.main import command_parser
from toile.dressing.run.scene import Garment, Scene
from toile.dressing.run.scene_file import load_scene
from toile.dressing.wear.drape_types import FailureKind
from toile.geometry.errors import InputError, about

BODY = "[avatar]\nfile = 'body.obj'\n"
TUBE = "[[garment]]\nsource = 'tube.obj'\n"
SQUARES = "[[garment]]\nsource = 'squares_specification.json'\n"

Fault = tuple[str | None, str | None, str | None, tuple[int, ...]]
"""Name of the file, field, garment, faces."""

MISTAKES: dict[str, tuple[str, Fault]] = {
    "unknown key": (TUBE + "fabrik = 'canvas'\n", ("scene.toml", "garment.0.fabrik", "tube", ())),
    "wrong type": (TUBE + "self_contact = 'no'\n", ("scene.toml", "garment.0.self_contact", "tube", ())),
    "no source": ("[[garment]]\nname = 'coat'\n", ("scene.toml", "garment.0", "coat", ())),
    "no garment": (BODY, ("scene.toml", "garment", None, ())),
    "no such quality": ("quality = 'hight'\n" + TUBE, ("scene.toml", "quality", None, ())),
    "quality beside a table": (
        "quality = 'hight'\n" + TUBE + "[remesh]\nsize_max = 0.1\n", ("scene.toml", "quality", None, ())
    ),
    "number out of range": ("edge_length = -1\n" + TUBE, ("scene.toml", "edge_length", None, ())),
    "friction out of range": (
        "friction_between = [['a', 'body', 11]]\n" + TUBE, ("scene.toml", "friction_between", None, ())
    ),
    "no such fabric": (
        TUBE + "[[garment]]\nsource = 'tshirt'\nfabric = 'denm'\n",
        ("scene.toml", "garment.1.fabric", "tshirt", ()),
    ),
    "fabric that no cloth is": (
        TUBE + "[fabric.mine]\nlike = 'canvas'\nshear = -1\n", ("scene.toml", "fabric.mine.shear", None, ())
    ),
    "gusts": (TUBE + "[air]\ngusts = 3\n", ("scene.toml", "air.gusts", None, ())),
    "sizes": (TUBE + "[remesh]\nsize_max = 0\n", ("scene.toml", "remesh.size_max", None, ())),
    "shortest size": (TUBE + "[remesh]\nsize_min = -1\n", ("scene.toml", "remesh.size_min", None, ())),
    "sizes the wrong way round": (
        TUBE + "[remesh]\nsize_min = 0.2\nsize_max = 0.1\n", ("scene.toml", "remesh.size_max", None, ())
    ),
    "angle": (
        TUBE + "[remesh]\nsize_max = 0.1\nrefine_angle = nan\n",
        ("scene.toml", "remesh.refine_angle", None, ()),
    ),
    "friction of a fabric that nobody wears": (
        "friction_between = [['denim-12oz', 'body', 0.4]]\n" + BODY + TUBE,
        (None, "friction_between", None, ()),
    ),
    "no such avatar file": ("[avatar]\nfile = 'gone.ply'\n" + TUBE, ("gone.ply", "avatar", None, ())),
    "unit of the avatar": (BODY + "units = 'ell'\n" + TUBE, ("body.obj", "avatar.units", None, ())),
    "avatar of no size": ("[avatar]\nfile = 'coin.obj'\n" + TUBE, ("coin.obj", "avatar", None, ())),
    "mannequin of no size": ("[avatar]\nheight = 0.2\n" + TUBE, (None, "avatar.height", None, ())),
    "no such garment": ("[[garment]]\nsource = 'tshrt'\n", (None, "source", "tshrt", ())),
    "no such garment file": ("[[garment]]\nsource = 'gone.obj'\n", ("gone.obj", "source", "gone", ())),
    "kind of file": ("[[garment]]\nsource = 'a.docx'\nname = 'shirt'\n", ("a.docx", "source", "shirt", ())),
    "vertices that are NaN": (BODY + "[[garment]]\nsource = 'nan.obj'\n", ("nan.obj", None, "nan", ())),
    "faces without area": (
        BODY + "[[garment]]\nsource = 'flat.npz'\n", ("flat.npz", "faces", "flat", ())
    ),
    "face without vertices": (
        BODY + "[[garment]]\nsource = 'lost.npz'\n", ("lost.npz", None, "lost", (1,))
    ),
    "array": (BODY + "[[garment]]\nsource = 'few.npz'\n", ("few.npz", "faces", "few", ())),
    "unit of a garment": (BODY + TUBE + "units = 'ell'\n", ("tube.obj", "units", "tube", ())),
    "far away": (BODY + "[[garment]]\nsource = 'far.obj'\n", ("far.obj", None, "far", ())),
    "pin": (BODY + TUBE + "pins = ['waist']\n", (None, "pins", "tube", ())),
    "panel": (BODY + TUBE + "warp_angle = { sleeve = 3 }\n", (None, "warp_angle", "tube", ())),
    "pattern: a vertex": (
        BODY + "[[garment]]\nsource = 'vertex_specification.json'\n",
        ("vertex_specification.json", "pattern.panels.left.vertices.1", "vertex", ()),
    ),
    "pattern: a stitch": (
        BODY + "[[garment]]\nsource = 'stitch_specification.json'\nname = 'bib'\n",
        ("stitch_specification.json", "pattern.stitches.0", "bib", ()),
    ),
    "pattern: a curve": (
        BODY + "[[garment]]\nsource = 'curve_specification.json'\n",
        ("curve_specification.json", "pattern.panels.right.edges.2.curvature", "curve", ()),
    ),
    "pattern: units": (
        BODY + "[[garment]]\nsource = 'units_specification.json'\n",
        ("units_specification.json", "properties.units_in_meter", "units", ()),
    ),
    "pattern: a panel far away": (
        BODY + "[[garment]]\nsource = 'apart_specification.json'\n",
        ("apart_specification.json", "pattern.panels.right", "apart", ()),
    ),
}  # fmt: skip


def square(x: float) -> dict[str, Any]:
    return {
        "vertices": [[0, 0], [20, 0], [20, 20], [0, 20]],
        "edges": [{"endpoints": [i, (i + 1) % 4]} for i in range(4)],
        "translation": [x, 100, 30],
        "rotation": [0, 0, 0],
    }


def write_pattern(name: str, spoil: Callable[[dict[str, Any]], object]) -> None:
    """Two squares sewn to each other, but for one thing."""
    panels = {"left": square(-25), "right": square(5)}
    stitches = [[{"panel": "left", "edge": 1}, {"panel": "right", "edge": 3}]]
    document = {
        "pattern": {"panels": panels, "stitches": stitches},
        "properties": {"units_in_meter": 100, "normalized_edge_loops": True},
    }
    spoil(document)
    Path(f"{name}_specification.json").write_text(json.dumps(document))


def write_mesh(path: str, positions: Any, faces: Any) -> None:
    lines = [f"v {x} {y} {z}\n" for x, y, z in positions]
    Path(path).write_text("".join(lines + [f"f {a} {b} {c}\n" for a, b, c in np.asarray(faces) + 1]))


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of good and bad files, the current one."""
    monkeypatch.chdir(tmp_path)
    body = trimesh.creation.icosphere(subdivisions=3)
    body.apply_scale((0.2, 0.85, 0.12))
    body.apply_translation((0.0, 0.85, 0.0))
    write_mesh("body.obj", body.vertices, body.faces)
    write_mesh("coin.obj", 0.01 * body.vertices, body.faces)
    tube = trimesh.creation.cylinder(0.3, 0.4, sections=24, cap=False)
    tube.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
    tube.apply_translation((0.0, 1.0, 0.0))
    points, faces = np.array(tube.vertices), np.array(tube.faces)
    write_mesh("tube.obj", points, faces)
    write_mesh("far.obj", points + np.array([0.0, 0.0, 9.0]), faces)
    write_mesh("nan.obj", np.where(np.arange(len(points))[:, None] == 7, np.nan, points), faces)
    without_area = faces.copy()
    without_area[:, 2] = without_area[:, 1]
    np.savez("flat.npz", vertices=points, faces=without_area)
    np.savez("lost.npz", vertices=points, faces=np.array([[0, 1, 2], [0, 1, 9999]]))
    np.savez("few.npz", vertices=points)
    Path("a.docx").write_text("x")
    write_pattern("vertex", lambda d: d["pattern"]["panels"]["left"]["vertices"].__setitem__(1, ["a", 0]))
    write_pattern("stitch", lambda d: d["pattern"]["stitches"][0][1].update(panel="sleeve"))
    write_pattern("curve", lambda d: d["pattern"]["panels"]["right"]["edges"][2].update(curvature=3))
    write_pattern("units", lambda d: d["properties"].update(units_in_meter=-1))
    write_pattern("apart", lambda d: d["pattern"]["panels"]["right"]["translation"].__setitem__(2, 900))
    yield tmp_path


def fault_of(error: InputError) -> Fault:
    """What an error is about."""
    assert "\n" not in str(error)
    return None if error.file is None else error.file.name, error.field, error.garment, error.faces


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_are_the_same_data_everywhere(
    mistake: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, fault = MISTAKES[mistake]
    (folder / "scene.toml").write_text(text)
    (folder / "job.json").write_text(json.dumps({"garments": [], "first_frame": 1, "sequence": False}))

    with pytest.raises(InputError) as raised:
        toile.dress(load_scene("scene.toml"))
    assert fault_of(raised.value) == fault
    assert str(raised.value).count("scene.toml") <= 1

    options = command_parser().parse_args(["dress", "scene.toml", "--quiet", "-o", "out"])
    with pytest.raises(InputError) as raised:
        options.run(options)
    assert fault_of(raised.value) == fault

    capsys.readouterr()
    assert worker.main(["dress", str(folder)]) == 2
    said = json.loads(capsys.readouterr().out.splitlines()[-1])
    told = said.get("file"), said.get("field"), said.get("garment"), tuple(said.get("faces", ()))
    assert told == fault
    assert set(said) <= {"error", "file", "field", "garment", "faces"}


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: Scene(garments=[Garment("tshirt")], quality="hight"), "quality"),
        (lambda: Scene(garments=[Garment("tshirt")], friction=-1.0), "friction"),
        (
            lambda: Scene(garments=[Garment("tshirt")], friction_between={("a", "b"): 11}),
            "friction_between",
        ),
        (lambda: Scene(garments=[]), "garments"),
        (lambda: toile.fabric("denm"), "fabric"),
        (lambda: toile.Air(drag=9.0), "drag"),
    ],
)
def test_python_names_the_argument(make: Callable[[], object], field: str) -> None:
    with pytest.raises(InputError) as raised:
        make()
    assert fault_of(raised.value) == (None, field, None, ())


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        (["dress"], "--output"),
        (["dress", "-o", "out"], "--garment"),
        (["dress", "--garment", "tube.obj", "--units", "m", "-o", "out"], "--avatar"),
        (["patterns", "--avatar", "body.obj"], "--write"),
        (["batch", "-o", "out"], "--garments"),
        (["batch", "--garments", "nothing*.obj", "-o", "out"], "--garments"),
        (["bench", "compare", "a", "b", "--ratio", "0.5"], "--ratio"),
        (["mannequin", "--height", "20", "-o", "body.obj"], "height"),
    ],
)
def test_command_names_the_option(arguments: list[str], field: str) -> None:
    options = command_parser().parse_args(arguments)
    with pytest.raises(InputError) as raised:
        options.run(options)
    assert fault_of(raised.value) == (None, field, None, ())


def test_batch_names_file_and_column(folder: Path) -> None:
    Path("jobs.csv").write_text("garment,friction\ntube.obj,rough\n")
    options = command_parser().parse_args(["batch", "--jobs", "jobs.csv", "-o", "out"])
    with pytest.raises(InputError, match=r"jobs\.csv, line 2: friction must be a number") as raised:
        options.run(options)
    assert fault_of(raised.value) == ("jobs.csv", "friction", None, ())


def test_what_is_known_stays() -> None:
    with (
        pytest.raises(InputError) as raised,
        about(file=Path("outer"), garment="coat", field="a"),
        about(file=Path("inner"), field="b"),
    ):
        raise InputError("wrong", [3, 1, 3], field="c")
    assert fault_of(raised.value) == ("inner", "a.b.c", "coat", (1, 3))
    placed = raised.value.at("scene.toml, line 3", file=Path("scene.toml"))
    assert (str(placed), placed.garment, placed.faces) == ("scene.toml, line 3: wrong", "coat", (1, 3))
    assert fault_of(placed)[:2] == ("scene.toml", "a.b.c")


def test_garment_named_in_python_is_the_one_at_fault() -> None:
    scene = Scene(avatar="body.obj", garments=[Garment("tube.obj"), Garment("far.obj", name="coat")])
    with pytest.raises(InputError, match="garment 'coat' is") as raised:
        toile.dress(scene)
    assert fault_of(raised.value) == ("far.obj", None, "coat", ())


def test_every_failure_is_explained() -> None:
    kinds = {kind for part in get_args(FailureClass) for kind in get_args(part)}
    assert set(get_args(FailureKind)) < kinds
    assert set(FAILURE_CLASSES) == kinds
