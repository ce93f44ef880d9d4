"""Blender's own cloth and toile on the same scenes, in one run.

python bench/blender_cloth.py --blender-python PATH [--out bench/results]

PATH is a Python that can `import bpy`. Blender as a module needs a certain version of Python (4.5: 3.11),
hence an environment of its own: `python3.11 -m venv DIR && DIR/bin/pip install "bpy==4.5.*"`, on a bare
Debian also the packages libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1 libxext6.
Writes blender_cloth.json and blender_cloth.md.

A square of 1 m falls on a fixed sphere (`sphere`) or swings down from two corners (`hang`) for two seconds.
Both engines get the same vertices, triangles, areal density, stiffness, longest step and film rate, collide
with the sphere and within the cloth, and run on one core. What crosses is counted in all frames by toile's
audit, which shares no code with its contact search. CPU times are medians and count the frames
only.
"""

import argparse
import json
import os
import platform
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import process_time

import numpy as np
import trimesh
from blender_cloth_scenes import (
    FABRIC,
    FRAME_SECONDS,
    SECONDS,
    SIDES,
    STEPS,
    BlenderChoice,
    Scene,
    blender_settings,
    choices,
    equal_steps_plan,
    make_scene,
    toile_plan,
)

from toile.collide.audit import Auditor
from toile.dressing.run.kernels import DRAPE_KERNELS, load_kernels
from toile.engine.film.plan import FilmFrame, FilmPlan
from toile.engine.film.simulate import Simulation
from toile.studies.scenes.scenes import GRAVITY, SPHERE_RADIUS, sheet

REPEATS = 3
EQUAL_STEPS = "toile, no shorter steps"
LOOK = round(0.3 / FRAME_SECONDS)
"""Frame at which it is measured how far the sheet has fallen."""


@dataclass(frozen=True, kw_only=True)
class Film:
    """Positions of all frames [m], shape (f, n, 3), triangles, CPU time and the audit's part of it [s]."""

    positions: np.ndarray
    faces: np.ndarray
    cpu: float
    audit: float
    short: int
    steps: int
    versions: dict[str, str]


def run_toile(scene: Scene, seconds: float = SECONDS, plan: FilmPlan | None = None) -> Film:
    """Run a scene in toile, by the plan of its own benchmark scenes or another."""
    frames = []

    def on_frame(frame: FilmFrame) -> bool:
        frames.append(frame.cloth.positions)
        return True

    cloth = sheet(scene.flat, scene.faces, scene.positions, scene.pinned, FABRIC)
    film = Simulation(cloth, scene.ball, plan or toile_plan(), on_frame)
    started = process_time()
    record = film.run(seconds)
    cpu = process_time() - started
    audit = film.clock.cpu("audit")
    return Film(
        positions=np.array(frames),
        faces=cloth.face_nodes,
        cpu=cpu,
        audit=audit,
        short=0,
        steps=record.steps,
        versions={},
    )


def run_blender(python: Path, scene: Scene, choice: BlenderChoice, seconds: float = SECONDS) -> Film:
    """Run a scene in Blender, in a process of its own."""
    film = blender_film(
        python,
        scene.positions,
        scene.quads,
        scene.pinned,
        scene.ball,
        blender_settings(scene, choice),
        seconds,
    )
    if not np.array_equal(_canonical(film["triangles"]), _canonical(scene.faces)):
        raise SystemExit("Blender collides other triangles than toile")
    frames = round(seconds / FRAME_SECONDS)
    return Film(
        positions=film["positions"].astype(np.float64), faces=film["triangles"], cpu=float(film["cpu"]),
        audit=0.0, short=int(film["short"]), steps=choice.steps * frames,
        versions={"Blender": str(film["blender"]), "its Python": str(film["python"])},
    )  # fmt: skip


def blender_film(
    python: Path, positions: np.ndarray, polygons: np.ndarray, pinned: np.ndarray,
    ball: tuple[np.ndarray, np.ndarray] | None, settings: dict[str, dict[str, object]], seconds: float,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Let Blender's worker compute a film of a mesh, perhaps with a ball; return what it gives."""
    ball = ball or (np.empty((0, 3)), np.empty((0, 3), np.int32))
    with tempfile.TemporaryDirectory() as folder:
        given, got = Path(folder) / "scene.npz", Path(folder) / "film.npz"
        np.savez(
            given, positions=positions, polygons=polygons, pinned=pinned, ball_positions=ball[0],
            ball_faces=ball[1], frames=round(seconds / FRAME_SECONDS), frame_seconds=FRAME_SECONDS,
            settings=json.dumps(settings),
        )  # fmt: skip
        worker = Path(__file__).with_name("blender_cloth_worker.py")
        # Blender brings its own packages: nothing of this environment shall get in.
        environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        done = subprocess.run(
            [python, worker, given, got], env=environment, capture_output=True, text=True, check=False
        )
        if not got.exists():
            raise SystemExit(f"Blender gave no film:\n{done.stdout}{done.stderr}")
        return dict(np.load(got))


def _canonical(faces: np.ndarray) -> np.ndarray:
    """Triangles in an order of their own, to compare sets of them."""
    ordered = np.sort(faces, axis=1)
    return ordered[np.lexsort(ordered.T)]


def figures(scene: Scene, film: Film) -> dict[str, object]:
    """What the frames of a film show."""
    auditor = Auditor(*(scene.ball or (None, None)))
    nodes = np.arange(scene.side**2, dtype=np.int32)
    found = [auditor.audit(np.ascontiguousarray(x), film.faces, nodes) for x in film.positions]
    body, self_ = [len(pairs.avatar) for pairs in found], [len(pairs.cloth) for pairs in found]
    grid = film.positions.reshape(-1, scene.side, scene.side, 3)
    strain = np.max(
        [
            (np.linalg.norm(np.diff(grid, axis=axis), axis=3) / scene.edge - 1.0).max(axis=(1, 2))
            for axis in (1, 2)
        ],
        axis=0,
    )
    row: dict[str, object] = {
        "crossings_body": sum(body), "crossings_self": sum(self_),
        "frames_crossing": sum(a + b > 0 for a, b in zip(body, self_, strict=True)), "frames": len(found),
        "frames_stopped_short": film.short,
        "fallen_mm": 1e3 * float((film.positions[0] - film.positions[LOOK])[:, 1].mean()),
        "strain_percent": 100.0 * strain.max(), "end_strain_percent": 100.0 * strain[-1],
    }  # fmt: skip
    if scene.ball is not None:
        # The ball's centre is the origin: what is nearest to it is nearest to the ball.
        origin = np.zeros((len(film.faces), 3))
        near = [
            np.linalg.norm(trimesh.triangles.closest_point(x[film.faces], origin), axis=1).min()
            for x in film.positions
        ]
        gaps = (np.array(near) - SPHERE_RADIUS) / 1e-3
        row |= {"least_gap_mm": gaps.min(), "end_gap_mm": gaps[-1]}
    return row


def check_units(python: Path) -> dict[str, dict[str, float]]:
    """Let a sheet fall freely and let one hang, in both engines; raise if seconds or newtons differ.

    After n steps h of either engine's implicit Euler a free body has fallen g h^2 n (n + 1)/2. A sheet hung
    by its top edge is longer by rho g/(2 C); on Blender's N springs of one mass each, by (N - 1)/N of that.
    """
    step, seconds = FRAME_SECONDS / STEPS, 0.2
    count = round(seconds / step)
    free, strip = make_scene("free", 11), make_scene("strip", 11)
    choice = choices(free)[0]
    long = FABRIC.areal_density * GRAVITY / (2.0 * FABRIC.stretch_warp)
    found = {"fall in 0.2 s [mm]": {"exact": 1e3 * GRAVITY * step**2 * count * (count + 1) / 2.0}}
    found["sag of a hanging metre [mm]"] = {"exact": 1e3 * long}
    for name, fall, hung in (
        ("toile", run_toile(free, seconds), run_toile(strip, 2.0)),
        ("Blender", run_blender(python, free, choice, seconds), run_blender(python, strip, choice, 2.0)),
    ):
        drop = fall.positions[0, :, 1] - fall.positions[-1, :, 1]
        found["fall in 0.2 s [mm]"][name] = 1e3 * float(drop.mean())
        found["sag of a hanging metre [mm]"][name] = -1e3 * float(hung.positions[-1, : strip.side, 1].mean())
    for row, tolerance in zip(found.values(), (1e-3, 0.15), strict=True):
        for name in ("toile", "Blender"):
            if abs(row[name] / row["exact"] - 1.0) > tolerance:
                raise SystemExit(f"the engines' units differ: {found}")
    return found


def compare(python: Path, scene: Scene) -> tuple[list[dict[str, object]], dict[str, str]]:
    """All rows of a scene, engines taking turns; and versions."""
    films: dict[str, list[Film]] = {}
    for _ in range(REPEATS):
        films.setdefault("toile", []).append(run_toile(scene))
        films.setdefault(EQUAL_STEPS, []).append(run_toile(scene, plan=equal_steps_plan()))
        for choice in choices(scene):
            films.setdefault(choice.label, []).append(run_blender(python, scene, choice))
    rows, versions = [], {}
    for label, runs in films.items():
        versions |= runs[0].versions
        same = all(np.array_equal(run.positions, runs[0].positions) for run in runs)
        row = {
            "scene": scene.name, "side": scene.side, "engine": label, "steps": runs[0].steps,
            "cpu_per_second": median(run.cpu for run in runs) / SECONDS,
            "cpu_per_second_without_audit": median(run.cpu - run.audit for run in runs) / SECONDS,
            "cpu_of_runs": [round(run.cpu, 2) for run in runs], "runs_agree_to_the_bit": same,
            **figures(scene, runs[0]),
        }  # fmt: skip
        print(json.dumps(row, default=float), flush=True)
        rows.append(row)
    return rows, versions


NOTES = f"""\
A square of 1 m in a vacuum for 2 s, 30 frames per second. `sphere`: it falls 5 cm onto a fixed icosphere of
5120 faces, radius 0.25 m. `hang`: level at first, it swings down from two corners. Cotton poplin made equal
in warp and weft: {1e3 * FABRIC.areal_density:g} g/m^2, {FABRIC.stretch_warp:g} N/m (in compression a
fiftieth), shear {FABRIC.shear:g} N/m, bending {1e6 * FABRIC.bending_warp:.2g} uN m, friction
{FABRIC.friction_body:g} on the sphere and {FABRIC.friction_self:g} on cloth. 240 steps are of 1/120 s; toile
takes shorter ones where it needs them, or, as "{EQUAL_STEPS}", never.

Reach of contact: toile 2 mm from the sphere, 1 mm within the cloth. "Blender": its distances and outer
thickness at the least that it allows, 1 mm, which makes 2 mm from the sphere and 2 mm within the cloth. "Self
distance 0.4 edges": 8 or 4 mm instead of 1 mm within the cloth. "Quarter steps": 1/480 s. "Its default
distances": 15 mm, outer thickness 20 mm; not with 100 vertices along a side, where 2 s were not done after
480 CPU s.

CPU s: medians of {REPEATS} runs on one core, of the frames only. Crossings: pairs of triangles, summed over
all frames. Strain: along the sides of the quads. Gap: from the true sphere, whose mesh lies up to 0.25 mm
inside it; negative where cloth is in the sphere. Fallen: mean over the sheet. Solver stopped short: frames in
which Blender's linear solver gave up at its limit of 100 iterations.
"""


def table(rows: list[dict[str, object]]) -> str:
    """The rows in Markdown."""
    lines = [
        "| scene | engine | steps | CPU s per simulated s | crossings with the sphere "
        "| crossings within the cloth | frames that cross | strain max / end % | gap least / end mm "
        "| fallen after 0.3 s mm | solver stopped short |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        cpu = f"{row['cpu_per_second']:.1f}"
        if row["engine"] in ("toile", EQUAL_STEPS):
            cpu += f" ({row['cpu_per_second_without_audit']:.1f} without audit)"
        gap = f"{row['least_gap_mm']:.2f} / {row['end_gap_mm']:.2f}" if "least_gap_mm" in row else ""
        lines.append(
            f"| {row['scene']} {row['side']} | {row['engine']} | {row['steps']} | {cpu} "
            f"| {row['crossings_body'] if gap else ''} | {row['crossings_self']} "
            f"| {row['frames_crossing']} of {row['frames']} "
            f"| {row['strain_percent']:.1f} / {row['end_strain_percent']:.1f} | {gap} "
            f"| {row['fallen_mm']:.0f} | {row['frames_stopped_short'] or ''} |"
        )
    return "\n".join(lines)


def commit() -> str:
    """The commit of this checkout."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "--short", "HEAD"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--blender-python", type=Path, required=True, metavar="PATH")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "results")
    options = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    load_kernels(DRAPE_KERNELS)
    checks = check_units(options.blender_python)
    print(json.dumps(checks), flush=True)
    rows, versions = [], {"toile": commit(), "Python": platform.python_version(), "numpy": np.__version__}
    for name, sides in SIDES.items():
        for side in sides:
            found, theirs = compare(options.blender_python, make_scene(name, side))
            rows += found
            versions |= theirs
    facts = {"versions": versions, "checks": checks, "rows": rows}
    (options.out / "blender_cloth.json").write_text(json.dumps(facts, indent=1, default=float) + "\n")
    said = ", ".join(f"{name} {version}" for name, version in versions.items())
    heading = "# Beside Blender's cloth"
    command = "`python bench/blender_cloth.py --blender-python PATH`"
    text = f"{heading}\n\n{command}: {said}.\n\n{NOTES}\n{table(rows)}\n"
    (options.out / "blender_cloth.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
