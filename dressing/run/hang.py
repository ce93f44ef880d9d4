"""Garments of a scene put on its avatar: read, sewn, hanging, and the report of it."""

from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.obstacles.beside import beside
from toile.dressing.body.obstacles.solid import Solid, read_obstacle
from toile.dressing.body.place import ROOM, Place
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.pattern.drawn.read_drawn import DRAWN_FORMATS
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.pattern.sewing_edges import SewingEdges
from toile.dressing.run.checkpoint import Checkpoint, Hung
from toile.dressing.run.kernels import (
    DRAPE_KERNELS,
    PANEL_KERNELS,
    PICTURE_KERNELS,
    REMESH_KERNELS,
    load_kernels,
)
from toile.dressing.run.lead_in import HANGING, led_in
from toile.dressing.run.listener import Listener
from toile.dressing.run.load_garment import load_garment, pinned_vertices
from toile.dressing.run.output.garment_figures import strain_figures
from toile.dressing.run.output.input_files import input_hashes
from toile.dressing.run.report import RunSpent, drape_report
from toile.dressing.run.resolved_scene import ResolvedScene
from toile.dressing.run.result import DressedGarment
from toile.dressing.run.scene import AvatarFile, MannequinSize
from toile.dressing.run.scene_avatar import load_dress_form
from toile.dressing.wear.coarsest_edges import fitting_sizing
from toile.dressing.wear.drape_types import DrapedGarment, DrapeOptions, DrapeOutcome
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError
from toile.geometry.stage_clock import Spent, now, together

PATTERNS = (".json", *DRAWN_FORMATS)
"""Ends of the names of files that hold panels to be sewn."""
MOST_RETRIED = 8e5
"""Faces times Newton iterations in jammed attempts after which the next is the last: 20 CPU s or so."""
LAST_WORK, LAST_PER_FACE = 1e6, 300
"""What the last attempt may take then until the garment settles: at least; and per face, or twice what the
one before took, as long as there is as much left."""
ALL_WORK = 3.5e6
"""What all attempts may take together: 60 CPU s or less."""


@dataclass(frozen=True)
class _Sewing:
    """The last sewing attempt, and the time of all attempts: reading, and by stages.

    `form` is the body as cloth meets it, among obstacles.
    """

    form: DressForm
    cloth: list[tuple[GarmentMesh, Fabric]]
    options: DrapeOptions
    outcome: DrapeOutcome
    reading: Spent
    stages: dict[str, Spent]


def hang(scene: ResolvedScene, checkpoint: Checkpoint | None, listener: Listener) -> Hung:
    """Put the garments on the avatar as it is at the start.

    `checkpoint` is where the scene is noted once all of it is read, or None. Raises InputError if a file is
    at fault, or a garment cannot be put on its avatar.
    """
    started = now()
    avatar, form = load_dress_form(scene.avatar, scene.measurements)
    own = form
    avatar, form, led = _led_in(scene, avatar, own)
    for note in (*avatar.notes, *form.notes, *led):
        listener.say(f"{avatar.name}: {note}")
    for note in _doubts(scene, form):
        listener.say(f"{avatar.name}: {note}")
    loading = load_scene_kernels(scene, checkpoint is not None, listener)
    solids = _solids(scene, avatar, listener)
    opened = avatar.motion is None and form.avatar.motion is not None
    avatar = beside(avatar, solids, ROOM)
    _say_jump(avatar, listener)
    reading = now().less(started).less(loading)
    moved = _among(form, solids, still=opened)
    sewing = _sew(scene, form, moved, checkpoint, listener)
    if opened:
        moved = _among(own, solids)
        sewing = _closed(sewing, moved, listener, scene.tolerance)
    outcome, form = sewing.outcome, sewing.form
    if form.avatar is not moved.avatar:
        avatar = replace(avatar, vertices=form.place.outward(form.avatar.vertices))
    for note in outcome.notes:
        listener.say(note)
    for place in outcome.figures.strained:
        listener.say(f"strained by up to {place.percent:.0f} % in {place.faces} faces: {place.where}")
    garments = tuple(
        _dressed(mesh, fabric, draped, form.place)
        for (mesh, fabric), draped in zip(sewing.cloth, outcome.garments, strict=False)
    )
    report = drape_report(
        status=outcome.status,
        failure=outcome.failure,
        figures=replace(outcome.figures, stages=sewing.stages),
        quality=scene.quality,
        options=sewing.options,
        avatar=_avatar_facts(avatar),
        garments=[
            _garment_facts(garment, mesh) for garment, (mesh, _) in zip(garments, sewing.cloth, strict=False)
        ],
        spent=RunSpent(total=now().less(started), io=reading.plus(sewing.reading), compile=loading),
        inputs=input_hashes(scene),
    )
    return Hung(
        avatar=replace(avatar, motion=None), body=form.avatar, place=form.place, drape=outcome,
        garments=garments, report=report, sizing=sewing.options.sizing,
    )  # fmt: skip


def _solids(scene: ResolvedScene, avatar: Avatar, listener: Listener) -> list[Solid]:
    """Return the obstacles beside the avatar, read, and say what was repaired."""
    solids = [read_obstacle(obstacle, avatar) for obstacle in scene.obstacles]
    for solid in solids:
        for note in solid.notes:
            listener.say(f"{solid.name}: {note}")
    return solids


def _among(form: DressForm, solids: list[Solid], *, still: bool = False) -> DressForm:
    """Return a body among obstacles, which stay where the film begins if `still`; without any, itself."""
    if not solids:
        return form
    return form.with_avatar(beside(form.avatar, solids, form.place, still=still))


def _closed(sewing: _Sewing, own: DressForm, listener: Listener, tolerance: float) -> _Sewing:
    """Return garments that hang on open arms after these have closed, on a body that stands still."""
    from toile.dressing.wear.close_arms import close_arms
    from toile.dressing.wear.skins_apart import NOTABLE

    opened = sewing.form
    if sewing.outcome.status not in ("converged", "frame_limit"):
        still = copy(opened)
        still.avatar = replace(opened.avatar, motion=None)
        return replace(sewing, form=still)
    hung = replace(sewing.outcome, figures=replace(sewing.outcome.figures, stages=sewing.stages))
    outcome, form = close_arms(
        opened, own, sewing.cloth, sewing.options, hung, listener.on_frame(tolerance)
    )  # fmt: skip
    depth = float(np.linalg.norm(form.avatar.vertices - own.avatar.vertices, axis=1).max())
    if outcome.failure is None and depth > NOTABLE:
        listener.say(
            f"{own.avatar.name}: where its skins meet they give way by up to {1e3 * depth:.0f} mm, so that "
            "cloth has room between them"
        )
    return replace(sewing, form=form, outcome=outcome, stages=dict(outcome.figures.stages))


def _is_sewn(scene: ResolvedScene) -> bool:
    """Whether a garment of the scene is sewn of panels."""
    return any(
        isinstance(garment.source, str | Pattern)
        or (isinstance(garment.source, Path) and garment.source.suffix.lower() in PATTERNS)
        for garment in scene.garments
    )


def _led_in(
    scene: ResolvedScene, avatar: Avatar, form: DressForm
) -> tuple[Avatar, DressForm, tuple[str, ...]]:
    """Return the avatar and its form as its garments are put on, and a sentence where a lead-in was made."""
    if not isinstance(scene.avatar, AvatarFile):
        return avatar, form, ()
    avatar, form, why = led_in(scene.avatar, avatar, form, _is_sewn(scene))
    return avatar, form, () if why is None else (why,)


def _doubts(scene: ResolvedScene, form: DressForm) -> Iterator[str]:
    """Say at once what may stand in the way of sewing: a pose in which sleeves find no room."""
    if not _is_sewn(scene) or isinstance(scene.avatar, MannequinSize):
        return
    found = form.measured
    if isinstance(found, InputError):
        yield f"{found}; panels that need the pose may not find their place"
    elif found.arm_angle > HANGING:
        begins = " in its first frame; begin the clip" if form.avatar.motion is not None else "; pose it"
        yield (
            f"its arms hang, {np.degrees(found.arm_angle):.0f} degrees below the horizontal{begins} with "
            "them apart (45 degrees) if seams of sleeves jam"
        )


def _say_jump(avatar: Avatar, listener: Listener) -> None:
    """Say where a film will end early."""
    from toile.dressing.run.jumps import jump_of

    jump = jump_of(avatar)
    if jump is not None:
        listener.say(f"{avatar.name}: {jump}")


def load_scene_kernels(scene: ResolvedScene, draws: bool, listener: Listener) -> Spent:
    """Import what a scene needs of the modules that hold kernels; return the time that took.

    Kernels are compiled when they are imported for the first time, and loaded from disk afterwards.
    """
    started = now()
    from toile.geometry.kernel import WARM

    if not WARM:
        listener.say("compiling kernels (once)")
    modules: tuple[str, ...] = DRAPE_KERNELS
    if any(not isinstance(garment.source, GarmentMesh) for garment in scene.garments):
        modules += PANEL_KERNELS
    if scene.sizing is not None:
        modules += REMESH_KERNELS
    if draws:
        modules += PICTURE_KERNELS
    load_kernels(modules)
    import_module("toile.dressing.wear.put_on")
    return now().less(started)


def _sew(
    scene: ResolvedScene, form: DressForm, around: DressForm, checkpoint: Checkpoint | None,
    listener: Listener,
) -> _Sewing:  # fmt: skip
    """Read and drape the garments, in other triangles where seams jam.

    Garments are made for the body of `form`, and meet the same one among obstacles, `around`.
    """
    from toile.dressing.wear.put_on import drape
    from toile.dressing.wear.skins_apart import skins_apart

    reading = Spent()
    stages: dict[str, Spent] = {}
    work = last_work = 0
    meshes: list[GarmentMesh] = []
    worn = around
    for edges in scene.sewing:
        started = now()
        before, meshes = meshes, [load_garment(garment, form, edges) for garment in scene.garments]
        options = _options(scene, meshes, edges, form)
        if around.avatar.obstacles:
            options = replace(options, obstacles=around.avatar.obstacles)
        if work >= MOST_RETRIED:
            options = replace(options, persistent=True, most_work=_work_left(meshes, work, last_work))
        reading = reading.plus(now().less(started))
        if not options.persistent and _are_same(before, meshes):
            continue
        cloth = [
            (mesh, _as_thick(garment.fabric, mesh.thickness))
            for mesh, garment in zip(meshes, scene.garments, strict=True)
        ]
        if checkpoint is not None and edges == scene.sewing[0]:
            # Only after everything was read: a typing error must not delete a run that can be resumed.
            checkpoint.begin(scene)
        worn, said = skins_apart(around, meshes)
        if said is not None and edges == scene.sewing[0]:
            listener.say(f"{form.avatar.name}: {said}")
        outcome = drape(worn, cloth, options, listener.on_frame(scene.tolerance))
        stages = together(stages, outcome.figures.stages)
        work, last_work = work + outcome.work, outcome.work
        if not outcome.gave_up:
            break
        listener.say(f"seams jammed in triangles of {1e3 * edges.length:g} mm; sewing again in others")
    return _Sewing(worn, cloth, options, outcome, reading, stages)


def _work_left(meshes: list[GarmentMesh], work: int, last_work: int) -> float:
    """Return what the last attempt may take, after others that took `work`, the one before `last_work`."""
    wanted = max(2.0 * last_work, LAST_PER_FACE * sum(len(mesh.faces) for mesh in meshes))
    return max(LAST_WORK, min(wanted, ALL_WORK - work))


def _are_same(before: list[GarmentMesh], meshes: list[GarmentMesh]) -> bool:
    """Whether garments without seams have the triangles that they had before, and would jam again."""
    return len(before) == len(meshes) and all(
        not len(mesh.stitches)
        and np.array_equal(mesh.faces, old.faces)
        and np.array_equal(mesh.positions, old.positions)
        for old, mesh in zip(before, meshes, strict=True)
    )


def floor_height(ground: bool | float, form: DressForm) -> float | None:
    """Return the height of the floor [m]: a scene's own, that under the feet of a body that stands, or None.

    A body stands if it can be measured. Where it moves, the floor is as low as its feet ever get.
    """
    if not isinstance(ground, bool):
        return float(ground) - form.place.origin[1]
    if not ground or isinstance(form.measured, InputError):
        return None
    motion = form.avatar.motion
    low = float(form.avatar.vertices[:, 1].min())
    return low if motion is None else min(low, float(motion.frames[:, :, 1].min()))


def _options(
    scene: ResolvedScene, meshes: list[GarmentMesh], edges: SewingEdges, form: DressForm
) -> DrapeOptions:
    """Return how garments are draped that are sewn in these edges."""
    return DrapeOptions(
        edge_length=edges.length,
        max_frames=scene.max_frames,
        tolerance=scene.tolerance,
        sizing=fitting_sizing(scene.sizing, meshes, form.avatar.vertices, form.avatar.faces),
        gravity=scene.gravity,
        friction=scene.friction,
        friction_between=scene.friction_between,
        pins=tuple(
            pinned_vertices(mesh, garment.pins) for mesh, garment in zip(meshes, scene.garments, strict=True)
        ),
        self_contact=tuple(garment.self_contact for garment in scene.garments),
        persistent=edges == scene.sewing[-1],
        ground=floor_height(scene.ground, form),
    )


def _as_thick(fabric: Fabric, thickness: float | None) -> Fabric:
    """Return a fabric of the thickness that a garment's file shows [m], where it shows one."""
    return fabric if thickness is None else replace(fabric, thickness=thickness)


def _dressed(mesh: GarmentMesh, fabric: Fabric, draped: DrapedGarment, place: Place) -> DressedGarment:
    """Return a draped garment in the room, with its name and panels."""
    return DressedGarment(
        name=mesh.name,
        fabric=fabric,
        positions=place.outward(draped.positions),
        faces=draped.faces,
        uv=draped.uv,
        uv_faces=draped.faces_material,
        panel=draped.panel,
        panel_names=mesh.panel_names,
        velocities=None if draped.velocities is None else place.turned_out(draped.velocities),
        origin=draped.origin,
        strain=draped.strain,
        trims=mesh.trims,
    )


def _avatar_facts(avatar: Avatar) -> dict[str, Any]:
    """Return what the report says about the avatar."""
    return {
        "name": avatar.name,
        "vertices": len(avatar.vertices),
        "faces": len(avatar.faces),
        "metres_per_unit": avatar.metres_per_unit,
        "up_axis": avatar.up_axis,
        "front_degrees": avatar.front,
        "notes": list(avatar.notes),
    }


def _garment_facts(garment: DressedGarment, mesh: GarmentMesh) -> dict[str, Any]:
    """Return what the report says about a garment."""
    return {
        "name": garment.name,
        "fabric": garment.fabric.name,
        "panels": list(garment.panel_names),
        "nodes": len(garment.positions),
        "faces": len(garment.faces),
        "stitches": len(mesh.stitches),
        "minimum_angle_degrees": mesh.minimum_angle,
    } | strain_figures(garment)
