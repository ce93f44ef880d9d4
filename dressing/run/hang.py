"""Garments of a scene put on its avatar: read, sewn, hanging, and the report of it."""

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
from toile.dressing.run.report import RunSpent, drape_report
from toile.dressing.run.resolved_scene import ResolvedScene
from toile.dressing.run.result import DressedGarment
from toile.dressing.run.scene_avatar import load_scene_avatar
from toile.dressing.wear.drape_types import DrapedGarment, DrapeOptions, DrapeOutcome
from toile.engine.cloth.fabric import Fabric
from toile.geometry.stage_clock import Spent, now, together


@dataclass(frozen=True)
class _Sewing:
    """The last sewing attempt, and the time of all attempts: reading, and by stages."""

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
    avatar = load_scene_avatar(scene.avatar)
    for note in avatar.notes:
        listener.say(f"{avatar.name}: {note}")
    loading = load_scene_kernels(scene, checkpoint is not None, listener)
    form = DressForm(avatar)
    reading = now().less(started).less(loading)
    sewing = _sew(scene, form, checkpoint, listener)
    outcome = sewing.outcome
    for note in outcome.notes:
        listener.say(note)
    garments = tuple(
        _dressed(mesh, fabric, draped)
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
    )
    return Hung(avatar=avatar, drape=outcome, garments=garments, report=report)


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


def _sew(scene: ResolvedScene, form: DressForm, checkpoint: Checkpoint | None, listener: Listener) -> _Sewing:
    """Read and drape the garments, in other triangles where seams jam."""
    from toile.dressing.wear.put_on import drape

    reading = Spent()
    stages: dict[str, Spent] = {}
    for edges in scene.sewing:
        started = now()
        meshes = [load_garment(garment, form, edges) for garment in scene.garments]
        options = _options(scene, meshes, edges)
        reading = reading.plus(now().less(started))
        cloth = [(mesh, garment.fabric) for mesh, garment in zip(meshes, scene.garments, strict=True)]
        if checkpoint is not None and edges == scene.sewing[0]:
            # Only after everything was read: a typing error must not delete a run that can be resumed.
            checkpoint.begin(scene)
        outcome = drape(form, cloth, options, listener.on_frame(scene.tolerance))
        stages = together(stages, outcome.figures.stages)
        if not outcome.gave_up:
            break
        listener.say(f"seams jammed in triangles of {1e3 * edges.length:g} mm; sewing again in others")
    return _Sewing(cloth, options, outcome, reading, stages)


def _options(scene: ResolvedScene, meshes: list[GarmentMesh], edges: SewingEdges) -> DrapeOptions:
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
    )


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
