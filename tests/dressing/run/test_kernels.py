"""Kernels are compiled in two processes on a first run, and only loaded on later ones."""

import ast
import os
import pkgutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

import toile
from toile.dressing.run import kernels
from toile.geometry import kernel
from toile.geometry.sources import modules_behind, read_sources

ALL_KERNELS = (
    kernels.DRAPE_KERNELS
    + kernels.PANEL_KERNELS
    + kernels.REMESH_KERNELS
    + kernels.INTEGRATOR_KERNELS
    + kernels.PICTURE_KERNELS
)
KERNELS = ("kernel", "packed_kernel")
"""Decorators."""
SMALL = ("toile.engine.solve.assembly", "toile.engine.solve.cg")


def holds_kernels(module: str) -> bool:
    """Whether a function of the module is decorated with one of `KERNELS`."""
    spec = find_spec(module)
    assert spec is not None and spec.origin is not None
    return any(
        isinstance(entry, ast.Call) and isinstance(entry.func, ast.Name) and entry.func.id in KERNELS
        for node in ast.parse(Path(spec.origin).read_text()).body
        if isinstance(node, ast.FunctionDef)
        for entry in node.decorator_list
    )


def test_every_module_with_kernels_is_listed_once() -> None:
    modules = [module.name for module in pkgutil.walk_packages(toile.__path__, "toile.")]
    assert sorted(ALL_KERNELS) == sorted(filter(holds_kernels, modules))


def test_modules_come_after_those_they_import() -> None:
    """The process at the front of a list must not compile what the one at its end begins with."""
    sources = read_sources()
    groups = (kernels.PANEL_KERNELS, kernels.REMESH_KERNELS, kernels.PICTURE_KERNELS)
    for group in (kernels.DRAPE_KERNELS, *groups, kernels.INTEGRATOR_KERNELS):
        for place, module in enumerate(group):
            behind = modules_behind(sources, module) & set(group)
            assert behind <= set(group[: place + 1]), f"{module} imports a later one"


def test_modules_are_listed_by_what_needs_them() -> None:
    assert "toile.engine.forces.membrane" in kernels.DRAPE_KERNELS
    assert "toile.remesh.panel.split_ears" in kernels.PANEL_KERNELS
    assert {"toile.collide.patch_clearance", "toile.remesh.adapt.merge_patches"} <= set(
        kernels.REMESH_KERNELS
    )
    assert "toile.dressing.pictures.shading" in kernels.PICTURE_KERNELS
    assert set(kernels.INTEGRATOR_KERNELS) <= {
        "toile.engine.forces.spring",
        "toile.engine.forces.membrane_damping",
    }
    listed = set(ALL_KERNELS) - set(kernels.INTEGRATOR_KERNELS)
    for module in ("toile.dressing.wear.put_on", "toile.dressing.run.follow"):
        assert set(filter(holds_kernels, modules_behind(read_sources(), module))) <= listed


def stored(folder: Path) -> set[str]:
    """Kernels, as module.function, whose machine code is in a folder."""
    return {".".join(path.name.split("-")[0].split(".")[:2]) for path in folder.rglob("*.nbc")}


SCRIPT = """
import subprocess, sys
started = []
class Popen(subprocess.Popen):
    def __init__(self, command, **options):
        started.append(command)
        super().__init__(command, **options)
subprocess.Popen = Popen
from toile.dressing.run.kernels import load_kernels
load_kernels(sys.argv[1:])
print(len(started))
"""


def processes_started(folder: Path) -> int:
    """How many helpers a new process starts to load the small kernels, with a cache folder."""
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment["TOILE_CACHE_DIR"] = str(folder)
    command = [sys.executable, "-c", SCRIPT, *SMALL]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return int(done.stdout)


def test_first_run_starts_one_helper_and_the_next_none(tmp_path: Path) -> None:
    assert processes_started(tmp_path) == (1 if (os.cpu_count() or 1) > 1 else 0)
    assert {"assembly.scatter_hessians", "cg._turn"} <= stored(tmp_path)
    assert processes_started(tmp_path) == 0


def test_helper_stores_what_it_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("TOILE_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    helper = kernels.start_helper(["toile.engine.solve.assembly"])
    assert helper is not None and helper.wait() == 0
    assert stored(tmp_path) == {"assembly.scatter_gradients", "assembly.scatter_hessians"}


def test_kernels_load_where_no_helper_can_start(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*arguments: object, **options: object) -> None:
        raise OSError("no more processes")

    monkeypatch.setattr(kernel, "WARM", False)
    monkeypatch.setattr(subprocess, "Popen", refuse)
    kernels.load_kernels(SMALL)
    for executable in ("", "/opt/editor/editor"):
        monkeypatch.setattr(sys, "executable", executable)
        assert kernels.start_helper(SMALL) is None
