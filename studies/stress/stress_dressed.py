"""Hard cases of whole garments: layers, a walking body, a seam through the body, a run that is killed."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, process_time

import numpy as np

from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.pattern import Edge, Panel, Pattern, Stitch
from toile.dressing.run.dress import FOLLOWS, dress
from toile.dressing.run.progress import ProgressState
from toile.dressing.run.quality import quality_preset
from toile.dressing.run.result import Result, dressed_png
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.studies.scenes.walking_mannequin import walk
from toile.studies.stress.stress_killed import differing_files, run_killed, with_failure
from toile.studies.stress.stress_row import StressRow, outcome_of, picture_path

QUALITY = "preview"
WALK_FRAMES = 30
KILLED_FRAMES = 5


@dataclass(frozen=True, kw_only=True)
class DressedCase:
    """A hard case of whole garments: what makes its result, "valid" or "message", and its limit [CPU s]."""

    make: Callable[[Callable[[Scene], Result], bool], Result]
    expected: str = "valid"
    limit: float = 600.0


def run_dressed_case(name: str, remesh: bool, pictures: Path | None) -> StressRow:
    """Run one case, on its own mesh or an adaptive one; draw its end into a folder if there is one."""
    case = DRESSED_CASES[name]
    started = process_time() + _of_children()

    def spent() -> float:
        return process_time() + _of_children() - started

    def on_frame(_: ProgressState) -> bool:
        return spent() < case.limit

    result = case.make(lambda scene: dress(scene, progress=on_frame), remesh)
    report = result.report
    film = report.get("animation", {})
    crossings = max(report["intersections"]["worst_frame"], film.get("intersections_max", 0))
    failure = report["failure"]
    outcome = outcome_of(
        finite=all(np.isfinite(garment.positions).all() for garment in result.garments),
        crossings=crossings, late=spent() > case.limit, broken_off=result.status not in FOLLOWS,
    )  # fmt: skip
    if pictures is not None:
        write_atomic(picture_path(pictures, name, remesh), dressed_png(result.avatar, result.garments))
    gaps = [gap for gap in (report["min_gap_mm"], film.get("min_gap_mm")) if gap is not None]
    strain = report["strain_percent"]
    return StressRow(
        case=name, remesh=remesh, outcome=outcome, expected=case.expected, intersections=crossings,
        min_gap_mm=min(gaps) if gaps else None,
        strain_percent=max(strain["warp_max"], strain["weft_max"], film.get("strain_percent_max", 0.0)),
        frames=report["frames"] + film.get("frames", 0), steps=report["steps"] + film.get("steps", 0),
        cpu=spent(), message="" if failure is None else f"{failure['message']} ({failure['where']})",
    )  # fmt: skip


def _three_garments(run: Callable[[Scene], Result], remesh: bool) -> Result:
    """Wear trousers, a T-shirt over them and a circle skirt over both."""
    garments = [Garment("trousers"), Garment("tshirt"), Garment("circle_skirt", fabric="denim-12oz")]
    return run(Scene(garments=garments, quality=QUALITY, remesh=remesh))


def _walking(run: Callable[[Scene], Result], remesh: bool) -> Result:
    """Walk in a circle skirt and a T-shirt over it."""
    with TemporaryDirectory() as folder:
        avatar = _walk_file(Path(folder), WALK_FRAMES)
        garments = [Garment("circle_skirt"), Garment("tshirt")]
        return run(Scene(garments=garments, avatar=avatar, quality=QUALITY, remesh=remesh))


def _sewn_through_the_body(run: Callable[[Scene], Result], remesh: bool) -> Result:
    """Sew two tubes side by side, of which each would have to pass through the trunk."""
    body = mannequin()
    size = measure(body)
    z_back, z_front = size.torso_depth
    width, height, gap = 0.24, 0.2, 0.03
    corners = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height))
    edges = tuple(Edge(i, (i + 1) % 4) for i in range(4))
    panels = []
    for side, x in (("left", 0.005), ("right", -0.005 - width)):
        place = size.waist_height
        panels.append(
            Panel(name=f"{side}_front", vertices=corners, edges=edges, translation=(x, place, z_front + gap))
        )
        panels.append(
            Panel(
                name=f"{side}_back", vertices=corners, edges=edges, rotation_degrees=(0.0, 180.0, 0.0),
                translation=(x + width, place, z_back - gap),
            )
        )  # fmt: skip
    # Edge 1 of a front panel and edge 3 of the back one, and the other way round, lie at the same x.
    stitches = tuple(
        Stitch(f"{side}_front", a, f"{side}_back", 4 - a) for side in ("left", "right") for a in (1, 3)
    )
    mesh = mesh_pattern(
        Pattern(name="two_tubes", panels=tuple(panels), stitches=stitches),
        edge_length=quality_preset(QUALITY).edge_length,
    )
    return run(Scene(garments=[Garment(mesh)], quality=QUALITY, remesh=remesh))


def _killed(run: Callable[[Scene], Result], remesh: bool) -> Result:
    """Kill a run at random moments and resume it: its files are those of one that was left alone."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        avatar = _walk_file(folder, KILLED_FRAMES)
        scene = Scene(garments=[Garment("tshirt")], avatar=avatar, quality=QUALITY, remesh=remesh)
        begun = monotonic()
        result = run(scene)
        seconds = monotonic() - begun
        result.save(folder / "whole")
        said = run_killed(
            [
                "--garment", "tshirt", "--avatar", str(avatar.path), "--quality", QUALITY,
                *([] if remesh else ["--no-remesh"]),
            ],
            folder / "killed", seconds,
        )  # fmt: skip
        shapes = ("dressed.glb", "preview.png", "tshirt.ply", "tshirt.obj")
        differing = differing_files(folder / "whole", folder / "killed", shapes)
    if differing:
        return with_failure(result, f"{', '.join(differing)} differ: {'; '.join(said)}")
    return result


DRESSED_CASES = {
    "three_garments": DressedCase(make=_three_garments),
    "walking": DressedCase(make=_walking),
    "sewn_through_the_body": DressedCase(make=_sewn_through_the_body, expected="message"),
    "killed": DressedCase(make=_killed),
}
"""Cases by name."""


def _walk_file(folder: Path, frames: int) -> AvatarFile:
    """Write the first frames of a walking mannequin as a body that moves."""
    body = mannequin()
    motion = walk(body, frames)
    np.savez(folder / "walk.npz", vertices=motion.frames, faces=body.faces, fps=motion.fps)
    return AvatarFile(path=folder / "walk.npz")


def _of_children() -> float:
    """CPU time of processes that this one has started [s]."""
    times = os.times()
    return times.children_user + times.children_system
