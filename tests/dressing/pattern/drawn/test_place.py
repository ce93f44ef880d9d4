"""Drawn pieces on a body: sides, heights, and sleeves rolled around the arm without being stretched."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.body.measurements import Measurements
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.drawn.freesewing_svg import read_freesewing_svg
from toile.dressing.pattern.drawn.piece import DrawnPattern
from toile.dressing.pattern.drawn.place import place_by_words, placed_pattern
from toile.dressing.pattern.drawn.suggest import suggest_seams
from toile.dressing.pattern.garmentcode import read_garmentcode
from toile.dressing.pattern.garmentcode_write import write_garmentcode
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

SAMPLES = Path(__file__).parent / "samples"
BODY = Measurements(
    height=1.66, neck=0.33, chest=0.98, waist=0.80, hip=1.05, upper_arm=0.30, wrist=0.16, thigh=0.60,
    shoulder_width=0.34, neck_width=0.12, arm_length=0.50, inseam=0.76, neck_height=1.415,
    shoulder_height=1.37,
    armpit_height=1.245, chest_height=1.24, waist_height=1.08, hip_height=0.80, crotch_height=0.76,
    arm_angle=0.73, shoulder_point=(0.174, 1.37, -0.02), torso_depth=(-0.145, 0.143),
)  # fmt: skip


def sewn(design: str) -> DrawnPattern:
    drawn = read_freesewing_svg(SAMPLES / f"freesewing_{design}_34.svg")
    return replace(drawn, seams=suggest_seams(drawn).sure)


@pytest.fixture(scope="module")
def tee() -> GarmentMesh:
    return mesh_pattern(placed_pattern(sewn("teagan"), BODY, {}, None), edge_length=0.03)


def vertices(mesh: GarmentMesh, panel: str) -> Float:
    used = np.unique(mesh.faces[mesh.panel == mesh.panel_names.index(panel)])
    return np.asarray(mesh.positions[used])


def test_front_and_back_hang_flat_on_their_sides_of_the_body(tee: GarmentMesh) -> None:
    front, back = vertices(tee, "front"), vertices(tee, "back")
    assert front[:, 2] == pytest.approx(0.193) and back[:, 2] == pytest.approx(-0.195)
    assert front[:, 1].max() == pytest.approx(back[:, 1].max())
    assert 1.38 < front[:, 1].max() < 1.45
    # The neck of the front is cut deeper.
    middle = [np.abs(points[:, 0]) < 0.02 for points in (front, back)]
    assert front[middle[0], 1].max() < back[middle[1], 1].max() - 0.03


def test_right_sides_face_away_from_the_body(tee: GarmentMesh) -> None:
    corners = tee.positions[tee.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    centre = np.array([0.0, 1.2, 0.0])
    for index, panel in enumerate(tee.panel_names):
        own = tee.panel == index
        middle = corners[own].mean(axis=1)
        axis = vertices(tee, panel).mean(axis=0) if panel.startswith("sleeve") else centre
        assert (np.einsum("ij,ij->i", normal[own], middle - axis) > 0.0).mean() > 0.95, panel


def test_a_rolled_sleeve_keeps_its_lengths(tee: GarmentMesh) -> None:
    rolled = np.isin(tee.panel, [tee.panel_names.index(name) for name in ("sleeve", "sleeve~")])
    ends = tee.faces[rolled]
    space = np.linalg.norm(tee.positions[ends] - tee.positions[np.roll(ends, -1, axis=1)], axis=2)
    flat = np.linalg.norm(tee.uv[ends] - tee.uv[np.roll(ends, -1, axis=1)], axis=2)
    # Chords of a cylinder of 6 cm are shorter than its arcs by (length / radius)^2 / 24.
    assert np.abs(space / flat - 1.0).max() < (flat.max() / 0.055) ** 2 / 24
    assert tee.flat


def test_sleeves_surround_the_arms_with_their_fronts_in_front(tee: GarmentMesh) -> None:
    for name, side in (("sleeve", -1.0), ("sleeve~", 1.0)):
        points = vertices(tee, name)
        assert (np.sign(points[:, 0]) == side).all()
        assert np.ptp(points[:, 2]) > 0.09
    start, end = (tee.positions[tee.stitches[:, side]] for side in (0, 1))
    gaps = np.linalg.norm(start - end, axis=1)
    assert gaps.max() < 0.42
    caps = [
        n for n, name in enumerate(tee.seam_names) if "sleeve" in name and ("front" in name or "back" in name)
    ]
    assert gaps[np.isin(tee.seam, caps)].max() < 0.25


def test_the_hem_goes_down_whichever_way_a_piece_lies() -> None:
    drawn = sewn("teagan")
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    lying = replace(
        drawn,
        pieces=tuple(
            replace(p, edges=tuple(edge @ turn.T for edge in p.edges), warp_degrees=p.warp_degrees - 90.0)
            for p in drawn.pieces
        ),
    )
    upright, turned = (
        mesh_pattern(placed_pattern(d, BODY, {}, None), edge_length=0.03) for d in (drawn, lying)
    )
    assert turned.positions == pytest.approx(upright.positions, abs=1e-9)
    assert turned.rest_corners == pytest.approx(upright.rest_corners, abs=1e-9)


def test_trousers_start_at_the_waist_with_their_crotch_in_the_middle() -> None:
    pattern = placed_pattern(sewn("titan"), BODY, {}, "bottom")
    mesh = mesh_pattern(pattern, edge_length=0.04)
    assert mesh.positions[:, 1].max() == pytest.approx(1.09)
    for seam, name in enumerate(mesh.seam_names):
        if "~" in name and name.split(" - ")[0].split(".")[0] == name.split(" - ")[1].split("~")[0]:
            pairs = mesh.positions[mesh.stitches[mesh.seam == seam]]
            assert np.abs(pairs[..., 0]).max() < 0.25
    low = vertices(mesh, "front")
    assert low[:, 0].min() * low[:, 0].max() > 0.0


def test_a_roll_survives_garmentcode(tmp_path: Path) -> None:
    pattern = placed_pattern(sewn("teagan"), BODY, {}, None)
    write_garmentcode(pattern, tmp_path / "p_specification.json")
    back = mesh_pattern(read_garmentcode(tmp_path / "p_specification.json"), edge_length=0.03)
    for name in ("sleeve", "front"):
        assert vertices(back, name).min(axis=0) == pytest.approx(
            vertices(mesh_pattern(pattern, edge_length=0.03), name).min(axis=0), abs=5e-3
        )


def test_words_say_where_pieces_go() -> None:
    assert place_by_words("TEAGAN-SL_34 SLEEVE SHORT") == "sleeve"
    assert place_by_words("frontSideDart") == "front"
    assert place_by_words("Pattern2D_768516") is None
    assert place_by_words("waistband") == "waistband"


def test_a_piece_without_a_place_is_asked_for() -> None:
    drawn = sewn("teagan")
    nameless = replace(drawn, pieces=tuple(replace(p, words="x") for p in drawn.pieces))
    with pytest.raises(InputError, match=r"where piece 'front' goes on the body.*place = \"front\""):
        placed_pattern(nameless, BODY, {}, None)
