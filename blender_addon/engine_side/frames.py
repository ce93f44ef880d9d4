"""The cache folder of one garment: a USDC file per frame, or one point cache, and a sidecar."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from toile.blender_addon.engine_side.carried import Carried
from toile.blender_addon.engine_side.fit_primvars import fit_primvars, strain_primvars
from toile.blender_addon.engine_side.on_surface import OnSurface
from toile.blender_addon.engine_side.usd_frame import Primvar, write_usd_frame
from toile.blender_addon.engine_side.worker import SIDECAR
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.files.writers.pc2 import PointCache
from toile.dressing.fit.fit_maps import GarmentFit
from toile.dressing.run.result import DressedGarment


class FrameWriter:
    """Writes the frames of one garment; those of an earlier run go when the first one comes."""

    def __init__(self, folder: Path, entry: dict[str, Any], job: dict[str, Any]) -> None:
        self._target = Path(entry["cache"])
        self._stem: str = entry["stem"]
        self._first: int = job["first_frame"]
        self._sequence: bool = job["sequence"]
        self._facts = {"fingerprints": entry["fingerprints"], "first_frame": self._first}
        self._carried = Carried(folder / f"{self._stem}_carried.npz")
        self._fit: bool = job["fit"]
        self._last: int | None = None
        self._shown: tuple[int, DressedGarment] | None = None
        self._points: PointCache | None = None
        self._surface: OnSurface | None = None
        if entry["keep_topology"]:
            with np.load(folder / f"{self._stem}.npz") as data:
                self._original = data["vertices"].astype(np.float64)
            corner_vertex = self._carried.corner_vertex
            rest = self._original[corner_vertex]
            self._surface = OnSurface(rest, corner_vertex, len(self._original))

    def add(self, frame: int, garment: DressedGarment) -> None:
        """Write a frame, counted from 0."""
        if self._last is None:
            self._forget()
        carried = self._carried
        if self._surface is not None:
            points = carried.local(self._surface.points(garment, self._original), frame)
            if self._points is None:
                self._points = PointCache(self._target / f"{self._stem}.pc2", len(points), self._first)
            self._points.add(points)
        else:
            self._shown = frame, garment
            self._write(*self._shown, strain_primvars(garment) if self._fit else [])
        self._last = self._first + frame
        self._say("partial")

    def add_fit(self, maps: GarmentFit) -> None:
        """Add how the garment fits to the last frame."""
        if self._shown is not None:
            frame, garment = self._shown
            self._write(frame, garment, fit_primvars(maps, garment))

    def _write(self, frame: int, garment: DressedGarment, fit: list[Primvar]) -> None:
        """Write a frame, with how the garment fits; older maps of the object go."""
        carried, taken = self._carried, {primvar.name for primvar in fit}
        number = f"_{self._first + frame:04d}" if self._sequence else ""
        velocities = garment.velocities if self._sequence else None
        write_usd_frame(
            self._target / f"{self._stem}{number}.usdc", carried.local(garment.positions, frame),
            garment.faces, None if velocities is None else carried.local_vectors(velocities, frame),
            [primvar for primvar in carried.primvars(garment) if primvar.name not in taken] + fit,
        )  # fmt: skip

    def close(self, state: str, report: dict[str, Any]) -> None:
        """Note how the run ended, and its report."""
        if self._last is not None:
            self._facts["report"] = report
            self._say(state)

    def _forget(self) -> None:
        """Remove what an earlier run left."""
        self._target.mkdir(parents=True, exist_ok=True)
        for pattern in (f"{self._stem}.usdc", f"{self._stem}_*.usdc", f"{self._stem}.pc2"):
            for path in self._target.glob(pattern):
                path.unlink(missing_ok=True)

    def _say(self, state: str) -> None:
        facts = {"state": state, "last_frame": self._last, **self._facts}
        write_atomic(self._target / SIDECAR, json.dumps(facts, indent=2).encode())
