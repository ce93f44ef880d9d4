"""Folds of panels and the laws of fabrics, as scene files and patterns have them, and mistakes in them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import toile
from toile.dressing.garment.fabrics import checked_fabric, fabric
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.drawn.piece import Piece
from toile.dressing.pattern.drawn.unfold import panels_of
from toile.dressing.pattern.fold_table import with_folds
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError

SQUARE = ((0.0, 0.0), (0.2, 0.0), (0.2, 0.1), (0.0, 0.1))
SCENE = """
[[garment]]
source = "tshirt"
fabric = "mine"
folds = {{ body_front = [{fold}] }}

[fabric.mine]
like = "cotton-poplin"
{law}
"""


def panel(*folds: toile.Fold, clockwise: bool = False) -> toile.Pattern:
    corners = SQUARE[::-1] if clockwise else SQUARE
    edges = tuple(toile.Edge(i, (i + 1) % 4) for i in range(4))
    only = toile.Panel(name="only", vertices=corners, edges=edges, folds=folds)
    return toile.Pattern(name="square", panels=(only,), stitches=())


def load(tmp_path: Path, fold: str = "", law: str = "") -> toile.Scene:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE.format(fold=fold, law=law))
    return toile.load_scene(path)


def test_a_scene_file_has_folds_and_curves(tmp_path: Path) -> None:
    scene = load(
        tmp_path, "{ points = [[0, 0.1], [0.3, 0.1]], degrees = -90 }, { line = 2, stiffness = 0.01 }",
        "stretch_curve_warp = [[0.02, 40], [0.04, 200]]\npoisson = 0.3\nbending_damping = 0.02",
    )  # fmt: skip
    first, second = scene.garments[0].folds["body_front"]
    assert first == toile.Fold(((0.0, 0.1), (0.3, 0.1)), -90.0)
    assert second == toile.Fold((), 180.0, 0.01, line=2)
    mine = scene.fabrics["mine"]
    assert mine.stretch_curve_warp == ((0.02, 40.0), (0.04, 200.0))
    assert (mine.poisson, mine.bending_damping) == (0.3, 0.02)


@pytest.mark.parametrize(
    ("fold", "said"),
    [
        ("{ points = [[0, 0.1]], angle = 3 }", "unknown key 'angle'"),
        ("{ degrees = 90 }", "write { points"),
        ("{ points = [[0, 1], [1]] }", "write { points"),
        ("7", "folds of 'body_front' are tables"),
        ("{ line = 0.5 }", "number of a drawn line"),
    ],
)
def test_a_fold_that_is_none_is_named_with_its_line(fold: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"scene\.toml, line 5") as caught:
        load(tmp_path, fold)
    assert said in str(caught.value)


@pytest.mark.parametrize("clockwise", [False, True])
def test_folds_part_a_panel(clockwise: bool) -> None:
    """Two straight ones, drawn a little short of the outline, and what lies between is filled."""
    folds = (toile.Fold(((0.05, 0.002), (0.06, 0.1)), 90.0), toile.Fold(((0.1, 0.0), (0.1, 0.1)), -180.0))
    mesh = mesh_pattern(panel(*folds, clockwise=clockwise), edge_length=0.02)
    assert mesh.folds is not None
    u, v = (mesh.rest_corners[:, k] - mesh.rest_corners[:, 0] for k in (1, 2))
    area = np.bincount(mesh.folds.part, 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))
    assert sorted(area) == pytest.approx([0.0045, 0.0055, 0.01], abs=1e-4)
    assert mesh.minimum_angle > 20.0
    hinges = mesh.folds.hinges(mesh.faces, mesh.uv)
    lengths = np.bincount(hinges.line, hinges.length)
    assert lengths == pytest.approx([np.hypot(0.01, 0.1), 0.1], abs=1e-3)


@pytest.mark.parametrize(
    ("folds", "said"),
    [
        ([toile.Fold(((0.05, 0.0), (0.05, 0.06)))], "40 mm from the outline"),
        ([toile.Fold(((0.05, 0.0), (0.1, 0.1))), toile.Fold(((0.1, 0.0), (0.05, 0.1)))], "cross"),
        ([toile.Fold(((0.05, 0.0), (0.05, 0.1)), 200.0)], "give -180 to 180"),
        ([toile.Fold(((0.05, 0.0),))], "two points"),
        ([toile.Fold(((0.05, 0.0), (0.05, 0.1)), stiffness=-1.0)], "must not be negative"),
    ],
)
def test_folds_that_cannot_be_are_named(folds: list[toile.Fold], said: str) -> None:
    with pytest.raises(InputError, match="only") as caught:
        mesh_pattern(panel(*folds), edge_length=0.02)
    assert said in str(caught.value)


def test_a_fold_follows_a_drawn_line_of_both_halves() -> None:
    corners = np.array(SQUARE)
    edges = tuple(np.array([corners[k], corners[(k + 1) % 4]]) for k in range(4))
    piece = Piece(name="skirt", edges=edges, fold=3, lines=(np.array([(0.05, 0.0), (0.05, 0.1)]),))
    (whole,) = panels_of(piece)
    assert np.array(whole.lines)[:, :, 0] == pytest.approx(np.array([[0.05, 0.05], [-0.05, -0.05]]))
    pattern = toile.Pattern(name="skirt", panels=(whole,), stitches=())
    pleats = {"skirt": (toile.Fold(line=0, degrees=180.0), toile.Fold(line=1, degrees=-180.0))}
    mesh = mesh_pattern(with_folds(pattern, pleats), edge_length=0.02)
    assert mesh.folds is not None and mesh.folds.part.max() == 2
    with pytest.raises(InputError, match="2 drawn lines, none of number 2"):
        with_folds(pattern, {"skirt": (toile.Fold(line=2),)})
    with pytest.raises(InputError, match="unknown panel 'skrt'"):
        with_folds(pattern, {"skrt": ()})


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"stretch_curve_warp": [[0.02, 40.0], [0.01, 80.0]]}, "must rise from zero"),
        ({"stretch_curve_weft": [[0.02, "much"]]}, "must be points"),
        ({"stretch_curve_warp": "stiff"}, "must be points"),
        ({"stretch_curve_warp": [[0.01, 100.0], [0.1, 110.0]], "poisson": 0.6}, "lower poisson"),
        ({"poisson": 1.2}, "must lie between 0 and 0.99"),
        ({"strain_limit": 4.0}, r"in percent\?"),
        (
            {"strain_limit": 0.04, "stretch_curve_warp": [[0.1, 9]], "stretch_curve_weft": [[0.1, 9]]},
            "no effect",
        ),
    ],
)
def test_laws_that_no_cloth_has_are_named(change: dict[str, object], said: str) -> None:
    values = {**vars(fabric("cotton-poplin")), **change}
    with pytest.raises(InputError, match=said):
        checked_fabric(Fabric(**values))


def test_a_mesh_cannot_be_folded() -> None:
    mesh = replace(mesh_pattern(panel(), edge_length=0.05), name="flat")
    garment = toile.Garment(mesh, folds={"only": (toile.Fold(((0.1, 0.0), (0.1, 0.1))),)})
    with pytest.raises(InputError, match="folds are lines of a pattern's panels"):
        toile.dress(toile.Scene(garments=[garment], quality="preview"))
