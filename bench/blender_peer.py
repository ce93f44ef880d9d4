"""Blender's cloth and toile on one mesh with one fabric: error against CPU time, as in `toile bench`.

python bench/blender_peer.py --blender-python PATH [--side N] [--scene NAME ...] --out DIR

PATH is a Python that can `import bpy`: see blender_cloth.py. Writes a report as `toile bench --out DIR` does,
with a chart for `hang` and one for `sphere`, the sheet in a vacuum for one second. Reference: toile on a mesh
of half the edges, TR-BDF2 in short steps. Blender's cloth is another model, masses and springs: no step size
would take it there exactly.
"""

import argparse
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import mean

from blender_cloth import Film, figures, run_blender, run_toile
from blender_cloth_scenes import FRAME_SECONDS, STEPS, Scene, choices, make_scene, toile_plan

from toile.dressing.files.writers.atomic import writable_folder
from toile.dressing.run.kernels import DRAPE_KERNELS, load_kernels
from toile.dressing.run.report import versions
from toile.studies.adaptive.surface_distance import mean_surface_distance
from toile.studies.speed_error.films import INTEGRATORS, exactly, in_steps
from toile.studies.speed_error.machine import machine
from toile.studies.speed_error.point import Chart, Point
from toile.studies.speed_error.stored import Report
from toile.studies.speed_error.timed import repeated
from toile.studies.speed_error.write import write_pages

SECONDS = 1.0
SAMPLED = round(0.2 / FRAME_SECONDS)
"""Frames between two whose surfaces are compared."""
SPACING = 0.01
"""Of the points that stand for a surface [m]."""
REPEATS = 3
NEWTON = {"hang": 4, "sphere": None}
"""Iterations per step of the reference, as in `toile bench`."""
TOILE_STEPS, BLENDER_STEPS = (60, 120, 240), (STEPS, 4 * STEPS, 16 * STEPS)
"""Per second, and per frame."""


def distance(film: Film, reference: Film) -> float:
    """Mean distance of the surfaces from those of the reference [mm], mean over the film."""
    return 1e3 * mean(
        mean_surface_distance(
            (film.positions[k], film.faces), (reference.positions[k], reference.faces), SPACING
        )
        for k in range(SAMPLED, len(film.positions), SAMPLED)
    )


def point(curve: str, label: str, scene: Scene, reference: Film, run: Callable[[], Film]) -> Point:
    """Run a film and compare it."""

    def clocked() -> tuple[Film, float]:
        film = run()
        return film, film.cpu - film.audit

    film, timing = repeated(clocked, REPEATS)
    found = figures(scene, film)
    done = Point(
        curve=curve, label=label, cpu=timing.cpu, spread=timing.spread, repeats=timing.repeats,
        error=distance(film, reference), faces=len(film.faces),
        crossings=int(found["crossings_body"]) + int(found["crossings_self"]),
        figures={"strain max %": float(found["strain_percent"])},
    )  # fmt: skip
    said = f"{done.error:.3g} mm, {done.cpu:.2f} CPU s, {done.crossings} crossings"
    print(f"{scene.name}, {curve}, {label}: {said}", flush=True)
    return done


def peers(python: Path, name: str, side: int) -> tuple[Chart, dict[str, str]]:
    """Both engines on one scene; and Blender's versions."""
    scene, fine = make_scene(name, side), make_scene(name, 2 * side - 1)
    solved = exactly(fine.edge, 480, NEWTON[name])
    reference = run_toile(fine, SECONDS, solved.change(toile_plan()))
    coarse = run_toile(scene, SECONDS, exactly(scene.edge, 240, NEWTON[name]).change(toile_plan()))
    print(f"{name}: reference is done, {reference.cpu:.0f} CPU s", flush=True)
    points = []
    for integrator, step in INTEGRATORS.items():
        for count in TOILE_STEPS:
            plan = in_steps(count, step)(toile_plan())
            points.append(
                point(
                    f"toile, {integrator}", f"1/{count} s", scene, reference,
                    lambda plan=plan: run_toile(scene, SECONDS, plan),
                )
            )  # fmt: skip
    for choice in choices(scene)[:2]:
        for steps in BLENDER_STEPS:
            own = replace(choice, steps=steps)
            label = f"1/{round(steps / FRAME_SECONDS)} s"
            points.append(
                point(
                    choice.label, label, scene, reference,
                    lambda own=own: run_blender(python, scene, own, SECONDS),
                )
            )  # fmt: skip
    found = run_blender(python, scene, choices(scene)[0], FRAME_SECONDS).versions
    chart = Chart(
        scene=name,
        title=f"beside Blender's cloth, {side} x {side} vertices",
        error="mean distance of the surface, mean over 1 s of film; CPU time without toile's audit",
        unit="mm",
        reference=f"toile, {solved.label}, {reference.cpu:.0f} CPU s",
        floor=distance(coarse, reference),
        points=tuple(points),
    )
    return chart, found


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--blender-python", type=Path, required=True, metavar="PATH")
    parser.add_argument("--side", type=int, default=50, metavar="N", help="vertices along a side")
    parser.add_argument("--scene", nargs="+", choices=tuple(NEWTON), default=list(NEWTON))
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    options = parser.parse_args()
    folder = writable_folder(options.out)
    load_kernels(DRAPE_KERNELS)
    charts, said = [], versions()
    for name in options.scene:
        chart, theirs = peers(options.blender_python, name, options.side)
        charts.append(chart)
        said |= theirs
        report = Report(quick=False, machine=machine(), versions=said, charts=tuple(charts))
        command = (
            f"python bench/blender_peer.py --blender-python PATH --side {options.side} "
            f"--scene {' '.join(options.scene)}"
        )
        write_pages(folder, report, command)


if __name__ == "__main__":
    main()
