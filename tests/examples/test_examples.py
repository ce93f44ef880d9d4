"""Every script in examples/ runs, and one physical number of what comes of it is right."""

import ast
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import ConvexHull, cKDTree

import toile
from toile.dressing.garment import readers
from toile.dressing.pattern import drafts
from toile.engine.cloth.fields.fastenings import found_points
from toile.studies.validation.cusick import drape_coefficient

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = {path.stem: path for path in sorted((ROOT / "examples").glob("*.py")) if path.stem != "gallery"}
COARSE = {"edge_length": 0.03}
REDUCED: dict[str, dict[str, Any]] = {
    "batch": {"heights": (1.6, 1.75), **COARSE},
    "blender_scene": {"size": 0.03},
    "compare_fabrics": {"edge": 0.02},
    "dress_mannequin": {"quality": "preview"},
    "layers": COARSE,
    "made_to_measure": {"people": ("small", "large"), **COARSE},
    "moving_body": {"frames": 5, **COARSE},
    "own_draft": COARSE,
    "own_fabric": {"edge_length": 0.04},
    "own_garment_reader": COARSE,
    "own_pattern": COARSE,
    "pleated_skirt": {"edge_length": 0.02},
    "results_in_numpy": COARSE,
    "scene_file": {"settings": "edge_length = 0.03\n"},
    "sheet_on_sphere": {"edge": 0.04},
}
"""What `main` is given to be quick; an example that is not here runs as it is."""


@pytest.fixture(autouse=True)
def own_registers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drafts and readers that an example registers are gone after it."""
    monkeypatch.setattr(drafts, "_DRAFTS", dict(drafts._DRAFTS))
    monkeypatch.setattr(readers, "_READERS", dict(readers._READERS))


def hangs(result: toile.Result) -> None:
    """The garments are sewn and at rest, and nothing crosses in any frame that settles."""
    assert result.status == "converged"
    assert result.report["intersections"] == {"avatar": 0, "self": 0, "worst_frame": 0}
    assert result.report["min_gap_mm"] > 0.0


def holes(garment: toile.DressedGarment) -> int:
    """Number of openings of a garment in one piece that is a sphere with holes, by Euler's formula."""
    edges = np.sort(garment.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return 2 - (len(np.unique(garment.faces)) - len(np.unique(edges, axis=0)) + len(garment.faces))


def sheet_on_sphere(frames: list[Any], _: Path) -> None:
    assert not any(len(frame.crossings.avatar) + len(frame.crossings.cloth) for frame in frames)
    heights = frames[-1].cloth.positions[:, 1]
    # It lies on a sphere of 0.2 m, 2 mm above and 1 mm more between its nodes; its corners hang down.
    assert 0.2 < heights.max() < 0.203
    assert heights.min() < -0.05


def own_force(film: Any, folder: Path) -> None:
    place = import_module("examples.own_force").PLACE
    away = np.linalg.norm(np.load(folder / "positions.npy") - place, axis=1)
    assert np.array_equal(np.load(folder / "positions.npy"), film.cloth.positions)
    # At rest in its plane the nearest node is 15 cm away, and none of the others moves by itself.
    assert away.min() < 0.02
    assert not any(map(sum, film.record.crossings))


def compare_fabrics(cloths: dict[str, Any], folder: Path) -> None:
    silk, jersey, denim = (100.0 * drape_coefficient(cloth) for cloth in cloths.values())
    assert 15.0 < silk < 40.0 and 15.0 < jersey < 50.0
    assert 60.0 < denim < 90.0


def own_fabric(results: list[toile.Result], _: Path) -> None:
    for result in results:
        hangs(result)
    # Seen from above; in fine triangles by a third, in these by a fifth.
    silk, felt = (ConvexHull(result.garments[0].positions[:, [0, 2]]).volume for result in results)
    assert felt > 1.1 * silk


def made_to_measure(results: list[toile.Result], _: Path) -> None:
    cloth_area = import_module("examples.made_to_measure").cloth_area
    for result in results:
        hangs(result)
    small, large = (cloth_area(result.garments[0]) for result in results)
    assert 1.3 * small < large < 1.7 * small


def moving_body(result: toile.Result, _: Path) -> None:
    hangs(result)
    animation = result.report["animation"]
    assert animation["frames"] == 5 and animation["intersections_max"] == 0
    # The body turns by TURN (k/12)^2 in k frames, at last twice as fast as on average; the skirt lags.
    example = import_module("examples.moving_body")
    body = 2.0 * np.radians(example.TURN) * (animation["frames"] / 12) ** 2 / animation["seconds"]
    assert 0.1 * body < turning(result.garments[0]) < 0.9 * body


def turning(garment: toile.DressedGarment) -> float:
    """Mean angular velocity of the nodes about the vertical [1/s]."""
    assert garment.velocities is not None
    (x, z), (u, w) = (part[:, [0, 2]].T for part in (garment.positions, garment.velocities))
    return float((z * u - x * w).sum() / (x * x + z * z).sum())


def batch(results: list[toile.JobResult], _: Path) -> None:
    assert [result.outcome.state for result in results] == ["done", "done"]
    for result in results:
        assert result.folder is not None and (result.folder / "tshirt.ply").is_file()


def results_in_numpy(result: toile.Result, folder: Path) -> None:
    hangs(result)
    strain = 100.0 * np.load(folder / "shirt.npz")["strain"].max(axis=0)
    told = result.report["strain_percent"]
    assert strain == pytest.approx([told["warp_max"], told["weft_max"]], rel=1e-6)


def dress_mannequin(result: toile.Result, folder: Path) -> None:
    hangs(result)
    written = {path.name for path in folder.iterdir()}
    assert {"dressed.glb", "preview.png", "report.json", "tshirt.ply", "tshirt.obj", "view.html"} <= written
    (shirt,) = result.garments
    height = float(np.ptp(result.avatar.vertices[:, 1]))
    assert 0.6 * height < shirt.positions[:, 1].mean() < 0.8 * height


def own_pattern(result: toile.Result, _: Path) -> None:
    hangs(result)
    # Hem, neck and two armholes: all four seams are sewn from end to end.
    assert holes(result.garments[0]) == 4
    assert 1.38 < result.garments[0].positions[:, 1].max() < 1.48


def own_draft(result: toile.Result, _: Path) -> None:
    hangs(result)
    (skirt,) = result.garments
    assert holes(skirt) == 2
    assert skirt.positions[:, 1].min() == pytest.approx(0.29 * 1.68, abs=0.03)


def gathered_skirt(result: toile.Result, _: Path) -> None:
    hangs(result)
    (skirt,) = result.garments
    example = import_module("examples.gathered_skirt")
    top = skirt.uv[:, 1] > skirt.uv[:, 1].max() - 1e-9
    waist = skirt.positions[np.unique(skirt.faces[top[skirt.uv_faces]])]
    # It stays up, gathered to the waist, and its elastic pulls as its strain around the waist has it.
    assert waist[:, 1] == pytest.approx(skirt.uv[:, 1].max(), abs=0.03)
    around = ConvexHull(waist[:, [0, 2]]).area
    cut = 2.0 * np.ptp(skirt.uv[top, 0])
    assert around < 0.6 * cut
    theory = example.FIRM * (around / (example.TIGHT / example.FULL * cut) - 1.0)
    assert theory > 4.0
    assert example.tension(skirt) == pytest.approx(theory, rel=0.02)


def pleated_skirt(result: toile.Result, _: Path) -> None:
    hangs(result)
    (skirt,) = result.garments
    example = import_module("examples.pleated_skirt")
    # All twelve pleats: three layers over each other everywhere, and the hem as far around as the band.
    assert example.in_order(skirt) == 1.0
    height = skirt.positions[:, 1]
    assert height.max() - height.min() == pytest.approx(example.LENGTH, abs=0.02)
    radius = np.linalg.norm(skirt.positions[height < height.min() + 0.05][:, [0, 2]], axis=1)
    assert radius.max() < 1.15 * example.RADIUS


def own_garment_reader(result: toile.Result, _: Path) -> None:
    hangs(result)
    # The neck, and one long border.
    assert holes(result.garments[0]) == 2
    assert result.garments[0].panel_names == ("front", "back")


def layers(result: toile.Result, _: Path) -> None:
    hangs(result)
    trousers, shirt = (garment.positions for garment in result.garments)
    low, high = shirt[:, 1].min(), trousers[:, 1].max()
    assert low < high - 0.05
    both = [
        points[(points[:, 1] > low + 0.02) & (points[:, 1] < high - 0.02)] for points in (trousers, shirt)
    ]
    inner, outer = (ConvexHull(points[:, [0, 2]]).volume for points in both)
    assert outer > inner


def scene_file(result: toile.Result, _: Path) -> None:
    hangs(result)
    linen = result.garments[0].fabric
    assert (linen.name, linen.areal_density, linen.bending_warp) == ("my linen", 0.19, 2.5e-5)
    assert linen.bending_weft == toile.fabric("cotton-poplin").bending_weft


def buttoned_vest(result: toile.Result, _: Path) -> None:
    hangs(result)
    (vest,) = result.garments
    example = import_module("examples.buttoned_vest")
    names = list(vest.panel_names)
    front = vest.uv[np.unique(vest.uv_faces[vest.panel == names.index("left")])]
    middle = front[np.isclose(front[:, 0], -0.5 * example.OVERLAP), 1]
    low, top = middle.min(), middle.max()
    places = np.linspace(low + 0.03, top - 0.03, example.BUTTONS)
    sides = []
    for name in ("left", "right"):
        own = np.flatnonzero(vest.panel == names.index(name)).astype(np.int32)
        points = np.column_stack([0.0 * places, places, 0.0 * places])
        found = found_points(points, own, np.pad(vest.uv[vest.uv_faces], ((0, 0), (0, 0), (0, 1))))
        sides.append(np.einsum("kq,kqi->ki", found.weights, vest.positions[vest.faces[found.face]]))
    apart = sides[0] - sides[1]
    pocket = np.unique(vest.faces[vest.panel == names.index("pocket")])
    left = np.unique(vest.faces[vest.panel == names.index("left")])
    # The pocket lies flat on the front, outside of it.
    away, near = cKDTree(vest.positions[left]).query(vest.positions[pocket])
    assert np.median(away) < 0.012
    assert np.median(vest.positions[pocket, 2] - vest.positions[left][near, 2]) > 0.0005
    # Those that are closed are as far apart as they shall be, and the left front lies on top; above it gapes.
    assert np.linalg.norm(apart[: example.CLOSED], axis=1).max() < 0.008
    assert apart[: example.CLOSED, 2].min() > 0.001
    assert np.linalg.norm(apart[-1]) > 0.015


def blender_scene(mesh: tuple[Any, Any], folder: Path) -> None:
    points, faces = mesh
    assert len(np.unique(faces)) == len(points)
    assert (folder / "dressed.blend").is_file()
    # Blender has Z up: the shirt reaches from the hip to the neck.
    assert 0.75 < points[:, 2].min() < 0.95 and 1.35 < points[:, 2].max() < 1.5


CHECKS: dict[str, Callable[[Any, Path], None]] = {
    check.__name__: check
    for check in (
        batch, blender_scene, buttoned_vest, compare_fabrics, dress_mannequin, gathered_skirt, layers,
        made_to_measure, moving_body, own_draft, own_fabric, own_force, own_garment_reader,
        own_pattern, pleated_skirt, results_in_numpy,
        scene_file, sheet_on_sphere,
    )
}  # fmt: skip
"""Example to what is asserted of what its `main` returns and of the folder that it has written."""


@pytest.mark.parametrize("name", SCRIPTS)
def test_example_runs(name: str, tmp_path: Path) -> None:
    assert name in CHECKS, f"add a check of what examples/{name}.py returns to this file"
    if name == "blender_scene":
        pytest.importorskip("bpy", reason="Blender is not here (pip install bpy)")
    returned = import_module(f"examples.{name}").main(str(tmp_path), **REDUCED.get(name, {}))

    CHECKS[name](returned, tmp_path)


@pytest.mark.parametrize("name", SCRIPTS)
def test_example_is_short_and_shown(name: str) -> None:
    text = SCRIPTS[name].read_text()
    assert len([line for line in text.splitlines() if line.strip()]) <= 60
    assert f"python examples/{name}.py" in (ast.get_docstring(ast.parse(text)) or "")
    page = (ROOT / "docs" / "examples.md").read_text()
    assert f"(../examples/{name}.py)" in page and f"(images/examples/{name}.png)" in page
    assert (ROOT / "docs" / "images" / "examples" / f"{name}.png").stat().st_size <= 100_000
