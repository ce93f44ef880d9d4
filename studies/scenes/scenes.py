"""Reference scenes of cloth in motion: a sheet on a sphere, a flag in wind, a sheet hung by two corners.

All use cotton poplin on meshes of one edge length.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import trimesh

from toile.dressing.garment.fabrics import fabric
from toile.dressing.run.air import plate_resistance
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.film.plan import FilmPlan
from toile.engine.forces.air_flow import AirFlow
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Bool, Float, Int
from toile.remesh.panel.rectangle import rectangle

GRAVITY = 9.81
SPHERE_RADIUS = 0.25
DROP = 0.05
FLAG_WIND = 10.0


class BenchmarkScene(NamedTuple):
    """Cloth, still obstacle (vertices, faces) or None, plan of the film and its length [s]."""

    cloth: Cloth
    avatar: tuple[Float, Int] | None
    plan: FilmPlan
    seconds: float


def sphere(edge: float) -> BenchmarkScene:
    """Return a square of 1 m, edges `edge` [m] long, that falls 5 cm onto a fixed sphere of radius 0.25 m.

    The sphere is an icosphere of 5120 triangles whose faces are at most 0.25 mm inside the true one. Cloth
    touches itself. Two seconds. Adaptive meshes follow every tenth frame, so that remeshing stays a
    small part of the time.
    """
    ball = trimesh.creation.icosphere(subdivisions=4, radius=SPHERE_RADIUS)
    avatar = surface_of(ball)
    flat, faces = rectangle(1.0, 1.0, edge)
    height = SPHERE_RADIUS + DROP
    positions = np.column_stack((flat[:, 0] - 0.5, np.full(len(flat), height), 0.5 - flat[:, 1]))
    cloth = sheet(flat, faces, positions, np.zeros(len(flat), bool))
    return BenchmarkScene(cloth, avatar, replace(film_plan(), remesh_frames=10), 2.0)


def flag(edge: float) -> BenchmarkScene:
    """Return a flag of 1.5 m x 1 m held along its short edge, in a wind of 10 m/s along it. Two seconds.

    The wind comes five degrees from the side, because a flat flag along the wind feels none. Pressure drag of
    a plate, rho c u^2/2 with 1.2 kg/m^3 and c = 1, is 60 Pa at 10 m/s; the force here is linear in the
    relative speed and gives the same there with k_w = rho c u/2 = 6 N s/m^3. Adaptive meshes follow every
    eighth frame: it never rests, and more often is no nearer to the reference.
    """
    flat, faces = rectangle(1.5, 1.0, edge)
    positions = np.column_stack((flat, np.zeros(len(flat))))
    cloth = sheet(flat, faces, positions, flat[:, 0] < 1e-9)
    angle = np.radians(5.0)
    wind = (FLAG_WIND * float(np.cos(angle)), 0.0, FLAG_WIND * float(np.sin(angle)))
    air = AirFlow(velocity=wind, resistance=plate_resistance(FLAG_WIND))
    plan = replace(film_plan(air), remesh_frames=8)
    return BenchmarkScene(cloth, None, plan, 2.0)


def hang(edge: float) -> BenchmarkScene:
    """Return a square of 1 m, level at first, that swings down from two pinned neighbouring corners.

    Two seconds of film in still air (of the resistance at 1 m/s). Adaptive meshes follow every third frame:
    it falls fast.
    """
    flat, faces = rectangle(1.0, 1.0, edge)
    positions = np.column_stack((flat[:, 0], np.zeros(len(flat)), 1.0 - flat[:, 1]))
    corner = (flat[:, 1] > 1.0 - 1e-9) & ((flat[:, 0] < 1e-9) | (flat[:, 0] > 1.0 - 1e-9))
    cloth = sheet(flat, faces, positions, corner)
    air = AirFlow(velocity=(0.0, 0.0, 0.0), resistance=plate_resistance(1.0))
    plan = replace(film_plan(air), remesh_frames=3)
    return BenchmarkScene(cloth, None, plan, 2.0)


SCENES = {"sphere": sphere, "flag": flag, "hang": hang}


def film_plan(air: AirFlow | None = None) -> FilmPlan:
    """Return the plan of a film of cloth with self-contact."""
    return FilmPlan(step=StepOptions(air=air))


def surface_of(mesh: trimesh.Trimesh) -> tuple[Float, Int]:
    """Return a mesh as the engine takes it: vertices [m], shape (v, 3), and faces, shape (t, 3)."""
    return np.ascontiguousarray(mesh.vertices, np.float64), np.ascontiguousarray(mesh.faces, np.int32)


def sheet(flat: Float, faces: Int, positions: Float, pinned: Bool, material: Fabric | None = None) -> Cloth:
    """Make a sheet, of cotton poplin unless told, warp along the first coordinate of `flat` [m], (n, 2)."""
    return flat_cloth(flat, faces, positions, material or fabric("cotton-poplin"), pinned)
