"""The garment objects of one run: their folders, the frames that appear in them, and how the run ended."""

import json
from pathlib import Path
from typing import Any

import bpy

from toile.blender_addon.frame_folders import forget, new_folder
from toile.blender_addon.problem import Problem
from toile.blender_addon.result import select_faces, show_frames
from toile.blender_addon.snapshot.scene_folder import stems


class Dressed:
    """Garments that are dressed in one run, found again whatever they are called by then."""

    def __init__(self, garments: tuple[Any, ...]) -> None:
        named = dict(zip(stems(garments), garments, strict=True))
        self._ids = {stem: obj.session_uid for stem, obj in named.items()}
        self._names = {stem: obj.name for stem, obj in named.items()}
        self._folders: dict[str, Path] = {}
        self._job: dict[str, Any] = {}
        self._frames = 0
        self._state = ""

    def begin(self, folder: Path) -> dict[str, Any]:
        """Make a folder for the frames of every garment; return the job in the scene folder."""
        path = folder / "job.json"
        self._job = json.loads(path.read_text(encoding="utf-8"))
        for entry in self._job["garments"]:
            self._folders[entry["stem"]] = new_folder(entry["name"])
            entry["cache"] = str(self._folders[entry["stem"]])
        path.write_text(json.dumps(self._job), encoding="utf-8")
        return self._job

    def frame_came(self) -> None:
        """Let every object show its frames from the first one on; redraw it where another one has come."""
        self._frames += 1
        for stem, name in self._names.items():
            obj = self._object(stem)
            if obj is None:
                raise Problem(f"'{name}' is gone: the run was stopped")
            if self._frames == 1:
                entry = next(entry for entry in self._job["garments"] if entry["stem"] == stem)
                show_frames(obj, self._folders[stem], entry, self._job["first_frame"], self._job["sequence"])
                obj.toile.state = "in progress"
            else:
                obj.update_tag()

    def failed(self, problem: Problem) -> None:
        """Select the faces at fault."""
        self._state = "failed"
        faulty = self._object(problem.garment)
        if faulty is not None and problem.faces:
            select_faces(faulty, problem.faces)

    def done(self) -> None:
        """Note that the run came to its end."""
        self._state = "complete"

    def end(self, notes: list[str]) -> None:
        """Note on the objects how the run ended, and what was said; remove folders that stayed empty."""
        state = self._state or f"cancelled after {self._frames} frames"
        for stem in self._ids:
            obj = self._object(stem)
            if obj is not None and (self._folders or self._state):
                obj.toile.state, obj.toile.notes = state, "\n".join(notes)
        for folder in self._folders.values():
            if not self._frames:
                forget(folder)
            elif not self._state:
                _note_cancelled(folder / "toile.json")

    def _object(self, stem: str) -> Any:
        """Return the object that a file name stands for, None if it is gone."""
        wanted = self._ids.get(stem)
        return next((obj for obj in bpy.data.objects if obj.session_uid == wanted), None)


def _note_cancelled(sidecar: Path) -> None:
    """Note in a sidecar that frames are missing because the user stopped the run."""
    if sidecar.is_file():
        facts = json.loads(sidecar.read_text(encoding="utf-8"))
        sidecar.write_text(json.dumps(facts | {"state": "cancelled"}, indent=2), encoding="utf-8")
