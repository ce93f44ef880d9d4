"""Sizing: one metric per face from curvature, motion, compression and obstacles.

A metric M (2x2, in the face's warp and weft directions, [1/m^2]) wants edges of length 1 / sqrt(e . M e) in
direction e. Source: Narain, Samii and O'Brien 2012, section 4; there the velocity gradient includes rotation,
which refines cloth that merely swings.
"""

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, SupportsFloat

import numpy as np

from toile.geometry.arrays import Float
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, shown
from toile.remesh.sizing.plane_tensor import eigenvalues, gram, turned, with_eigenvalues
from toile.remesh.sizing.row_products import row_cross, row_dot


@dataclass(frozen=True, kw_only=True)
class SizingOptions:
    """Options of a sizing field.

    Attributes
    ----------
    size_min, size_max
        Shortest and longest edges to ask for [m].
    refine_angle
        Turn of the surface normal per edge [rad].
    refine_velocity
        Change of velocity along an edge, rotation aside [m/s].
    refine_compression
        Edge length over the inverse root of compression [m]: cloth whose squared lengths shrink by the
        share e asks for edges of refine_compression / sqrt(e) before it buckles.
    aspect_min
        Shortest over longest wanted edge of a triangle, in (0, 1] (dimensionless).

    Raises InputError if a field is not a positive finite number, `aspect_min` exceeds 1 or `size_min`
    exceeds `size_max`.
    """

    size_min: float
    size_max: float
    refine_angle: float = 0.3
    refine_velocity: float = 0.5
    refine_compression: float = 0.005
    aspect_min: float = 0.2

    if TYPE_CHECKING:

        def __init__(
            self, *, size_min: SupportsFloat, size_max: SupportsFloat, refine_angle: SupportsFloat = 0.3,
            refine_velocity: SupportsFloat = 0.5, refine_compression: SupportsFloat = 0.005,
            aspect_min: SupportsFloat = 0.2,
        ) -> None: ...  # fmt: skip

    def __post_init__(self) -> None:
        """Check every field."""
        for entry in fields(self):
            value, hint = getattr(self, entry.name), _HINTS[entry.name]
            if not is_real(value):
                raise InputError(f"{entry.name} must be a finite number, got {shown(value)}; {hint}")
            if value <= 0.0:
                raise InputError(f"{entry.name} must be greater than zero, got {value:g}; {hint}")
            object.__setattr__(self, entry.name, float(value))
        if self.aspect_min > 1.0:
            raise InputError(f"aspect_min must not exceed 1, got {self.aspect_min:g}; {_HINTS['aspect_min']}")
        if self.size_min > self.size_max:
            raise InputError(
                f"size_min must not exceed size_max, {self.size_max:g} m, got {self.size_min:g} m; "
                "lower size_min or raise size_max"
            )


_HINTS = {
    "size_min": "give the shortest edge to ask for [m], such as 0.005",
    "size_max": "give the longest edge to ask for [m], such as 0.05",
    "refine_angle": "give a turn per edge [rad], such as 0.3, or 1e6 to ignore curvature",
    "refine_velocity": "give a change per edge [m/s], such as 0.5, or 1e6 to ignore motion",
    "refine_compression": "give a length [m], such as 0.005, or 1e6 to ignore compression",
    "aspect_min": "give a ratio such as 0.2, or 1 for triangles of equal edges",
}
"""What to give instead of a wrong value."""


def curvature_metric(curvature: Float, refine_angle: float) -> Float:
    """Return S^T S / angle^2 of curvatures S [1/m], shape (t, 2, 2)."""
    return gram(curvature) / refine_angle**2


def velocity_metric(deformation: Float, velocity_gradient: Float, refine_velocity: float) -> Float:
    """Return (grad v)^T (grad v) / velocity^2 of the velocity gradient less its rotation, shape (t, 2, 2).

    `deformation` F (dimensionless) and `velocity_gradient` [1/s] have shape (t, 3, 2). The rotation is the
    angular velocity w that fits grad v = [w] F best in least squares.
    """
    first, second = deformation[..., 0], deformation[..., 1]
    moment = row_cross(first, velocity_gradient[..., 0]) + row_cross(second, velocity_gradient[..., 1])
    spin = _solve_symmetric(_inertia(first) + _inertia(second), moment)
    rest = np.stack(
        [
            velocity_gradient[..., 0] - row_cross(spin, first),
            velocity_gradient[..., 1] - row_cross(spin, second),
        ],
        axis=2,
    )
    return gram(rest) / refine_velocity**2


def compression_metric(deformation: Float, curvature: Float, refine_compression: float) -> Float:
    """Return the metric that compression asks for before the cloth buckles, shape (t, 2, 2).

    `deformation` F (dimensionless) has shape (t, 3, 2), `curvature` S [1/m] shape (t, 2, 2). With the strain
    e = F^T F - 1 it is the positive part of (-e + sqrt(e^2 - 4 c^2 perp(S^T S))) / (2 c^2), the root being
    signed: curvature across a wrinkle's direction stiffens the sheet.
    """
    strain = gram(deformation) - np.eye(2)
    inner = gram(strain) - 4.0 * refine_compression**2 * turned(gram(curvature))
    low, high = eigenvalues(inner)
    root = with_eigenvalues(inner, _signed_root(low), _signed_root(high))
    metric = (root - strain) / (2.0 * refine_compression**2)
    low, high = eigenvalues(metric)
    return with_eigenvalues(metric, np.maximum(low, 0.0), np.maximum(high, 0.0))


def obstacle_metric(gradient: Float, distance: Float) -> Float:
    """Return g g^T / h^2 of distances h [m], shape (t,), with gradients g along the face, shape (t, 2)."""
    scaled = gradient / distance[:, None]
    return gram(scaled[:, None, :])


def clamped(metric: Float, options: SizingOptions) -> Float:
    """Bound wanted lengths to [size_min, size_max] and their ratio by `aspect_min`, shape (t, 2, 2)."""
    low, high = eigenvalues(metric)
    least, most = 1.0 / options.size_max**2, 1.0 / options.size_min**2
    high = np.clip(high, least, most)
    low = np.maximum(np.clip(low, least, most), options.aspect_min**2 * high)
    return with_eigenvalues(metric, low, high)


def _signed_root(values: Float) -> Float:
    return np.asarray(np.sign(values) * np.sqrt(np.abs(values)))


def _inertia(vectors: Float) -> Float:
    """Return |a|^2 1 - a a^T of vectors (t, 3), shape (t, 3, 3)."""
    squared = row_dot(vectors, vectors)[:, None, None]
    return np.asarray(squared * np.eye(3) - vectors[:, :, None] * vectors[:, None, :])


def _solve_symmetric(matrices: Float, right: Float) -> Float:
    """Solve with symmetric matrices (t, 3, 3), by Cramer's rule; 0 where one is singular; shape (t, 3)."""
    a, b, c = matrices[:, 0], matrices[:, 1], matrices[:, 2]
    bc = row_cross(b, c)
    determinant = row_dot(a, bc)
    scale = np.einsum("tii->t", matrices) ** 3
    regular = determinant > 1e-12 * scale
    products = [row_dot(right, bc), row_dot(right, row_cross(c, a)), row_dot(right, row_cross(a, b))]
    solution = np.stack(products, axis=1) / np.where(regular, determinant, 1.0)[:, None]
    return np.where(regular[:, None], solution, 0.0)
