"""Stretch and shear of fabric: Baraff and Witkin's conditions as a finite-element energy.

With F = [f_u f_v] the deformation gradient of a face (columns: where a metre of warp and of weft goes), the
energy per rest area is k_u/2 (|f_u| - 1)^2 + k_v/2 (|f_v| - 1)^2 + k_s/2 (f_u . f_v)^2, independent of the
mesh. The Hessian is projected on its positive semi-definite part in closed form.

In compression k_u and k_v are a fabric's share of their values in tension: threads buckle, and wrinkles finer
than the mesh take up shortening almost without force (Pipkin 1986, the relaxed energy of membranes). It also
keeps flat triangles from locking: a face that spans an arc is shorter than the arc.

Sources: Baraff and Witkin 1998, section 4 (the conditions); Kim 2020, "A finite element formulation of
Baraff-Witkin cloth" (energy per area, eigenvalues).
"""

from math import sqrt

import numpy as np
from numba import types

from toile.engine.forces.force import ElementForce
from toile.engine.solve.assembly import scatter_gradients
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import (
    F64_2,
    F64_3,
    I32_2,
    OUT_F64_1,
    OUT_F64_2,
    OUT_F64_3,
    OUT_F64_4,
    helper,
    kernel,
    packed_kernel,
)
from toile.geometry.threads.crew import in_parts

FACES_PER_PART = 1024
"""Faces that one thread evaluates at a time."""


@helper
def _threads(faces, shape, x, t):  # type: ignore[no-untyped-def]
    """Return f_u and f_v of a face, three components each."""
    ux = uy = uz = vx = vy = vz = 0.0
    for a in range(3):
        i = faces[t, a]
        du, dv = shape[t, 4 + a], shape[t, 7 + a]
        ux, uy, uz = ux + du * x[i, 0], uy + du * x[i, 1], uz + du * x[i, 2]
        vx, vy, vz = vx + dv * x[i, 0], vy + dv * x[i, 1], vz + dv * x[i, 2]
    return ux, uy, uz, vx, vy, vz


@kernel(types.void(I32_2, F64_2, F64_2, OUT_F64_1))
def fill_energies(faces: Int, shape: Float, x: Float, energy: Float) -> None:
    """Fill element energies [J], shape (t,), of faces with constants `shape` (t, 11): see `Membrane`."""
    for t in range(len(faces)):
        ux, uy, uz, vx, vy, vz = _threads(faces, shape, x, t)
        warp = sqrt(ux * ux + uy * uy + uz * uz) - 1.0
        weft = sqrt(vx * vx + vy * vy + vz * vz) - 1.0
        shear = ux * vx + uy * vy + uz * vz
        k_u = shape[t, 1] if warp > 0.0 else shape[t, 1] * shape[t, 10]
        k_v = shape[t, 2] if weft > 0.0 else shape[t, 2] * shape[t, 10]
        density = k_u * warp * warp + k_v * weft * weft + shape[t, 3] * shear * shear
        energy[t] = 0.5 * shape[t, 0] * density


@packed_kernel(types.void(I32_2, F64_2, F64_2, OUT_F64_2))
def _strains(faces: Int, shape: Float, x: Float, strain: Float) -> None:
    """Fill |f_u| - 1, |f_v| - 1, shape (t, 2)."""
    for t in range(len(faces)):
        ux, uy, uz, vx, vy, vz = _threads(faces, shape, x, t)
        strain[t, 0] = sqrt(ux * ux + uy * uy + uz * uz) - 1.0
        strain[t, 1] = sqrt(vx * vx + vy * vy + vz * vz) - 1.0


@kernel(types.void(I32_2, F64_2, F64_2, OUT_F64_3))
def _gradients(faces: Int, shape: Float, x: Float, gradient: Float) -> None:
    """Fill gradients [N], shape (t, 3, 3)."""
    for t in range(len(faces)):
        ux, uy, uz, vx, vy, vz = _threads(faces, shape, x, t)
        length_u, length_v = sqrt(ux * ux + uy * uy + uz * uz), sqrt(vx * vx + vy * vy + vz * vz)
        pull_u, pull_v = shape[t, 0] * shape[t, 1], shape[t, 0] * shape[t, 2]
        pull_u *= 1.0 - 1.0 / length_u if length_u > 0.0 else 0.0
        pull_v *= 1.0 - 1.0 / length_v if length_v > 0.0 else 0.0
        pull_u *= 1.0 if length_u > 1.0 else shape[t, 10]
        pull_v *= 1.0 if length_v > 1.0 else shape[t, 10]
        pull_s = shape[t, 0] * shape[t, 3] * (ux * vx + uy * vy + uz * vz)
        for a in range(3):
            of_u = shape[t, 4 + a] * pull_u + shape[t, 7 + a] * pull_s
            of_v = shape[t, 7 + a] * pull_v + shape[t, 4 + a] * pull_s
            gradient[t, a, 0] = of_u * ux + of_v * vx
            gradient[t, a, 1] = of_u * uy + of_v * vy
            gradient[t, a, 2] = of_u * uz + of_v * vz


@kernel(types.void(I32_2, F64_2, F64_2, OUT_F64_1, OUT_F64_3, OUT_F64_4))
def _evaluate(faces: Int, shape: Float, x: Float, energy: Float, gradient: Float, hessian: Float) -> None:
    """Fill energies [J], gradients [N] (t, 3, 3) and Hessian blocks [N/m] (t, 6, 3, 3).

    Projected Hessian in (f_u, f_v). Stretch: k on f f^T / |f|^2 and max(0, k (1 - 1/|f|)) across it. Shear,
    with I6 = f_u . f_v, I2 = |f_u|^2 + |f_v|^2: its only positive eigenvalue in the plane of (f_u, f_v) and
    (f_v, f_u) is lambda = (I2 + sqrt(I2^2 + 12 I6^2)) / 2 with vector q = (I6 f_u + lambda f_v, I6 f_v +
    lambda f_u); across that plane it is |I6|, twice, on (d, s d) with s the sign of I6 and d perpendicular to
    w = f_u + s f_v.
    """
    f, stress, q = np.empty((2, 3), np.float64), np.empty((2, 3), np.float64), np.empty((2, 3), np.float64)
    huu, huv, hvv = np.empty((3, 3), np.float64), np.empty((3, 3), np.float64), np.empty((3, 3), np.float64)
    w = np.empty(3, np.float64)
    for t in range(len(faces)):
        area = shape[t, 0]
        k_u, k_v, k_s = shape[t, 1], shape[t, 2], shape[t, 3]
        i, j, k = faces[t, 0], faces[t, 1], faces[t, 2]
        for c in range(3):
            f[0, c] = shape[t, 4] * x[i, c] + shape[t, 5] * x[j, c] + shape[t, 6] * x[k, c]
            f[1, c] = shape[t, 7] * x[i, c] + shape[t, 8] * x[j, c] + shape[t, 9] * x[k, c]
        uu = f[0, 0] * f[0, 0] + f[0, 1] * f[0, 1] + f[0, 2] * f[0, 2]
        vv = f[1, 0] * f[1, 0] + f[1, 1] * f[1, 1] + f[1, 2] * f[1, 2]
        i6 = f[0, 0] * f[1, 0] + f[0, 1] * f[1, 1] + f[0, 2] * f[1, 2]
        length_u, length_v, i2 = sqrt(uu), sqrt(vv), uu + vv
        inverse_u = 1.0 / length_u if length_u > 0.0 else 0.0
        inverse_v = 1.0 / length_v if length_v > 0.0 else 0.0
        strain_u, strain_v = length_u - 1.0, length_v - 1.0
        if strain_u < 0.0:
            k_u *= shape[t, 10]
        if strain_v < 0.0:
            k_v *= shape[t, 10]
        energy[t] = 0.5 * area * (k_u * strain_u * strain_u + k_v * strain_v * strain_v + k_s * i6 * i6)
        pull_u, pull_v, pull_s = (
            area * k_u * strain_u * inverse_u,
            area * k_v * strain_v * inverse_v,
            area * k_s * i6,
        )
        for c in range(3):
            stress[0, c] = pull_u * f[0, c] + pull_s * f[1, c]
            stress[1, c] = pull_v * f[1, c] + pull_s * f[0, c]
        for a in range(3):
            for c in range(3):
                gradient[t, a, c] = shape[t, 4 + a] * stress[0, c] + shape[t, 7 + a] * stress[1, c]

        across_u, across_v = area * k_u * max(0.0, 1.0 - inverse_u), area * k_v * max(0.0, 1.0 - inverse_v)
        along_u, along_v = (area * k_u - across_u) * inverse_u**2, (area * k_v - across_v) * inverse_v**2
        if inverse_u == 0.0:
            across_u = 0.0
        if inverse_v == 0.0:
            across_v = 0.0
        side = 1.0 if i6 >= 0.0 else -1.0
        lam = 0.5 * (i2 + sqrt(i2 * i2 + 12.0 * i6 * i6))
        q_squared = i2 * (i6 * i6 + lam * lam) + 4.0 * i6 * i6 * lam
        stiff_q = area * k_s * lam / q_squared if q_squared > 0.0 else 0.0
        stiff_w = 0.5 * area * k_s * abs(i6)
        w_squared = i2 + 2.0 * side * i6
        inverse_w = 1.0 / w_squared if w_squared > 0.0 else 0.0
        for c in range(3):
            w[c] = f[0, c] + side * f[1, c]
            q[0, c] = i6 * f[0, c] + lam * f[1, c]
            q[1, c] = i6 * f[1, c] + lam * f[0, c]
        for r in range(3):
            for c in range(3):
                unit = 1.0 if r == c else 0.0
                rest = stiff_w * (unit - inverse_w * w[r] * w[c])
                huu[r, c] = along_u * f[0, r] * f[0, c] + across_u * unit + stiff_q * q[0, r] * q[0, c] + rest
                hvv[r, c] = along_v * f[1, r] * f[1, c] + across_v * unit + stiff_q * q[1, r] * q[1, c] + rest
                huv[r, c] = stiff_q * q[0, r] * q[1, c] + side * rest
        for pair in range(6):
            a = pair if pair < 3 else (0 if pair < 5 else 1)
            b = pair if pair < 3 else (1 if pair == 3 else 2)
            du_a, dv_a = shape[t, 4 + a], shape[t, 7 + a]
            du_b, dv_b = shape[t, 4 + b], shape[t, 7 + b]
            for r in range(3):
                for c in range(3):
                    hessian[t, pair, r, c] = (
                        du_a * du_b * huu[r, c]
                        + dv_a * dv_b * hvv[r, c]
                        + du_a * dv_b * huv[r, c]
                        + dv_a * du_b * huv[c, r]
                    )


@kernel(types.void(F64_3, OUT_F64_2))
def fill_rest_shapes(rest: Float, shape: Float) -> None:
    """Fill rest areas and weights of derivatives in constants (t, 11), from rest corners (t, 3, 2) [m]."""
    for t in range(len(rest)):
        warp_1, weft_1 = rest[t, 1, 0] - rest[t, 0, 0], rest[t, 1, 1] - rest[t, 0, 1]
        warp_2, weft_2 = rest[t, 2, 0] - rest[t, 0, 0], rest[t, 2, 1] - rest[t, 0, 1]
        determinant = warp_1 * weft_2 - weft_1 * warp_2
        inverse = 1.0 / determinant if abs(determinant) > 0.0 else 0.0
        shape[t, 0] = 0.5 * abs(determinant)
        shape[t, 5], shape[t, 6] = weft_2 * inverse, -weft_1 * inverse
        shape[t, 8], shape[t, 9] = -warp_2 * inverse, warp_1 * inverse
        shape[t, 4], shape[t, 7] = -shape[t, 5] - shape[t, 6], -shape[t, 8] - shape[t, 9]


class Membrane(ElementForce):
    """Membrane energy of faces.

    Attributes
    ----------
    shape
        Constants of every face, shape (t, 11): rest area; stiffness along warp, along weft, of shear; weights
        of the corners in the warp, then in the weft derivative; share of stretch stiffness in compression.
    element_energy
        Energy of every face [J], shape (t,).
    element_gradient
        Gradient at its corners [N], shape (t, 3, 3).
    element_hessian
        Positive semi-definite blocks of the corner pairs (0,0), (1,1), (2,2), (0,1), (0,2), (1,2) [N/m],
        shape (t, 6, 3, 3).
    """

    def __init__(
        self,
        faces: Int,
        rest_corners: Float,
        stretch_warp: Float,
        stretch_weft: Float,
        shear: Float,
        compression: Float | float = 1.0,
    ) -> None:
        """Build for faces (t, 3) of nodes, rest corners (t, 3, 2) [m] and stiffness (t,) [N/m].

        Rest corners are in (warp, weft) coordinates. A face without rest area has no energy. `compression`
        is the share of the stretch stiffness that acts in compression, for all faces or per face (t,).
        """
        count = len(faces)
        shape = np.empty((count, 11))
        fill_rest_shapes(np.ascontiguousarray(rest_corners, np.float64), shape)
        shape[:, 1], shape[:, 2], shape[:, 3], shape[:, 10] = stretch_warp, stretch_weft, shear, compression
        self.faces = self.nodes = faces
        self.shape = shape
        self.element_energy = np.zeros(count)
        self.element_gradient = np.zeros((count, 3, 3))
        self.element_hessian = np.zeros((count, 6, 3, 3))

    @property
    def damped_shape(self) -> Float:
        """Constants of `shape` with the stiffness that damping goes by."""
        return self.shape

    def energy(self, x: Float) -> float:
        """Energy [J] at node positions x [m], shape (n, 3)."""
        fill_energies(self.faces, self.shape, x, self.element_energy)
        return float(self.element_energy.sum())

    def evaluate_gradient(self, x: Float) -> None:
        """Fill the gradients only, at node positions x [m], shape (n, 3)."""
        _gradients(self.faces, self.shape, x, self.element_gradient)

    def evaluate(self, x: Float) -> None:
        """Fill the element arrays at node positions x [m], shape (n, 3)."""

        def fill(first: int, last: int) -> None:
            some = slice(first, last)
            _evaluate(
                self.faces[some], self.shape[some], x, self.element_energy[some],
                self.element_gradient[some], self.element_hessian[some],
            )  # fmt: skip

        in_parts(fill, len(self.faces), FACES_PER_PART)

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the derivative of the energy [N] to an array of shape (n, 3)."""
        self.evaluate_gradient(x)
        scatter_gradients(self.faces, self.element_gradient, gradient)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add gradient and projected Hessian at node positions x [m], shape (n, 3)."""
        self.evaluate(x)
        scatter_gradients(self.faces, self.element_gradient, gradient)
        hessian.add_elements(self.faces, self.element_hessian)

    def gradient(self, values: Float) -> Float:
        """Return the change of node values (n, k) per metre of warp and of weft on faces, shape (t, k, 2)."""
        at_corners = values[self.faces]
        return np.asarray(np.einsum("tck,tdc->tkd", at_corners, self.shape[:, 4:10].reshape(-1, 2, 3)))

    def warp_weft_strain(self, x: Float) -> Float:
        """Return stretch along warp and weft, |f_u| - 1 and |f_v| - 1, shape (t, 2)."""
        strain = np.empty((len(self.faces), 2))
        _strains(self.faces, self.shape, x, strain)
        return strain
