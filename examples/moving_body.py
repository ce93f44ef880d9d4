"""A body that moves: the mannequin turns about itself, and its circle skirt flies, frame by frame.

Any body will do whose vertices are known over time: VertexMotion holds them. Frames go to FOLDER/frames.
Run: python examples/moving_body.py [FOLDER]
"""

import sys
from dataclasses import replace

import numpy as np

import toile

FPS = 24.0
TURN = 120.0
"""How far it turns in half a second [degrees]."""


def turning(body: toile.Avatar, frames: int, degrees: float) -> toile.VertexMotion:
    """Return the body as it turns about the vertical, slowly at first."""
    poses = []
    for share in np.linspace(0.0, 1.0, frames + 1):
        angle = np.radians(degrees) * share**2
        cosine, sine = np.cos(angle), np.sin(angle)
        turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
        poses.append(body.vertices @ turn.T)
    return toile.VertexMotion(frames=np.stack(poses), fps=FPS)


def main(output: str = "out", frames: int = 10, edge_length: float = 0.024) -> toile.Result:
    """Hang the skirt on the body as it stands, then let the body turn faster and faster."""
    body = toile.mannequin()
    dancer = replace(body, motion=turning(body, frames, TURN * (frames / 12) ** 2))
    scene = toile.Scene(
        avatar=dancer,
        garments=[toile.Garment("circle_skirt", fabric="cotton-poplin")],
        air=toile.Air(),
        quality="preview",
        edge_length=edge_length,
    )
    result = toile.dress(scene, output=output, say=print)
    print(f"{result.status}: {result.report['animation']['frames']} frames")
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
