"""`toile bench film`: films or drapes, of this version and another and of Blender, in turns."""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from toile.geometry.errors import InputError
from toile.studies.film.blender_film import QUALITIES, BlenderFilm, blender_film
from toile.studies.film.film_row import BLENDER, FilmRow
from toile.studies.film.garment_film import GarmentFilm
from toile.studies.film.material_distance import Worn, rms_and_largest
from toile.studies.film.toile_version import THIS, ToileVersion

FINE_SHARE = 0.25
"""Share of the usual step of the film that others are compared with."""
FINE_QUALITY = "accurate"
"""Preset of the drape that others are compared with."""
TWO = 2
"""Threads, beside one."""


@dataclass(frozen=True, kw_only=True)
class Effort:
    """How films are measured.

    Attributes
    ----------
    versions
        Versions of toile that take turns.
    blender
        A Python that has Blender, or None.
    still
        Whether garments are draped only.
    quality
        Preset.
    frames
        Frames after the first, or None for those of the film.
    repeats
        Runs that are timed.
    say
        Told what was done.
    """

    versions: tuple[ToileVersion, ...]
    blender: str | None
    still: bool
    quality: str
    frames: int | None
    repeats: int
    say: Callable[[str], None]


@dataclass(frozen=True)
class DressRun:
    """One run of a version: its times and report, and the garments in every frame."""

    facts: dict[str, Any]
    frames: list[Worn]


@dataclass
class _Runs:
    """What a version has done so far: runs in one thread and in two, and the fine one."""

    one: list[DressRun] = field(default_factory=list)
    two: list[DressRun] = field(default_factory=list)
    fine: DressRun | None = None


def bench_film(film: GarmentFilm, effort: Effort, folder: Path) -> Iterator[list[FilmRow]]:
    """Measure a film; yield all its rows again after every run, so that nothing measured is lost.

    `folder` is for files that are passed between processes.
    """
    body = film.write_body(folder, effort.frames, effort.still)
    runs: dict[str, _Runs] = {version.name: _Runs() for version in effort.versions}
    others: dict[str, list[BlenderFilm]] = {}
    job = {
        "garments": list(film.garments), "avatar": str(body), "quality": effort.quality, "step_share": 1.0,
        "threads": 1,
    }  # fmt: skip

    def rows() -> list[FilmRow]:
        found = [_row(film, effort, name, done) for name, done in runs.items() if done.one]
        return found + [_blender_row(film, name, done) for name, done in others.items()]

    for _ in range(effort.repeats):
        for version in effort.versions:
            done = runs[version.name]
            done.one.append(run_version(version, job, folder))
            effort.say(_said(film, version.name, done.one[-1], effort.still))
            yield rows()
            if version.name == THIS and done.one[-1].facts["threads"]:
                done.two.append(run_version(version, job | {"threads": TWO}, folder))
                yield rows()
        if effort.blender is not None and not effort.still:
            start, poses = runs[THIS].one[0].frames[0], dict(np.load(body))
            for quality in QUALITIES:
                made = blender_film(
                    effort.blender, quality, start, (poses["vertices"], poses["faces"]), float(poses["fps"])
                )
                others.setdefault(f"{BLENDER}{quality}", []).append(made)
                effort.say(f"{film.name}, {BLENDER}{quality}: {made.cpu:.2f} CPU s in {made.version}")
                yield rows()
    fine = {"quality": FINE_QUALITY} if effort.still else {"step_share": FINE_SHARE}
    for version in effort.versions:
        if runs[version.name].one[0].facts["status"] == "failed":
            continue
        runs[version.name].fine = run_version(version, job | fine, folder)
        effort.say(f"{film.name}, {version.name}: the fine one is done")
        yield rows()


def run_version(version: ToileVersion, job: dict[str, Any], folder: Path) -> DressRun:
    """Run a job in a version of toile. Raises InputError with its name where it cannot."""
    asked, made = folder / "job.json", folder / "run.npz"
    made.unlink(missing_ok=True)
    asked.write_text(json.dumps(job | {"folder": str(version.path)}))
    # The other packages are found where this process finds them; threads of libraries would count as work.
    path = [
        str(version.path),
        *(entry for entry in sys.path if entry and not (Path(entry) / "toile").is_dir()),
    ]
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(path), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
        "MKL_NUM_THREADS": "1",
    }  # fmt: skip
    worker = str(Path(__file__).with_name("dress_worker.py"))
    done = subprocess.run(
        [sys.executable, "-P", worker, str(asked), str(made)], env=environment, stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE, text=True, check=False,
    )  # fmt: skip
    if not made.exists():
        said = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
        raise InputError(f"toile {version.name} cannot be measured: {said}", field="--against")
    with np.load(made) as arrays:
        facts = json.loads(str(arrays["facts"]))
        if "problem" in facts:
            raise InputError(f"toile {version.name} cannot be measured: {facts['problem']}")
        count = sum(name.startswith("positions_") for name in arrays.files)
        names = ("positions", "faces", "uv", "uv_faces", "panel")
        frames = [Worn(*(arrays[f"{name}_{index}"] for name in names)) for index in range(count)]
    return DressRun(facts, frames)


def _row(film: GarmentFilm, effort: Effort, name: str, runs: _Runs) -> FilmRow:
    """Return what a version has shown so far."""
    first = runs.one[0]
    report = first.facts["report"]
    found = report if effort.still else report.get("animation") or {"frames": 0}
    frames = max(1, 1 if effort.still else found["frames"])
    cpu = [run.facts["cpu"] / frames for run in runs.one]
    failure = report["failure"] or {}
    crossings = report["intersections"]["worst_frame"] if effort.still else found.get("intersections_max", 0)
    strain = report["strain_percent"]
    largest = max(strain["warp_max"], strain["weft_max"])
    rms, most = _distances(runs)
    return FilmRow(
        film=film.name, version=name, still=effort.still, frames=found["frames"],
        faces=max(len(frame.faces) for frame in first.frames), repeats=len(cpu), cpu=median(cpu),
        cpu_spread=max(cpu) - min(cpu), wall=median(run.facts["wall"] / frames for run in runs.one),
        wall_two_threads=median(run.facts["wall"] / frames for run in runs.two) if runs.two else None,
        steps=found.get("steps", 0), newton_iterations=found.get("newton_iterations", 0),
        crossings=crossings, strain=largest if effort.still else found.get("strain_percent_max", largest),
        distance_rms=rms, distance_max=most,
        failure=" ".join(filter(None, (failure.get("class"), failure.get("where")))),
    )  # fmt: skip


def _distances(runs: _Runs) -> tuple[float | None, float | None]:
    """Distances of a version's first run from its fine one [mm], where both came to the same end."""
    fine = runs.fine
    if fine is None or len(fine.frames) != len(runs.one[0].frames) or not fine.frames[0].flat:
        return None, None
    rms, largest = rms_and_largest(runs.one[0].frames, fine.frames)
    return 1e3 * rms, 1e3 * largest


def _blender_row(film: GarmentFilm, name: str, made: Sequence[BlenderFilm]) -> FilmRow:
    """Return what Blender has shown so far."""
    length = max(1, len(made[0].crossings) - 1)
    cpu = [one.cpu / length for one in made]
    return FilmRow(
        film=film.name, version=name, still=False, frames=length, faces=made[0].faces, repeats=len(cpu),
        cpu=median(cpu), cpu_spread=max(cpu) - min(cpu), wall=None, steps=length * made[0].quality,
        newton_iterations=None, crossings=max(made[0].crossings), strain=100.0 * made[0].strain,
    )  # fmt: skip


def _said(film: GarmentFilm, name: str, run: DressRun, still: bool) -> str:
    """Return a line about a run."""
    frames = max(1, len(run.frames) - 1)
    length = "in all" if still else f"in {frames} frames"
    return f"{film.name}, {name}: {run.facts['cpu']:.1f} CPU s {length}, {run.facts['status']}"
