"""The guard that shortens every vertex by itself against one line search for all.

    python bench/line_search.py

Both run the same films from the same start. The line search is the additive continuous collision detection of
ipctk over the same candidates, with half the guard's floor as least distance. Its time is that of the search
alone, without the building of ipctk's objects. Needs ipctk (an extra for developers).
"""

import sys
from collections.abc import Callable
from time import process_time

import ipctk
import numpy as np

import toile.engine.step.safe_motion
from toile.collide.guard import FLOOR, safe_factors
from toile.engine.film.plan import FilmFrame
from toile.engine.film.simulate import Simulation
from toile.geometry.arrays import Float, Int
from toile.studies.scenes.scenes import sphere
from toile.studies.stress.stress_pulled import funnel
from toile.studies.stress.stress_scene import StressScene
from toile.studies.stress.stress_scenes import spikes

Guard = Callable[[Float, Float, Int, Int], tuple[Float, float]]
"""Returns factors and the CPU time that it took [s]."""
LIMIT = 120.0
"""CPU time after which a film is broken off [s]."""


class Watched:
    """A guard, its time [s], and the sums of wanted and safe motions [m]."""

    def __init__(self, guard: Guard) -> None:
        self.guard = guard
        self.seconds, self.wanted, self.done = 0.0, 0.0, 0.0

    def __call__(self, p: Float, move: Float, vertex_face: Int, edge_edge: Int) -> Float:
        factor, seconds = self.guard(p, move, vertex_face, edge_edge)
        self.seconds += seconds
        length = np.linalg.norm(move, axis=1)
        self.wanted += float(length.sum())
        self.done += float((factor * length).sum())
        return factor


def per_vertex(p: Float, move: Float, vertex_face: Int, edge_edge: Int) -> tuple[Float, float]:
    """Return what the guard lets pass."""
    started = process_time()
    factor = safe_factors(p, move, vertex_face, edge_edge)
    return factor, process_time() - started


def line_search(p: Float, move: Float, vertex_face: Int, edge_edge: Int) -> tuple[Float, float]:
    """Return the largest common factor of all displacements at which no pair meets, for every vertex."""
    candidates = ipctk.Candidates()
    faces, face = np.unique(vertex_face[:, 1:], axis=0, return_inverse=True)
    ends = np.concatenate([edge_edge.reshape(-1, 2), faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges, edge = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    sides = edge[: 2 * len(edge_edge)].reshape(-1, 2)
    mesh = ipctk.CollisionMesh(p, edges, faces)
    candidates.fv_candidates = [
        ipctk.FaceVertexCandidate(int(f), int(v)) for f, v in zip(face, vertex_face[:, 0], strict=True)
    ]
    candidates.ee_candidates = [ipctk.EdgeEdgeCandidate(int(a), int(b)) for a, b in sides]
    started = process_time()
    factor = candidates.compute_collision_free_stepsize(
        mesh, p, p + move, 0.5 * FLOOR, ipctk.AdditiveCCD(conservative_rescaling=0.9)
    )
    return np.full(len(p), factor), process_time() - started


def films() -> dict[str, StressScene]:
    """Return the scenes by name."""
    sheet = sphere(0.025)
    ball = StressScene(cloth=sheet.cloth, edge=0.025, plan=sheet.plan, seconds=0.6, avatar=sheet.avatar)
    return {"sphere": ball, "spikes": spikes(), "funnel": funnel()}


def main() -> int:
    """Run all films with both and print what came of it."""
    print(f"{'film':8}{'guard':>13}{'frames':>9}{'steps':>7}{'guard s':>9}{'passed':>10}{'strain':>8}")
    for name, scene in films().items():
        for label, guard in (("per vertex", per_vertex), ("line search", line_search)):
            watched = Watched(guard)
            toile.engine.step.safe_motion.safe_factors = watched
            started = process_time()

            def in_time(frame: FilmFrame, since: float = started) -> bool:
                return process_time() - since < LIMIT

            film = Simulation(
                scene.cloth, scene.avatar, scene.plan, in_time, scene.motion, pin_motion=scene.pin_motion
            )
            record = film.run(scene.seconds)
            frames = round(scene.seconds / scene.plan.frame_seconds)
            print(
                f"{name:8}{label:>13}{len(record.crossings) - 1:5}/{frames:3}{record.steps:7}"
                f"{watched.seconds:9.2f}"
                f"{watched.done / max(watched.wanted, 1e-300):10.1%}{max(record.stretch_max):8.1%}"
                f"  {record.failure}",
                flush=True,
            )
    toile.engine.step.safe_motion.safe_factors = safe_factors
    return 0


if __name__ == "__main__":
    sys.exit(main())
