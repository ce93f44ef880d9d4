"""A skirt that is gathered by elastic along its waist, and stays up by it.

Two rectangles, 1.8 times as wide as the waist; elastic of 85 % of the waist is sewn to their upper edges. Its
tension is printed. Run: python examples/gathered_skirt.py [FOLDER]
"""

import sys

import numpy as np

import toile

FIRM = 25.0
"""Tension of the elastic per strain [N]: 20 mm wide, as in skirts."""
FULL, TIGHT = 1.8, 0.85
"""Girth of the fabric, and of the elastic at rest, over the waist."""


def gathered_skirt(body: toile.Measurements) -> toile.Pattern:
    """Return two rectangles from the waist to the knee, sewn along their sides."""
    wide, hem, top = 0.25 * FULL * body.waist, 0.29 * body.height, body.waist_height
    corners = ((-wide, hem), (wide, hem), (wide, top), (-wide, top))
    back, front = (z + gap for z, gap in zip(body.torso_depth, (-0.05, 0.05), strict=True))
    panels = tuple(
        toile.Panel(
            name=name, vertices=points, translation=(0.0, 0.0, z), label="leg",
            edges=tuple(toile.Edge(i, (i + 1) % 4, role="waist" if i == up else None) for i in range(4)),
        )
        for name, points, z, up in (("front", corners, front, 2), ("back", corners[::-1], back, 0))
    )  # fmt: skip
    seams = (toile.Stitch("front", 1, "back", 1), toile.Stitch("front", 3, "back", 3))
    return toile.Pattern(name="gathered_skirt", panels=panels, stitches=seams)


def tension(skirt: toile.DressedGarment) -> float:
    """Return the mean tension of the elastic [N]: of the edges along the top."""
    top = np.isclose(skirt.uv[:, 1], skirt.uv[:, 1].max())[skirt.uv_faces]
    now = rest = 0.0
    for k in range(3):
        side = np.flatnonzero(top[:, k] & top[:, (k + 1) % 3])
        ends, drawn = (faces[side][:, [k, (k + 1) % 3]] for faces in (skirt.faces, skirt.uv_faces))
        now += np.linalg.norm(np.diff(skirt.positions[ends], axis=1), axis=2).sum()
        rest += TIGHT / FULL * np.linalg.norm(np.diff(skirt.uv[drawn], axis=1), axis=2).sum()
    return float(FIRM * (now / rest - 1.0))


def main(output: str = "out", edge_length: float | None = None) -> toile.Result:
    """Register the draft and dress the mannequin in it."""
    toile.register_draft("gathered_skirt", gathered_skirt)
    elastic = toile.Elastic(run="waist", rest=TIGHT / FULL, stiffness=FIRM)
    garment = toile.Garment("gathered_skirt", fabric="cotton-poplin", elastic=(elastic,))
    scene = toile.Scene(garments=[garment], quality="preview", edge_length=edge_length)
    result = toile.dress(scene, output=output, say=print)
    print(f"{result.status}: the elastic pulls with {tension(result.garments[0]):.2f} N")
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
