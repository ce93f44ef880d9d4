"""The mannequin with a skeleton of three joints, as glTF, whose clip begins with its arms hanging."""

import numpy as np
from scipy.spatial.transform import Rotation

from tests.dressing.files.gltf_writer import Glb
from toile.dressing.body.mannequin import mannequin
from toile.geometry.arrays import Float

FPS = 24.0
PLACES = np.array([[0.0, 1.0, 0.0], [0.18, 1.32, 0.0], [-0.18, 1.32, 0.0]])
"""Hips, left and right shoulder in the pose of binding [m]."""


def skinned_mannequin(
    *, down: float, frames: int, at: tuple[float, float, float], own: float = 0.0, facing: float = 0.0
) -> Glb:
    """Return a body whose arms are `down` degrees below those of the mannequin, and rise by 4 in the clip.

    It begins at a place [m] on the floor, faces an angle about Y [degrees], and walks 5 cm along +Z. Arms of
    the nodes without animation are `own` degrees below the mannequin's.
    """
    body = mannequin()
    glb = Glb()
    weights = np.zeros((len(body.vertices), 4))
    weights[:, :3] = joint_weights(body.vertices)
    joints = np.tile([0, 1, 2, 0], (len(body.vertices), 1))
    mesh = glb.mesh(
        body.vertices,
        body.faces,
        attributes={"JOINTS_0": glb.numbers(joints, "<u1"), "WEIGHTS_0": glb.numbers(weights)},
    )
    arms = [
        glb.node(
            root=False, translation=list(PLACES[arm] - PLACES[0]), rotation=_turn("z", sign * own)[0].tolist()
        )
        for arm, sign in ((1, -1.0), (2, 1.0))
    ]
    hips = glb.node(translation=list(PLACES[0]), children=arms)
    bind = np.tile(np.eye(4), (3, 1, 1))
    bind[:, :3, 3] = -PLACES
    skin = glb.add("skins", joints=[hips, *arms], inverseBindMatrices=glb.numbers(bind.swapaxes(1, 2)))
    glb.node(mesh=mesh, skin=skin)
    times = np.array([0.0, (frames - 1) / FPS])
    for node, sign in zip(arms, (-1.0, 1.0), strict=True):
        glb.animate(node, "rotation", times, _turn("z", sign * down, sign * (down - 4.0)))
    place = np.array(at) + PLACES[0]
    glb.animate(hips, "translation", times, [place, place + np.array([0.0, 0.0, 0.05])])
    glb.animate(hips, "rotation", times, _turn("y", facing, facing))
    return glb


def _turn(axis: str, *degrees: float) -> Float:
    """Return quaternions about an axis, shape (k, 4)."""
    return np.asarray(Rotation.from_euler(axis, np.array(degrees)[:, None], degrees=True).as_quat())


def joint_weights(vertices: Float) -> Float:
    """Return the weights of hips, left and right arm, shape (v, 3)."""
    x, y = np.abs(vertices[:, 0]) - PLACES[1, 0], vertices[:, 1] - PLACES[1, 1]
    along, across = np.sqrt(0.5) * (x - y), np.sqrt(0.5) * (x + y)
    arm = _smooth((along + 0.02) / 0.14) * _smooth((across + 0.13) / 0.05)
    left = vertices[:, 0] > 0.0
    return np.stack([1.0 - arm, np.where(left, arm, 0.0), np.where(left, 0.0, arm)], axis=1)


def _smooth(share: Float) -> Float:
    """Return a cubic step from 0 to 1."""
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(s * s * (3.0 - 2.0 * s))
