"""Bad input ends the command with exit code 2 and one line that names what is wrong and what to do."""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from toile.dressing.cli.main import main

Document = dict[str, Any]
Refused = Callable[..., str]


def written(path: Path, positions: Any, faces: Any) -> Path:
    """A mesh as an OBJ file, NaN included."""
    lines = [f"v {x} {y} {z}\n" for x, y, z in positions]
    path.write_text("".join(lines + [f"f {a} {b} {c}\n" for a, b, c in np.asarray(faces) + 1]))
    return path


def body_mesh() -> Any:
    """An egg as large as a body, metres, Y up."""
    shape = trimesh.creation.icosphere(subdivisions=3)
    shape.apply_scale((0.2, 0.85, 0.12))
    shape.apply_translation((0.0, 0.85, 0.0))
    return shape


def tube_mesh() -> Any:
    """A tube around it."""
    shape = trimesh.creation.cylinder(0.3, 0.4, sections=24, cap=False)
    shape.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
    shape.apply_translation((0.0, 1.0, 0.0))
    return shape


def square(x: float) -> Document:
    return {
        "vertices": [[0, 0], [20, 0], [20, 20], [0, 20]],
        "edges": [{"endpoints": [i, (i + 1) % 4]} for i in range(4)],
        "translation": [x, 100, 30],
        "rotation": [0, 0, 0],
    }


def two_squares() -> Document:
    """Two squares in front of the body, sewn along the sides that face each other."""
    return {
        "pattern": {
            "panels": {"left": square(-25), "right": square(5)},
            "stitches": [[{"panel": "left", "edge": 1}, {"panel": "right", "edge": 3}]],
        },
        "properties": {"units_in_meter": 100, "curvature_coords": "relative", "normalized_edge_loops": True},
    }


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a good body and a good garment, and the current one."""
    written(tmp_path / "body.obj", body_mesh().vertices, body_mesh().faces)
    written(tmp_path / "tube.obj", tube_mesh().vertices, tube_mesh().faces)
    monkeypatch.chdir(tmp_path)
    yield tmp_path


@pytest.fixture
def refused(capfd: pytest.CaptureFixture[str]) -> Refused:
    """Return a function that runs a command that must be refused, and returns its one line."""

    def run(*arguments: object, output: object = "out") -> str:
        assert main(["dress", *map(str, arguments), "-o", str(output)]) == 2
        error = capfd.readouterr().err
        assert error.startswith("toile: ")
        assert error.count("\n") == 1, error
        assert "Traceback" not in error
        return error

    return run


def refused_pattern(refused: Refused, spoil: Callable[[Document], Any]) -> str:
    """The line about a pattern that is good but for one thing."""
    document = two_squares()
    spoil(document)
    Path("bad_specification.json").write_text(json.dumps(document))
    return refused("--avatar", "body.obj", "--garment", "bad_specification.json")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--garment", "gone.obj"], "gone.obj: garment file not found; check the path"),
        (["--garment", 300 * "x" + ".obj"], "xxx.obj: garment file not found; check the path"),
        (["--garment", 300 * "x"], "unknown garment 'xxx"),
        (
            ["--garment", "tube.obj", "--avatar", 300 * "x" + ".glb"],
            "xxx.glb: avatar file not found; check the path",
        ),
        (["--garment", "gone_specification.json"], "gone_specification.json: garment file not found; check"),
        (
            ["--garment", "tube.obj", "--avatar", "gone.ply"],
            "gone.ply: avatar file not found; check the path",
        ),
        (["gone.toml"], "gone.toml: there is no such scene file; check the path"),
    ],
)
def test_missing_file(arguments: list[str], message: str, refused: Refused) -> None:
    assert message in refused(*arguments)


def test_unknown_extension(refused: Refused) -> None:
    for name in ("a.docx", "a.fbx", "plain"):
        Path(name).write_text("x")
    assert "a.docx: unknown garment format '.docx'; use .json, .dxf" in refused("--garment", "a.docx")
    error = refused("--garment", Path("plain").absolute())
    assert "plain: unknown garment format '(no extension)'; use" in error
    error = refused("--garment", "tube.obj", "--avatar", "a.fbx")
    assert "a.fbx: FBX is a closed format; open it in Blender and export .glb" in error


@pytest.mark.parametrize("extension", [".obj", ".ply", ".glb", ".json"])
def test_empty_file(extension: str, refused: Refused) -> None:
    name = f"empty{extension}"
    Path(name).write_text("")
    assert f"{name}: the file is empty; export the garment again" in refused("--garment", name)
    if extension != ".json":
        error = refused("--garment", "tube.obj", "--avatar", name)
        assert f"{name}: the file is empty; export the body again" in error


def test_mesh_without_faces(refused: Refused) -> None:
    Path("dots.obj").write_text("v 0 0 0\nv 0 1.7 0\nv 0.3 1 0\n")
    error = refused("--garment", "dots.obj", "--avatar", "body.obj")
    assert "dots.obj: the mesh has no faces; export the garment as a surface mesh" in error
    error = refused("--garment", "tube.obj", "--avatar", "dots.obj")
    assert "dots.obj: holds no triangles" in error
    assert "export the body as a surface mesh" in error


@pytest.mark.parametrize("extension", [".obj", ".ply", ".glb"])
def test_nan_coordinates_in_a_mesh(extension: str, refused: Refused) -> None:
    for name, mesh in (("body", body_mesh()), ("tube", tube_mesh())):
        positions = np.array(mesh.vertices)
        positions[7, 1] = np.nan
        path = Path(f"nan_{name}{extension}")
        if extension == ".obj":
            written(path, positions, mesh.faces)
        else:
            trimesh.Trimesh(positions, mesh.faces, process=False).export(path)
    error = refused("--garment", f"nan_tube{extension}", "--avatar", "body.obj")
    assert f"nan_tube{extension}: 1 vertices are not finite (first: 7); repair the mesh" in error
    error = refused("--garment", "tube.obj", "--avatar", f"nan_body{extension}")
    assert (
        f"nan_body{extension}: 1 vertices have NaN or infinite coordinates (first: vertex 7); clean" in error
    )


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_nan_coordinates_in_a_pattern(value: float, refused: Refused) -> None:
    error = refused_pattern(
        refused, lambda d: d["pattern"]["panels"]["left"]["vertices"].__setitem__(1, [value, 0])
    )
    assert f"bad_specification.json: panel 'left': vertex 1 must be a finite number, got {value}" in error


def test_stitch_to_a_panel_or_an_edge_that_does_not_exist(refused: Refused) -> None:
    error = refused_pattern(refused, lambda d: d["pattern"]["stitches"][0][1].update(panel="sleeve"))
    assert "bad_specification.json: stitch 0 refers to panel 'sleeve', which does not exist" in error
    assert "the panels are left, right" in error
    error = refused_pattern(refused, lambda d: d["pattern"]["stitches"][0][1].update(edge=9))
    assert "stitch 0: edge is 9, but panel 'right' has only 0..3" in error


def test_outline_that_crosses_itself(refused: Refused) -> None:
    bow = [[0, 0], [20, 20], [20, 0], [0, 20]]
    error = refused_pattern(refused, lambda d: d["pattern"]["panels"]["left"].update(vertices=bow))
    assert "bad_specification.json: panel 'left' crosses itself: edges 0 and 2 cross or touch; move" in error
    error = refused_pattern(
        refused, lambda d: d["pattern"]["panels"]["left"]["edges"][0].update(curvature=[0.5, 2.5])
    )
    assert "panel 'left' crosses itself: edges 0 and 2 cross or touch; move" in error


def test_edges_that_cannot_be_matched(refused: Refused) -> None:
    narrow = [[0, 0], [20, 0], [20, 1], [0, 20]]
    error = refused_pattern(refused, lambda d: d["pattern"]["panels"]["left"].update(vertices=narrow))
    assert "bad_specification.json: stitch 0 (left.1 - right.3) sews an edge of 1 cm to one of 20 cm" in error
    assert "more than 12 to 1 cannot be matched, check the edge numbers" in error
    itself = {"panel": "left", "edge": 1}
    error = refused_pattern(refused, lambda d: d["pattern"]["stitches"][0].__setitem__(1, itself))
    assert "stitch 0 sews panel 'left', edge 1 to itself; name two different edges" in error
    error = refused_pattern(
        refused, lambda d: d["pattern"]["stitches"].append([itself, {"panel": "right", "edge": 1}])
    )
    assert "stitch 1 sews panel 'left', edge 1 again (stitch 0 does already); split the edge or" in error


def test_pattern_in_wrong_units(refused: Refused) -> None:
    error = refused_pattern(refused, lambda d: d["properties"].update(units_in_meter=1))
    assert "bad_specification.json: panel 'left' is more than 10 m large" in error
    assert "check its vertices and properties.units_in_meter" in error
    error = refused_pattern(refused, lambda d: d["properties"].update(units_in_meter=10000))
    assert "bad_specification.json: the largest panel measures 0.283 cm" in error


def test_friction_of_a_fabric_that_nobody_wears(refused: Refused) -> None:
    scene = 'friction_between = [["denim-12oz", "body", 0.4]]\n[[garment]]\nsource = "tube.obj"\n'
    Path("scene.toml").write_text(scene)
    error = refused("scene.toml")
    assert "friction_between: unknown fabric 'denim-12oz'; known are: cotton-poplin, body" in error


def test_unknown_fabric_suggests_the_nearest(refused: Refused) -> None:
    error = refused("--garment", "tube.obj", "--fabric", "denm")
    assert "unknown fabric 'denm'; did you mean 'denim-12oz'?" in error
    Path("scene.toml").write_text("[[garment]]\nsource = 'tube.obj'\nfabric = 'cotton-popln'\n")
    error = refused("scene.toml")
    assert "scene.toml, line 3: unknown fabric 'cotton-popln'; did you mean 'cotton-poplin'" in error


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("stretch_warp = -1", "stretch_warp must be greater than zero, got -1"),
        ("bending_bias = -1e-6", "bending_bias must not be negative, got -1e-06"),
        ("shear = nan", "shear must be a finite number, got nan"),
    ],
)
def test_stiffness_that_no_cloth_has(line: str, message: str, refused: Refused) -> None:
    Path("scene.toml").write_text(
        f"[[garment]]\nsource = 'tube.obj'\nfabric = 'mine'\n\n[fabric.mine]\nlike = 'canvas'\n{line}\n"
    )
    assert f"scene.toml, line 7: fabric 'mine': {message}" in refused("scene.toml")


@pytest.mark.parametrize("extension", [".obj", ".ply", ".glb"])
@pytest.mark.parametrize(("size", "name"), [(0.012, "0.0204 m in m"), (10.0, "17 m in m")])
def test_coin_and_tower(size: float, name: str, extension: str, refused: Refused) -> None:
    mesh = body_mesh()
    mesh.apply_scale(size)
    mesh.export(f"odd{extension}")
    error = refused("--garment", "tube.obj", "--avatar", f"odd{extension}")
    assert f"odd{extension}: the avatar is not the size of a body in any unit ({name}" in error
    assert "give its units (m, dm, cm or mm) or scale the file" in error
    error = refused("--garment", "tube.obj", "--avatar", f"odd{extension}", "--units", "m")
    assert "large in m; give the correct units" in error


@pytest.mark.parametrize("shift", [(0.0, 0.0, 9.0), (0.0, 4.0, 0.0), (-1.5, 0.0, 0.0)])
def test_mesh_far_from_the_body(shift: tuple[float, float, float], refused: Refused) -> None:
    """Also where another unit would shrink garment and distance together."""
    written(Path("far.obj"), tube_mesh().vertices + shift, tube_mesh().faces)
    error = refused("--garment", "far.obj", "--avatar", "body.obj")
    assert "garment 'far' is" in error
    assert (
        f"m away from the body (along {'xyz'[int(np.abs(shift).argmax())]}); move it onto the body" in error
    )


@pytest.mark.parametrize(("distance", "told"), [(900.0, "8.88 m"), (1e300, "e+298 m")])
def test_pattern_far_from_the_body(distance: float, told: str, refused: Refused) -> None:
    def move(document: Document, *names: str) -> None:
        for name in names:
            document["pattern"]["panels"][name]["translation"][2] = distance

    error = refused_pattern(refused, lambda d: move(d, "left", "right"))
    assert "garment 'bad' is" in error
    error = refused_pattern(refused, lambda d: move(d, "right"))
    assert "garment 'bad': panel 'right' is" in error
    assert told in error
    assert "away from the body (along z); move it onto the body" in error


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs POSIX permissions")
def test_read_only_output_folder(here: Path, refused: Refused) -> None:
    """For the superuser every folder is writable: he becomes somebody else for a while."""
    locked = here / "locked"
    locked.mkdir()
    locked.chmod(0o555)
    user = os.geteuid()
    try:
        if user == 0:
            os.seteuid(65534)
        error = refused("--garment", "tube.obj", "--avatar", "body.obj", output=locked)
    finally:
        os.seteuid(user)
        locked.chmod(0o755)
    assert f"{locked}: cannot write into the output folder (Permission denied); choose another" in error


def test_the_process_itself_ends_with_2() -> None:
    command = [sys.executable, "-m", "toile", "dress", "--garment", "gone.obj", "-o", "out"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == "toile: gone.obj: garment file not found; check the path\n"
