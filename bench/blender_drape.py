"""The drape test in Blender's cloth and in toile: how far the drape coefficient depends on the mesh.

python bench/blender_drape.py --blender-python PATH [--out bench/results]

PATH is a Python that can `import bpy`: see blender_cloth.py. A round cloth hangs over a disc (the Cusick test
of `toile validate`) on irregular triangles of 12, 6 and 3 mm, the same in both engines. Blender's springs get
what stands for the same fabric on that mesh ("converted"), or once for 6 mm and then on all meshes, as the
panel of a cloth keeps it whose mesh is subdivided ("set once"). Writes blender_drape.json and .md.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
from blender_cloth import blender_film
from blender_cloth_scenes import FABRIC, FRAME_SECONDS

from toile.dressing.run.report import versions
from toile.engine.cloth.cloth import Cloth
from toile.studies.validation.cusick import DISC, SPECIMEN, drape_coefficient, hung, ring_mesh, specimen

EDGES, SET_FOR = (0.012, 0.006, 0.003), 0.006
"""Of the triangles, and of those for which Blender's springs are set once [m]."""
SECONDS, STEPS = 8.0, 16
"""Length of Blender's film [s], and steps per frame: 1/480 s each."""
LOOK = round(0.5 / FRAME_SECONDS)
"""Frames over which the motion left at the end is measured."""
DAMPING, AIR = 5.0, 1.0
"""Of springs and of the air: Blender's defaults."""


def settings(edge: float, nodes: int, area: float) -> dict[str, dict[str, object]]:
    """Blender's properties for FABRIC on triangles of that edge [m].

    Springs of constant k along equilateral triangles are a membrane of Young's modulus 2 k/sqrt(3); a
    spring's constant is tension/edge (see blender_settings). Its angular spring pushes the middles of two
    faces with bending edge/10 per radian, which is a moment of bending edge^2/(20 sqrt(3)), and such hinges a
    plate of rigidity sqrt(3)/2 times that (Seung and Nelson 1988): bending = 40 D/edge^2. Triangles have no
    diagonals, so no shear springs. Mass is per vertex.
    """
    stretch = 0.5 * np.sqrt(3.0) * FABRIC.stretch_warp * edge
    stiffness = {
        "tension_stiffness": stretch,
        "compression_stiffness": FABRIC.compression * stretch,
        "shear_stiffness": 0.0,
        "bending_stiffness": 40.0 * FABRIC.bending_warp / edge**2,
    }
    damping = {f"{kind}_damping": DAMPING for kind in ("tension", "compression", "shear")}
    cloth = {
        "quality": STEPS, "mass": 1e3 * FABRIC.areal_density * area / nodes, "air_damping": AIR,
        "bending_model": "ANGULAR", "bending_damping": 0.5, **stiffness, **damping,
    }  # fmt: skip
    return {
        "cloth": cloth,
        "collision": {"use_collision": False, "use_self_collision": False},
        "collider": {},
    }


def in_blender(python: Path, edge: float, set_for: float) -> dict[str, object]:
    """Hang the cloth in Blender with springs set for one edge length [m] on a mesh of another."""
    cloth = specimen(FABRIC, edge)
    flat, faces = ring_mesh(set_for)
    corners = flat[faces]
    sides = corners[:, 1:] - corners[:, :1]
    area = 0.5 * float(np.abs(np.linalg.det(sides)).sum())
    told = settings(set_for, len(flat), area)
    film = blender_film(python, cloth.positions, cloth.face_nodes, cloth.pinned, None, told, SECONDS)
    last = film["positions"].astype(np.float64)
    moved = np.linalg.norm(last[-1] - last[-1 - LOOK], axis=1)
    return row(replace(cloth, positions=last[-1])) | {
        "moved_mm": 1e3 * float(np.sqrt(np.mean(moved**2))), "cpu": float(film["cpu"]),
        "blender": str(film["blender"]),
    }  # fmt: skip


def row(cloth: Cloth) -> dict[str, object]:
    """What a cloth that hangs shows."""
    ends = cloth.positions[cloth.face_nodes] - cloth.positions[np.roll(cloth.face_nodes, -1, axis=1)]
    rest = cloth.rest_corners - np.roll(cloth.rest_corners, -1, axis=1)
    strain = np.linalg.norm(ends, axis=2) / np.linalg.norm(rest, axis=2) - 1.0
    return {
        "nodes": len(cloth.positions), "coefficient": 100.0 * drape_coefficient(cloth),
        "strain_max_percent": 100.0 * float(strain.max()),
    }  # fmt: skip


def page(found: list[dict[str, object]]) -> str:
    """Return the page of the figures."""
    blender = next(one["blender"] for one in found if "blender" in one)
    version = found[0]["toile"]
    lines = [
        "# The drape test in Blender's cloth and in toile",
        "",
        f"`python bench/blender_drape.py --blender-python PATH`: toile {version}, Blender {blender}.",
        "",
        f"A round cloth of radius {1e3 * SPECIMEN:g} mm held level inside {1e3 * DISC:g} mm, poplin made",
        "equal in warp and weft; drape coefficient in percent of the free ring. Blender: 8 s in steps",
        "of 1/480 s, its default damping, no self-collision. `converted`: springs for this fabric on that",
        "mesh; `set once`: springs and mass per vertex as on triangles of 6 mm, on all.",
        "",
        "| engine | edges mm | nodes | drape coefficient % | largest strain % | still moves, mm in 0.5 s |",
        "|---|---|---|---|---|---|",
    ]
    for one in found:
        moved = f"{one['moved_mm']:.2g}" if "moved_mm" in one else ""
        lines.append(
            f"| {one['engine']} | {1e3 * float(str(one['edge'])):g} | {one['nodes']} "
            f"| {one['coefficient']:.1f} | {one['strain_max_percent']:.1f} | {moved} |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure all meshes and write what was found."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--blender-python", type=Path, required=True, metavar="PATH")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "results", metavar="DIR")
    options = parser.parse_args()
    found: list[dict[str, object]] = []
    for edge in EDGES:
        ways = {
            "toile": lambda edge=edge: row(hung(FABRIC, edge)[0]),
            "Blender, converted": lambda edge=edge: in_blender(options.blender_python, edge, edge),
            "Blender, set once": lambda edge=edge: in_blender(options.blender_python, edge, SET_FOR),
        }
        for engine, measure in ways.items():
            found.append({"engine": engine, "edge": edge, "toile": versions()["toile"], **measure()})
            print(json.dumps(found[-1]), flush=True)
    found.sort(key=lambda one: str(one["engine"]))
    (options.out / "blender_drape.json").write_text(json.dumps(found, indent=2) + "\n")
    (options.out / "blender_drape.md").write_text(page(found))


if __name__ == "__main__":
    main()
