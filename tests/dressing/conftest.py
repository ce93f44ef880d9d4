"""A stand-in for the frame loop: garments stay where they start, frames only count down a residual."""

import sys
from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING, cast

import numpy as np
import pytest

from toile.dressing.body.avatar import Avatar
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.drape_types import (
    DrapedGarment,
    DrapeFigures,
    DrapeOptions,
    DrapeOutcome,
    Failure,
    FrameState,
    Status,
)
from toile.engine.cloth.fabric import Fabric
from toile.geometry.stage_clock import Spent

if TYPE_CHECKING:
    from toile.engine.cloth.cloth import Cloth
    from toile.engine.step.options import StepOptions


class FakeDrape:
    """Callable with the signature of toile.dressing.wear.put_on.drape; remembers what it was asked.

    Its first `jams` calls give up.
    """

    def __init__(self, end: Status, at_start: Callable[[], None] | None, frames: int = 6) -> None:
        self.end = end
        self.at_start = at_start
        self.frames = frames
        self.jams = 0
        self.calls: list[tuple[Avatar, list[tuple[GarmentMesh, Fabric]], DrapeOptions]] = []

    def __call__(
        self,
        avatar: Avatar,
        garments: list[tuple[GarmentMesh, Fabric]],
        options: DrapeOptions,
        on_frame: Callable[[FrameState], bool],
    ) -> DrapeOutcome:
        self.calls.append((avatar, garments, options))
        if self.at_start is not None:
            self.at_start()
        status = self.end
        faces = sum(len(mesh.faces) for mesh, _ in garments)
        for frame in range(1, self.frames + 1):
            state = FrameState(
                frame=frame,
                faces=faces,
                contacts=7 * frame,
                residual=10.0**-frame,
                seconds=0.5 * frame,
                max_frames=options.max_frames,
            )
            if not on_frame(state):
                status = "cancelled"
                break
        figures = DrapeFigures(
            frames=frame,
            simulated_seconds=frame / 24,
            steps=3 * frame,
            newton_iterations=5 * frame,
            cg_iterations=90 * frame,
            nodes=(faces, faces, faces),
            faces=(faces, faces, faces),
            contacts_max=7 * frame,
            avatar_intersections=0,
            self_intersections=0,
            worst_frame_intersections=0,
            min_gap_mm=float("inf"),
            warp_strain_max=1.5,
            weft_strain_max=2.5,
            strain_p99=1.0,
            areas=tuple((0.5, 0.5) for _ in garments),
            strained=(),
            residual=np.float64(0.001),
            remeshings=0,
            splits=0,
            flips=0,
            collapses=0,
            energy_jump_max=0.0,
            pop=0.0,
            stages={"solve": Spent(0.25, 0.5), "io": Spent(0.5, 1.0)},
        )
        failure = Failure(kind="tangled", message="cannot move", where="panel front")
        return DrapeOutcome(
            status=status,
            failure=failure if status == "failed" else None,
            figures=figures,
            garments=[
                DrapedGarment(
                    positions=mesh.positions,
                    faces=mesh.faces,
                    faces_material=mesh.faces,
                    uv=mesh.uv,
                    panel=mesh.panel,
                )
                for mesh, _ in garments
            ],
            cloth=cast("Cloth", None),
            step=cast("StepOptions", None),
            gave_up=len(self.calls) <= self.jams,
        )


@pytest.fixture
def fake_drape(monkeypatch: pytest.MonkeyPatch) -> Callable[..., FakeDrape]:
    """Return a function that puts a FakeDrape where toile.dress looks for the frame loop."""

    def install(end: Status = "converged", at_start: Callable[[], None] | None = None) -> FakeDrape:
        fake = FakeDrape(end, at_start)
        module = ModuleType("toile.dressing.wear.put_on")
        module.drape = fake  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "toile.dressing.wear.put_on", module)
        return fake

    return install
