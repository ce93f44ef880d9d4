"""Growth of resident memory over a long film: a shirt on a mannequin that walks on the spot, in a loop."""

import gc
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from toile.dressing.body.stored_mannequin import stored_mannequin
from toile.dressing.run.dress import dress
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError
from toile.studies.scenes.walking_mannequin import in_a_loop

GROWTH_LIMIT = 20.0
"""Most that a frame may add, fitted over the film after its first third [kB]: 20 MB in 1,000 frames."""
EVERY = 50
"""Frames between two lines about the memory."""
STATUS = Path("/proc/self/status")
"""Where Linux says how much memory a process holds."""


def resident() -> float:
    """Return the resident memory of this process [kB]. Raises InputError where the system does not tell."""
    if not STATUS.exists():
        raise InputError("memory is measured on Linux only")
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith("VmRSS"))
    return float(line.split()[1])


def film_memory(
    frames: int, say: Callable[[str], None], edge_length: float | None = None,
    measure: Callable[[], float] = resident,
) -> float:  # fmt: skip
    """Make a film of so many frames; return how much memory grows per frame [kB].

    `edge_length` [m] gives a mesh of one size instead of an adaptive one; `measure` tells the memory [kB].
    """
    held: list[float] = []

    def record(index: int, _: object) -> None:
        gc.collect()
        held.append(measure())
        if index % EVERY == 0:
            say(f"memory: frame {index} of {frames}, {1e-3 * held[-1]:.0f} MB")

    with TemporaryDirectory(prefix="toile-bench-") as folder:
        body = stored_mannequin()
        motion = in_a_loop(body, frames + 1)
        path = Path(folder) / "loop.npz"
        np.savez(path, vertices=motion.frames, faces=body.faces, fps=motion.fps)
        del motion
        scene = Scene(
            garments=[Garment("tshirt")], avatar=AvatarFile(path=path), quality="preview",
            edge_length=edge_length, remesh=edge_length is None,
        )  # fmt: skip
        result = dress(scene, record=record)
    if len(held) != frames + 1:
        raise RuntimeError(f"the film ended after frame {len(held) - 1}: {result.failure}")
    return growth(np.array(held))


def growth(held: Float) -> float:
    """Return the slope of memory by frame, shape (k,), after the first third: caches fill in there."""
    later = held[len(held) // 3 :]
    return float(np.polyfit(np.arange(len(later)), later, 1)[0])
