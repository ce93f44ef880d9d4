"""Obstacles beside the avatar: solids that cloth meets, one file each, still or as they move."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from toile.blender_addon.snapshot.avatar_snapshot import AvatarSnapshot
from toile.blender_addon.snapshot.cast import AvatarPart
from toile.blender_addon.snapshot.space import Space
from toile.dressing.files.writers.npz_motion import MotionWriter
from toile.dressing.files.writers.ply import ply_bytes
from toile.geometry.arrays import Float


class ObstacleSnapshot(AvatarSnapshot):
    """One obstacle, the `number`-th of a scene; what never moves in `frames` frames becomes a still file."""

    def __init__(
        self, part: AvatarPart, number: int, scene: Any, space: Space, folder: Path, frames: int
    ) -> None:
        super().__init__((part,), scene, space)
        self._settings, self.name = part.obj.toile, part.obj.name
        self._stem, self._folder, self._frames = f"obstacle {number}", folder, frames
        self._first: Float | None = None
        self._moves = False
        self._writer: MotionWriter | None = None

    def note(self, depsgraph: Any) -> None:
        """Note where it is in the present frame."""
        vertices = self.see(depsgraph)
        if self._first is None:
            self._first = vertices
            if self._frames > 1:
                path = self._folder / f"{self._stem}.npz"
                self._writer = MotionWriter(path, "vertices", self._frames, len(vertices))
        self._moves |= bool(np.any(vertices != self._first))
        if self._writer is not None:
            self._writer.add(vertices)

    def write(self, fps: float) -> list[str]:
        """Complete its file; return its table in a scene file."""
        if self._writer is not None:
            self._writer.close(faces=self.faces, fps=fps)
        file = self._folder / f"{self._stem}.npz"
        if not self._moves and self._first is not None:
            file.unlink(missing_ok=True)
            file = file.with_suffix(".ply")
            file.write_bytes(ply_bytes(self._first, self.faces))
        lines = [
            "[[obstacle]]", f'file = "{file.name}"', f"name = {json.dumps(self.name, ensure_ascii=False)}",
            'units = "m"', 'up = "y"',
        ]  # fmt: skip
        if self._settings.use_friction:
            lines.append(f"friction = {self._settings.friction:.9g}")
        return lines
