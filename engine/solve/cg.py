"""Preconditioned conjugate gradients for the filtered system of a Newton iteration."""

import math
from typing import NamedTuple

import numpy as np
from numba import types

from toile.engine.solve.linear_system import LinearSystem
from toile.engine.solve.preconditioner.base import Preconditioner
from toile.geometry.arrays import Bool, Float
from toile.geometry.kernel import BOOL_1, F64_2, OUT_F64_2, kernel


class CgResult(NamedTuple):
    """Solution [m], shape (node_count, 3); iterations done; relative residual reached; whether it sufficed.

    `reference` is the square of what the residual is relative to [J].

    The residual is measured in the preconditioner's norm, sqrt(r . M^-1 r), relative to that of the
    right-hand side: with 3000 N/m in the cloth's plane and 0.1 N/m across it the plain norm sees only
    the plane.
    """

    solution: Float
    iterations: int
    residual: float
    converged: bool
    reference: float


def solve(
    system: LinearSystem,
    right_hand_side: Float,
    preconditioner: Preconditioner,
    *,
    tolerance: float = 1e-3,
    max_iterations: int = 1000,
    start: Float | None = None,
    reference: float | None = None,
) -> CgResult:
    """Solve A x = b with x = 0 at pinned nodes (Hestenes & Stiefel 1952, preconditioned).

    Parameters
    ----------
    system : the matrix A.
    right_hand_side : b [N], shape (node_count, 3); its values at pinned nodes are ignored.
    preconditioner : already updated for this system (a stale one is valid as well).
    tolerance : stop when the residual, in the preconditioner's norm, has dropped by this factor.
    max_iterations : give up after as many products with A; `converged` is then False.
    start : warm start [m], shape (node_count, 3); its values at pinned nodes are ignored. None: zero.
    reference : that of a like right-hand side [J], which saves finding it; only with a warm start, not zero.

    Raises
    ------
    FloatingPointError : a non-finite number turned up, or A is not positive definite.
    """
    order, rank = system.pattern.order, system.pattern.rank
    load: Float = np.asarray(right_hand_side, dtype=np.float64)[order]
    _zero_pinned(system.pinned, load)
    residual = load.copy()
    solution = np.zeros_like(load)
    direction = np.empty_like(load)
    product = np.empty_like(load)
    if start is None or not reference:
        reference = _remove_exact_part(system, preconditioner, residual, solution, product)
        scaled = preconditioner.apply(residual, direction)
        reference += scaled
    limit = tolerance * tolerance * reference
    if start is not None and reference > 0.0:
        correction = np.zeros_like(load)
        np.take(start, order, axis=0, out=solution)
        _zero_pinned(system.pinned, solution)
        system.apply(solution, product)
        np.subtract(load, product, out=residual)
        _remove_exact_part(system, preconditioner, residual, correction, product)
        solution += correction
        scaled = preconditioner.apply(residual, direction)
    iterations = 0
    preconditioned = np.empty_like(residual)
    while scaled > limit and iterations < max_iterations:
        curvature = system.apply(direction, product)
        if not curvature > 0.0:
            raise FloatingPointError(
                f"curvature {curvature} along a search direction: A is not positive definite"
            )
        _advance(scaled / curvature, direction, product, solution, residual)
        iterations += 1
        previous, scaled = scaled, preconditioner.apply(residual, preconditioned)
        _turn(scaled / previous, preconditioned, direction)
    if not math.isfinite(scaled):
        raise FloatingPointError("the residual is not finite")
    ratio = math.sqrt(max(scaled, 0.0) / reference) if reference > 0.0 else 0.0
    return CgResult(solution[rank], iterations, ratio, scaled <= limit, reference)


def _remove_exact_part(
    system: LinearSystem, preconditioner: Preconditioner, residual: Float, correction: Float, product: Float
) -> float:
    """Write what the preconditioner solves exactly into `correction`; return its share of r . M^-1 r."""
    if not preconditioner.correct(residual, correction):
        return 0.0
    share = float((residual * correction).sum())
    system.apply(correction, product)
    residual -= product
    return share


@kernel(types.void(BOOL_1, OUT_F64_2))
def _zero_pinned(pinned: Bool, vectors: Float) -> None:
    for i in range(pinned.shape[0]):
        if pinned[i]:
            vectors[i, 0] = 0.0
            vectors[i, 1] = 0.0
            vectors[i, 2] = 0.0


@kernel(types.void(types.float64, F64_2, F64_2, OUT_F64_2, OUT_F64_2))
def _advance(step: float, direction: Float, product: Float, solution: Float, residual: Float) -> None:
    for i in range(direction.shape[0]):
        for k in range(3):
            solution[i, k] += step * direction[i, k]
            residual[i, k] -= step * product[i, k]


@kernel(types.void(types.float64, F64_2, OUT_F64_2))
def _turn(factor: float, preconditioned: Float, direction: Float) -> None:
    for i in range(direction.shape[0]):
        for k in range(3):
            direction[i, k] = preconditioned[i, k] + factor * direction[i, k]
