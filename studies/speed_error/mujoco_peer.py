"""MuJoCo beside toile, where it is installed: the nearest engine on a CPU that lets no cloth pass."""

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from toile.collide.audit import Auditor
from toile.dressing.garment.fabrics import fabric
from toile.geometry.arrays import Float, Int
from toile.studies.scenes.scenes import DROP, SPHERE_RADIUS
from toile.studies.speed_error.point import Point

FRAME_SECONDS = 1.0 / 30.0
HOW_TO_INSTALL = "MuJoCo is not installed (pip install 'toile[peers]'): no rows of it"


@dataclass(frozen=True)
class MujocoFilm:
    """Positions of all frames [m], shape (k, n, 3), triangles, shape (t, 3), CPU time of the steps [s]."""

    positions: Float
    faces: Int
    cpu: float


def peer_versions() -> dict[str, str]:
    """Return the version of MuJoCo, or that there is none."""
    try:
        return {"mujoco": version("mujoco")}
    except PackageNotFoundError:
        return {"mujoco": "not installed"}


def has_mujoco(say: Callable[[str], None], scene: str) -> bool:
    """Tell whether MuJoCo is installed, and say so where it is not."""
    if find_spec("mujoco") is None:
        say(f"{scene}: {HOW_TO_INSTALL}")
        return False
    return True


def mujoco_film(scene: str, cells: int, seconds: float, step: float) -> MujocoFilm:
    """Run `sphere` or `swing` on cells x cells in MuJoCo, in steps of a length [s].

    Its cloth is an isotropic plate with the mean stiffness of the scene's poplin, as stiff in compression.
    Raises RuntimeError where MuJoCo fails.
    """
    poplin = fabric("cotton-poplin")
    job = {
        "scene": scene, "cells": cells, "seconds": seconds, "frame_seconds": FRAME_SECONDS, "step": step,
        "stretch": 0.5 * (poplin.stretch_warp + poplin.stretch_weft),
        "bending": (poplin.bending_warp + poplin.bending_weft + poplin.bending_bias) / 3.0,
        "areal_density": poplin.areal_density, "radius": SPHERE_RADIUS, "drop": DROP,
    }  # fmt: skip
    worker = Path(__file__).with_name("mujoco_worker.py")
    with TemporaryDirectory(prefix="toile-bench-") as folder:
        asked, made = Path(folder) / "job.json", Path(folder) / "film.npz"
        asked.write_text(json.dumps(job))
        done = subprocess.run(
            [sys.executable, "-P", str(worker), str(asked), str(made)], capture_output=True, text=True,
            check=False,
        )  # fmt: skip
        if not made.exists():
            raise RuntimeError(f"MuJoCo gave no film: {(done.stderr.strip().splitlines() or [''])[-1]}")
        with np.load(made) as film:
            return MujocoFilm(film["positions"], film["faces"].astype(np.int32), float(film["cpu"]))


def mujoco_point(film: MujocoFilm, step: float, error: float, crossings: int, cells: int) -> Point:
    """Return a film in steps of a length [s] as a point of a chart, with its error in the chart's unit."""
    return Point(
        curve="MuJoCo", label=f"{1e3 * step:g} ms", cpu=film.cpu, spread=0.0, repeats=1, error=error,
        faces=len(film.faces), crossings=crossings,
        figures={"strain max %": 100.0 * side_strain(film, cells)},
    )  # fmt: skip


def crossings_in_all(film: MujocoFilm, ball: tuple[Float, Int] | None) -> int:
    """Count pairs of triangles that cross, summed over all frames, by toile's audit."""
    auditor = Auditor(*(ball or (None, None)))
    weld = np.arange(film.positions.shape[1], dtype=np.int32)
    found = [auditor.audit(np.ascontiguousarray(x), film.faces, weld) for x in film.positions]
    return sum(len(one.avatar) + len(one.cloth) for one in found)


def side_strain(film: MujocoFilm, cells: int) -> float:
    """Largest strain of a side of the grid's cells in any frame: along warp or weft."""
    grid = film.positions.reshape(len(film.positions), cells + 1, cells + 1, 3)
    lengths = [np.linalg.norm(np.diff(grid, axis=axis), axis=3) * cells for axis in (1, 2)]
    return float(max(length.max() for length in lengths) - 1.0)


def at_nodes_of(start: Float, film: MujocoFilm) -> Float:
    """Return the end of a film [m], shape (n, 3), in the order of nodes that start somewhere [m], (n, 3)."""

    def order(positions: Float) -> Int:
        grid = np.rint(1e6 * positions).astype(np.int64)
        return np.lexsort((grid[:, 2], grid[:, 0])).astype(np.int32)

    end = np.empty_like(start)
    end[order(start)] = film.positions[-1][order(film.positions[0])]
    return end
