"""A scene without stitches, pins, avatar and self-contact pays for none of them."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from toile.collide.search import ContactSearch
from toile.engine.adapt import remeshing
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fields.fields import Fields
from toile.engine.cloth.goals import Goals
from toile.engine.drape.drape import Drape
from toile.engine.drape.plan import DrapePlan, Frame
from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.bend import Bending
from toile.engine.forces.contact import ContactLaw
from toile.engine.forces.goal import GoalPull
from toile.engine.forces.hold import Holds
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.membrane_damping import MembraneDamping
from toile.engine.forces.step_request import StepRequest
from toile.engine.forces.stitch import Stitches
from toile.engine.forces.untangle import Untangling
from toile.engine.forces.wind import Wind
from toile.engine.solve.preconditioner import two_level
from toile.engine.step import cloth_forces, cloth_run, collisions
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.options import StepOptions
from toile.geometry.stage_clock import StageClock
from toile.studies.scenes.flat_meshes import mesh

GRAVITY = 9.81
SLACK = Fabric(
    name="slack", areal_density=0.1, thickness=2e-4, bending_warp=0.0, bending_weft=0.0, bending_bias=0.0,
    stretch_warp=100.0, stretch_weft=100.0, shear=10.0,
)  # fmt: skip


def options(self_contact: bool = False) -> StepOptions:
    law = ContactLaw(stiffness=1e6, edge_share=1.0)
    return StepOptions(
        gravity=GRAVITY, radius_body=0.002, radius_self=0.001, law_body=law, law_self=law,
        growth_radius=0.006, slip=1e-3, self_contact=self_contact,
    )  # fmt: skip


def sheet(fabric: Fabric) -> Cloth:
    points, faces = mesh("random", 1.0, 1.0, 0.2)
    positions = np.column_stack((points, np.zeros(len(points))))
    return Cloth(
        positions=positions, velocities=np.zeros_like(positions),
        node=np.arange(len(points), dtype=np.int32), faces=faces, rest_corners=points[faces],
        fabrics=(fabric,), fabric=np.zeros(len(faces), np.int32), garment=np.zeros(len(faces), np.int32),
        panel=np.zeros(len(faces), np.int32), uv=points,
        stitches=np.empty((0, 2), np.int32), seam=np.empty(0, np.int32), stitch_length=np.empty(0),
        held=np.empty(0, np.int32), waist=np.empty(0, np.int32), pinned=np.zeros(len(points), bool),
        rest_curved=np.zeros(len(faces), bool), start_positions=positions,
    )  # fmt: skip


def forbidden(what: str) -> Callable[..., Any]:
    def call(*_: Any, **__: Any) -> Any:
        raise AssertionError(f"{what} although nobody asked for it")

    return call


@pytest.fixture
def bare(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make everything that such a scene does not need raise."""
    for name in ("Collisions", "MembraneDamping", "SewingHolds", "Stitches", "Wind", "vertex_normals"):
        monkeypatch.setattr(cloth_forces, name, forbidden(name))
    for name in ("EdgeElastic", "EnclosedGas", "KeyedMembrane", "SurfacePressure", "TimedPull"):
        monkeypatch.setattr(cloth_forces, name, forbidden(name))
    monkeypatch.setattr(Fields, "over", forbidden("Fields"))
    monkeypatch.setattr(remeshing, "end_vertices", forbidden("runs"))
    monkeypatch.setattr(two_level, "_Squares", forbidden("squares"))
    for name in ("ContactSearch", "Untangling", "evaluate_contacts", "safe_factors", "safe_in_motion"):
        monkeypatch.setattr(collisions, name, forbidden(name))
    monkeypatch.setattr(GoalPull, "__init__", forbidden("GoalPull"))
    monkeypatch.setattr(cloth_run, "AvatarSurface", forbidden("AvatarSurface"))


@pytest.mark.usefixtures("bare")
def test_free_cloth_falls_without_search_stitches_holds_or_bending(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Bending, "for_cloth", forbidden("Bending"))
    stepper = cloth_stepper(sheet(SLACK), None, options(), StageClock())
    assert [type(force) for force in stepper.forces] == [Membrane]
    assert stepper.collisions is None and stepper.pinned is None
    before = stepper.x.copy()
    h = 0.01
    outcome = stepper.step(StepRequest(h=h, at_rest=True, cg_tolerance=1e-10))
    assert outcome.contacts == 0
    assert stepper.x - before == pytest.approx(np.tile([0.0, -h * h * GRAVITY, 0.0], (len(before), 1)))


@pytest.mark.usefixtures("bare")
def test_frame_loop_skips_what_has_nothing_to_do() -> None:
    cloth = sheet(SLACK)
    cloth = replace(cloth, pinned=cloth.positions[:, 1] > 0.99)
    phases: set[str] = set()

    def on_frame(frame: Frame) -> bool:
        phases.add(frame.phase)
        return True

    run = Drape(cloth, None, [], DrapePlan(step=options(), max_steps=30), on_frame)
    record = run.run()
    assert phases == {"settling"}
    assert record.node_counts == [len(cloth.positions)]
    assert np.array_equal(run.cloth.positions[cloth.pinned], cloth.positions[cloth.pinned])
    assert run.smallest_gap() is None


def test_what_is_asked_is_there() -> None:
    """The twin: the same sheet with bending, damping, a stitch, goals, air and self-contact has them."""
    cloth = sheet(replace(SLACK, bending_bias=1e-6, damping=1e-3))
    count = len(cloth.positions)
    cloth = replace(
        cloth, stitches=np.array([(0, 3)], np.int32), seam=np.zeros(1, np.int32), stitch_length=np.ones(1),
        goals=Goals(stiffness=np.ones(count), places=cloth.positions),
    )  # fmt: skip
    air = AirFlow(velocity=(0.0, 0.0, 0.0), resistance=1.0)
    stepper = cloth_stepper(cloth, None, replace(options(self_contact=True), air=air), StageClock())
    assert stepper.collisions is not None and isinstance(stepper.collisions.search, ContactSearch)
    for kind in (Membrane, MembraneDamping, Bending, Stitches, Holds, GoalPull, Wind):
        assert isinstance(stepper.force(kind), kind)
    assert stepper.force(Untangling) is None
    stepper.let_pass(np.ones(count, bool))
    assert isinstance(stepper.force(Untangling), Untangling)
    stepper.let_pass(np.zeros(count, bool))
    assert stepper.force(Untangling) is None


@pytest.mark.usefixtures("bare")
def test_damping_is_there_for_the_fabric_that_has_it(monkeypatch: pytest.MonkeyPatch) -> None:
    damped = sheet(replace(SLACK, damping=1e-3))
    assert cloth_stepper(sheet(SLACK), None, options(), StageClock()).force(MembraneDamping) is None
    monkeypatch.setattr(cloth_forces, "MembraneDamping", MembraneDamping)
    stepper = cloth_stepper(damped, None, options(), StageClock())
    assert [type(force) for force in stepper.forces] == [Membrane, MembraneDamping]
