"""Wind: air presses on moving cloth along its normal and rubs along it, linearly in the relative speed.

Force per area k_w (n . u) n + k_s (u - (n . u) n), with n the normal of the face and u = u_w - v the velocity
of the air less that of the cloth; a third of a face's area counts at each of its nodes, with the node's own
velocity. Seen from the flow this is k_s u, which is drag, and (k_w - k_s) (n . u) n, whose part along u is
drag as well and whose part across it is lift. In still air all is drag. Normals and areas are those at the
start of the step, so the force derives from a dissipation potential, h/2 sum of areas (k_w (n . u)^2 + k_s |u
- (n . u) n|^2), quadratic in the positions.
"""

import numpy as np

from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.force import NodalForce, StepState
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int


class Wind(NodalForce):
    """Wind on one topology; `begin` takes the normals of a step.

    Attributes
    ----------
    drag
        Resistance of every node [N s/m], shape (n, 3, 3), symmetric positive semi-definite.
    """

    def __init__(self, faces: Int, node_count: int, air: AirFlow) -> None:
        self.faces = faces
        self.flow = air
        self.air = air.velocity_at(0.0)
        self.drag = np.zeros((node_count, 3, 3))
        self._step: StepState | None = None

    def begin(self, step: StepState, x: Float) -> bool:
        """Take normals and areas at node positions x [m], shape (n, 3), and the air's velocity."""
        self._step = step
        self.air = self.flow.velocity_around(step.request.seconds, x)
        corner = x[self.faces[:, 0]]
        normal = np.cross(x[self.faces[:, 1]] - corner, x[self.faces[:, 2]] - corner)
        twice_area = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
        scale = (self.flow.resistance - self.flow.friction) / (6.0 * twice_area)
        nodes = self.faces.ravel()
        for row in range(3):
            for column in range(row, 3):
                share = np.repeat(scale * normal[:, row] * normal[:, column], 3)
                self.drag[:, row, column] = np.bincount(nodes, share, len(self.drag))
                self.drag[:, column, row] = self.drag[:, row, column]
        if self.flow.friction:
            third = np.repeat(self.flow.friction / 6.0 * twice_area, 3)
            self.drag[:, [0, 1, 2], [0, 1, 2]] += np.bincount(nodes, third, len(self.drag))[:, None]
        return True

    def energy(self, x: Float) -> float:
        """Dissipation potential of the step [J] at its end x [m], shape (n, 3)."""
        assert self._step is not None
        slip = self._slip(x)
        return 0.5 * float(np.einsum("n,ni,nij,nj->", self._step.h, slip, self.drag, slip))

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add minus the force [N] to an array of shape (n, 3)."""
        gradient += np.einsum("nij,nj->ni", self.drag, self._slip(x))

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient, and the drag over the step size."""
        assert self._step is not None
        self.add_gradient(x, gradient)
        hessian.add_nodes(self.drag / self._step.h[:, None, None])

    def _slip(self, x: Float) -> Float:
        """Velocity of the cloth less that of the air [m/s], shape (n, 3)."""
        assert self._step is not None
        return np.asarray(self._step.velocity_at(x) - self.air)
