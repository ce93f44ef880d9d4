"""The work of the operators, in steps: snapshot, engine, frames that appear; or drafting a pattern."""

import json
import shutil
import sys
import tempfile
from collections.abc import Generator, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import bpy

from toile.blender_addon.engine_process import EngineProcess
from toile.blender_addon.pattern_object import pattern_object
from toile.blender_addon.problem import Problem
from toile.blender_addon.result import select_faces, show_frames
from toile.blender_addon.run import Current, Run, Steps
from toile.blender_addon.snapshot.scene_folder import cache_folder, of_role, stems, write_scene
from toile.blender_addon.snapshot.wind import not_understood


class Place:
    """The folder of compiled kernels; None is the engine's usual one."""

    kernels: str | None = None


def dress_steps(context: Any) -> Steps:
    """Dress the avatars of the scene in its garments."""
    if not bpy.data.filepath:
        raise Problem("save the .blend file first: the frames are kept beside it")
    objects = of_role(context.scene, "GARMENT")
    garments = {stem: obj.name for obj, stem in zip(objects, stems(objects), strict=True)}
    folders = {stem: cache_folder(bpy.data.objects[name]) for stem, name in garments.items()}
    run = Current.run
    if run is not None:
        run.notes += not_understood(context.scene, context.scene.toile.mode == "SIMULATE")
    frames = 0
    try:
        with _folder() as folder:
            yield from _read(run, write_scene(context, folder))
            if run is not None and run.cancelled:
                return
            job = json.loads((folder / "job.json").read_text(encoding="utf-8"))
            with closing(_spoken("dress", folder, run)) as messages:
                for message in messages:
                    if message is not None and "frame" in message:
                        frames += 1
                        for stem, name in garments.items():
                            _frame_came(name, folders[stem], stem, job, first=frames == 1)
                    yield message is not None
    except Problem as problem:
        faulty = bpy.data.objects.get(garments.get(problem.garment, ""))
        if faulty is not None and problem.faces:
            select_faces(faulty, problem.faces)
        _set_states(garments, "failed")
        raise
    cancelled = run is not None and run.cancelled
    if cancelled:
        _note_cancelled(folders)
    _set_states(garments, f"cancelled after {frames} frames" if cancelled else "complete")


def draft_steps(context: Any, pattern: str) -> Steps:
    """Draft a pattern to the avatar, or take a pattern file, and place its panels around the avatar."""
    run = Current.run
    with _folder() as folder:
        yield from _read(run, write_scene(context, folder, pattern))
        _show(run, "drafting the pattern")
        with closing(_spoken("draft", folder, run)) as messages:
            for message in messages:
                if message is not None and "done" in message:
                    made = pattern_object(context, folder / "draft.npz", message["done"]["name"])
                    job = json.loads((folder / "job.json").read_text(encoding="utf-8"))
                    made.toile.draft_frame = job["first_frame"]
                yield message is not None


def dress_body_steps(context: Any, body: Any, pattern: str) -> Steps:
    """Make a body the avatar, draft it a garment, and dress it."""
    body.toile.role = "AVATAR"
    yield from draft_steps(context, pattern)
    if Current.run is None or not Current.run.cancelled:
        yield from dress_steps(context)


def _read(run: Run | None, texts: Iterator[str]) -> Steps:
    """Read the scene, bit by bit, unless the run is cancelled."""
    if run is not None:
        run.reading = True
    for text in texts:
        _show(run, text)
        yield True
        if run is not None and run.cancelled:
            break
    if run is not None:
        run.reading = False


@contextmanager
def _folder() -> Iterator[Path]:
    """Give a folder for the engine, and remove it afterwards."""
    folder = Path(tempfile.mkdtemp(prefix="toile_"))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _spoken(task: str, folder: Path, run: Run | None) -> Generator[dict[str, Any] | None, None, None]:
    """Start the engine and yield what it says until it has ended or the run is cancelled."""
    environment = {} if Place.kernels is None else {"TOILE_CACHE_DIR": Place.kernels}
    yield None
    engine = EngineProcess(task, folder, _bundled_paths(), environment)
    yield None
    try:
        for message in engine.messages():
            if run is not None and run.cancelled:
                # It takes a while to give its memory back.
                while not engine.is_stopped():
                    yield None
                return
            if message is not None:
                if "progress" in message and run is not None:
                    run.progress(**{key.replace("max_frames", "frames"): value
                                    for key, value in message["progress"].items()})  # fmt: skip
                if "say" in message:
                    _show(run, message["say"])
            yield message
    finally:
        engine.end()


def _bundled_paths() -> list[str]:
    """Return where Blender keeps its own modules, of which the engine needs USD."""
    before = list(sys.path)
    bpy.utils.expose_bundled_modules()
    added = [path for path in sys.path if path not in before]
    if not added:
        import pxr

        added = [str(Path(pxr.__file__).parents[1])]
    sys.path[:] = before
    return added


def _show(run: Run | None, text: str) -> None:
    if run is not None:
        run.text = text


def _frame_came(name: str, folder: str, stem: str, job: dict[str, Any], *, first: bool) -> None:
    """Let an object show its frames from the first one on; redraw it where the present one has come."""
    obj = bpy.data.objects.get(name)
    if obj is None:
        raise Problem(f"'{name}' is gone: the run was stopped")
    if first:
        show_frames(obj, folder, stem, job["first_frame"], job["sequence"])
        obj.toile.state = "in progress"
    else:
        obj.update_tag()


def _set_states(garments: dict[str, str], state: str) -> None:
    for name in garments.values():
        if name in bpy.data.objects:
            bpy.data.objects[name].toile.state = state


def _note_cancelled(folders: dict[str, str]) -> None:
    """Note in the sidecars that frames are missing because the user stopped the run."""
    for folder in folders.values():
        path = Path(bpy.path.abspath(folder)) / "toile.json"
        if path.is_file():
            facts = json.loads(path.read_text(encoding="utf-8"))
            path.write_text(json.dumps(facts | {"state": "cancelled"}, indent=2), encoding="utf-8")
