"""Garments worn over each other: put on one after the other, hung together."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from tests.engine.step.test_only_what_is_asked import SLACK, sheet
from toile.collide.audit import Auditor
from toile.dressing.run.dress import dress
from toile.dressing.run.progress import ProgressState
from toile.dressing.run.result import DressedGarment, Result
from toile.dressing.run.scene import Garment, Scene
from toile.dressing.wear.worn import Worn, worn_together
from toile.engine.cloth.fabric import Fabric


def test_what_is_worn_moves_with_the_body() -> None:
    """A garment on a ball that is shrunk and turned keeps its place on it."""
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.3)
    vertices, faces = np.asarray(ball.vertices, np.float64), np.asarray(ball.faces, np.int32)
    cloth = sheet(SLACK)
    points = cloth.positions - cloth.positions.mean(axis=0) + np.array([0.0, 0.0, 2.0])
    on_ball = 0.302 * points / np.linalg.norm(points, axis=1)[:, None]

    worn = Worn(vertices, faces, [replace(cloth, positions=on_ball)])
    assert np.array_equal(worn.on(vertices)[: len(vertices)], vertices)
    assert np.allclose(worn.on(vertices)[len(vertices) :], on_ball)
    assert len(worn.faces) == len(faces) + len(cloth.faces) and worn.faces.dtype == np.int32
    smaller = worn.on(0.9 * vertices)[len(vertices) :]
    assert np.abs(np.linalg.norm(smaller, axis=1) - (0.302 - 0.03)).max() < 1e-3
    assert np.array_equal(Worn(vertices, faces, []).on(0.9 * vertices), 0.9 * vertices)


def test_garments_worn_together_are_one_cloth() -> None:
    other = Fabric(**{**vars(SLACK), "name": "other", "areal_density": 0.3})
    one, two = sheet(SLACK), sheet(other)
    both = worn_together([one, two])
    assert both.mass.sum() == pytest.approx(one.mass.sum() + two.mass.sum())
    assert [fabric.name for fabric in both.fabrics] == ["slack", "other"]
    assert np.array_equal(both.garment, np.repeat([0, 1], len(one.faces)))
    assert np.array_equal(both.face_nodes[len(one.faces) :], two.face_nodes + len(one.positions))
    assert both.faces.dtype == both.node.dtype == np.int32


def share_outside(over: DressedGarment, under: DressedGarment) -> float:
    """Share of the nodes of one garment, where it touches another, that lie on its right side."""
    normals = np.zeros_like(under.positions)
    corners = under.positions[under.faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    np.add.at(normals, under.faces.ravel(), np.repeat(across, 3, axis=0))
    distance, nearest = cKDTree(under.positions).query(over.positions)
    close = np.asarray(distance) < 0.006
    side = np.einsum("ij,ij->i", over.positions - under.positions[nearest], normals[nearest])
    assert close.sum() > 50
    return float((side[close] > 0.0).mean())


def two_shirts() -> Scene:
    return Scene(
        garments=[Garment("tshirt", name="under"), Garment("tshirt", name="over", fabric="denim-12oz")],
        quality="preview",
    )


def test_one_shirt_over_another() -> None:
    result: Result = dress(two_shirts())
    assert result.status == "converged", result.report["failure"]
    under, over = result.garments
    assert (under.name, over.name, over.fabric.name) == ("under", "over", "denim-12oz")
    assert result.report["intersections"] == {"avatar": 0, "self": 0, "worst_frame": 0}
    assert share_outside(over, under) > 0.98
    positions = np.concatenate([under.positions, over.positions])
    faces = np.concatenate([under.faces, over.faces + len(under.positions)]).astype(np.int32)
    found = Auditor(result.avatar.vertices, result.avatar.faces).audit(
        positions, faces, np.arange(len(positions), dtype=np.int32)
    )
    assert not len(found.avatar) and not len(found.cloth)


def test_cancelled_while_the_first_is_put_on() -> None:
    seen: list[int] = []

    def progress(state: ProgressState) -> bool:
        seen.append(state.frame)
        return len(seen) < 2

    result = dress(two_shirts(), progress=progress)
    assert result.status == "cancelled"
    assert [garment.name for garment in result.garments] == ["under"]
    assert seen[:2] == [0, 1]
