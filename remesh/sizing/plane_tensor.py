"""Symmetric 2x2 tensors, shape (n, 2, 2), as metrics of the plane.

Such a tensor is a point (Mohr): the mean of its eigenvalues, and a deviator of two components whose length is
half their difference. A dominates B (A - B has no negative eigenvalue) where the mean of A exceeds that of B
by at least the distance of their deviators; so A covers B like a disk that contains another.
"""

import numpy as np

from toile.geometry.arrays import Float


def eigenvalues(tensors: Float) -> tuple[Float, Float]:
    """Return the smaller and the larger eigenvalue, shapes (n,)."""
    mean, deviator, _ = _mohr(tensors)
    return mean - deviator, mean + deviator


def with_eigenvalues(tensors: Float, smaller: Float, larger: Float) -> Float:
    """Return tensors with the same eigenvectors and other eigenvalues (n,), in any order."""
    _, _, direction = _mohr(tensors)
    return _from_mohr(0.5 * (smaller + larger), 0.5 * (larger - smaller) * direction)


def smallest_dominating(a: Float, b: Float) -> Float:
    """Return the tensors of smallest trace that dominate both a and b: the smallest disk around two disks."""
    mean_a, length_a, direction_a = _mohr(a)
    mean_b, length_b, direction_b = _mohr(b)
    at_a, at_b = length_a * direction_a, length_b * direction_b
    apart = at_b - at_a
    distance = np.sqrt(apart[0] ** 2 + apart[1] ** 2)
    mean = 0.5 * (mean_a + mean_b + distance)
    share = (mean - mean_a) / np.where(distance > 0.0, distance, 1.0)
    around = _from_mohr(mean, at_a + share * apart)
    a_covers, b_covers = mean_a - mean_b >= distance, mean_b - mean_a >= distance
    return np.where(a_covers[:, None, None], a, np.where(b_covers[:, None, None], b, around))


def gram(rows: Float) -> Float:
    """Return R^T R of (n, k, 2), shape (n, 2, 2)."""
    return np.asarray(np.einsum("nki,nkj->nij", rows, rows))


def turned(tensors: Float) -> Float:
    """Return the tensors rotated by a right angle."""
    result = np.empty_like(tensors)
    result[:, 0, 0], result[:, 1, 1] = tensors[:, 1, 1], tensors[:, 0, 0]
    result[:, 0, 1], result[:, 1, 0] = -tensors[:, 0, 1], -tensors[:, 1, 0]
    return result


def _mohr(tensors: Float) -> tuple[Float, Float, Float]:
    """Mean (n,), length of the deviator (n,), its direction (2, n): zero for multiples of the identity."""
    mean = 0.5 * (tensors[:, 0, 0] + tensors[:, 1, 1])
    deviator = np.stack([0.5 * (tensors[:, 0, 0] - tensors[:, 1, 1]), tensors[:, 0, 1]])
    length = np.sqrt(deviator[0] ** 2 + deviator[1] ** 2)
    return mean, length, deviator / np.where(length > 0.0, length, 1.0)


def _from_mohr(mean: Float, deviator: Float) -> Float:
    tensors = np.empty((len(mean), 2, 2))
    tensors[:, 0, 0], tensors[:, 1, 1] = mean + deviator[0], mean - deviator[0]
    tensors[:, 0, 1] = tensors[:, 1, 0] = deviator[1]
    return tensors
