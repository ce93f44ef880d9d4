"""One timed run of a scene, in a process of its own, by whatever version of toile its path leads to.

python dress_worker.py JOB.json RUN.npz

JOB holds `folder` (where toile must lie), `garments` (names or files), `avatar` (a file), `quality`,
`step_share` (1, or the share of the usual step size that a film takes) and `threads`, where the version can
be told. RUN receives `facts`, JSON of the times and the report, or of the problem if there was one; and of
frame k `positions_k` (n, 3), `faces_k` (t, 3), `uv_k` (m, 2), `uv_faces_k` (t, 3) and `panel_k` (t,), all
garments together.

Only public names of toile are used, which every version since 0.1 has, but for steps of another size.
"""

import json
import os
import sys
from dataclasses import fields, replace
from importlib import import_module
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

import toile

FOLLOW = ("toile.dressing.run.follow", "toile.dress.follow")
"""Where versions of toile make the plan of a film."""
PANELS = 10_000
"""More than any garment has."""


def cpu_now() -> float:
    """Return the CPU time of this process and of those it has waited for [s]."""
    times = os.times()
    return process_time() + times.children_user + times.children_system


def take_steps_of(share: float) -> None:
    """Let films take steps of a share of their usual size. Raises LookupError where that is not known."""
    for name in FOLLOW:
        try:
            follow: Any = import_module(name)
        except ModuleNotFoundError:
            continue
        usual = follow.FilmPlan

        def shorter(usual: Any = usual, **settings: Any) -> Any:
            plan = usual(**settings)
            return replace(
                plan, longest_step=share * plan.longest_step, shortest_step=share * plan.shortest_step,
                motion_max=share * plan.motion_max,
            )  # fmt: skip

        follow.FilmPlan = shorter
        return
    raise LookupError("this version of toile has no plan of films that is known here")


def scene_of(job: dict[str, Any], **more: Any) -> "toile.Scene":
    """Return the scene of a job."""
    if knows_threads():
        more["threads"] = job["threads"]
    return toile.Scene(
        garments=[toile.Garment(source) for source in job["garments"]],
        avatar=toile.AvatarFile(path=Path(job["avatar"])), quality=job["quality"], **more,
    )  # fmt: skip


def knows_threads() -> bool:
    """Whether a scene of this version can be told how many threads to use."""
    return "threads" in {entry.name for entry in fields(toile.Scene)}


def measured(job: dict[str, Any]) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Run a job; return its facts and the meshes of its frames."""
    # Kernels are loaded, or compiled, and files read once before anything is timed.
    toile.dress(scene_of(job, max_frames=1))
    if job["step_share"] != 1.0:
        take_steps_of(job["step_share"])
    frames: list[tuple[Any, ...]] = []
    hung = cpu_now(), perf_counter()

    def progress(state: object) -> bool:
        nonlocal hung
        if not frames:
            # The last frame of the drape is where a film begins.
            hung = cpu_now(), perf_counter()
        return True

    def record(index: int, garments: tuple[Any, ...]) -> None:
        frames.append(garments)

    started = cpu_now(), perf_counter()
    result = toile.dress(scene_of(job), None, progress, None, record)
    ended = cpu_now(), perf_counter()
    since = hung if len(frames) > 1 else started
    facts = {
        "cpu": ended[0] - since[0], "wall": ended[1] - since[1], "status": result.status,
        "report": result.report, "threads": knows_threads(),
    }  # fmt: skip
    meshes = {}
    for index, garments in enumerate(frames):
        for name, array in one_mesh(garments).items():
            meshes[f"{name}_{index}"] = array
    return facts, meshes


def one_mesh(garments: tuple[Any, ...]) -> dict[str, np.ndarray]:
    """Return garments as one mesh."""
    nodes = np.cumsum([0, *(len(garment.positions) for garment in garments)])
    vertices = np.cumsum([0, *(len(garment.uv) for garment in garments)])
    return {
        "positions": np.concatenate([garment.positions for garment in garments]),
        "faces": np.concatenate([garment.faces + nodes[k] for k, garment in enumerate(garments)]),
        "uv": np.concatenate([garment.uv for garment in garments]),
        "uv_faces": np.concatenate([garment.uv_faces + vertices[k] for k, garment in enumerate(garments)]),
        "panel": np.concatenate([garment.panel + k * PANELS for k, garment in enumerate(garments)]),
    }


def main() -> None:
    """Run the job of the first argument and write the second."""
    job = json.loads(Path(sys.argv[1]).read_text())
    meshes: dict[str, Any] = {}
    try:
        found = Path(str(toile.__file__)).absolute()
        if not found.is_relative_to(job["folder"]):
            raise LookupError(f"Python finds another one, {found}")
        facts, meshes = measured(job)
    except (toile.InputError, LookupError) as error:
        facts = {"problem": str(error)}
    np.savez(sys.argv[2], facts=json.dumps(facts), **meshes)


if __name__ == "__main__":
    main()
