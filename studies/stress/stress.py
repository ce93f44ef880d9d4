"""The suite of hard cases: small scenes, each with an expected end and a time limit.

A case is valid if every frame is finite and, by the independent audit, free of crossings, and if the film
came to its end within the limit; one that cannot be valid must end in a clear message instead.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

from toile.dressing.files.palette import BODY, garment_colour
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.files.writers.png import png_bytes
from toile.dressing.pictures.preview import PreviewMesh, render
from toile.engine.film.plan import FilmFrame
from toile.engine.film.simulate import Simulation
from toile.remesh.sizing.sizing import SizingOptions
from toile.studies.stress.stress_dressed import DRESSED_CASES, run_dressed_case
from toile.studies.stress.stress_row import StressRow, outcome_of, picture_path
from toile.studies.stress.stress_scene import StressScene
from toile.studies.stress.stress_scenes import STRESS_SCENES

STRESS_CASES = (*STRESS_SCENES, *DRESSED_CASES)
"""Names of all cases."""


def run_case(name: str, remesh: bool, pictures: Path | None = None) -> StressRow:
    """Run one case, on its own mesh or an adaptive one; draw its end into a folder if there is one."""
    if name in DRESSED_CASES:
        return run_dressed_case(name, remesh, pictures)
    scene = STRESS_SCENES[name]()
    plan = scene.plan
    if remesh:
        plan = replace(plan, sizing=SizingOptions(size_min=0.5 * scene.edge, size_max=10.0 * scene.edge))
    started = process_time()
    late = finite = True
    last: FilmFrame | None = None

    def on_frame(frame: FilmFrame) -> bool:
        nonlocal late, finite, last
        last = frame
        late = process_time() - started > scene.limit
        finite = bool(np.isfinite(frame.cloth.positions).all())
        return finite and not late

    film = Simulation(scene.cloth, scene.avatar, plan, on_frame, scene.motion, pin_motion=scene.pin_motion)
    record = film.run(scene.seconds)
    crossings = sum(map(sum, record.crossings))
    failed = bool(record.failure)
    outcome = outcome_of(finite=finite, crossings=crossings, late=late and not failed, broken_off=failed)
    gaps = [gap for gap in record.min_gap if np.isfinite(gap)]
    if pictures is not None and last is not None:
        write_atomic(picture_path(pictures, name, remesh), _picture(scene, last))
    return StressRow(
        case=name,
        remesh=remesh,
        outcome=outcome,
        expected=scene.expected,
        intersections=crossings,
        min_gap_mm=1e3 * min(gaps) if gaps else None,
        strain_percent=100.0 * max(record.stretch_max),
        frames=len(record.crossings) - 1,
        steps=record.steps,
        cpu=process_time() - started,
        message=record.failure,
    )


def run_stress(
    names: list[str], say: Callable[[StressRow], None], pictures: Path | None = None
) -> list[StressRow]:
    """Run cases with and without remeshing; `say` gets every row as it is done."""
    rows = []
    for name in names:
        for remesh in (False, True):
            rows.append(run_case(name, remesh, pictures))
            say(rows[-1])
    return rows


def _picture(scene: StressScene, frame: FilmFrame) -> bytes:
    """Return a PNG of the end of a case."""
    cloth = frame.cloth
    meshes = [
        PreviewMesh(
            positions=cloth.positions, faces=cloth.face_nodes, colour=garment_colour(0), double_sided=True
        )
    ]
    if scene.avatar is not None and frame.avatar is not None and scene.shows_avatar:
        meshes.append(PreviewMesh(positions=frame.avatar, faces=scene.avatar[1], colour=BODY))
    return png_bytes(render(meshes))
