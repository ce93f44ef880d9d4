"""Algebra of plane metrics against closed forms and brute force."""

import numpy as np

from toile.geometry.arrays import Float
from toile.remesh.sizing.plane_tensor import eigenvalues, smallest_dominating, turned, with_eigenvalues


def random_metrics(count: int, seed: int) -> Float:
    factors = np.random.default_rng(seed).normal(size=(count, 2, 2))
    return np.asarray(np.einsum("nki,nkj->nij", factors, factors))


def test_eigenvalues_match_numpy() -> None:
    tensors = random_metrics(50, 1)
    low, high = eigenvalues(tensors)
    assert np.abs(np.stack([low, high], axis=1) - np.linalg.eigvalsh(tensors)).max() < 1e-13


def test_changed_eigenvalues_keep_the_eigenvectors() -> None:
    tensors = random_metrics(50, 2)
    low, high = eigenvalues(tensors)
    assert np.abs(with_eigenvalues(tensors, low, high) - tensors).max() < 1e-13
    squared = with_eigenvalues(tensors, low**2, high**2)
    assert np.abs(squared - tensors @ tensors).max() < 1e-12
    inverse = with_eigenvalues(tensors, 1 / low, 1 / high)
    assert np.abs(inverse @ tensors - np.eye(2)).max() < 1e-9


def test_turned_tensors_swap_directions() -> None:
    tensors = random_metrics(20, 3)
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    assert np.abs(turned(tensors) - quarter @ tensors @ quarter.T).max() < 1e-15


def test_dominating_tensor_dominates_both() -> None:
    a, b = random_metrics(200, 4), random_metrics(200, 5)
    around = smallest_dominating(a, b)
    assert np.linalg.eigvalsh(around - a).min() > -1e-12
    assert np.linalg.eigvalsh(around - b).min() > -1e-12


def test_dominating_tensor_has_the_smallest_trace() -> None:
    """Every tensor that dominates a is a plus a positive one; search those on a grid of deviators."""
    a, b = random_metrics(30, 6), random_metrics(30, 7)
    trace = np.trace(smallest_dominating(a, b), axis1=1, axis2=2)
    for one, two, least in zip(a, b, trace, strict=True):
        reach = np.linspace(-0.5, 0.5, 201) * (np.trace(one) + np.trace(two))
        x, y = np.meshgrid(reach, reach)
        mean = np.full(x.shape, 0.0)
        for tensor in (one, two):
            away = np.hypot(x - 0.5 * (tensor[0, 0] - tensor[1, 1]), y - tensor[0, 1])
            mean = np.maximum(mean, 0.5 * np.trace(tensor) + away)
        best = 2.0 * mean.min()
        assert least <= best + 1e-12
        assert best - least < 0.03 * least


def test_a_tensor_that_dominates_already_is_returned_as_it_is() -> None:
    a = random_metrics(20, 8)
    b = a + random_metrics(20, 9)
    assert np.array_equal(smallest_dominating(a, b), b)
    assert np.array_equal(smallest_dominating(b, a), b)
    assert np.array_equal(smallest_dominating(a, a), a)
