"""A drape from garment meshes to draped garments: start repair, engine, figures."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.spatial import cKDTree

from toile.collide.shrunken import shrunken
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.obstacles.beside import without_obstacles
from toile.dressing.body.place import Place
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.arms import drawn_in_arms
from toile.dressing.wear.assemble_cloth import assemble_cloth, pin_motion
from toile.dressing.wear.drape_types import (
    DrapeFigures,
    DrapeOptions,
    DrapeOutcome,
    Failure,
    FrameState,
    Status,
    in_all,
)
from toile.dressing.wear.fault import faces_at_fault, place_of
from toile.dressing.wear.reel import Reel
from toile.dressing.wear.sewn_pins import pins_in_time
from toile.dressing.wear.start.raised_arms import LEVEL, raised_arms
from toile.dressing.wear.start.start_places import start_places
from toile.dressing.wear.taken_apart import taken_apart
from toile.dressing.wear.watch import Watch, garment_areas, strained_places
from toile.dressing.wear.worn import Worn, worn_together
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.drape.drape import Drape
from toile.engine.drape.plan import STEPS_PER_FRAME, DrapePlan, Growth
from toile.engine.forces.contact import ContactLaw
from toile.engine.forces.contact_pairs import BODY
from toile.engine.forces.ground import Ground
from toile.engine.step.options import StepOptions
from toile.geometry.errors import CrowdedError, InputError

SHRINK = 0.04
"""How far the body is drawn in while seams close [m]."""
BODY_RADIUS = 0.002
SELF_RADIUS = 0.001
GROWTH_RADIUS = 0.006
GROWTH_PER_STEP = 0.005
ARMS_PER_STEP = 0.03
CONTACT_STIFFNESS = 2e6
"""Pressure per depth of contact [Pa/m]: a tight garment's 500 Pa sinks in 0.25 mm."""
SLIP = 1e-3
LEAST_MERGE_GAP, MERGE_GAP = 0.006, 0.5
"""Gap at which stitches merge: at least [m], and in edges, since they pull against whole edges."""
LEAST_LATE_STIFFNESS, LATE_STIFFNESS = 1000.0, 6e4
"""Stiffness of a stitch that is open after sewing: at least [N/m], and per edge length [N/m^2]."""
PEAK_OVER_RMS = 10.0
MOST_WORK, MOST_PER_FACE, MOST_IN_ALL = 1e6, 600, 2.5e6
"""Newton iterations times faces after which a garment that is still being put on is given up: at least, per
face of the mesh at the start, and at most. Three times what any takes that is put on in its first mesh."""
HELD_WITHIN = 0.015
"""Distance within which cloth may hold back the body [m]."""


def drape(
    form: DressForm,
    garments: list[tuple[GarmentMesh, Fabric]],
    options: DrapeOptions,
    on_frame: Callable[[FrameState], bool],
) -> DrapeOutcome:
    """Drape garments on a still body.

    Several patterns are put on one after the other, from the body outwards, each over those worn already; at
    last they hang together. Garments that are 3-D meshes all start where they are. `on_frame` is called after
    every output frame and cancels the drape by returning False.

    Raises
    ------
    InputError
        A garment starts in a way that cannot be repaired.
    """
    layered = len(garments) > 1 and all(mesh.flat for mesh, _ in garments)
    reel = Reel(on_frame, options.max_frames * (len(garments) + 1 if layered else 1))
    if not layered:
        return _put_on(form, garments, options, reel, [])
    parts: list[DrapeOutcome] = []
    for index, garment in enumerate(garments):
        own = replace(options, pins=options.pins[index : index + 1])
        parts.append(_put_on(form, [garment], own, reel, [part.cloth for part in parts]))
        if parts[-1].gave_up or parts[-1].status == "cancelled" or _is_over(parts[-1].failure):
            break
    worn = garments[: len(parts)]
    watch = Watch(form.avatar.vertices, [mesh for mesh, _ in worn], form.place)
    run = Drape(
        worn_together([part.cloth for part in parts]), (form.avatar.vertices, form.avatar.faces), [],
        _plan(options, _all_fabrics(worn)), reel.showing(watch),
    )  # fmt: skip
    failure = next((part.failure for part in parts if part.failure is not None), None)
    run.record.cancelled = parts[-1].status == "cancelled"
    if not (parts[-1].gave_up or run.record.cancelled or _is_over(failure)):
        failure = _broken_down(run, run.hang, watch) or failure
    else:
        run.close_frame(0)
    notes = tuple(note for part in parts for note in part.notes)
    outcome = _outcome(run, worn, failure, notes, watch, form.place)
    return replace(
        outcome, gave_up=parts[-1].gave_up, work=sum(part.work for part in parts),
        figures=in_all([part.figures for part in parts], outcome.figures),
    )  # fmt: skip


def settle_worn(
    form: DressForm,
    garments: list[tuple[GarmentMesh, Fabric]],
    options: DrapeOptions,
    cloth: Cloth,
    on_frame: Callable[[FrameState], bool],
) -> DrapeOutcome:
    """Let cloth that is worn on a still body find equilibrium there."""
    watch = Watch(form.avatar.vertices, [mesh for mesh, _ in garments], form.place)
    run = Drape(
        cloth, (form.avatar.vertices, form.avatar.faces), [], _plan(options, _all_fabrics(garments)),
        Reel(on_frame, options.max_frames).showing(watch),
    )  # fmt: skip
    return _outcome(run, garments, _broken_down(run, run.hang, watch), (), watch, form.place)


def _put_on(
    form: DressForm, garments: list[tuple[GarmentMesh, Fabric]], options: DrapeOptions, reel: Reel,
    worn: list[Cloth],
) -> DrapeOutcome:  # fmt: skip
    """Sew garments on the body, over what is worn, and let them settle."""
    avatar = form.avatar
    clothed = Worn(avatar.vertices, avatar.faces, worn)
    thin = shrunken(avatar.vertices, avatar.faces, SHRINK)
    notes = [f"garment '{mesh.name}': {note}" for mesh, _ in garments for note in mesh.notes]
    shapes = [(avatar.vertices, GROWTH_PER_STEP)]
    body = None if isinstance(form.measured, InputError) else form.measured
    alone, around = thin[: avatar.body_count], thin[avatar.body_count :]
    raised = raised_arms(alone, avatar.alone.faces, body, [mesh for mesh, _ in garments])
    drawn = drawn_in_arms(alone, body, [mesh for mesh, _ in garments]) if raised is None else None
    if raised is not None:
        (first, *later), raised_sleeves = raised
        later = [*(np.concatenate([shape, around]) for shape in later), thin]
        shapes = [*((shape, ARMS_PER_STEP) for shape in later), *shapes]
        thin = np.concatenate([first, around])
        garments = [(mesh, fabric) for mesh, (_, fabric) in zip(raised_sleeves, garments, strict=True)]
        notes.append(
            "the arms are raised until the garment hangs, so that its skirt closes below the sleeves"
        )
    if drawn is not None:
        shapes.insert(0, (thin, ARMS_PER_STEP))
        thin = np.concatenate([drawn, around])
        notes.append("the arms are drawn in until the garment hangs, so that it does not catch on them")
    growth = [Growth(vertices=clothed.on(shape), per_step=per_step) for shape, per_step in shapes]
    obstacle = (clothed.on(thin), clothed.faces)
    arm_angle = 0.0 if body is None else float(LEVEL if raised is not None else body.arm_angle)
    dressed = without_obstacles(*obstacle, avatar.obstacles)
    meshes, said = start_places([mesh for mesh, _ in garments], dressed, obstacle, body, arm_angle)
    notes += said
    at_once, when_sewn = pins_in_time(meshes, options.pins)
    cloth = assemble_cloth(
        [(mesh, fabric) for mesh, (_, fabric) in zip(meshes, garments, strict=True)], at_once
    )
    watch = Watch(avatar.vertices, [mesh for mesh, _ in garments], form.place)
    most = min(max(MOST_WORK, MOST_PER_FACE * len(cloth.faces)), MOST_IN_ALL)
    plan = _plan(options, _all_fabrics(garments))
    plan = replace(plan, most_work=most if plan.most_work is None else min(most, plan.most_work))
    run = Drape(cloth, obstacle, growth, plan, reel.showing(watch), when_sewn)
    return _outcome(run, garments, _broken_down(run, run.run, watch), tuple(notes), watch, form.place)


def _is_over(failure: Failure | None) -> bool:
    """Whether a failure leaves nothing to go on with."""
    return failure is not None and failure.kind in ("overstretched", "fell_off")


def _broken_down(run: Drape, phases: Callable[[], object], watch: Watch) -> Failure | None:
    """Run a drape; return what happened if its numbers broke down, or if the watch stopped it."""
    try:
        phases()
        if watch.failure is not None:
            run.record.cancelled = False
            return watch.failure
    except FloatingPointError as error:
        return Failure(
            kind="numerical", message=f"the solver broke down: {error}", where=f"step {run.record.steps}"
        )
    except CrowdedError as error:
        return Failure(kind="numerical", message=str(error), where=f"step {run.record.steps}")
    return None


def _all_fabrics(garments: list[tuple[GarmentMesh, Fabric]]) -> list[Fabric]:
    """Return the fabrics of garments and of their panels."""
    return [entry for mesh, fabric in garments for entry in (fabric, *mesh.panel_fabrics.values())]


def _plan(options: DrapeOptions, fabrics: list[Fabric]) -> DrapePlan:
    """Turn options into the engine's numbers."""
    friction = dict(options.friction_between)
    if options.friction is not None:
        friction = {frozenset((fabric.name, BODY)): options.friction for fabric in fabrics} | friction
    return DrapePlan(
        step=StepOptions(
            gravity=options.gravity,
            radius_body=BODY_RADIUS,
            radius_self=SELF_RADIUS,
            growth_radius=GROWTH_RADIUS,
            law_body=ContactLaw(stiffness=CONTACT_STIFFNESS, edge_share=0.5),
            law_self=ContactLaw(stiffness=CONTACT_STIFFNESS, edge_share=1.0),
            friction=friction,
            slip=SLIP,
            self_contact=not options.self_contact or any(options.self_contact),
            parts=options.obstacles,
            more_forces=() if options.ground is None else (partial(Ground.under, options.ground),),
        ),
        max_steps=options.max_frames * STEPS_PER_FRAME,
        rms_motion=options.tolerance,
        peak_motion=PEAK_OVER_RMS * options.tolerance,
        merge_gap=max(LEAST_MERGE_GAP, MERGE_GAP * options.edge_length),
        late_stiffness=max(LEAST_LATE_STIFFNESS, LATE_STIFFNESS * options.edge_length),
        sizing=options.sizing,
        persistent=options.persistent,
        most_work=options.most_work,
    )


def _outcome(
    run: Drape,
    garments: list[tuple[GarmentMesh, Fabric]],
    failure: Failure | None,
    notes: tuple[str, ...],
    watch: Watch,
    place: Place,
) -> DrapeOutcome:
    """Read the outcome off a finished drape; `failure` is what broke it down, if anything did."""
    record, meshes = run.record, [mesh for mesh, _ in garments]
    if failure is None and not record.cancelled:
        failure = _shortcoming(run, meshes, place) or (None if record.gave_up else watch.at_end(run.cloth))
        if failure is not None and run.is_spent():
            each = record.work / record.first_faces
            failure = replace(
                failure, message=f"{failure.message}; given up after {each:.0f} Newton iterations per face"
            )
    status: Status = "frame_limit"
    if record.cancelled:
        status = "cancelled"
    elif failure is not None:
        status = "failed"
    elif record.converged:
        status = "converged"
    return DrapeOutcome(
        status=status, failure=failure, figures=_figures(run, meshes, place),
        garments=taken_apart(run.cloth, [mesh.trims for mesh in meshes]),
        cloth=run.cloth, step=run.plan.step, notes=notes,
        gave_up=record.gave_up, work=record.work, pin_motion=pin_motion(meshes, run.cloth.origin),
        anchors=run.anchors(),
    )  # fmt: skip


def _shortcoming(run: Drape, meshes: list[GarmentMesh], place: Place) -> Failure | None:
    """Return what a drape that went to its end has not achieved, None if it is fine."""
    record, cloth = run.record, run.cloth
    last = record.crossings[-1]
    if sum(last):
        found = run.audit()
        where = place_of(cloth, found, meshes, place)
        return Failure(
            kind="tangled",
            message=f"{sum(last)} pairs of triangles still cross; the garment could not be disentangled "
            "(start its pieces farther from the body and from each other, or check its size)",
            where=f"frame {len(record.crossings) - 1}; {where}",
            faces=faces_at_fault(cloth, found),
        )
    gaps = run.gaps()
    # What is closer than cloth keeps from cloth is closed, though its nodes are still two.
    is_open = gaps > run.plan.closed_gap
    if is_open.any():
        names = [name for mesh in meshes for name in mesh.seam_names]
        seams = sorted({names[index] for index in cloth.seam[is_open]})
        why = (
            "the garment may be too small for this body, its panels may start across each other, or cloth is "
            "in the way (place the panels named here farther apart, or check their seams)"
        )
        if run.phase != "settling" and run.record.steps >= run.plan.max_steps:
            why = _unfinished(run)
        return Failure(
            kind="open_seams",
            message=f"{is_open.sum()} stitches did not close, gap up to {gaps.max() * 1e3:.0f} mm; {why}",
            where=", ".join(seams),
        )
    if run.phase != "settling":
        return Failure(
            kind="not_sewn",
            message=_unfinished(run),
            where=f"frame {len(record.crossings) - 1}{_held_back(run, place)}",
        )
    return None


def _unfinished(run: Drape) -> str:
    """Say why a garment is not sewn yet."""
    if run.record.steps < run.plan.max_steps:
        return (
            f"the garment jammed while it was still {run.phase}; place its panels farther from the body and "
            "from each other, or check its size"
        )
    return f"the frame limit was reached while the garment was still {run.phase}; allow more frames"


def _held_back(run: Drape, place: Place) -> str:
    """Say where a growing body, next to the cloth, lacks the most."""
    if run.phase != "growing" or run.surface is None or not run.growth:
        return ""
    body = run.surface.vertices
    away, _ = cKDTree(run.stepper.x).query(body, distance_upper_bound=HELD_WITHIN)
    left = np.where(np.isfinite(away), np.linalg.norm(run.growth[-1].vertices - body, axis=1), 0.0)
    x, y, z = place.outward(body[int(left.argmax())])
    return f"; under the cloth the body lacks {1e3 * left.max():.0f} mm near ({x:.2f}, {y:.2f}, {z:.2f}) m"


def _figures(run: Drape, meshes: list[GarmentMesh], place: Place) -> DrapeFigures:
    """Read the figures off a finished drape."""
    record = run.record
    settled = record.settled_crossings or record.crossings[-1:]
    last = record.crossings[-1]
    strain, smallest_gap = 100.0 * run.warp_weft_strain(), run.smallest_gap()
    cut = np.bincount(run.cloth.garment, run.cloth.rest_area, len(meshes))
    counts = record.node_counts
    faces = [record.first_faces, *(entry.faces for entry in record.remeshings)]
    return DrapeFigures(
        frames=len(record.crossings) - 1,
        simulated_seconds=record.simulated_seconds,
        steps=record.steps,
        newton_iterations=record.newton_iterations,
        cg_iterations=record.cg_iterations,
        nodes=(counts[0], counts[-1], max(counts)),
        faces=(faces[0], faces[-1], max(faces)),
        contacts_max=record.contacts_max,
        avatar_intersections=last[0],
        self_intersections=last[1],
        worst_frame_intersections=max(a + b for a, b in settled),
        min_gap_mm=None if smallest_gap is None else 1e3 * smallest_gap,
        warp_strain_max=float(strain[:, 0].max()),
        weft_strain_max=float(strain[:, 1].max()),
        strain_p99=float(np.quantile(strain, 0.99)),
        areas=tuple(zip(garment_areas(run.cloth, len(meshes)), cut.tolist(), strict=True)),
        strained=strained_places(run.cloth, meshes, place),
        residual=record.rms_motion,
        remeshings=len(record.remeshings),
        splits=sum(done.splits for done in record.remeshings),
        flips=sum(done.flips for done in record.remeshings),
        collapses=sum(done.collapses for done in record.remeshings),
        energy_jump_max=max((done.energy_jump for done in record.remeshings), default=0.0),
        pop=record.pop,
        stages=run.clock.spent,
    )
