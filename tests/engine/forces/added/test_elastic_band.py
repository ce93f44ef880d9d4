"""Elastic along edges and elastic regions: tension and pressure on a cylinder against theory."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from tests.engine.forces.added.shapes import SOFT, tube
from tests.engine.step.test_only_what_is_asked import options
from toile.collide.avatar_surface import AvatarSurface
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.edge_runs import EdgeRun
from toile.engine.cloth.fields.fields import Fields
from toile.engine.forces.added.edge_elastic import EdgeElastic
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.step import ClothStepper
from toile.geometry.stage_clock import StageClock

RADIUS, GIRTH, WIDTH, EDGE = 0.1, 0.72, 0.03, 0.015
FIRM = 4.0
"""Of elastic along an edge [N]."""
REST = 0.7


def cylinder() -> AvatarSurface:
    shape = trimesh.creation.cylinder(radius=RADIUS, height=0.2, sections=96)
    points = np.ascontiguousarray(np.array(shape.vertices)[:, [0, 2, 1]])
    faces = np.ascontiguousarray(np.array(shape.faces, np.int32)[:, [0, 2, 1]])
    return AvatarSurface(points, faces)


def settled(cloth: Cloth) -> ClothStepper:
    """On the cylinder, without gravity."""
    stepper = cloth_stepper(cloth, cylinder(), replace(options(), gravity=0.0), StageClock())
    for h in [0.01] * 20 + [0.05] * 40:
        stepper.step(StepRequest(h=h, at_rest=True, friction=False, cg_tolerance=1e-5))
    return stepper


def push(stepper: ClothStepper) -> float:
    """Force with which the cylinder pushes cloth outwards, summed over it [N]."""
    assert stepper.collisions is not None
    force = np.zeros_like(stepper.x)
    stepper.collisions.add_gradient(stepper.x, force)
    outwards = stepper.x * [1.0, 0.0, 1.0]
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    return -float((force * outwards).sum())


def girth(stepper: ClothStepper) -> float:
    """Mean length around, measured along the edges of rows [m]."""
    around = np.linalg.norm(stepper.x[:, [0, 2]], axis=1).mean()
    return float(2.0 * np.pi * around)


def test_elastic_along_an_edge_has_the_tension_of_its_strain_and_presses_by_t_over_r() -> None:
    lower = np.array([[(0.0, 0.0, 0.0), (GIRTH, 0.0, 0.0)]])
    run = EdgeRun(garment=0, panel=0, lines=lower, rest=REST, stiffness=FIRM)
    cloth = replace(tube(GIRTH, WIDTH, EDGE, 0.115), elastic=(run,))
    stepper = settled(cloth)
    force = stepper.force(EdgeElastic)
    assert force is not None and len(force.nodes) == round(GIRTH / EDGE)
    low = np.unique(force.nodes)
    at = float(np.linalg.norm(stepper.x[low][:, [0, 2]], axis=1).mean())
    theory = FIRM * (2.0 * np.pi * at / (REST * GIRTH) - 1.0)
    tension = force.tension(stepper.x)
    assert theory > 0.8
    assert tension == pytest.approx(theory, rel=0.02)
    # T/R per length of band, all around
    assert push(stepper) == pytest.approx(2.0 * np.pi * theory, rel=0.03)


def test_an_elastic_region_has_the_tension_of_its_strain_and_presses_by_t_over_r() -> None:
    cloth = tube(GIRTH, WIDTH, EDGE, 0.115)
    everywhere = np.zeros(len(cloth.faces), np.int32)
    cloth = replace(cloth, fields=Fields(region=everywhere, values=({"rest_warp": REST},)))
    stepper = settled(cloth)
    membrane = stepper.force(Membrane)
    assert membrane is not None
    strain = girth(stepper) / (REST * GIRTH) - 1.0
    tension = SOFT.stretch_warp * strain * WIDTH
    assert membrane.warp_weft_strain(stepper.x)[:, 0] == pytest.approx(strain, rel=0.02)
    gradient = np.zeros_like(stepper.x)
    membrane.add_gradient(stepper.x, gradient)
    outwards = stepper.x * [1.0, 0.0, 1.0]
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    assert float((gradient * outwards).sum()) == pytest.approx(2.0 * np.pi * tension, rel=0.02)
    assert push(stepper) == pytest.approx(2.0 * np.pi * tension, rel=0.03)


def test_it_waits_for_the_seams() -> None:
    lower = np.array([[(0.0, 0.0, 0.0), (GIRTH, 0.0, 0.0)]])
    run = EdgeRun(garment=0, panel=0, lines=lower, rest=REST, stiffness=FIRM)
    cloth = replace(tube(GIRTH, WIDTH, EDGE, 0.115), elastic=(run,))
    everywhere = np.zeros(len(cloth.faces), np.int32)
    fields = Fields(region=everywhere, values=({"rest_warp": REST, "pressure": 10.0},))
    sewn = replace(cloth, fields=fields)
    open_seams = replace(sewn, stitches=np.array([(0, 5)], np.int32))
    assert EdgeElastic.for_cloth(sewn) is not None
    assert EdgeElastic.for_cloth(open_seams) is None
    assert open_seams.rest_scale(0.0) is None
    assert sewn.rest_scale(0.0) == pytest.approx(np.tile([REST, 1.0], (len(cloth.faces), 1)))
