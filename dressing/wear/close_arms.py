"""Arms that were opened so that garments could be sewn, closed again around what the body wears."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from toile.dressing.body.dress_form import DressForm
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.drape_types import DrapeOptions, DrapeOutcome, Failure, FrameState, in_all
from toile.dressing.wear.put_on import settle_worn
from toile.dressing.wear.taken_apart import taken_apart
from toile.engine.cloth.fabric import Fabric
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.plan import (
    LONGEST_STEP,
    PUSHED_NEWTON,
    PUSHED_RISE,
    PUSHED_TOLERANCE,
    FilmFrame,
    FilmPlan,
)
from toile.engine.film.simulate import Simulation
from toile.geometry.stage_clock import StageClock, together


def close_arms(
    opened: DressForm,
    own: DressForm,
    garments: list[tuple[GarmentMesh, Fabric]],
    options: DrapeOptions,
    hung: DrapeOutcome,
    on_frame: Callable[[FrameState], bool],
) -> tuple[DrapeOutcome, DressForm]:
    """Let garments follow arms that close, and settle on the body as its file has it.

    Parameters
    ----------
    opened, own
        The body with open arms and the motion from there, and as its file has it.
    garments, options
        As they were put on.
    hung
        How they hang on open arms.
    on_frame
        Called after every frame; cancels by returning False.

    Returns
    -------
    tuple
        The outcome, and the body as cloth meets it: skins that touch leave room for it.
    """
    motion = opened.avatar.motion
    assert motion is not None
    clock = StageClock()
    last = len(motion.frames) - 1

    def on_film_frame(frame: FilmFrame) -> bool:
        return on_frame(
            FrameState(
                frame=frame.index, faces=len(frame.cloth.faces), contacts=frame.contacts, residual=np.nan,
                seconds=frame.seconds, max_frames=last, doing="closing the arms",
            )
        )  # fmt: skip

    plan = FilmPlan(
        integrator=tr_bdf2, longest_step=LONGEST_STEP, step=hung.step, frame_seconds=1.0 / motion.fps,
        newton=PUSHED_NEWTON, newton_tolerance=PUSHED_TOLERANCE, stretch_rise=PUSHED_RISE,
        sizing=options.sizing,
    )  # fmt: skip
    body = (opened.avatar.vertices, opened.avatar.faces)
    film = Simulation(hung.cloth, body, plan, on_film_frame, motion, clock, hung.pin_motion)
    made = film.run(motion.seconds)
    skin = film.body()[0]
    assert skin is not None
    form = own.with_skin(skin)
    cloth = film.state().cloth
    cloth = replace(cloth, velocities=np.zeros_like(cloth.positions))
    failure = None
    if made.failure or any(map(sum, made.crossings)):
        failure = Failure(
            kind="motion" if made.failure else "crossing",
            message="its arms were opened to sew the garments, and close into the cloth: "
            f"{made.failure or 'triangles cross'}; pose the body with its arms apart",
            where=f"frame {len(made.crossings) - 1} of {last}",
        )
    if failure is not None or made.cancelled:
        parts = taken_apart(cloth, [mesh.trims for mesh, _ in garments])
        outcome = replace(
            hung, status="failed" if failure is not None else "cancelled", failure=failure, garments=parts,
            cloth=cloth,
        )  # fmt: skip
    else:
        outcome = settle_worn(form, garments, options, cloth, on_frame)
        outcome = replace(outcome, notes=hung.notes, figures=in_all([hung.figures], outcome.figures))
    figures = replace(outcome.figures, stages=together(outcome.figures.stages, clock.spent))
    return replace(outcome, figures=figures), form
