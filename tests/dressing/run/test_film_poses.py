"""Films of bodies that touch themselves: arms that rub the trunk, seats, hands that rest on thighs."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.mannequin_figure import ARM_ANGLE, SHOULDER
from toile.dressing.run.dress import dress
from toile.dressing.run.follow import TIGHT
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.geometry.arrays import Float

BODY = mannequin()
HEIGHT = float(BODY.vertices[:, 1].max())
HIP, KNEE = np.array([0.0, 0.53 * HEIGHT, 0.0]), np.array([0.0, 0.28 * HEIGHT, 0.0])
FRAMES = 12


def eased(share: Float) -> Float:
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(s * s * (3.0 - 2.0 * s))


def turned(points: Float, angle: Float, axis: int, about: Float) -> Float:
    """Points, shape (v, 3), each turned by its own angle [rad] about an axis through a point."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    arm = points - about
    moved = arm.copy()
    moved[:, first] = np.cos(angle) * arm[:, first] - np.sin(angle) * arm[:, second]
    moved[:, second] = np.sin(angle) * arm[:, first] + np.cos(angle) * arm[:, second]
    return np.asarray(about + moved)


def posed(lowered: float = 0.0, ahead: float = 0.0, seat: float = 0.0) -> Float:
    """Vertices [m] of the mannequin with its arms lowered and moved ahead, and thighs raised [rad]."""
    v = BODY.vertices
    x, y = v[:, 0] / HEIGHT, v[:, 1] / HEIGHT
    side, cosine, sine = np.sign(x), np.cos(ARM_ANGLE), np.sin(ARM_ANGLE)
    along = (np.abs(x) - SHOULDER[0]) * cosine - (y - SHOULDER[1]) * sine
    across = (np.abs(x) - SHOULDER[0]) * sine + (y - SHOULDER[1]) * cosine
    arm = eased((along + 0.03) / 0.08) * eased((across + 0.075) / 0.045)
    no_arm = arm == 0.0
    v = turned(v, seat * eased((KNEE[1] / HEIGHT + 0.03 - y) / 0.06) * no_arm, 0, KNEE)
    leg = eased((HIP[1] / HEIGHT - y) / 0.09) * np.clip(np.abs(x) / 0.02, 0.0, 1.0) * no_arm
    v = turned(v, -seat * leg, 0, HIP)
    shoulder = HEIGHT * np.column_stack((side * SHOULDER[0], np.full_like(x, SHOULDER[1]), np.zeros_like(x)))
    v = turned(v, -side * arm * lowered, 2, shoulder)
    return turned(v, -arm * ahead, 0, shoulder)


def arm_to_body(vertices: Float) -> float:
    """Distance between the hands and forearms and the trunk and legs [m]."""
    x, y = np.abs(BODY.vertices[:, 0]) / HEIGHT, BODY.vertices[:, 1] / HEIGHT
    arm, other = (x > 0.25) & (y > 0.4), (x < 0.11) & (y < 0.75)
    return float(np.min(cKDTree(vertices[other]).query(vertices[arm])[0]))


@pytest.mark.parametrize(
    ("garment", "pose"),
    [
        pytest.param("tshirt", {"lowered": 50.0}, id="arms rub the trunk"),
        pytest.param(
            "trousers",
            {"lowered": 50.0, "ahead": 52.0, "seat": 90.0},
            id="on a seat, hands on the thighs",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_body_that_touches_itself(garment: str, pose: dict[str, float], tmp_path: Path) -> None:
    radians = {name: float(np.radians(angle)) for name, angle in pose.items()}
    assert arm_to_body(BODY.vertices) > 0.1 > 0.02 > arm_to_body(posed(**radians))
    frames = np.stack(
        [
            posed(**{name: share * angle for name, angle in radians.items()})
            for share in np.linspace(0.0, 1.0, FRAMES)
        ]
    )
    np.savez(tmp_path / "body.npz", vertices=frames, faces=BODY.faces, fps=24.0)
    scene = Scene(
        garments=[Garment(garment)], avatar=AvatarFile(path=tmp_path / "body.npz"), quality="preview",
        edge_length=0.05, remesh=False,
    )  # fmt: skip
    result = dress(scene)
    assert result.failure is None, result.failure
    animation = result.report["animation"]
    assert animation["frames"] == FRAMES - 1 and animation["intersections_max"] == 0
    assert animation["steps_kept_unsolved"] == 0 and animation["strain_percent_max"] < 100.0 * TIGHT
