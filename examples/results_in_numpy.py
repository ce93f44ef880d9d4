"""Results in numpy: where a T-shirt is stretched, panel by panel, from positions and UVs alone.

Run: python examples/results_in_numpy.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

import toile
from toile.geometry.arrays import Float


def strain(garment: toile.DressedGarment) -> Float:
    """Return the strain of every face along warp and weft, shape (t, 2)."""
    places = garment.positions[garment.faces]  # (t, 3, 3): corners of every face in space [m]
    flat = garment.uv[garment.uv_faces]  # (t, 3, 2): the same corners in the pattern [m]
    rest = np.stack([flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]], axis=2)
    now = np.stack([places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]], axis=2)
    deformation = now @ np.linalg.inv(rest)  # (t, 3, 2)
    # The pattern's y runs along the warp.
    return np.asarray(np.linalg.norm(deformation, axis=1)[:, ::-1] - 1.0)


def areas(garment: toile.DressedGarment) -> Float:
    """Return the area of every face in the pattern [m^2], shape (t,)."""
    a, b, c = np.moveaxis(garment.uv[garment.uv_faces], 1, 0)
    return np.asarray(0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]))


def main(output: str = "out", edge_length: float | None = None) -> toile.Result:
    """Drape a shirt, print a table of its panels and write the arrays."""
    scene = toile.Scene(garments=[toile.Garment("tshirt")], quality="preview", edge_length=edge_length)
    result = toile.dress(scene, output=output)
    (shirt,) = result.garments
    stretched, area = strain(shirt), areas(shirt)
    for number, name in enumerate(shirt.panel_names):
        own = shirt.panel == number
        warp, weft = 100.0 * np.average(stretched[own], axis=0, weights=area[own])
        print(f"{name:<20}{1e4 * area[own].sum():7.0f} cm2   warp {warp:+.2f} %   weft {weft:+.2f} %")
    print(f"mass {1000 * shirt.fabric.areal_density * area.sum():.0f} g")
    np.savez(Path(output) / "shirt.npz", positions=shirt.positions, faces=shirt.faces, strain=stretched)
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
