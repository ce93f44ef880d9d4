"""Throughput with contact: a sheet falls on a sphere, in meshes of 2,000 to 50,000 nodes.

    python bench/throughput.py [--seconds S] [--json FILE]

Prints per mesh the node-frames per CPU second (frames of 1/60 s, every frame audited), the share of contact,
and the CPU time per step, and how that grows with the number of nodes.
"""

import argparse
import json
import math
import platform
import sys
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

from toile.dressing.run.report import versions
from toile.engine.film.simulate import Simulation
from toile.studies.scenes.scenes import sphere

NODES = (2_000, 5_000, 10_000, 20_000, 50_000)
FRAME = 1.0 / 60.0
THROUGHPUT, CONTACT_SHARE, GROWTH = 20_000.0, 0.5, 1.25
"""Bars: node-frames per CPU second at 10,000 nodes, contact's share of the time there, exponent of growth."""


def measured(nodes: int, seconds: float) -> dict[str, float]:
    """Run the film on a mesh of about that many nodes."""
    scene = sphere(math.sqrt(2.0 / (math.sqrt(3.0) * nodes)))
    film = Simulation(
        scene.cloth, scene.avatar, replace(scene.plan, frame_seconds=FRAME), lambda frame: True
    )  # fmt: skip
    started = process_time()
    record = film.run(seconds)
    spent = process_time() - started
    count, frames = len(scene.cloth.positions), len(record.crossings) - 1
    return {
        "nodes": count, "frames": frames, "steps": record.steps, "cpu": spent,
        "node_frames_per_cpu_second": count * frames / spent,
        "cpu_ms_per_step": 1e3 * spent / record.steps,
        "cg_iterations_per_step": record.cg_iterations / record.steps,
        "crossings": sum(map(sum, record.crossings)),
        **{
            f"{stage}_share": film.clock.cpu(stage) / spent
            for stage in ("contact", "solve", "assembly", "audit")
        },
    }  # fmt: skip


def main() -> int:
    """Measure all meshes; the exit code tells whether the bars were met."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=0.5, help="length of the film [s]")
    parser.add_argument("--json", type=Path, metavar="FILE", help="store the figures")
    options = parser.parse_args()
    measured(500, 0.2)  # Kernels are loaded by now.
    rows = []
    print(
        f"{'nodes':>7}{'node-frames/s':>15}{'ms/step':>9}{'contact':>9}{'solve':>7}{'audit':>7}{'CG':>6}{'crossings':>11}"
    )
    for nodes in NODES:
        row = measured(nodes, options.seconds)
        rows.append(row)
        print(
            f"{row['nodes']:7}{row['node_frames_per_cpu_second']:15.0f}{row['cpu_ms_per_step']:9.1f}"
            f"{row['contact_share']:9.0%}{row['solve_share']:7.0%}{row['audit_share']:7.0%}"
            f"{row['cg_iterations_per_step']:6.0f}{row['crossings']:11}",
            flush=True,
        )
    count, cost = (np.log([row[key] for row in rows]) for key in ("nodes", "cpu_ms_per_step"))
    growth = float(np.polyfit(count, cost, 1)[0])
    print(f"CPU time per step grows like nodes^{growth:.2f} (bar {GROWTH})")
    if options.json is not None:
        stored = {"growth": growth, "rows": rows, "processor": platform.processor(), "versions": versions()}
        options.json.write_text(json.dumps(stored, indent=2) + "\n")
    near = min(rows, key=lambda row: abs(row["nodes"] - 10_000))
    met = (
        near["node_frames_per_cpu_second"] >= THROUGHPUT
        and near["contact_share"] <= CONTACT_SHARE
        and growth <= GROWTH
        and not any(row["crossings"] for row in rows)
    )
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
