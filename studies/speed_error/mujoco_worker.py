"""A sheet in MuJoCo, in a process of its own: `sphere` or `swing` on a grid.

python mujoco_worker.py JOB.json FILM.npz

JOB holds `scene` ("sphere" or "swing"), `cells` along a side of 1 m, `seconds`, `frame_seconds`, `step` [s],
`stretch` [N/m], `bending` [N m], `areal_density` [kg/m^2], `radius` of the ball and the `drop` onto it [m].
FILM gets positions (k, n, 3) [m], Y up, triangles (t, 3) and the CPU time of the steps [s]. Self-contact and
the ball are those of MuJoCo's penetration-free mode `ipc`, which has no friction.
"""

import json
import sys
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

POISSON = 0.3
COLLIDES = {"sphere": 'selfcollide="auto"', "swing": 'selfcollide="none" contype="0" conaffinity="0"'}


def model_text(job: dict[str, Any]) -> str:
    """Return the scene in MuJoCo's format, Z up."""
    cells, on_ball = job["cells"], job["scene"] == "sphere"
    # A plate of this thickness has both stiffnesses.
    thickness = (12.0 * (1.0 - POISSON**2) * job["bending"] / job["stretch"]) ** 0.5
    height = job["radius"] + job["drop"] if on_ball else 0.0
    # A grid lies about its place; swinging cloth is pinned along x = 0 and ends at y = 1.
    middle = 0.0 if on_ball else 0.5
    ball = f'<geom type="sphere" size="{job["radius"]}"/>' if on_ball else ""
    pin = "" if on_ball else f'<pin gridrange="0 0 0 {cells}"/>'
    flags = '<flag ipc="enable"/>' if on_ball else '<flag contact="disable"/>'
    return f"""<mujoco>
<option timestep="{job["step"]}" solver="Newton" integrator="discrete" gravity="0 0 -9.81">{flags}</option>
<worldbody>{ball}
<flexcomp name="sheet" type="grid" dim="2" count="{cells + 1} {cells + 1} 1"
 spacing="{1.0 / cells} {1.0 / cells} 1" pos="{middle} {middle} {height}"
 mass="{job["areal_density"]}" radius="0.0005">
<elasticity young="{job["stretch"] / thickness}" poisson="{POISSON}" thickness="{thickness}"
 elastic2d="both"/>
<contact {COLLIDES[job["scene"]]}/>{pin}
</flexcomp></worldbody></mujoco>"""


def main() -> None:
    """Run the job of the first argument and write the second."""
    import mujoco

    job = json.loads(Path(sys.argv[1]).read_text())
    model = mujoco.MjModel.from_xml_string(model_text(job))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    frames, cpu = [data.flexvert_xpos.copy()], 0.0
    for frame in range(1, round(job["seconds"] / job["frame_seconds"]) + 1):
        started = process_time()
        while data.time < frame * job["frame_seconds"] - 0.5 * job["step"]:
            mujoco.mj_step(model, data)
        cpu += process_time() - started
        frames.append(data.flexvert_xpos.copy())
    positions = np.array(frames)
    faces = model.flex_elem.reshape(-1, 3)
    np.savez(sys.argv[2], positions=positions[..., [0, 2, 1]] * (1.0, 1.0, -1.0), faces=faces, cpu=cpu)


if __name__ == "__main__":
    main()
