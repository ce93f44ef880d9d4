"""A flared panel that starts between the body and the panel it hangs from is moved outside it."""

from dataclasses import replace

import numpy as np
import pytest

from tests.dressing.wear.test_start_repair import panels
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.layer_order import BEYOND, flared_outside
from toile.geometry.arrays import Float, Int


def ring(inner: float, outer: float, half_angle: float) -> tuple[Float, Int]:
    """A ring around the origin, open at the top: points (n, 2), the inner arc first, and faces."""
    angle = np.linspace(-np.pi / 2 - half_angle, -np.pi / 2 + half_angle, 41)
    around = np.column_stack((np.cos(angle), np.sin(angle)))
    k = np.arange(40)
    faces = np.concatenate([np.stack([k, k + 41, k + 42], 1), np.stack([k, k + 42, k + 1], 1)])
    return np.concatenate([inner * around, outer * around]), faces.astype(np.int32)


def peplum(depth: float, *, half_angle: float = 2.5, sign: float = 1.0) -> GarmentMesh:
    """A bodice 0.2 m from the body's middle, and a ring sewn to its lower edge at another depth."""
    top, (points, faces) = panels(0.2, sign * 0.2), ring(0.1, 0.25, half_angle)
    x = np.linspace(-0.2, 0.2, 41)
    bodice = np.concatenate([np.column_stack((x, np.full(41, y))) for y in np.linspace(0.0, 0.4, 41)])
    k = (41 * np.arange(40)[:, None] + np.arange(40)).ravel()
    squares = np.concatenate([np.stack([k, k + 1, k + 42], 1), np.stack([k, k + 42, k + 41], 1)])
    uv = np.concatenate([bodice, points])
    z = np.concatenate([np.full(len(bodice), 0.2), np.full(len(points), depth)])
    both = np.concatenate([squares, faces + len(bodice)]).astype(np.int32)
    if sign < 0.0:
        both = both[:, ::-1].copy()
    return replace(
        top, positions=np.column_stack((uv, sign * z)), uv=uv, faces=both,
        panel=np.repeat(np.array([0, 1], np.int32), [len(squares), len(faces)]), panel_names=("top", "skirt"),
        rest_corners=uv[both], seam=np.zeros(41, np.int32),
        stitches=np.column_stack((np.arange(41), len(bodice) + np.arange(41))).astype(np.int32),
    )  # fmt: skip


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_flared_panel_behind_the_bodice_comes_in_front(sign: float) -> None:
    start = peplum(0.17, sign=sign)
    moved, notes = flared_outside(start)
    rise = moved.positions - start.positions
    bodice = 41 * 41
    assert np.array_equal(moved.positions[:bodice], start.positions[:bodice])
    assert np.ptp(rise[bodice:], axis=0) == pytest.approx(0.0, abs=1e-12)
    assert rise[-1] == pytest.approx([0.0, 0.0, sign * (0.03 + BEYOND)])
    assert notes == ("garment shirt: panel skirt starts 5 cm farther out, outside the panel it hangs from",)
    assert flared_outside(moved)[1] == ()


def test_what_is_outside_straight_or_apart_stays() -> None:
    for mesh in (peplum(0.25), replace(peplum(0.17), flat=False)):
        assert flared_outside(mesh) == (mesh, ())
    narrow = peplum(0.17, half_angle=0.3)
    assert flared_outside(narrow) == (narrow, ())
    start = peplum(0.17)
    below = start.positions.copy()
    below[41 * 41 :, 1] -= 0.5
    apart = replace(start, positions=below)
    assert flared_outside(apart) == (apart, ())
