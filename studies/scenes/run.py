"""One timed run of a reference scene."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from time import process_time

import numpy as np

from toile.dressing.run.dress import dress
from toile.dressing.run.kernels import DRAPE_KERNELS, PANEL_KERNELS, REMESH_KERNELS, load_kernels
from toile.dressing.run.progress import ProgressState
from toile.dressing.run.scene import Garment, Scene
from toile.engine.film.plan import FilmFrame
from toile.engine.film.simulate import Simulation
from toile.engine.solve.linear_system import LinearSystem
from toile.engine.solve.preconditioner.base import Preconditioner
from toile.geometry.arrays import Float, Int
from toile.remesh.sizing.sizing import SizingOptions
from toile.studies.scenes.scenes import BenchmarkScene

SAMPLED = 0.2
"""Time between the surfaces of a film that are compared [s]."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """One run.

    Attributes
    ----------
    cpu
        CPU time without loading kernels [s].
    faces
        Faces, mean over the frames.
    crossings
        Crossing pairs of triangles, sum over all frames of a film, of the worst output frame of a drape.
    remesh_share
        Share of the CPU time that remeshing took.
    energy_jump, energy_drop
        Largest rise and fall of the elastic energy in a remeshing, as a share of it.
    drape_coefficient
        Area of the shadow along the rest normal over the area of the cloth, mean over the second half.
    audit_share
        Share of the CPU time that the audit of a film's frames took.
    strain_max
        Largest strain along warp or weft in a film's frames.
    steps
        Time steps of a film.
    surfaces
        Nodes [m], shape (n, 3), and faces, shape (t, 3): of a film after every SAMPLED seconds, of a drape at
        the end.
    """

    cpu: float
    faces: float
    crossings: int
    remesh_share: float
    energy_jump: float
    energy_drop: float
    drape_coefficient: float
    audit_share: float = 0.0
    strain_max: float = 0.0
    steps: int = 0
    surfaces: tuple[tuple[Float, Int], ...]


def run_film(
    scene: BenchmarkScene, seconds: float | None, sizing: SizingOptions | None,
    preconditioning: Callable[[LinearSystem], Preconditioner] | None = None,
) -> Run:  # fmt: skip
    """Run a film for its own length or `seconds`, on an adaptive mesh if `sizing` says how.

    `preconditioning` makes another preconditioner than the usual one, on a mesh that stays.
    """
    load_all_kernels()
    length = seconds or scene.seconds
    shadows, surfaces = [], []
    every = round(SAMPLED / scene.plan.frame_seconds)

    def on_frame(frame: FilmFrame) -> bool:
        if frame.index and frame.index % every == 0:
            surfaces.append((frame.cloth.positions, frame.cloth.face_nodes))
        if frame.seconds > 0.5 * length:
            shadows.append(_shadow(frame.cloth.positions, frame.cloth.face_nodes, normal))
        return True

    normal = _mean_normal(scene.cloth.positions, scene.cloth.face_nodes)
    started = process_time()
    film = Simulation(scene.cloth, scene.avatar, replace(scene.plan, sizing=sizing), on_frame)
    if preconditioning is not None:
        film.stepper.precondition(preconditioning)
    record = film.run(length)
    cpu = process_time() - started
    jumps = [done.energy_jump for done in record.remeshings]
    return Run(
        cpu=cpu,
        faces=float(np.mean(record.faces)),
        crossings=sum(map(sum, record.crossings)),
        remesh_share=film.clock.cpu("remesh") / cpu,
        energy_jump=max(jumps, default=0.0),
        energy_drop=-min(jumps, default=0.0),
        drape_coefficient=float(np.mean(shadows)) / float(scene.cloth.rest_area.sum()),
        audit_share=film.clock.cpu("audit") / cpu,
        strain_max=max(record.stretch_max),
        steps=record.steps,
        surfaces=tuple(surfaces),
    )


def run_shirt(edge: float, sizing: SizingOptions | None) -> Run:
    """Dress the mannequin in the built-in T-shirt of edges `edge` [m], or adaptive ones, at `standard`."""
    faces = []

    def count(state: ProgressState) -> bool:
        faces.append(state.faces)
        return True

    scene = Scene(
        garments=[Garment("tshirt")], quality="standard", remesh=sizing or False,
        edge_length=None if sizing else edge,
    )  # fmt: skip
    load_all_kernels()
    result = dress(scene, progress=count)
    report, garment = result.report, result.garments[0]
    cpu = report["cpu_seconds"] - report["stage_cpu_seconds"]["compile"]
    return Run(
        cpu=cpu,
        faces=float(np.mean(faces)),
        crossings=report["intersections"]["worst_frame"],
        remesh_share=report["stage_cpu_seconds"]["remesh"] / cpu,
        energy_jump=report["remeshing"]["energy_jump_max"],
        energy_drop=0.0,
        drape_coefficient=0.0,
        surfaces=((garment.positions, garment.faces),),
    )


def load_all_kernels() -> None:
    """Load all that is loaded on first use: it shall not count as CPU time."""
    load_kernels((*DRAPE_KERNELS, *PANEL_KERNELS, *REMESH_KERNELS))
    import_module("toile.engine.adapt.remeshing")


def _mean_normal(positions: Float, faces: Int) -> Float:
    """Direction in which the area of a surface is largest, shape (3,)."""
    a, b, c = (positions[faces[:, k]] for k in range(3))
    whole = np.cross(b - a, c - a).sum(axis=0)
    return np.asarray(whole / np.linalg.norm(whole))


def _shadow(positions: Float, faces: Int, normal: Float) -> float:
    """Area of a surface as seen along a direction, what is folded back counted against it [m^2]."""
    a, b, c = (positions[faces[:, k]] for k in range(3))
    return 0.5 * float((np.cross(b - a, c - a) @ normal).sum())
