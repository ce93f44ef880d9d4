"""From a scene to dressed garments: load, mesh, drape, write."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.files.writers.atomic import writable_folder, write_atomic
from toile.dressing.files.writers.ply import ply_bytes
from toile.dressing.fit.fit_words import CHECKED
from toile.dressing.run.checkpoint import Checkpoint, Hung
from toile.dressing.run.hang import hang, load_scene_kernels
from toile.dressing.run.listener import FitListener, Listener, Say
from toile.dressing.run.output.one_run import one_run
from toile.dressing.run.output.result_view import save_view
from toile.dressing.run.progress import Progress
from toile.dressing.run.report import with_animation
from toile.dressing.run.resolved_scene import ResolvedScene, resolve
from toile.dressing.run.result import Record, Result, file_stem, save_report, save_shapes
from toile.dressing.run.scene import OFF, Scene
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import whole
from toile.geometry.stage_clock import now, together
from toile.geometry.threads.crew import MOST_THREADS, crew_of

if TYPE_CHECKING:
    from toile.dressing.fit.worn import Worn
    from toile.engine.film.plan import FilmState

FOLLOWS = ("converged", "frame_limit")
"""States of a drape after which garments follow an avatar that moves, and after which their fit is read."""
CHECK_EDGES = 1.3
"""Edges of the mesh of a second drape, whose difference is the error bar of a fit, in those of the first."""


def dress(
    scene: Scene,
    output: str | Path | None = None,
    progress: Progress | None = None,
    say: Say | None = None,
    record: Record | None = None,
    fit: FitListener | None = None,
) -> Result:
    """Put a scene's garments on its avatar.

    Parameters
    ----------
    scene
        What to drape.
    output
        Folder for dressed.glb, preview.png, view.html, report.json and a PLY, an OBJ and the scene's
        `formats` per garment; None writes nothing.
    progress
        Called after every frame; returning False cancels, and what is draped so far is the result. So does a
        first Ctrl-C, or the stop of a notebook; a second one raises KeyboardInterrupt.
    say
        Called with one sentence for everything that was recognised or repaired, and before compiling.
    record
        Called with every frame of garments that follow an avatar in motion; else once, with frame 0.
    fit
        Called at the end with the maps of how the garments fit, where the scene's `fit` is not "off"; with
        it no output folder is needed for them.

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
    resolved = resolve(scene)
    listener = Listener(progress, say, record, fit)
    with one_run(folder), listener.heeding_interrupts(), crew_of(scene.threads or 1):
        return _from_the_start(resolved, folder, listener)


def resume(
    output: str | Path, progress: Progress | None = None, say: Say | None = None, threads: int = 1
) -> Result:
    """Resume an interrupted run from its last frame, with the result it would have had.

    Parameters and result are those of `dress` and of a scene. Raises InputError if the folder
    holds no interrupted run.
    """
    folder = Path(output)
    if not folder.is_dir():
        raise InputError(f"{folder}: there is no run to resume; there is no such folder", file=folder)
    threads = whole(threads, "threads", 1, MOST_THREADS)
    listener = Listener(progress, say)
    with one_run(writable_folder(folder)), listener.heeding_interrupts(), crew_of(threads):
        return _resumed(folder, listener)


def _resumed(folder: Path, listener: Listener) -> Result:
    """Return the result of the run of a folder, resumed."""
    checkpoint = Checkpoint(folder)
    scene, hung, state = checkpoint.load()
    if hung is None:
        listener.say("the garments were not draped yet: starting from the beginning")
        return _from_the_start(scene, folder, listener)
    load_scene_kernels(scene, True, listener)
    last, motion = 0 if state is None else len(state.record.crossings) - 1, hung.body.motion
    listener.say(f"resuming after {f'frame {last}' if motion is None else motion.name(last)}")
    return _to_the_end(scene, hung, checkpoint, listener, state)


def _from_the_start(scene: ResolvedScene, folder: Path | None, listener: Listener) -> Result:
    """Hang the garments and do what comes after that."""
    checkpoint = None if folder is None else Checkpoint(folder)
    return _to_the_end(scene, hang(scene, checkpoint, listener), checkpoint, listener, None)


def _to_the_end(
    scene: ResolvedScene,
    hung: Hung,
    checkpoint: Checkpoint | None,
    listener: Listener,
    state: "FilmState | None",
) -> Result:
    """Let hung garments follow their avatar, if it moves; write what is left to write."""
    result = Result(
        status=hung.drape.status, report=hung.report, avatar=hung.avatar, garments=hung.garments,
        failure=hung.drape.failure,
    )  # fmt: skip
    if scene.air is not None and hung.body.motion is None:
        listener.say("air acts only on garments that follow a moving body; this body stands still")
    last: FilmState | None = None
    if hung.body.motion is not None and result.status in FOLLOWS:
        result, last = _followed(scene, hung, checkpoint, listener, state)
    else:
        listener.record(0, result.garments)
    if checkpoint is not None:
        save_shapes(checkpoint.output, result.avatar, result.garments, scene.formats)
        save_report(checkpoint.output, result.report)
        save_view(checkpoint.output, result)
    output = None if checkpoint is None else checkpoint.output
    if scene.fit != OFF and (output is not None or listener.fit is not None):
        _write_fit(scene, hung, last, result, output, listener)
    if checkpoint is not None:
        if scene.certificate:
            _certify(scene, result, checkpoint.output)
        if result.status != "cancelled":
            checkpoint.end()
    return result


def _followed(
    scene: ResolvedScene,
    hung: Hung,
    checkpoint: Checkpoint | None,
    listener: Listener,
    state: "FilmState | None",
) -> "tuple[Result, FilmState]":
    """Return the result of hung garments that follow their avatar, its film written, and its last state."""
    from toile.dressing.run.follow import follow
    from toile.dressing.run.output.film_files import write_film

    assert hung.body.motion is not None
    started = now()
    if checkpoint is not None and state is None:
        checkpoint.hung(hung)
    followed = follow(scene, hung, checkpoint, listener, state)
    written = now()
    if checkpoint is not None:
        fps, count = hung.body.motion.fps, followed.count
        if count:
            for sentence in write_film(checkpoint.output, followed.garments, fps, count, scene.formats):
                listener.say(sentence)
    stages = together(followed.stages, {"io": now().less(written)})
    status = hung.drape.status
    if followed.failure is not None:
        status = "failed"
    elif followed.cancelled:
        status = "cancelled"
    report = with_animation(
        hung.report, status, followed.failure, followed.figures, followed.end, stages,
        now().less(started),
    )  # fmt: skip
    result = Result(
        status=status, report=report, avatar=followed.avatar, garments=followed.garments,
        failure=followed.failure,
    )  # fmt: skip
    return result, followed.last


def _write_fit(
    scene: ResolvedScene, hung: Hung, last: "FilmState | None", result: Result, folder: Path | None,
    listener: Listener,
) -> None:  # fmt: skip
    """Tell how garments fit as they hang, or at the end of their film, and write it into a folder, if any."""
    from toile.dressing.fit.at_rest import at_rest
    from toile.dressing.fit.findings import fit_sentences
    from toile.dressing.fit.fit_files import write_fit
    from toile.dressing.fit.fit_maps import fit_maps

    if result.status not in FOLLOWS:
        listener.say(f"no fit: the drape is {result.status}")
        return
    check = None
    if scene.fit == CHECKED and last is None:
        listener.say("draping once more on another mesh, for the error bars of the fit")
        again = hang(scene.on_another_mesh(CHECK_EDGES), None, Listener())
        check = at_rest(_worn(again)) if again.drape.status in FOLLOWS else None
    if scene.fit == CHECKED and check is None:
        why = "garments follow a body in motion" if last is not None else "the second drape failed"
        listener.say(f"no error bars of the fit: {why}")
    worn = _worn(hung)
    if last is None:
        worn = at_rest(worn)
    elif last.avatar is not None:
        worn = replace(worn, cloth=last.cloth, anchors=last.anchors, vertices=last.avatar)
    if listener.fit is not None:
        listener.fit(fit_maps(worn))
    if folder is None:
        return
    tables = write_fit(folder, worn, [file_stem(garment.name) for garment in result.garments], check)
    for sentence in fit_sentences(tables):
        listener.say(sentence)


def _certify(scene: ResolvedScene, result: Result, folder: Path) -> None:
    """Write the body as the garments meet it, and the certificate of all that is written."""
    from toile.dressing.certificate.certificate import CertifiedGarment, write_certificate

    avatar = result.avatar
    write_atomic(folder / "body.ply", ply_bytes(avatar.to_source(avatar.vertices), avatar.faces))
    write_certificate(
        folder, scene, result.report,
        [
            CertifiedGarment(
                file_stem(garment.name), 0 if garment.trims is None else len(garment.trims.faces)
            )
            for garment in result.garments
        ],
    )  # fmt: skip


def _worn(hung: Hung) -> "Worn":
    """Return hung garments as fit is read off them."""
    from toile.dressing.body.dress_form import DressForm
    from toile.dressing.fit.worn import Worn, WornGarment

    measured = DressForm(hung.body).measured
    return Worn(
        cloth=hung.drape.cloth, anchors=hung.drape.anchors, step=hung.drape.step,
        vertices=hung.body.vertices, faces=hung.body.faces,
        measured=None if isinstance(measured, InputError) else measured,
        avatar=hung.avatar, place=hung.place,
        garments=tuple(
            WornGarment(name=garment.name, fabric=garment.fabric.name, panels=garment.panel_names)
            for garment in hung.garments
        ),
    )  # fmt: skip
