"""The mannequin: made to measure, closed, smooth, and with room for clothes."""

import hashlib

import manifold3d
import numpy as np
import pytest

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.avatar_crossings import crossing_pairs
from toile.dressing.body.avatar_sections import level_cut
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.geometry.errors import InputError

FIGURES = {
    "default": {},
    "child": {"height": 1.0, "chest": 0.56, "waist": 0.53, "hip": 0.58},
    "heavy": {"height": 1.6, "chest": 1.20, "waist": 1.15, "hip": 1.25},
    "slim and tall": {"height": 2.1, "chest": 0.90, "waist": 0.70, "hip": 0.95},
    "man": {"height": 1.8, "chest": 1.02, "waist": 0.88, "hip": 0.98},
}


@pytest.fixture(scope="module")
def figures() -> dict[str, Avatar]:
    return {name: mannequin(**sizes) for name, sizes in FIGURES.items()}


@pytest.mark.parametrize("name", FIGURES)
def test_it_has_the_measurements_asked_for(figures: dict[str, Avatar], name: str) -> None:
    wanted = {"height": 1.70, "chest": 0.92, "waist": 0.74, "hip": 0.98, **FIGURES[name]}
    avatar = figures[name]
    measured = measure(avatar)
    assert measured.height == pytest.approx(wanted["height"], rel=1e-9)
    for girth in ("chest", "waist", "hip"):
        assert getattr(measured, girth) == pytest.approx(wanted[girth], rel=0.015)
    assert np.degrees(measured.arm_angle) == pytest.approx(45.0, abs=1.5)
    assert avatar.vertices[:, 1].min() == 0.0


@pytest.mark.parametrize("name", FIGURES)
def test_it_is_one_clean_solid(figures: dict[str, Avatar], name: str) -> None:
    vertices, faces = figures[name].vertices, figures[name].faces
    solid = manifold3d.Manifold(
        manifold3d.Mesh64(vert_properties=vertices, tri_verts=faces.astype(np.uint64))
    )
    assert solid.status() == manifold3d.Error.NoError
    assert solid.genus() == 0
    assert len(solid.decompose()) == 1
    assert solid.volume() > 0.0
    assert not len(crossing_pairs(vertices, faces))
    assert 10_000 < len(faces) < 25_000


@pytest.mark.parametrize("name", FIGURES)
def test_triangles_are_even(figures: dict[str, Avatar], name: str) -> None:
    vertices, faces = figures[name].vertices, figures[name].faces
    corners = vertices[faces]
    edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    # 1 for equilateral triangles.
    quality = 4.0 * np.sqrt(3.0) * area / (edges**2).sum(axis=1)
    assert quality.min() > 0.05
    assert np.percentile(quality, 5) > 0.7
    low, high = np.percentile(edges, (1, 99))
    assert high < 3.5 * low


@pytest.mark.parametrize("name", FIGURES)
def test_trousers_and_sleeves_have_room(figures: dict[str, Avatar], name: str) -> None:
    avatar = figures[name]
    measured = measure(avatar)
    below_crotch = level_cut(avatar.vertices, avatar.faces, measured.crotch_height - 0.03 * measured.height)
    left = [s for s in below_crotch if 0.0 < s.centre[0] < 0.2 * measured.height]
    right = [s for s in below_crotch if -0.2 * measured.height < s.centre[0] < 0.0]
    assert left[0].low[0] - right[0].high[0] > 0.015 * measured.height
    below_armpit = level_cut(avatar.vertices, avatar.faces, measured.armpit_height - 0.03 * measured.height)
    arms = [s for s in below_armpit if s.centre[0] > 0.1 * measured.height]
    trunk = next(s for s in below_armpit if abs(s.centre[0]) < 0.01)
    assert arms[0].low[0] - trunk.high[0] > 0.01 * measured.height


def test_it_is_nearly_symmetric(figures: dict[str, Avatar]) -> None:
    low, high = figures["default"].vertices.min(axis=0), figures["default"].vertices.max(axis=0)
    assert low[0] + high[0] == pytest.approx(0.0, abs=2e-3)


def test_shoulders_slope_like_shoulders(figures: dict[str, Avatar]) -> None:
    measured = measure(figures["default"])
    fall = measured.neck_height - measured.shoulder_height
    run = 0.5 * (measured.shoulder_width - measured.neck_width)
    assert 14.0 < np.degrees(np.arctan2(fall, run)) < 28.0


def test_the_same_measurements_give_the_same_bytes(figures: dict[str, Avatar]) -> None:
    again = mannequin()

    def digest(avatar: Avatar) -> str:
        return hashlib.sha256(avatar.vertices.tobytes() + avatar.faces.tobytes()).hexdigest()

    assert digest(again) == digest(figures["default"])


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ({"waist": 3.0}, "waist of a figure 1.7 m tall must be"),
        ({"height": 170.0}, "height must be 1.0 to 2.1 m, got 170"),
        ({"chest": float("nan")}, "chest of a figure"),
        ({"hip": -1.0}, "hip of a figure"),
        ({"chest": 0.7, "waist": 1.2, "hip": 0.8}, "do not fit one figure"),
    ],
)
def test_nonsense_is_refused(sizes: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        mannequin(**sizes)
