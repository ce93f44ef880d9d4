"""Load kernels; on a first run, compile them in two processes at once."""

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from toile.geometry.sources import modules_behind, read_sources

DEFINES_KERNELS = re.compile(rb"^@(?:packed_)?kernel\(", re.MULTILINE)
ROOMS = {
    "panel": ("toile.remesh.panel.",),
    "remesh": ("toile.remesh.", "toile.collide.patch_clearance"),
    "picture": ("toile.dressing.pictures.",),
}
"""How names of modules begin that not every drape needs; the first that fits counts."""


def _kernel_modules() -> dict[str, tuple[str, ...]]:
    """Return the modules that define kernels, by what needs them; those that others import before those."""
    sources = read_sources()
    behind = {
        name: modules_behind(sources, name) for name, text in sources.items() if DEFINES_KERNELS.search(text)
    }
    runs = [name for name in sources if name.startswith(("toile.dressing.run.", "toile.dressing.batch."))]
    needed = modules_behind(sources, *runs)
    found: dict[str, list[str]] = {room: [] for room in ("drape", "integrator", *ROOMS)}
    # What a module imports has fewer modules behind it than the module itself.
    for name in sorted(behind, key=lambda name: (len(behind[name] & behind.keys()), name)):
        rooms = (room for room, starts in ROOMS.items() if name.startswith(starts))
        found[next(rooms, "drape") if name in needed else "integrator"].append(name)
    return {room: tuple(names) for room, names in found.items()}


_MODULES = _kernel_modules()
DRAPE_KERNELS = _MODULES["drape"]
PANEL_KERNELS = _MODULES["panel"]
REMESH_KERNELS = _MODULES["remesh"]
PICTURE_KERNELS = _MODULES["picture"]
INTEGRATOR_KERNELS = _MODULES["integrator"]
"""Modules whose kernels every drape needs; patterns; meshes that adapt; pictures; nothing but the studies."""

IMPORT_ALL = "import importlib, sys; [importlib.import_module(name) for name in sys.argv[1:]]"


def load_kernels(modules: Sequence[str]) -> None:
    """Import modules that hold kernels: what no earlier run has compiled is compiled, and stored on disk.

    Where nothing is stored yet, a second process works through the list from its end; what it has stored
    when this one gets there is loaded. Without it, or if it fails, this process compiles everything.
    """
    from toile.geometry.kernel import WARM

    helper = None if WARM else start_helper(modules[::-1])
    try:
        for name in modules:
            import_module(name)
    finally:
        if helper is not None:
            helper.kill()
            helper.wait()


def start_helper(modules: Sequence[str]) -> subprocess.Popen[bytes] | None:
    """Start a process that compiles the kernels of these modules; None where that is of no use."""
    # A program that embeds Python may name itself as the executable.
    if (os.cpu_count() or 1) < 2 or "python" not in Path(sys.executable or "").name.lower():
        return None
    environment = module_path_environment()
    command = [sys.executable, "-P", "-c", IMPORT_ALL, *modules]
    try:
        return subprocess.Popen(
            command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip
    except (OSError, ValueError):
        return None


def module_path_environment() -> dict[str, str]:
    """Return the environment of a Python process that finds the same modules as this one."""
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
