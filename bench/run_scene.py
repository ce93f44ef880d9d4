"""CPU time, crossings and stretch of a reference scene at one edge length.

Run: python bench/run_scene.py sphere --edge 0.02 [--seconds 2]
"""

import argparse
import time

import numpy as np

from toile.engine.film.plan import FilmFrame
from toile.engine.film.simulate import Simulation
from toile.studies.scenes.scenes import SCENES


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("--edge", type=float, default=0.02, help="edge length [m]")
    parser.add_argument("--seconds", type=float, help="length of the film [s]")
    parser.add_argument("--frames", action="store_true", help="print every frame")
    options = parser.parse_args()
    scene = SCENES[options.scene](options.edge)
    seconds = options.seconds or scene.seconds

    def on_frame(frame: FilmFrame) -> bool:
        if options.frames:
            print(
                f"{frame.seconds:6.3f} s  {frame.steps:3d} steps  {frame.contacts:5d} contacts  "
                f"gap {1e3 * frame.min_gap:6.3f} mm  stretch {100 * frame.stretch_max:5.2f} %  "
                f"speed {np.linalg.norm(frame.cloth.velocities, axis=1).max():5.2f} m/s  "
                f"{time.process_time() - started:6.2f} CPU s",
                flush=True,
            )
        return True

    started = time.process_time()
    film = Simulation(scene.cloth, scene.avatar, scene.plan, on_frame)
    record = film.run(seconds)
    cpu = time.process_time() - started
    shares = "  ".join(f"{stage} {100 * spent.cpu / cpu:.0f} %" for stage, spent in film.clock.spent.items())
    collisions = film.stepper.collisions
    searches = 0 if collisions is None else collisions.search.rebuilds
    print(
        f"{options.scene} at {1e3 * options.edge:g} mm: {record.faces[-1]} faces, {record.steps} steps "
        f"({record.retries} retries, {record.forced} forced), {record.newton_iterations} Newton, "
        f"{record.cg_iterations} CG, {searches} searches\n"
        f"CPU s per simulated second {cpu / record.simulated_seconds:.2f}   {shares}\n"
        f"crossings: worst frame {max(map(sum, record.crossings))}, sum {sum(map(sum, record.crossings))}   "
        f"stretch max {100 * max(record.stretch_max):.2f} %, end {100 * record.stretch_max[-1]:.2f} %   "
        f"min gap {1e3 * min(record.min_gap):.4f} mm"
    )


if __name__ == "__main__":
    main()
