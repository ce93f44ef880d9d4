"""Garments of a scene put on its avatar: read, sewn, hanging, and the report of it."""

import time
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.pattern.sewing_edges import SewingEdges
from toile.dressing.run.checkpoint import Checkpoint, Hung
from toile.dressing.run.kernels import (
    DRAPE_KERNELS,
    PANEL_KERNELS,
    PICTURE_KERNELS,
    REMESH_KERNELS,
    load_kernels,
)
from toile.dressing.run.listener import Listener
from toile.dressing.run.load_garment import load_garment, pinned_vertices
from toile.dressing.run.report import RunSeconds, drape_report
from toile.dressing.run.resolved_scene import ResolvedScene
from toile.dressing.run.result import DressedGarment
from toile.dressing.run.scene_avatar import load_scene_avatar
from toile.dressing.wear.drape_types import DrapedGarment, DrapeOptions, DrapeOutcome
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError

MOST_RETRIED = 8e5
"""Faces times Newton iterations in jammed attempts after which the next is the last: 20 CPU s or so."""
LAST_WORK = 1e6
"""What the last attempt may take then until the garment settles, or twice what the one before took."""


@dataclass(frozen=True)
class _Sewing:
    """The last sewing attempt, and the wall time of all attempts [s]: reading, and by stages."""

    cloth: list[tuple[GarmentMesh, Fabric]]
    options: DrapeOptions
    outcome: DrapeOutcome
    reading_seconds: float
    stage_seconds: dict[str, float]


def hang(scene: ResolvedScene, checkpoint: Checkpoint | None, listener: Listener) -> Hung:
    """Put the garments on the avatar as it is at the start.

    `checkpoint` is where the scene is noted once all of it is read, or None. Raises InputError if a file is
    at fault, or a garment cannot be put on its avatar.
    """
    wall, cpu = time.perf_counter(), time.process_time()
    avatar = load_scene_avatar(scene.avatar)
    for note in avatar.notes:
        listener.say(f"{avatar.name}: {note}")
    compile_seconds = load_scene_kernels(scene, checkpoint is not None, listener)
    form = DressForm(avatar)
    reading_seconds = time.perf_counter() - wall - compile_seconds
    sewing = _sew(scene, form, checkpoint, listener)
    outcome = sewing.outcome
    for note in outcome.notes:
        listener.say(note)
    for place in outcome.figures.strained:
        listener.say(f"strained by up to {place.percent:.0f} % in {place.faces} faces: {place.where}")
    garments = tuple(
        _dressed(mesh, fabric, draped)
        for (mesh, fabric), draped in zip(sewing.cloth, outcome.garments, strict=False)
    )
    report = drape_report(
        status=outcome.status,
        failure=outcome.failure,
        figures=replace(outcome.figures, stage_seconds=sewing.stage_seconds),
        quality=scene.quality,
        options=sewing.options,
        avatar=_avatar_facts(avatar),
        garments=[
            _garment_facts(garment, mesh) for garment, (mesh, _) in zip(garments, sewing.cloth, strict=False)
        ],
        seconds=RunSeconds(
            wall=time.perf_counter() - wall,
            cpu=time.process_time() - cpu,
            io=reading_seconds + sewing.reading_seconds,
            compile=compile_seconds,
        ),
    )
    return Hung(avatar=avatar, drape=outcome, garments=garments, report=report)


def load_scene_kernels(scene: ResolvedScene, draws: bool, listener: Listener) -> float:
    """Import what a scene needs of the modules that hold kernels; return the seconds that took.

    Kernels are compiled when they are imported for the first time, and loaded from disk afterwards.
    """
    started = time.perf_counter()
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
    return time.perf_counter() - started


def _sew(scene: ResolvedScene, form: DressForm, checkpoint: Checkpoint | None, listener: Listener) -> _Sewing:
    """Read and drape the garments, in other triangles where seams jam."""
    from toile.dressing.wear.put_on import drape

    reading_seconds = 0.0
    stage_seconds: dict[str, float] = {}
    spent = last_work = 0
    for edges in scene.sewing:
        started = time.perf_counter()
        meshes = [load_garment(garment, form, edges) for garment in scene.garments]
        options = _options(scene, meshes, edges, floor_height(scene.ground, form))
        if spent >= MOST_RETRIED:
            options = replace(options, persistent=True, most_work=max(LAST_WORK, 2.0 * last_work))
        reading_seconds += time.perf_counter() - started
        cloth = [
            (mesh, _as_thick(garment.fabric, mesh.thickness))
            for mesh, garment in zip(meshes, scene.garments, strict=True)
        ]
        if checkpoint is not None and edges == scene.sewing[0]:
            # Only after everything was read: a typing error must not delete a run that can be resumed.
            checkpoint.begin(scene)
        outcome = drape(form, cloth, options, listener.on_frame(scene.tolerance))
        for stage, seconds in outcome.figures.stage_seconds.items():
            stage_seconds[stage] = stage_seconds.get(stage, 0.0) + seconds
        spent, last_work = spent + outcome.work, outcome.work
        if not outcome.gave_up:
            break
        listener.say(f"seams jammed in triangles of {1e3 * edges.length:g} mm; sewing again in others")
    return _Sewing(cloth, options, outcome, reading_seconds, stage_seconds)


def floor_height(ground: bool | float, form: DressForm) -> float | None:
    """Return the height of the floor [m]: a scene's own, that under the feet of a body that stands, or None.

    A body stands if it can be measured. Where it moves, the floor is as low as its feet ever get.
    """
    if not isinstance(ground, bool):
        return float(ground)
    if not ground or isinstance(form.measured, InputError):
        return None
    motion = form.avatar.motion
    low = float(form.avatar.vertices[:, 1].min())
    return low if motion is None else min(low, float(motion.frames[:, :, 1].min()))


def _options(
    scene: ResolvedScene, meshes: list[GarmentMesh], edges: SewingEdges, floor: float | None
) -> DrapeOptions:
    """Return how garments are draped that are sewn in these edges."""
    return DrapeOptions(
        edge_length=edges.length,
        max_frames=scene.max_frames,
        tolerance=scene.tolerance,
        sizing=scene.sizing,
        gravity=scene.gravity,
        friction=scene.friction,
        friction_between=scene.friction_between,
        pins=tuple(
            pinned_vertices(mesh, garment.pins) for mesh, garment in zip(meshes, scene.garments, strict=True)
        ),
        self_contact=tuple(garment.self_contact for garment in scene.garments),
        persistent=edges == scene.sewing[-1],
        ground=floor,
    )


def _as_thick(fabric: Fabric, thickness: float | None) -> Fabric:
    """Return a fabric of the thickness that a garment's file shows [m], where it shows one."""
    return fabric if thickness is None else replace(fabric, thickness=thickness)


def _dressed(mesh: GarmentMesh, fabric: Fabric, draped: DrapedGarment) -> DressedGarment:
    """Return a draped garment with its name and panels."""
    return DressedGarment(
        name=mesh.name,
        fabric=fabric,
        positions=draped.positions,
        faces=draped.faces,
        uv=draped.uv,
        uv_faces=draped.faces_material,
        panel=draped.panel,
        panel_names=mesh.panel_names,
        velocities=draped.velocities,
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
    }
