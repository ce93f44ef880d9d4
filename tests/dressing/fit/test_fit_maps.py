"""Fit of a stretched sleeve on a cylinder: known strains, pressure and tables."""

import json
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
import trimesh

import toile
from tests.dressing.wear.test_lay_on import sheet
from toile.dressing.body.avatar import Avatar
from toile.dressing.body.place import Place
from toile.dressing.files.writers.png import png_pixels
from toile.dressing.fit.cloth_state import cloth_state
from toile.dressing.fit.findings import findings, fit_sentences, shifts
from toile.dressing.fit.fit_files import write_fit
from toile.dressing.fit.fit_maps import QUANTITIES, FitMaps, fit_maps
from toile.dressing.fit.fit_tables import summary
from toile.dressing.fit.read_fit import read_fit
from toile.dressing.fit.regions import regions_of
from toile.dressing.fit.spread_out import spread_pressure, vertex_areas
from toile.dressing.fit.worn import Worn, WornGarment
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError
from toile.remesh.panel.rectangle import rectangle

KNIT = Fabric(
    name="knit", areal_density=0.2, thickness=8e-4, bending_warp=1e-6, bending_weft=1e-6, bending_bias=1e-6,
    stretch_warp=200.0, stretch_weft=100.0, shear=50.0, compression=1.0,
)  # fmt: skip
RADIUS = 0.1


def deformed(edge: float, warp: float, weft: float, shear: float, turn: float = 0.3) -> Cloth:
    """A sheet with the same strains everywhere, somewhere in the room."""
    flat, faces = rectangle(0.2, 0.2, edge)
    plane = np.column_stack(((1.0 + warp) * flat[:, 0] + shear * flat[:, 1], (1.0 + weft) * flat[:, 1]))
    c, s = np.cos(turn), np.sin(turn)
    room = np.column_stack((plane[:, 0] * c, plane[:, 1], plane[:, 0] * s))
    return flat_cloth(flat, faces, room, KNIT)


def test_known_strains_are_read_back() -> None:
    state = cloth_state(deformed(0.05, 0.12, -0.03, 0.0))
    assert np.abs(100.0 * state.strain - (12.0, -3.0)).max() < 0.2
    assert np.abs(state.shear).max() < 1e-9
    assert state.along == pytest.approx(np.tile([0.12 * 200.0, -0.03 * 100.0], (len(state.along), 1)))
    # Force per width that is 3 % less now.
    assert state.tension == pytest.approx(np.full(len(state.tension), 0.12 * 200.0 / 0.97))
    assert state.area.sum() == pytest.approx(0.04 * 1.12 * 0.97)
    sheared = cloth_state(deformed(0.05, 0.0, 0.0, 0.2))
    assert np.abs(100.0 * sheared.shear - 20.0).max() < 0.2


def test_spread_pressure_keeps_the_force_and_is_nowhere_negative() -> None:
    flat, faces = rectangle(0.2, 0.2, 0.01)
    positions = np.column_stack((flat, np.zeros(len(flat))))
    force = np.zeros(len(flat))
    force[np.argmin(np.linalg.norm(flat - 0.1, axis=1))] = 2.0
    area = vertex_areas(positions, faces)
    pressure = spread_pressure(force, positions, faces, 0.02)
    assert (pressure * area).sum() == pytest.approx(2.0)
    assert pressure.min() >= 0.0
    even = spread_pressure(300.0 * area, positions, faces, 0.02)
    assert even == pytest.approx(np.full(len(flat), 300.0))


def rod() -> tuple[Float, Int]:
    """A closed cylinder of 1.7 m about y, with rings where the sleeve is."""
    profile = [(0.0, 0.0), *((RADIUS, y) for y in (0.0, 0.5, 1.0, 1.05, 1.1, 1.15, 1.2, 1.7)), (0.0, 1.7)]
    mesh = trimesh.creation.revolve(np.array(profile), sections=64)
    vertices = np.ascontiguousarray(mesh.vertices[:, [0, 2, 1]] * (1.0, 1.0, -1.0))
    return vertices, np.ascontiguousarray(mesh.faces, np.int32)


def sleeve(edge: float) -> Worn:
    """A sleeve that lies 1.9 mm off a cylinder of radius 10 cm, half a turn wide, a tenth longer than cut."""
    vertices, faces = rod()
    around, height, gap = np.pi * (RADIUS + 0.0019), 0.2, 0.0019
    flat, triangles = rectangle(around, height, edge)
    angle = flat[:, 0] / (RADIUS + gap)
    r = RADIUS + gap
    positions = np.column_stack((r * np.cos(angle), 1.0 + flat[:, 1], -r * np.sin(angle)))
    cloth = flat_cloth(flat / (1.1, 1.0), triangles, positions, KNIT)
    avatar = Avatar(name="rod", vertices=vertices, faces=faces)
    return Worn(
        cloth=cloth, anchors=None, step=StepOptions(self_contact=False), vertices=vertices, faces=faces,
        measured=None, avatar=avatar, place=Place(), garments=(WornGarment(name="sleeve", fabric="knit",
        panels=("all",)),),
    )  # fmt: skip


@pytest.fixture(scope="module")
def maps() -> FitMaps:
    return fit_maps(sleeve(0.02))


def test_maps_of_a_sleeve(maps: FitMaps) -> None:
    (garment,) = maps.garments
    # The rod has corners: chords of it are up to 0.12 mm inside.
    assert garment.at_vertices["ease_mm"] == pytest.approx(np.full(len(garment.node), 1.9), abs=0.2)
    # Chords of the cloth are shorter than the arc.
    assert garment.at_faces["stretch_warp_percent"].mean() == pytest.approx(10.0, abs=0.2)
    assert maps.weight == pytest.approx(0.2 * np.pi * (RADIUS + 0.0019) * 0.2 / 1.1 * 9.81)
    area = np.bincount(garment.faces.ravel(), np.repeat(garment.area / 3.0, 3))
    total = (garment.at_vertices["pressure_Pa"] * area[garment.node]).sum()
    assert maps.body.press.sum() == pytest.approx(total)
    assert total > 0.0
    names = {maps.regions[index] for index in garment.region}
    assert names == {f"{k}0 to {k + 1}0 % of its height" for k in (5, 6, 7)}


def test_files_carry_the_maps_and_the_spread(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("toile.dressing.fit.fit_picture.TILE", 120)
    worn = sleeve(0.02)
    tables = write_fit(tmp_path, worn, ["sleeve"], sleeve(0.026))
    assert read_fit(tmp_path) == json.loads(json.dumps(tables))
    assert png_pixels((tmp_path / "fit.png").read_bytes()).shape[2] == 3
    mesh = meshio.read(tmp_path / "fit" / "sleeve.vtu")
    assert mesh.point_data["stretch_warp_percent"].mean() == pytest.approx(10.0, abs=0.2)
    # The same strains on another mesh: they differ by what chords are shorter.
    assert mesh.point_data["stretch_warp_percent_spread"].max() < 0.3
    assert mesh.point_data["ease_mm_spread"].max() < 0.2
    header = (tmp_path / "fit" / "body.ply").read_bytes()[:600].decode("latin1")
    assert "property float pressure_Pa\n" in header
    assert b'"_PRESSURE_PA"' in (tmp_path / "fit" / "fit.glb").read_bytes()
    assert tables["spread"]["body"]
    again = write_fit(tmp_path / "again", worn, ["sleeve"], sleeve(0.026))
    assert again == tables
    for name in ("fit.json", "fit.png", "fit/sleeve.ply", "fit/fit.glb"):
        assert (tmp_path / name).read_bytes() == (tmp_path / "again" / name).read_bytes()


def test_python_gets_the_maps_without_files(tmp_path: Path) -> None:
    """Only where the scene asks for a fit."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.3)
    ball.apply_translation([0.0, 0.3, 0.0])
    ball.export(tmp_path / "ball.ply")
    rows = [line.split() for line in sheet((-0.2, -0.2), (0.4, 0.4), 6).splitlines()]
    lines = [f"v {row[1]} 0.62 {row[2]}" if row[0] == "v" else " ".join(row) for row in rows]
    (tmp_path / "sheet.obj").write_text("\n".join(lines) + "\n")
    scene = toile.Scene(
        garments=tmp_path / "sheet.obj",
        avatar=toile.AvatarFile(path=tmp_path / "ball.ply", units="m", up="y"),
        edge_length=0.08, remesh=False, ground=False, fit="maps",
    )  # fmt: skip
    seen: list[FitMaps] = []
    result = toile.dress(scene, fit=seen.append)
    (garment,) = seen[0].garments
    assert np.array_equal(garment.faces, result.garments[0].faces)
    assert set(garment.at_vertices) == set(QUANTITIES) and garment.at_vertices["pressure_Pa"].max() > 1.0
    toile.dress(replace(scene, fit="off"), fit=seen.append)
    assert len(seen) == 1


def test_summary_is_by_area() -> None:
    values, area = np.array([1.0, 2.0, 100.0]), np.array([50.0, 49.0, 1.0])
    figures = summary(values, area, "Pa")
    assert figures == {"mean": 2.5, "p05": 1.0, "p95": 2.0, "max": 100.0}


def row(region: str, pressure: float, tension: float, ease: float) -> dict[str, object]:
    return {
        "name": region, "area_m2": 0.01, "pressure_Pa": {"p95": pressure}, "tension_N_m": {"p95": tension},
        "ease_mm": {"mean": ease},
    }  # fmt: skip


def test_findings_in_words() -> None:
    rows = [row("waist", 3000.0, 10.0, 0.0), row("hips", 0.0, 400.0, 0.0), row("chest", 0.0, 0.0, 55.0)]
    table = {
        "garments": [{"name": "skirt", "regions": rows, "waist_rise_mm": 21.0, "hem_rise_mm": -3.0}],
        "weight_N": 3.0, "carried_by_body_N": 2.99,
    }  # fmt: skip
    told = fit_sentences(table | {"findings": findings(table)})
    assert told == [
        "skirt: tight at hips, 400 N/m, and presses on the body with 0 Pa",
        "skirt: tight at waist, 10 N/m, and presses on the body with 3000 Pa",
        "skirt: loose at chest, 55 mm from the body",
        "skirt: waist rides up by 21 mm",
        "the body bears 2.99 N of the 3.00 N that the garments weigh",
    ]


def test_shift_of_a_hem(maps: FitMaps) -> None:
    (garment,) = maps.garments
    assert shifts(garment) == {"hem_rise_mm": 0.0}
    squeezed = replace(garment, positions=garment.positions * (1.0, 0.9, 1.0))
    assert shifts(squeezed)["hem_rise_mm"] == pytest.approx(10.0, abs=1.0)


def test_regions_of_a_measured_body() -> None:
    from toile.dressing.body.dress_form import DressForm
    from toile.dressing.body.mannequin import mannequin

    form = DressForm(mannequin())
    measured = form.measurements
    points = np.array(
        [
            (0.0, measured.height - 0.02, 0.0), (0.0, measured.chest_height, 0.2),
            (0.0, measured.waist_height, -0.2), (0.09, 0.1, 0.0), (-0.09, 0.6, 0.0), (0.0, 0.95, 0.2),
        ]
    )  # fmt: skip
    found = regions_of(points, measured, (0.0, measured.height))
    assert [found.names[index] for index in found.of] == [
        "head", "chest, front", "waist, back", "left calf", "right thigh", "hips, front"
    ]  # fmt: skip
    every = regions_of(form.avatar.vertices, measured, (0.0, measured.height))
    assert {"left upper arm", "right forearm", "left hand", "shoulders, back", "neck"} <= set(every.names)
    left = [index for index, name in enumerate(every.names) if name.startswith("left")]
    assert form.avatar.vertices[np.isin(every.of, left), 0].min() >= 0.0


def test_no_fit_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no fit here; make one with toile dress --fit"):
        read_fit(tmp_path)
    (tmp_path / "fit.json").write_text("[]")
    with pytest.raises(InputError, match="holds no fit"):
        read_fit(tmp_path)
