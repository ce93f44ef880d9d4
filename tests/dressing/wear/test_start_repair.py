import numpy as np
import pytest
import trimesh

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.start_repair import FARTHEST, clear_panels, lift_over_shoulders
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
FACES = np.array([(0, 1, 2), (0, 2, 3)], np.int32)


def box(side: float) -> tuple[Float, Int]:
    """A cube around the origin, edge length in metres."""
    cube = trimesh.creation.box(extents=(side, side, side))
    return np.ascontiguousarray(cube.vertices, np.float64), np.ascontiguousarray(cube.faces, np.int32)


def panels(half: float, *z: float, flat: bool = True) -> GarmentMesh:
    """Squares of half width `half` [m] at heights z, front panels facing +z, others -z; corners sewn."""
    count = len(z)
    back = np.array([-1.0, 1.0])
    sheets = [half * (SQUARE if level >= 0.0 else SQUARE * back) for level in z]
    positions = [np.column_stack((uv, np.full(4, level))) for uv, level in zip(sheets, z, strict=True)]
    return GarmentMesh(
        name="shirt",
        positions=np.concatenate(positions),
        uv=np.tile(half * SQUARE, (count, 1)),
        faces=np.concatenate([FACES + 4 * k for k in range(count)]).astype(np.int32),
        panel=np.repeat(np.arange(count, dtype=np.int32), 2),
        panel_names=tuple(f"panel {k}" for k in range(count)),
        rest_corners=np.tile(half * SQUARE[FACES], (count, 1, 1)),
        stitches=np.array([(3, 6), (2, 7)] if count == 2 else np.empty((0, 2)), np.int32),
        seam=np.zeros(2 if count == 2 else 0, np.int32),
        seam_names=("shoulder",),
        flat=flat,
        minimum_angle=45.0,
    )


def test_panel_that_cuts_the_body_moves_clear_and_the_rest_stays() -> None:
    start = panels(0.25, 0.05, -0.3)
    (moved,), notes = clear_panels([start], box(0.2))
    assert np.array_equal(moved.positions[4:], start.positions[4:])
    shift = moved.positions[:4] - start.positions[:4]
    assert np.ptp(shift, axis=0) == pytest.approx(0.0, abs=1e-12)
    assert shift[0, :2] == pytest.approx([0.0, 0.0])
    assert 0.05 < shift[0, 2] < 0.09
    (note,) = notes
    assert note.startswith("garment shirt: panel panel 0 cut the body")


def test_back_panel_moves_backward() -> None:
    (moved,), _ = clear_panels([panels(0.25, -0.05)], box(0.2))
    assert moved.positions[:, 2].max() < -0.1


def test_clear_panels_and_curved_garments_stay() -> None:
    clear = panels(0.25, 0.2, -0.2)
    (same,), notes = clear_panels([clear], box(0.2))
    assert np.array_equal(same.positions, clear.positions) and notes == ()
    curved = panels(0.25, 0.05, flat=False)
    assert clear_panels([curved], box(0.2)) == ([curved], ())


def test_panels_that_cross_each_other_are_parted() -> None:
    start = panels(0.25, 0.2, -0.2)
    upright = start.positions.copy()
    # The second panel cuts across the first.
    upright[4:] = np.column_stack((np.zeros(4), 0.25 * SQUARE[:, 1], 0.2 + 0.25 * SQUARE[:, 0]))
    crossed = GarmentMesh(**{**vars(start), "positions": upright})
    (parted,), notes = clear_panels([crossed], box(0.1))
    assert notes
    (same,), said = clear_panels([parted], box(0.1))
    assert said == () and np.array_equal(same.positions, parted.positions)


def test_hopeless_panel_is_named() -> None:
    with pytest.raises(InputError, match=rf"garment shirt: panel panel 0 cuts the body.*{FARTHEST:g} m"):
        clear_panels([panels(4.0, 0.0)], box(3.0))


def test_garment_is_lifted_until_its_shoulder_seams_pass_over_the_body() -> None:
    """The seams start at y = 0.05, the body's top is at y = 0.1."""
    start = panels(0.05, 0.3, -0.3)
    lifted, notes = lift_over_shoulders(start, box(0.2))
    rise = lifted.positions - start.positions
    assert np.ptp(rise, axis=0) == pytest.approx(0.0, abs=1e-12)
    assert 0.1 < rise[0, 1] < 0.14
    assert rise[0, [0, 2]] == pytest.approx([0.0, 0.0])
    assert "higher so that its seams close over the body" in notes[0]
    above, said = lift_over_shoulders(lifted, box(0.2))
    assert above is lifted and said == ()
    assert lift_over_shoulders(start, None) == (start, ())
