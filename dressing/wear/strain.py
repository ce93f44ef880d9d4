"""Strain of cloth along its threads."""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.geometry.arrays import Float


def warp_weft_strain(cloth: Cloth) -> Float:
    """Return the strain of every face along warp and weft, shape (t, 2); 0 where a face has no rest area."""
    natural = cloth.natural_corners
    rest = natural[:, 1:] - natural[:, :1]
    corners = cloth.positions[cloth.face_nodes]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled = rest[:, 0, 0] * rest[:, 1, 1] - rest[:, 0, 1] * rest[:, 1, 0]
    some = doubled > 0.0
    inverse = np.where(some, 1.0 / np.where(some, doubled, 1.0), 0.0)[:, None]
    warp = (rest[:, 1, 1:] * first - rest[:, 0, 1:] * second) * inverse
    weft = (rest[:, 0, :1] * second - rest[:, 1, :1] * first) * inverse
    strain = np.column_stack([np.linalg.norm(warp, axis=1), np.linalg.norm(weft, axis=1)]) - 1.0
    strain[~some] = 0.0
    return np.asarray(strain)
