"""A skirt of twelve knife pleats: one strip, three times as long as the skirt is round, and 24 folds.

It starts pleated, held along its top, and hangs; how many places have their three layers in order is printed.
Run: python examples/pleated_skirt.py [FOLDER]
"""

import sys
from dataclasses import replace

import numpy as np
from scipy.interpolate import LinearNDInterpolator

import toile
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.geometry.arrays import Float

PLEATS, RADIUS, TOP, LENGTH = 12, 0.2, 1.02, 0.45
"""Radius of the waistband, its height, and how far the skirt hangs below it [m]."""
WIDTH = 2.0 * np.pi * RADIUS / PLEATS
"""What is seen of a pleat [m]: it takes three times as much cloth."""
GAP = 0.004
"""Between layers at the start [m]."""


def pattern() -> toile.Pattern:
    """Return the strip; every pleat turns back under itself, and forward again under that."""
    corners = ((0.0, 0.0), (3 * PLEATS * WIDTH, 0.0), (3 * PLEATS * WIDTH, LENGTH), (0.0, LENGTH))
    places = [(place, sign) for k in range(PLEATS) for place, sign in ((3 * k + 1, -1.0), (3 * k + 2, 1.0))]
    skirt = toile.Panel(
        name="skirt", vertices=corners, label="leg",
        edges=tuple(toile.Edge(i, (i + 1) % 4, label="waistband" if i == 2 else "") for i in range(4)),
        folds=tuple(toile.Fold(((x * WIDTH, 0.0), (x * WIDTH, LENGTH)), 180.0 * sign) for x, sign in places),
    )  # fmt: skip
    return toile.Pattern(name="pleated", panels=(skirt,), stitches=(toile.Stitch("skirt", 1, "skirt", 3),))


def pleated(uv: Float) -> Float:
    """Return where points of the strip start [m], shape (n, 3): layers lie on each other as shingles do."""
    pleat = np.minimum(np.floor(uv[:, 0] / (3.0 * WIDTH) + 1e-9), PLEATS - 1)
    layer = uv[:, 0] / WIDTH - 3.0 * pleat
    along = np.where(layer <= 1.0, layer, np.where(layer <= 2.0, 2.0 - layer, layer - 2.0))
    under = np.where(layer <= 1.0, along, np.where(layer <= 2.0, 2.0 * along - 1.0, along - 1.0))
    angle, radius = 2.0 * np.pi / PLEATS * (pleat + along), RADIUS + GAP * under
    return np.column_stack((radius * np.sin(angle), TOP - LENGTH + uv[:, 1], radius * np.cos(angle)))


def in_order(skirt: toile.DressedGarment) -> float:
    """Return the share of places across all pleats that have their layers in order from the outside."""
    node = np.empty(len(skirt.uv), np.int32)
    node[skirt.uv_faces] = skirt.faces
    x = skirt.positions[node]
    radius = LinearNDInterpolator(skirt.uv, np.hypot(x[:, 0], x[:, 2]))
    pleat, along, up = np.meshgrid(
        np.arange(PLEATS), np.linspace(0.1, 0.9, 9), np.linspace(0.02, LENGTH - 0.02, 20)
    )
    outer, middle, inner = (
        radius(np.column_stack(((3 * pleat + place).ravel() * WIDTH, up.ravel())))
        for place in (along, 2.0 - along, 2.0 + along)
    )
    return float(((outer > middle) & (middle > inner)).mean())


def main(output: str = "out", edge_length: float = 0.0125) -> toile.Result:
    """Mesh the strip along its folds, pleat it, and let it hang."""
    mesh = mesh_pattern(pattern(), edge_length=edge_length)
    skirt = replace(mesh, positions=pleated(mesh.uv))
    garment = toile.Garment(skirt, fabric="wool-worsted", pins=("waistband",))
    scene = toile.Scene(garments=[garment], quality="preview", edge_length=edge_length, remesh=False)
    result = toile.dress(scene, output=output, say=print)
    print(f"{result.status}: {in_order(result.garments[0]):.1%} of the pleats lie in order")
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
