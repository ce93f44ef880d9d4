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

from toile.blender_addon.dressed import Dressed
from toile.blender_addon.engine_process import EngineProcess
from toile.blender_addon.frame_folders import remove_orphans
from toile.blender_addon.pattern_object import draft_key, drafted_for, pattern_object
from toile.blender_addon.problem import Problem, check_editable
from toile.blender_addon.run import Current, Run, Steps
from toile.blender_addon.snapshot.cast import Cast, casts, draft_cast
from toile.blender_addon.snapshot.scene_folder import check_settings, write_scene
from toile.blender_addon.snapshot.wind import not_understood

THICKENED = "is an open surface: cloth stays on the side of the body, on a solid 0.1 m deep at most"


class Place:
    """The folder of compiled kernels; None is the engine's usual one."""

    kernels: str | None = None


def dress_steps(context: Any, *, only_selected: bool = False, drafted: Any = None) -> Steps:
    """Dress the avatars of the scene in its garments, character by character.

    `drafted` is a garment whose character alone is dressed.
    """
    check_settings(context.scene)
    present, left_out = casts(context, only_selected=only_selected)
    if drafted is not None:
        present = [cast for cast in present if drafted in cast.garments]
    run = Current.run
    if run is not None:
        run.notes += left_out + not_understood(context.scene, context.scene.toile.mode == "SIMULATE")
    remove_orphans()
    for cast in present:
        yield from _dress_cast(context, cast, run)
        if run is not None and run.cancelled:
            return


def _dress_cast(context: Any, cast: Cast, run: Run | None) -> Steps:
    """Dress garments that take part in one run."""
    dressed = Dressed(cast.garments)
    first_note = 0 if run is None else len(run.notes)
    try:
        with _folder() as folder:
            yield from _read(run, write_scene(context, folder, cast))
            if run is not None and run.cancelled:
                return
            job = dressed.begin(folder)
            if run is not None:
                run.notes += [*job["notes"], *(f"'{name}' {THICKENED}" for name in job["thickened"])]
                run.notes += [
                    f"'{entry['name']}': attribute '{name}' does not follow: its type cannot be carried"
                    for entry in job["garments"] for name in entry["left_behind"]
                ]  # fmt: skip
            with closing(_spoken("dress", folder, run)) as messages:
                for message in messages:
                    if message is not None and "frame" in message:
                        dressed.frame_came()
                    yield message is not None
            if run is None or not run.cancelled:
                dressed.done()
    except Problem as problem:
        dressed.failed(problem)
        raise
    finally:
        dressed.end([] if run is None else run.notes[first_note:])


def draft_steps(context: Any, pattern: str, body: Any, into: Any = None) -> Steps:
    """Draft a pattern to a body, or take a pattern file, and place its panels around it.

    `body` is an avatar object; None is all avatars together. `into` is a garment whose mesh is made anew,
    unless it was drafted of just this.
    """
    run = Current.run
    with _folder() as folder:
        yield from _read(run, write_scene(context, folder, draft_cast(context, body), pattern))
        key = draft_key(folder)
        if into is not None and into.toile.draft_key == key:
            return
        _show(run, "drafting the pattern")
        with closing(_spoken("draft", folder, run)) as messages:
            for message in messages:
                if message is not None and "done" in message:
                    made = pattern_object(context, folder / "draft.npz", message["done"]["name"], into)
                    job = json.loads((folder / "job.json").read_text(encoding="utf-8"))
                    made.toile.draft_frame, made.toile.draft_key = job["first_frame"], key
                    made.toile.body, made.toile.pattern = body, pattern
                yield message is not None


def dress_body_steps(context: Any, body: Any, pattern: str) -> Steps:
    """Make a body the avatar, draft it a garment, and dress it; a garment that it has is drafted anew."""
    check_settings(context.scene)
    check_editable(body)
    body.toile.role = "AVATAR"
    own = drafted_for(context, body, pattern)
    yield from draft_steps(context, pattern, body, own)
    if Current.run is None or not Current.run.cancelled:
        yield from dress_steps(context, drafted=drafted_for(context, body, pattern))


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
                    if run is not None and message["lasting"] and message["say"] not in run.notes:
                        run.notes.append(message["say"])
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
