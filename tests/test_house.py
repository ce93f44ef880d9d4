"""The house: layers, kernels, names, sizes, start-up time, and the tools that check the rest."""

import ast
import importlib.util
import os
import pkgutil
import re
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest
from numba.core.dispatcher import Dispatcher

import toile

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("geometry", "collide", "remesh", "engine", "dressing", "studies", "blender_addon")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
MODULES = sorted(
    module.name
    for module in pkgutil.walk_packages(toile.__path__, "toile.")
    if not module.name.startswith("toile.blender_addon.")
)
"""Those of the add-on import bpy: its own tests run them, in Blender."""
KERNEL_MODULE = ROOT / "geometry" / "kernel.py"
MAX_LINES = 400
MAX_MODULES, MAX_SHARE = 20, 0.2
"""Modules in one folder, and its share of all lines of source."""
MAX_START_SECONDS = 1.0
COMMAND = 'pip install --quiet -e ".[dev]" && python -m pytest -n auto --dist loadfile'
"""The one command that runs everything, in README.md and .ci/run."""

TOOLS = {
    "ruff check": ("ruff", ["-m", "ruff", "check", "."]),
    "ruff format": ("ruff", ["-m", "ruff", "format", "--check", "."]),
    "mypy": ("mypy", ["-m", "mypy"]),
    "layers": ("importlinter", ["-c", "from importlinter.cli import lint_imports_command as m; m()"]),
}


@pytest.mark.parametrize("name", TOOLS)
def test_tool_finds_nothing(name: str) -> None:
    module, arguments = TOOLS[name]
    if importlib.util.find_spec(module) is None:
        pytest.skip(f"{module} is not installed (pip install -e '.[dev]')")
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_source_file_is_small_and_named_for_what_it_holds(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= MAX_LINES
    assert path.stem not in {"utils", "util", "helpers", "common", "misc"}


def test_no_room_is_crowded() -> None:
    rooms: dict[Path, list[Path]] = {}
    for path in SOURCES:
        if path.name != "__init__.py":
            rooms.setdefault(path.parent, []).append(path)
    lines = {room: sum(len(path.read_text().splitlines()) for path in paths) for room, paths in rooms.items()}
    for room, paths in rooms.items():
        assert len(paths) <= MAX_MODULES, f"{room} holds {len(paths)} modules"
        assert lines[room] <= MAX_SHARE * sum(lines.values()), f"{room} holds {lines[room]} lines"


def test_links_show_every_package_under_one_name() -> None:
    for package in PACKAGES:
        link = ROOT / "toile" / package
        assert os.readlink(link) == f"../{package}"
        assert (link / "__init__.py").is_file()


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_source_file_says_what_it_is_for(path: Path) -> None:
    assert (ast.get_docstring(ast.parse(path.read_text())) or "").strip()


@pytest.mark.parametrize("name", MODULES)
def test_module_imports_and_says_what_it_is_for(name: str) -> None:
    assert (import_module(name).__doc__ or "").strip()


def dispatchers(name: str) -> Iterator[tuple[str, Dispatcher]]:
    """The compiled functions that a module defines."""
    for attribute, value in vars(import_module(name)).items():
        if isinstance(value, Dispatcher) and value.py_func.__module__ == name:
            yield attribute, value


def test_kernels_have_one_explicit_signature_and_no_fast_math() -> None:
    kernels = 0
    for module in MODULES:
        for name, compiled in dispatchers(module):
            place = f"{module}.{name}"
            kernels += 1
            assert not compiled.targetoptions.get("fastmath"), f"{place} uses fast math"
            # numba closes a dispatcher to further types once a signature was given.
            closed = getattr(compiled, "_can_compile") is False  # noqa: B009 (not in numba's stubs)
            assert closed, f"{place} has no explicit signature: decorate it with @kernel"
            assert len(compiled.signatures) == 1, f"{place} is compiled {len(compiled.signatures)} times"
    assert kernels > 20


def source_of(module: str) -> ast.Module:
    """The syntax tree of a module."""
    spec = importlib.util.find_spec(module)
    assert spec is not None and spec.origin is not None
    return ast.parse(Path(spec.origin).read_text())


def is_decorated(node: ast.FunctionDef, decorator: str) -> bool:
    """Whether a function carries a decorator of that name, called or not."""
    names = [entry.func if isinstance(entry, ast.Call) else entry for entry in node.decorator_list]
    return any(isinstance(name, ast.Name) and name.id == decorator for name in names)


def functions_decorated(module: str, decorator: str) -> set[str]:
    """Names of the functions of a module that carry a decorator."""
    return {
        node.name
        for node in source_of(module).body
        if isinstance(node, ast.FunctionDef) and is_decorated(node, decorator)
    }


def test_helpers_are_called_by_kernels_only() -> None:
    """A helper called from Python would be compiled at run time, once per combination of types."""
    helpers = {module: functions_decorated(module, "helper") for module in MODULES}
    for module in MODULES:
        tree = source_of(module)
        known = set(helpers[module])
        for node in tree.body:
            if isinstance(node, ast.ImportFrom) and node.module in helpers:
                known |= {entry.asname or entry.name for entry in node.names} & helpers[node.module]
        compiled = [
            node
            for node in tree.body
            if isinstance(node, ast.FunctionDef)
            and any(is_decorated(node, name) for name in ("helper", "kernel", "packed_kernel"))
        ]
        inside = {id(name) for node in compiled for name in ast.walk(node)}
        calls = {
            f"{module}:{node.lineno} calls {node.func.id}"
            for node in ast.walk(tree)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in known
            if id(node) not in inside
        }
        assert not calls


def test_compile_options_live_in_one_file() -> None:
    forbidden = re.compile(r"\b(n?jit|vectorize|guvectorize|stencil|jitclass|fastmath)\b")
    for path in SOURCES:
        if path == KERNEL_MODULE:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("numba"):
                for entry in node.names:
                    assert not forbidden.search(entry.name), f"{path}: use toile.geometry.kernel"
            if isinstance(node, ast.keyword):
                assert node.arg != "fastmath", f"{path}: no fast math"
    assert "fastmath" not in KERNEL_MODULE.read_text()


def test_imports_are_declared_and_dependencies_imported() -> None:
    """Everything imported at run time is a declared dependency, and those without an extra are imported."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    optional = project["optional-dependencies"]
    extras = [entry for name in optional if name != "dev" for entry in optional[name]]
    declared = {re.split(r"[^A-Za-z0-9-]", entry)[0] for entry in (*project["dependencies"], *extras)}
    known = {"python-fcl": "fcl", "usd-core": "pxr"}
    modules = {known.get(name, name) for name in declared}
    imported = set()
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text())):
            names = []
            if isinstance(node, ast.Import):
                names = [entry.name for entry in node.names]
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{path}: relative import"
                names = [node.module or ""]
            for name in names:
                top = name.partition(".")[0]
                imported.add(top)
                allowed = (
                    top in {"toile", "bpy", "bpy_extras", "bmesh", *modules} or top in sys.stdlib_module_names
                )
                assert allowed, f"{path} imports {top}"
    for entry in project["dependencies"]:
        name = re.split(r"[^A-Za-z0-9-]", entry)[0]
        assert known.get(name, name) in imported, f"nothing imports {name}"


@pytest.mark.parametrize(
    "code", ["import toile", "from toile.dressing.cli.main import main; main(['--help'])"]
)
def test_start_is_quick_and_compiles_nothing(code: str) -> None:
    after = "; import sys; assert not {'numba', 'scipy', 'trimesh'} & set(sys.modules), 'imported too early'"
    best = float("inf")
    for _ in range(5):
        started = time.perf_counter()
        subprocess.run([sys.executable, "-c", code + after], cwd=ROOT, check=True, capture_output=True)
        best = min(best, time.perf_counter() - started)
        if best < MAX_START_SECONDS:
            break
    assert best < MAX_START_SECONDS


def test_checkout_without_links_works(tmp_path: Path) -> None:
    """Where links are not supported, git writes files that hold the target's name."""
    (tmp_path / "toile").mkdir()
    shutil.copy(ROOT / "toile" / "__init__.py", tmp_path / "toile")
    for package in PACKAGES:
        (tmp_path / "toile" / package).write_text(f"../{package}")
        shutil.copytree(ROOT / package, tmp_path / package)
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    code = "import toile; print(toile.fabric('denim-12oz').name, toile.InputError.__module__, toile.__file__)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert done.stdout.split() == [
        "denim-12oz", "toile.geometry.errors", str(tmp_path / "toile" / "__init__.py")
    ], done.stderr  # fmt: skip


def test_readme_and_ci_run_the_same_command() -> None:
    assert COMMAND in (ROOT / "README.md").read_text().splitlines()
    run = ROOT / ".ci" / "run"
    assert COMMAND in run.read_text().splitlines()
    assert os.access(run, os.X_OK)


def test_what_blender_imports_compiles_nothing() -> None:
    """Blender's process needs neither numba nor scipy: enabling the extension takes a moment."""
    folder = ROOT / "blender_addon"
    wanted = {
        node.module or ""
        for path in [*folder.glob("*.py"), *(folder / "snapshot").glob("*.py")]
        for node in ast.parse(path.read_text()).body
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("toile.")
    }
    modules = sorted(name for name in wanted if not name.startswith("toile.blender_addon"))
    code = (
        f"import sys, {', '.join(modules)}; print(sorted(set(sys.modules) & {{'numba', 'scipy', 'trimesh'}}))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
