"""The scenes that toile and Blender's cloth both get, and what Blender is told about them."""

from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

import numpy as np
import trimesh

from toile.dressing.garment.fabrics import fabric
from toile.engine.cloth.fabric import Fabric
from toile.engine.film.plan import FilmPlan
from toile.studies.scenes.scenes import DROP, SPHERE_RADIUS, film_plan

SECONDS, FRAME_SECONDS, STEPS = 2.0, 1.0 / 30.0, 4
"""Length of a film and of a frame [s]; steps per frame: 1/120 s each, the longest that toile takes."""
SIDES = {"sphere": (50, 100), "hang": (50, 100)}
"""Vertices along a side of the square, per scene."""
MILLIMETRE = 1e-3


def benchmark_fabric() -> Fabric:
    """Cotton poplin made the same in both directions: Blender knows one stiffness for warp and weft."""
    poplin = fabric("cotton-poplin")
    stretch = 0.5 * (poplin.stretch_warp + poplin.stretch_weft)
    bending = (poplin.bending_warp + poplin.bending_weft + poplin.bending_bias) / 3.0
    return replace(
        poplin, name="poplin, isotropic", stretch_warp=stretch, stretch_weft=stretch,
        bending_warp=bending, bending_weft=bending, bending_bias=bending,
    )  # fmt: skip


FABRIC = benchmark_fabric()


class Scene(NamedTuple):
    """A square sheet of side x side vertices, flat (n, 2) and in space (n, 3) [m], and a ball or None."""

    name: str
    side: int
    flat: np.ndarray
    positions: np.ndarray
    quads: np.ndarray
    pinned: np.ndarray
    ball: tuple[np.ndarray, np.ndarray] | None

    @property
    def faces(self) -> np.ndarray:
        """The triangles into which Blender cuts the quads: along their first diagonal."""
        return np.concatenate([self.quads[:, [0, 1, 2]], self.quads[:, [0, 2, 3]]])

    @property
    def edge(self) -> float:
        """Length of the quads' sides [m]."""
        return 1.0 / (self.side - 1)


@dataclass(frozen=True, kw_only=True)
class BlenderChoice:
    """What a row of Blender's differs in: steps per frame and distances [m] as its panels show them."""

    label: str
    steps: int
    cloth_distance: float
    self_distance: float
    collider_thickness: float


def make_scene(name: str, side: int) -> Scene:
    """Lay out `sphere`, `hang` or, for the checks, `free` (falls) or `strip` (hangs by its top edge)."""
    ticks = np.linspace(0.0, 1.0, side)
    flat = np.array([(x, y) for y in ticks for x in ticks])
    row, column = np.divmod(np.arange((side - 1) ** 2), side - 1)
    a = row * side + column
    corners = np.column_stack([a, a + 1, a + side + 1, a + side])
    # Diagonals alternate, or shear would be stiffer one way than the other.
    odd = (row + column) % 2 == 1
    corners[odd] = np.roll(corners[odd], -1, axis=1)
    level = np.column_stack([flat[:, 0] - 0.5, np.full(len(flat), SPHERE_RADIUS + DROP), 0.5 - flat[:, 1]])
    pinned = np.zeros(len(flat), bool)
    ball = None
    if name == "sphere":
        mesh = trimesh.creation.icosphere(subdivisions=4, radius=SPHERE_RADIUS)
        ball = np.array(mesh.vertices, np.float64), np.array(mesh.faces, np.int32)
    elif name == "hang":
        pinned[[-side, -1]] = True
    elif name == "strip":
        level = np.column_stack([flat, np.zeros(len(flat))])
        pinned[-side:] = True
    return Scene(name, side, flat, level, corners.astype(np.int32), pinned, ball)


def toile_plan() -> FilmPlan:
    """The plan of toile's own benchmark scenes, in a vacuum."""
    plan = replace(film_plan(), frame_seconds=FRAME_SECONDS, longest_step=FRAME_SECONDS / STEPS)
    assert plan.step.self_contact and plan.step.air is None
    return plan


def equal_steps_plan() -> FilmPlan:
    """The same plan with all steps of the length that Blender takes, however the cloth moves."""
    plan = toile_plan()
    return replace(plan, shortest_step=plan.longest_step, stretch_rise=inf, motion_max=inf)


def blender_settings(scene: Scene, choice: BlenderChoice) -> dict[str, dict[str, object]]:
    """Blender's properties for FABRIC on a grid of square cells of side e = scene.edge.

    Blender multiplies gravity by 0.001, so its unit of time is 1/31.6 s, and with masses in grams its unit of
    force is 1 N. A structural spring has the constant tension/e and carries a width e: tension = C e.
    Diagonals act in tension only, with shear/e: of the two, one resists shear, and shear = 2 G e. An angular
    spring pushes the centres of its two faces with bending e/10 per radian, a moment of bending e^2/20, which
    is D: bending = 20 D/e^2. Friction is in percent. Damping and air are off, as in toile. Mass is per
    vertex, so borders weigh twice what they should.
    """
    stretch = FABRIC.stretch_warp * scene.edge
    stiffness = {
        "tension_stiffness": stretch,
        "compression_stiffness": FABRIC.compression * stretch,
        "shear_stiffness": 2.0 * FABRIC.shear * scene.edge,
        "bending_stiffness": 20.0 * FABRIC.bending_warp / scene.edge**2,
    }
    damping = {f"{kind}_damping": 0.0 for kind in ("tension", "compression", "shear", "bending")}
    cloth = {
        "quality": choice.steps, "mass": 1e3 * FABRIC.areal_density / scene.side**2, "air_damping": 0.0,
        "bending_model": "ANGULAR", **stiffness, **damping,
    }  # fmt: skip
    collision = {
        "use_collision": True, "distance_min": choice.cloth_distance,
        "use_self_collision": True, "self_distance_min": choice.self_distance,
        "self_friction": 100.0 * FABRIC.friction_self,
    }  # fmt: skip
    collider = {
        "thickness_outer": choice.collider_thickness,
        "cloth_friction": 100.0 * FABRIC.friction_body,
    }
    return {"cloth": cloth, "collision": collision, "collider": collider}


def choices(scene: Scene) -> list[BlenderChoice]:
    """The rows of Blender's for a scene."""
    near = BlenderChoice(
        label="Blender", steps=STEPS,
        cloth_distance=MILLIMETRE, self_distance=MILLIMETRE, collider_thickness=MILLIMETRE,
    )  # fmt: skip
    rows = [
        near,
        replace(near, label="Blender, self distance 0.4 edges", self_distance=0.4 * scene.edge),
        replace(near, label="Blender, quarter steps", steps=4 * STEPS),
    ]
    if scene.side <= 50:
        # Of 100 vertices along a side, two seconds were not done after 480 CPU s.
        rows.append(
            BlenderChoice(
                label="Blender, its default distances", steps=STEPS,
                cloth_distance=0.015, self_distance=0.015, collider_thickness=0.02,
            )
        )  # fmt: skip
    return rows
