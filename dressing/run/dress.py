"""From a scene to dressed garments: load, mesh, drape, write."""

import time
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toile.dressing.body.animated_avatar import is_animated, load_animated_avatar
from toile.dressing.body.avatar import Avatar, load_avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.files.writers.atomic import writable_folder
from toile.dressing.garment.fabrics import DEFAULT_FABRIC, checked_fabric, fabrics
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.pattern.sewing_edges import SewingEdges, sewing_edges
from toile.dressing.run.checkpoint import Checkpoint, Hung
from toile.dressing.run.garment_source import check_source, default_name, load_garment, pinned_vertices
from toile.dressing.run.kernels import (
    DRAPE_KERNELS,
    PANEL_KERNELS,
    PICTURE_KERNELS,
    REMESH_KERNELS,
    load_kernels,
)
from toile.dressing.run.progress import Progress, ProgressState, TimeLeft
from toile.dressing.run.quality import quality_preset
from toile.dressing.run.report import drape_report, with_animation
from toile.dressing.run.result import DressedGarment, Record, Result, file_stem, save_report, save_shapes
from toile.dressing.run.scene import AvatarFile, MannequinSize, Scene
from toile.dressing.wear.drape_types import DrapedGarment, DrapeOptions, FrameState
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError, about
from toile.remesh.sizing.sizing import SizingOptions

if TYPE_CHECKING:
    from toile.engine.film.plan import FilmState

Say = Callable[[str], None]
FOLLOWS = ("converged", "frame_limit")
"""States of a drape after which garments follow an avatar that moves."""
SEWING_FINENESS = 1.0, 0.92
"""Edge length in which a garment is sewn whose mesh stays, in edges as asked for; the next if seams jam."""


def dress(
    scene: Scene,
    output: str | Path | None = None,
    progress: Progress | None = None,
    say: Say | None = None,
    record: Record | None = None,
) -> Result:
    """Put a scene's garments on its avatar.

    Parameters
    ----------
    scene
        What to drape.
    output
        Folder for dressed.glb, preview.png, report.json and a PLY and OBJ per garment; None writes nothing.
    progress
        Called after every frame; returning False cancels, and what is draped so far is the result.
    say
        Called with one sentence for everything that was recognised or repaired, and before compiling.
    record
        Called with every frame of garments that follow an avatar in motion; else once, with frame 0.

    Returns
    -------
    Result
        Its status says how the drape ended; a failed one still has what was computed.

    Raises
    ------
    InputError
        If the scene is at fault: which file, field or faces, and what to do.
    """
    folder = None if output is None else writable_folder(output)
    checkpoint = None if folder is None else Checkpoint(folder)
    hung = _hang(scene, checkpoint, progress, say)
    return _finished(scene, hung, folder, checkpoint, progress, say, record, None)


def resume(output: str | Path, progress: Progress | None = None, say: Say | None = None) -> Result:
    """Go on with a run that was interrupted, from its last frame: the result is what it had been.

    Parameters and result are those of `dress`. Raises InputError if the folder holds no interrupted run.
    """
    folder = Path(output)
    checkpoint = Checkpoint(folder)
    scene, hung, state = checkpoint.load()
    if hung is None:
        if say is not None:
            say("the garments did not hang yet: starting over")
        return dress(scene, folder, progress, say)
    _load_kernels(scene, True, say)
    if say is not None:
        say(f"going on after frame {0 if state is None else len(state.record.crossings) - 1}")
    return _finished(scene, hung, folder, checkpoint, progress, say, None, state)


def _finished(
    scene: Scene, hung: Hung, folder: Path | None, checkpoint: Checkpoint | None, progress: Progress | None,
    say: Say | None, record: Record | None, state: "FilmState | None",
) -> Result:  # fmt: skip
    """Let hung garments follow their avatar, if it moves; write what is left to write."""
    status, report, avatar, garments = hung.drape.status, hung.report, hung.avatar, hung.garments
    failure = hung.drape.failure
    if scene.air is not None and avatar.motion is None and say is not None:
        say("air acts on garments that follow a body in motion; this one stands still")
    if avatar.motion is not None and status in FOLLOWS:
        from toile.dressing.run.follow import follow, write_film

        wall, cpu = time.perf_counter(), time.process_time()
        if checkpoint is not None and state is None:
            checkpoint.hung(hung)
        quality, avatar_fps = quality_preset(scene.quality), avatar.motion.fps
        followed = follow(
            avatar, hung.drape, garments, _sizing(scene),
            None if scene.air is None else scene.air.flow(), folder,
            _frame_callback(progress, quality.tolerance),
            (lambda _: None) if checkpoint is None else checkpoint.frame, record or (lambda *_: None), state,
        )  # fmt: skip
        garments, avatar = followed.garments, followed.avatar
        if folder is not None:
            written = write_film(folder, garments, avatar_fps, followed.figures["frames"] + 1)
            if written is None and say is not None:
                say("no dressed.usdc: USD is not installed (pip install 'toile[usd]'); frames are in frames/")
        if followed.failure is not None:
            status, failure = "failed", followed.failure
        elif followed.cancelled:
            status = "cancelled"
        report = with_animation(
            report, status, followed.failure, followed.figures, followed.stage_seconds,
            time.perf_counter() - wall, time.process_time() - cpu,
        )  # fmt: skip
    elif record is not None:
        record(0, garments)
    if folder is not None:
        save_shapes(folder, avatar, garments)
        save_report(folder, report)
    if checkpoint is not None and status != "cancelled":
        checkpoint.end()
    return Result(status=status, report=report, avatar=avatar, garments=garments, failure=failure)


def _hang(scene: Scene, checkpoint: Checkpoint | None, progress: Progress | None, say: Say | None) -> Hung:
    """Put the garments on the avatar as it is at the start."""
    wall, cpu = time.perf_counter(), time.process_time()
    cloth_fabrics = [_fabric_of(scene, garment.fabric) for garment in scene.garments]
    for garment in scene.garments:
        check_source(garment)
    names = _unique_names(scene)
    quality = quality_preset(scene.quality)
    sizing = _sizing(scene)

    avatar = load_scene_avatar(scene)
    if say is not None:
        for note in avatar.notes:
            say(f"{avatar.name}: {note}")
    compile_seconds = _load_kernels(scene, checkpoint is not None, say)
    form = DressForm(avatar)
    io_seconds = time.perf_counter() - wall - compile_seconds
    from toile.dressing.wear.put_on import drape

    spent: dict[str, float] = {}
    attempts = _sewing_edges(scene, sizing)
    for edges in attempts:
        meshing = time.perf_counter()
        meshes = [
            load_garment(garment, name, form, edges)
            for garment, name in zip(scene.garments, names, strict=True)
        ]
        options = DrapeOptions(
            edge_length=edges.length,
            max_frames=scene.max_frames or quality.max_frames,
            tolerance=quality.tolerance,
            sizing=sizing,
            gravity=scene.gravity,
            friction=scene.friction,
            friction_between=_friction_between(scene, cloth_fabrics),
            threads=scene.threads,
            pins=tuple(
                pinned_vertices(mesh, garment.pins)
                for mesh, garment in zip(meshes, scene.garments, strict=True)
            ),
            self_contact=tuple(garment.self_contact for garment in scene.garments),
            persistent=edges == attempts[-1],
        )
        io_seconds += time.perf_counter() - meshing
        cloth = list(zip(meshes, cloth_fabrics, strict=True))
        if checkpoint is not None and edges == attempts[0]:
            # Not before all is read: a slip of the pen must not wipe out a run that can be taken up.
            checkpoint.begin(scene)
        outcome = drape(form, cloth, options, _frame_callback(progress, options.tolerance))
        for stage, seconds in outcome.figures.stage_seconds.items():
            spent[stage] = spent.get(stage, 0.0) + seconds
        if not outcome.gave_up:
            break
        if say is not None:
            say(f"seams jammed in triangles of {1e3 * edges.length:g} mm; sewing again in others")
    if say is not None:
        for note in outcome.notes:
            say(note)
    garments = tuple(
        _dressed(mesh, fabric, draped)
        for (mesh, fabric), draped in zip(cloth, outcome.garments, strict=False)
    )

    report = drape_report(
        status=outcome.status,
        failure=outcome.failure,
        figures=replace(outcome.figures, stage_seconds=spent),
        quality=quality.name,
        options=options,
        avatar=_avatar_facts(avatar),
        garments=[_garment_facts(garment, mesh) for garment, (mesh, _) in zip(garments, cloth, strict=False)],
        wall_seconds=time.perf_counter() - wall,
        cpu_seconds=time.process_time() - cpu,
        io_seconds=io_seconds,
        compile_seconds=compile_seconds,
    )
    return Hung(avatar=avatar, drape=outcome, garments=garments, report=report)


def _friction_between(scene: Scene, worn: list[Fabric]) -> dict[frozenset[str], float]:
    """Return the coefficients of named pairs, names checked against the fabrics that are worn."""
    known = {fabric.name: fabric for fabric in worn} | {"body": worn[0]}
    for pair in scene.friction_between:
        for name in pair:
            if name not in known:
                raise InputError(
                    f"friction_between: {unknown_name('fabric', name, known)}", field="friction_between"
                )
    return {frozenset(pair): value for pair, value in scene.friction_between.items()}


def _sizing(scene: Scene) -> SizingOptions | None:
    """Return how the mesh adapts: as the scene says, or as its quality does."""
    if isinstance(scene.remesh, SizingOptions):
        return scene.remesh
    if not scene.remesh:
        return None
    quality = quality_preset(scene.quality)
    return quality.sizing(scene.edge_length or quality.edge_length)


def _sewing_edges(scene: Scene, sizing: SizingOptions | None) -> list[SewingEdges]:
    """Return the edges in which the garments are sewn, one after the other until seams close."""
    if sizing is None:
        asked = scene.edge_length or quality_preset(scene.quality).edge_length
        return [SewingEdges(factor * asked, factor * asked) for factor in SEWING_FINENESS]
    return sewing_edges(sizing.size_min, sizing.size_max)


def _load_kernels(scene: Scene, draws: bool, say: Say | None) -> float:
    """Import what a scene needs of the modules that hold kernels; return the seconds that took.

    Kernels are compiled when they are imported for the first time, and loaded from disk afterwards.
    """
    started = time.perf_counter()
    from toile.geometry.kernel import WARM

    if say is not None and not WARM:
        say("compiling kernels (once)")
    modules: tuple[str, ...] = DRAPE_KERNELS
    if any(not isinstance(garment.source, GarmentMesh) for garment in scene.garments):
        modules += PANEL_KERNELS
    if scene.remesh:
        modules += REMESH_KERNELS
    if draws:
        modules += PICTURE_KERNELS
    load_kernels(modules)
    import_module("toile.dressing.wear.put_on")
    return time.perf_counter() - started


def load_scene_avatar(scene: Scene) -> Avatar:
    """Return the scene's avatar, read or built."""
    with about(field="avatar"):
        return _avatar_of(scene)


def _avatar_of(scene: Scene) -> Avatar:
    if isinstance(scene.avatar, Avatar):
        return scene.avatar
    if isinstance(scene.avatar, AvatarFile):
        file = scene.avatar
        if is_animated(file.path):
            return load_animated_avatar(file.path, units=file.units, up=file.up, fps=file.fps)
        if file.fps is not None:
            raise InputError(
                f"{file.path}: fps is for an avatar that moves; give an .npz, an animated .glb or a folder "
                "of meshes",
                file=file.path,
                field="fps",
            )
        return load_avatar(file.path, units=file.units, up=file.up)
    if scene.avatar is not None and not isinstance(scene.avatar, MannequinSize):
        raise InputError(f"avatar must be an Avatar, a file or a mannequin size, got {scene.avatar!r}")
    sizes = scene.avatar.given() if scene.avatar is not None else {}
    if not sizes:
        from toile.dressing.body.stored_mannequin import stored_mannequin

        return stored_mannequin()
    from toile.dressing.body.mannequin import mannequin

    return mannequin(**sizes)


def _fabric_of(scene: Scene, wanted: str | Fabric | None) -> Fabric:
    """Return a garment's fabric, checked."""
    choice = wanted if wanted is not None else scene.fabric if scene.fabric is not None else DEFAULT_FABRIC
    if isinstance(choice, Fabric):
        return checked_fabric(choice)
    known = {**fabrics(), **scene.fabrics}
    if choice not in known:
        raise InputError(unknown_name("fabric", choice, known), field="fabric")
    return checked_fabric(known[choice])


def _unique_names(scene: Scene) -> list[str]:
    """Return one name per garment, with numbers where two would write the same file."""
    names: list[str] = []
    taken = {"body", "dressed"}
    for garment in scene.garments:
        base = name = default_name(garment)
        number = 2
        while file_stem(name).lower() in taken:
            name = f"{base}_{number}"
            number += 1
        taken.add(file_stem(name).lower())
        names.append(name)
    return names


def _frame_callback(progress: Progress | None, tolerance: float) -> Callable[[FrameState], bool]:
    """Return the engine's callback: estimates the time left and passes the frame on."""
    clock = TimeLeft(tolerance)

    def on_frame(state: FrameState) -> bool:
        left = clock.update(state)
        if progress is None:
            return True
        answer = progress(
            ProgressState(
                frame=state.frame,
                max_frames=state.max_frames,
                faces=state.faces,
                contacts=state.contacts,
                residual=state.residual,
                tolerance=tolerance,
                seconds=state.seconds,
                seconds_left=left,
            )
        )
        return answer is not False

    return on_frame


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
