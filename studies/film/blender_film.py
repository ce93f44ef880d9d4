"""Blender's cloth on a film of toile: the same garment as it hangs at the start, the same body."""

import json
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from toile.collide.audit import Auditor
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError
from toile.studies.film.material_distance import Worn

QUALITIES = (5, 10)
"""Steps per frame: what Blender starts with, and twice that."""
AREAL_DENSITY = 0.15
"""Of its garments [kg/m^2]."""
SETTINGS: dict[str, dict[str, object]] = {
    "cloth": {
        "air_damping": 0.0, "bending_model": "ANGULAR", "tension_stiffness": 15.0,
        "compression_stiffness": 15.0, "shear_stiffness": 15.0, "bending_stiffness": 0.5,
    },
    "collision": {
        "use_collision": True, "distance_min": 0.002, "use_self_collision": True, "self_distance_min": 0.002,
    },
    "collider": {"thickness_outer": 0.002},
}  # fmt: skip
"""The stiffness of Blender's cotton; collision at 2 mm, as in toile."""


@dataclass(frozen=True)
class BlenderFilm:
    """A film: steps per frame, faces, CPU time [s], what crosses in each frame, largest strain of an edge."""

    quality: int
    faces: int
    cpu: float
    crossings: tuple[int, ...]
    strain: float
    version: str


def blender_film(python: str, quality: int, start: Worn, body: tuple[Float, Int], fps: float) -> BlenderFilm:
    """Run Blender's cloth with as many steps per frame as its quality says.

    Parameters
    ----------
    python
        A Python that can `import bpy`.
    quality
        Steps per frame.
    start
        The garment at the start: its rest shape.
    body
        Poses [m], shape (k, v, 3), and faces, shape (f, 3).
    fps
        Frames per second.

    Raises InputError where that Python has no Blender, or Blender fails.
    """
    corners = start.positions[start.faces]
    double = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 0.5 * float(np.linalg.norm(double, axis=1).sum())
    # Blender's mass is that of a vertex; in grams its unit of force is 1 N.
    mass = 1e3 * AREAL_DENSITY * area / len(start.positions)
    own = {"quality": quality, "mass": mass}
    with TemporaryDirectory(prefix="toile-bench-") as folder:
        job, film = Path(folder) / "job.npz", Path(folder) / "film.npz"
        np.savez(
            job, positions=start.positions, faces=start.faces, body=body[0], body_faces=body[1], fps=fps,
            settings=json.dumps({**SETTINGS, "cloth": {**SETTINGS["cloth"], **own}}),
        )  # fmt: skip
        said = _run(python, [str(Path(__file__).with_name("blender_worker.py")), str(job), str(film)])
        if not film.exists():
            raise InputError(
                f"{python}: Blender gave no film ({said}); --blender needs a Python that can import bpy",
                field="--blender",
            )
        made = dict(np.load(film))
    positions = made["positions"].astype(np.float64)
    return BlenderFilm(
        quality=quality, faces=len(start.faces), cpu=float(made["cpu"]),
        crossings=crossings_of(positions, start.faces, body),
        strain=edge_strain(positions, start.faces), version=str(made["blender"]),
    )  # fmt: skip


def _run(python: str, arguments: list[str]) -> str:
    """Run Blender's Python; return the last line that it said."""
    # It brings its own packages: nothing of this environment shall get in.
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    try:
        done = subprocess.run(
            [python, *arguments], env=environment, capture_output=True, text=True, check=False
        )
    except OSError as error:
        raise InputError(f"{python}: cannot be run ({error.strerror})", field="--blender") from None
    return (f"{done.stdout}\n{done.stderr}".strip().splitlines() or [""])[-1]


def crossings_of(positions: Float, faces: Int, body: tuple[Float, Int]) -> tuple[int, ...]:
    """Count what crosses in every frame, with the body and within the cloth, by toile's audit.

    `positions` [m] are of shape (k, n, 3), `faces` (t, 3), `body` poses and faces.
    """
    weld = np.arange(positions.shape[1], dtype=np.int32)
    own = np.ascontiguousarray(faces, np.int32)
    body_faces = np.ascontiguousarray(body[1], np.int32)
    counts = []
    for x, pose in zip(positions, body[0], strict=True):
        found = Auditor(np.ascontiguousarray(pose), body_faces).audit(np.ascontiguousarray(x), own, weld)
        counts.append(len(found.avatar) + len(found.cloth))
    return tuple(counts)


def edge_strain(positions: Float, faces: Int) -> float:
    """Largest strain of an edge in any frame; edges are as long as they should be in the first."""
    edges = np.unique(
        np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0
    )
    lengths = np.linalg.norm(positions[:, edges[:, 0]] - positions[:, edges[:, 1]], axis=2)
    return float((lengths / lengths[0] - 1.0).max())
