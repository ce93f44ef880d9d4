"""A force of one's own: a magnet gathers a hanging cloth. Run: python examples/own_force.py [FOLDER]."""

import sys

import numpy as np

import toile
from toile.dressing.files.writers.atomic import writable_folder
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.film.plan import FilmPlan
from toile.engine.film.simulate import Simulation
from toile.engine.forces.force import NodalForce
from toile.engine.solve.hessian import Hessian
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float
from toile.remesh.panel.rectangle import rectangle

PLACE, WIDTH = np.array([0.3, 0.25, 0.15]), 0.1  # of the magnet [m]; the cloth hangs at z = 0


class Magnet(NodalForce):
    """E = -p A exp(-r^2 / (2 w^2)) for every node of area A [m^2]; p A is its depth [J]."""

    def __init__(self, depth: Float) -> None:
        self.depth = depth

    def energy(self, x: Float) -> float:
        return -float(self._stiffness(x).sum() * WIDTH**2)

    def add_gradient(self, x: Float, gradient: Float) -> None:
        gradient += self._stiffness(x)[:, None] * (x - PLACE)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        self.add_gradient(x, gradient)  # and what is positive of k (1 - d d^T), d = (x - PLACE) / w [N/m]:
        d = (x - PLACE) / np.maximum(WIDTH, np.linalg.norm(x - PLACE, axis=1))[:, None]
        hessian.add_nodes(self._stiffness(x)[:, None, None] * (np.eye(3) - d[:, :, None] * d[:, None, :]))

    def _stiffness(self, x: Float) -> Float:
        return np.asarray(self.depth * np.exp(-0.5 * ((x - PLACE) ** 2).sum(axis=1) / WIDTH**2) / WIDTH**2)


def main(output: str = "out", strength: float = 0.3, edge: float = 0.02, seconds: float = 1.0) -> Simulation:
    """Hang a cloth of 0.6 m by its upper edge, 15 cm behind the magnet; return the film."""
    points, faces = rectangle(0.6, 0.6, edge)
    start, top = np.pad(points, ((0, 0), (0, 1))), points[:, 1] == points[:, 1].max()
    cloth = flat_cloth(points, faces, start, toile.fabric("cotton-poplin"), pinned=top)
    plan = FilmPlan(step=StepOptions(more_forces=(lambda some: Magnet(strength * some.node_area),)))
    film = Simulation(cloth, None, plan, on_frame=lambda frame: True)
    film.run(seconds)
    np.save(writable_folder(output) / "positions.npy", film.cloth.positions)
    return film


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
