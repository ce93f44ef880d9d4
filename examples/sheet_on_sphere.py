"""A square of silk falls onto a sphere and hangs from it in folds: the engine as a library.

No body, no pattern, no scene: a mesh, a fabric and an obstacle. The film goes to film.npz, as arrays.
Run: python examples/sheet_on_sphere.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np
import trimesh

import toile
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.film.plan import FilmFrame, FilmPlan
from toile.engine.film.simulate import Simulation
from toile.geometry.arrays import Float, Int
from toile.remesh.panel.rectangle import rectangle

RADIUS, SIDE, DROP = 0.2, 0.8, 0.01
"""Of the sphere, of the sheet, and how far it falls before they meet [m]."""


def ball() -> tuple[Float, Int]:
    """Return the sphere: vertices [m], shape (v, 3), and faces, shape (t, 3)."""
    sphere = trimesh.creation.icosphere(subdivisions=4, radius=RADIUS)
    return np.asarray(sphere.vertices, np.float64), np.asarray(sphere.faces, np.int32)


def main(output: str = "out", edge: float = 0.02, seconds: float = 1.0) -> list[FilmFrame]:
    """Let the sheet fall, write all frames and return them."""
    points, faces = rectangle(SIDE, SIDE, edge)
    x, z = points.T - 0.5 * SIDE
    positions = np.column_stack((x, np.full_like(x, RADIUS + DROP), -z))
    cloth = flat_cloth(points, faces, positions, toile.fabric("silk-charmeuse"))

    frames: list[FilmFrame] = []

    def keep(frame: FilmFrame) -> bool:
        frames.append(frame)
        return True

    film = Simulation(cloth, ball(), FilmPlan(), keep)
    record = film.run(seconds)

    Path(output).mkdir(parents=True, exist_ok=True)
    np.savez(Path(output) / "film.npz", vertices=[frame.cloth.positions for frame in frames], faces=faces)
    print(f"{len(frames)} frames, {record.steps} steps, {sum(map(sum, record.crossings))} crossings")
    return frames


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
