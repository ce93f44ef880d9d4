"""A skirt that is gathered by elastic along its waist, and stays up by it.

Two rectangles, 1.8 times as wide as the waist; elastic of 85 % of the waist is sewn to their upper edges. Its
tension is printed beside that of elastic that lies straight around the waist.
Run: python examples/gathered_skirt.py [FOLDER]
"""

import sys

import numpy as np
from scipy.spatial import ConvexHull

import toile

FIRM = 25.0
"""Tension of the elastic per strain [N]: 20 mm wide, as in skirts."""
FULL, TIGHT = 1.8, 0.85
"""Girth of the fabric, and of the elastic at rest, over the waist."""


def gathered_skirt(body: toile.Measurements) -> toile.Pattern:
    """Return two rectangles from the waist to the knee, sewn along their sides."""
    wide, top = 0.25 * FULL * body.waist, body.waist_height
    hem = 0.29 * body.height
    corners = ((-wide, hem), (wide, hem), (wide, top), (-wide, top))
    back, front = body.torso_depth
    panels = tuple(
        toile.Panel(
            name=name, vertices=points, translation=(0.0, 0.0, z), label="leg",
            edges=tuple(
                toile.Edge(i, (i + 1) % 4, role="waist" if i == top_edge else None) for i in range(4)
            ),
        )
        for name, points, z, top_edge in (
            ("front", corners, front + 0.05, 2), ("back", corners[::-1], back - 0.05, 0)
        )
    )  # fmt: skip
    seams = (toile.Stitch("front", 1, "back", 1), toile.Stitch("front", 3, "back", 3))
    return toile.Pattern(name="gathered_skirt", panels=panels, stitches=seams)


def tension(skirt: toile.DressedGarment) -> tuple[float, float]:
    """Return the mean tension of the elastic [N], and that of one that lies straight around the waist."""
    top = skirt.uv[:, 1].max()
    on_waist = np.isclose(skirt.uv[:, 1], top)[skirt.uv_faces]
    around = now = rest = 0.0
    ring = []
    for k in range(3):
        side = np.flatnonzero(on_waist[:, k] & on_waist[:, (k + 1) % 3])
        a, b = skirt.faces[side, k], skirt.faces[side, (k + 1) % 3]
        now += np.linalg.norm(skirt.positions[b] - skirt.positions[a], axis=1).sum()
        a, b = skirt.uv_faces[side, k], skirt.uv_faces[side, (k + 1) % 3]
        rest += TIGHT / FULL * np.linalg.norm(skirt.uv[b] - skirt.uv[a], axis=1).sum()
        ring.append(skirt.positions[skirt.faces[side, k]])
    # In the plane the area of a hull is its girth.
    around = ConvexHull(np.concatenate(ring)[:, [0, 2]]).area
    return FIRM * (now / rest - 1.0), FIRM * (around / rest - 1.0)


def main(output: str = "out", edge_length: float | None = None) -> toile.Result:
    """Draft the skirt, dress the mannequin in it and compare the pull of its elastic with theory."""
    toile.register_draft("gathered_skirt", gathered_skirt)
    elastic = toile.Elastic(run="waist", rest=TIGHT / FULL, stiffness=FIRM)
    garment = toile.Garment("gathered_skirt", fabric="cotton-poplin", elastic=(elastic,))
    scene = toile.Scene(garments=[garment], quality="preview", edge_length=edge_length)
    result = toile.dress(scene, output=output, say=print)
    height = 100.0 * result.garments[0].positions[:, 1].max()
    pull, straight = tension(result.garments[0])
    print(f"{result.status}: the waist is at {height:.0f} cm")
    print(f"its elastic pulls with {pull:.2f} N, if it lay straight with {straight:.2f} N")
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
