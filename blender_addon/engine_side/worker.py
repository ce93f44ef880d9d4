"""The engine's side: reads a scene folder, computes, writes frames, and reports in JSON lines.

Every line is an object with one of: `say` (a sentence; `lasting` if it is worth reading at the end),
`progress` (frame, max_frames, faces, contacts, seconds_left), `frame` (it is on disk), `done` (status and
figures), `error` (one sentence; perhaps `garment`, `file` in the folder, `field` and `faces` at fault).
"""

import json
import os
import sys
from pathlib import Path
from typing import Any

from toile.blender_addon.engine_side.wording import Wording
from toile.geometry.errors import InputError

SIDECAR = "toile.json"
"""The sidecar of a cache folder."""


def main(arguments: list[str]) -> int:
    """Do the job in a scene folder: `dress` it or `draft` its pattern. Return 0 for success."""
    task, folder = arguments[0], Path(arguments[1])
    try:
        (_draft if task == "draft" else _dress)(folder)
    except InputError as error:
        _tell(error=_wording(folder)(str(error)), **_at_fault(error, folder))
        return 2
    except BrokenPipeError:
        return 1
    except Exception as error:
        if os.environ.get("TOILE_TRACEBACK"):
            raise
        _tell(error=f"the engine failed ({type(error).__name__}: {' '.join(str(error).split())})")
        return 1
    return 0


def _tell(**message: Any) -> None:
    """Write one line to Blender."""
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


def _wording(folder: Path) -> Wording:
    """Return what translates the engine's sentences about a scene folder."""
    job = folder / "job.json"
    return Wording(folder, json.loads(job.read_text(encoding="utf-8")) if job.is_file() else None)


def _at_fault(error: InputError, folder: Path) -> dict[str, Any]:
    """Return what an error is about, as far as it is known; files of the scene folder by their name in it."""
    file = error.file
    if file is not None and file.is_relative_to(folder):
        file = file.relative_to(folder)
    known = {
        "garment": error.garment,
        "file": file and str(file),
        "field": error.field,
        "faces": list(error.faces),
    }
    return {name: value for name, value in known.items() if value}


def _dress(folder: Path) -> None:
    """Dress the scene of a folder, frame by frame into the cache folders of its garments."""
    from toile.blender_addon.engine_side.frames import FrameWriter
    from toile.dressing.fit.fit_maps import FitMaps
    from toile.dressing.run.dress import dress
    from toile.dressing.run.progress import ProgressState
    from toile.dressing.run.result import DressedGarment
    from toile.dressing.run.scene_file import load_scene

    job = json.loads((folder / "job.json").read_text(encoding="utf-8"))
    worded = Wording(folder, job)
    scene = load_scene(folder / "scene.toml")
    writers = [FrameWriter(folder, entry, job) for entry in job["garments"]]

    def on_frame(state: ProgressState) -> None:
        _tell(
            progress={
                "frame": state.frame, "max_frames": state.max_frames, "faces": state.faces,
                "contacts": state.contacts, "seconds_left": state.seconds_left,
            }
        )  # fmt: skip

    def record(frame: int, garments: tuple[DressedGarment, ...]) -> None:
        for writer, garment in zip(writers, garments, strict=True):
            writer.add(frame, garment)
        _tell(frame=job["first_frame"] + frame)

    def say(text: str) -> None:
        _tell(say=worded(text), lasting=worded.is_lasting(text))

    def fit(maps: FitMaps) -> None:
        for writer, garment in zip(writers, maps.garments, strict=True):
            writer.add_fit(garment)

    result = dress(scene, None, on_frame, say, record, fit)
    report, failure = result.report, result.failure
    state = "failed" if result.status == "failed" else "complete"
    for writer in writers:
        writer.close(state, report)
    if failure is not None:
        at_fault = [(job["garments"][index]["stem"], faces) for index, faces in enumerate(failure.faces)]
        stem, faces = next(((stem, faces) for stem, faces in at_fault if len(faces)), ("", ()))
        where = f" ({failure.where})" if failure.where else ""
        _tell(error=worded(failure.message + where), garment=stem, faces=[int(face) for face in faces])
        return
    figures = ("status", "frames", "faces", "intersections", "wall_seconds", "cpu_seconds")
    _tell(done={key: report[key] for key in figures})


def _draft(folder: Path) -> None:
    """Draft a pattern to the body of a folder and place it; it becomes draft.npz."""
    import numpy as np

    from toile.dressing.pattern.sewing_edges import sewing_edges
    from toile.dressing.run.load_garment import load_garment
    from toile.dressing.run.quality import COARSEST
    from toile.dressing.run.resolved_scene import resolve
    from toile.dressing.run.scene_avatar import load_dress_form
    from toile.dressing.run.scene_file import load_scene

    scene = resolve(load_scene(folder / "scene.toml"))
    sewn = sewing_edges(scene.edge_length, COARSEST * scene.edge_length)[0]
    _, form = load_dress_form(scene.avatar, scene.measurements)
    mesh = load_garment(scene.garments[0], form, sewn)
    labels: dict[str, Any] = {f"held_{label}": vertices for label, vertices in mesh.held.items()}
    np.savez(
        folder / "draft.npz", vertices=form.place.outward(mesh.positions), faces=mesh.faces, uv=mesh.uv,
        stitches=mesh.stitches, panel=mesh.panel, **labels,
    )  # fmt: skip
    _tell(done={"name": mesh.name, "panels": list(mesh.panel_names)})
