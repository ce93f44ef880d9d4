"""The longest stable step of explicit methods on a net of springs."""

from math import inf, sqrt

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import eigsh

from toile.geometry.arrays import Bool, Float
from toile.studies.scenes.spring_cloth import SpringNet


def fastest(net: SpringNet, x: Float, pinned: Bool) -> float:
    """Return the largest angular frequency [rad/s] of a net at places [m], shape (n, 3), pinned: (n,)."""
    d = x[net.pairs[:, 0]] - x[net.pairs[:, 1]]
    n = d / np.linalg.norm(d, axis=1)[:, None]
    blocks = net.stiffness[:, None, None] * n[:, :, None] * n[:, None, :]
    a, b = 3 * net.pairs[:, 0], 3 * net.pairs[:, 1]
    rows, columns, values = [], [], []
    for p, q, sign in ((a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)):
        for r in range(3):
            for c in range(3):
                rows.append(p + r)
                columns.append(q + c)
                values.append(sign * blocks[:, r, c])
    free = np.where(pinned, 0.0, 1.0 / np.sqrt(net.mass)).repeat(3)
    at, to = np.concatenate(rows), np.concatenate(columns)
    matrix = coo_array((np.concatenate(values) * free[at] * free[to], (at, to)), (len(free), len(free)))
    largest = eigsh(
        matrix.tocsr(), k=1, which="LA", return_eigenvectors=False, tol=1e-4, v0=np.ones(len(free))
    )
    return sqrt(max(float(largest[0]), 0.0))


def longest_step(method: str, frequency: float, lag: float) -> float:
    """Return the longest stable step [s] of "explicit" or "symplectic" Euler; infinite for other methods.

    Each mode of frequency w obeys x'' = -w^2 (x + lag x'). Both methods are stable while the roots of the
    polynomial of a step lie in the unit circle (Jury 1964): symplectic Euler for
    h < sqrt(lag^2 + 4/w^2) - lag; explicit Euler for h < lag, beyond critical damping for
    h < lag - sqrt(lag^2 - 4/w^2). Without damping explicit Euler never is.
    """
    if method == "symplectic":
        return sqrt(lag**2 + 4.0 / frequency**2) - lag
    if method == "explicit":
        over = lag**2 - 4.0 / frequency**2
        return lag if over <= 0.0 else lag - sqrt(over)
    return inf
