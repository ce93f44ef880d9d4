"""Machine code on disk: compiled anew whenever, and only when, something it was made of has changed."""

import ast
import importlib
import json
import os
import pkgutil
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from numba.core.dispatcher import Dispatcher

import toile
from toile.geometry import kernel_cache
from toile.geometry.kernel_cache import KEPT, LOCK, remove_old_folders
from toile.geometry.sources import CONSTANT, kernel_modules, modules_behind, read_sources

ROOT = Path(__file__).resolve().parents[2]
fcntl: Any = pytest.importorskip("fcntl") if sys.platform != "win32" else None

MODULES = {
    "geometry/knobs.py": "LIMIT = 2.0\n",
    "geometry/halves.py": (
        "from toile.geometry.kernel import helper\n@helper\ndef half(x):\n    return 0.5 * x\n"
    ),
    "geometry/doubled.py": (
        "from toile.geometry.kernel import F64_1, OUT_F64_1, kernel\n"
        "from numba import types\n"
        "from toile.geometry.halves import half\n"
        "from toile.geometry.knobs import LIMIT\n"
        "@kernel(types.void(F64_1, OUT_F64_1))\n"
        "def fill(x, out):\n"
        "    for k in range(len(x)):\n"
        "        out[k] = half(min(x[k], LIMIT))\n"
    ),
    "dressing/__init__.py": "",
    "dressing/words.py": "from toile.geometry.doubled import fill\n",
}
"""A kernel that takes a helper from one module and a constant from another, and a module that uses it."""
ASK = """
import json, numba, sys
import numpy as np
import toile.dressing.words
from toile.geometry.doubled import fill
out = np.zeros(2)
fill(np.array([1.0, 8.0]), out)
print(json.dumps([out.tolist(), sum(fill.stats.cache_hits.values())]))
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A small toile of its own, whose sources may be changed."""
    root = tmp_path / "tree"
    (root / "toile").mkdir(parents=True)
    shutil.copy(ROOT / "toile" / "__init__.py", root / "toile")
    shutil.copytree(ROOT / "geometry", root / "geometry")
    for name, text in MODULES.items():
        (root / name).parent.mkdir(exist_ok=True)
        (root / name).write_text(text)
    return root


def start(root: Path, cache: dict[str, str], code: str) -> "subprocess.Popen[str]":
    """Start a process that runs code with the toile in a folder."""
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment |= {"PYTHONPATH": str(root), "PYTHONDONTWRITEBYTECODE": "1"} | cache
    return subprocess.Popen(
        [sys.executable, "-c", code], cwd=root, env=environment, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


def answer(process: "subprocess.Popen[str]") -> Any:
    """Return what a process prints, as JSON."""
    out, error = process.communicate(timeout=120.0)
    assert process.returncode == 0, error
    return json.loads(out)


def ask(root: Path, cache: dict[str, str]) -> tuple[list[float], bool]:
    """Return what the kernel computes in a new process, and whether it was loaded from disk."""
    values, hits = answer(start(root, cache, ASK))
    return values, bool(hits)


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.parametrize("variable", ["TOILE_CACHE_DIR", "NUMBA_CACHE_DIR"])
def test_code_follows_helpers_and_constants_and_nothing_else(
    variable: str, tree: Path, tmp_path: Path
) -> None:
    cache = {variable: str(tmp_path / "cache")}
    assert ask(tree, cache) == ([0.5, 1.0], False)
    assert ask(tree, cache) == ([0.5, 1.0], True)
    edit(tree / "dressing/words.py", "from", "# A remark.\nfrom")
    (tree / "geometry/topology.py").write_text('"""Holds no kernel."""\n')
    assert ask(tree, cache) == ([0.5, 1.0], True), "neither is part of a kernel"
    edit(tree / "geometry/halves.py", "0.5", "0.25")
    assert ask(tree, cache) == ([0.25, 0.5], False), "a helper has changed"
    edit(tree / "geometry/knobs.py", "2.0", "4.0")
    assert ask(tree, cache) == ([0.25, 1.0], False), "a constant has changed"
    edit(tree / "geometry/knobs.py", "4.0", "2.0")
    edit(tree / "geometry/halves.py", "0.25", "0.5")
    assert ask(tree, cache) == ([0.5, 1.0], True), "the first state is still there"


def test_another_locator_of_numba_does_not_bring_stale_code_back(tree: Path, tmp_path: Path) -> None:
    cache = {"NUMBA_CACHE_LOCATOR_CLASSES": "InTreeCacheLocator", "TOILE_CACHE_DIR": str(tmp_path)}
    assert ask(tree, cache)[0] == [0.5, 1.0]
    edit(tree / "geometry/halves.py", "0.5", "0.25")
    assert ask(tree, cache)[0] == [0.25, 0.5]


def test_two_processes_that_compile_at_once_agree_and_leave_a_good_cache(tree: Path, tmp_path: Path) -> None:
    cache = {"TOILE_CACHE_DIR": str(tmp_path / "cache")}
    together = [answer(process) for process in [start(tree, cache, ASK) for _ in range(2)]]
    assert [values for values, _ in together] == [[0.5, 1.0]] * 2
    assert ask(tree, cache) == ([0.5, 1.0], True)
    assert not list((tmp_path / "cache").rglob("*.tmp.*"))


@pytest.mark.parametrize("kind", ["nbi", "nbc"])
def test_files_that_were_cut_short_are_written_again(kind: str, tree: Path, tmp_path: Path) -> None:
    cache = {"TOILE_CACHE_DIR": str(tmp_path / "cache")}
    ask(tree, cache)
    (file,) = (tmp_path / "cache").rglob(f"*.{kind}")
    for content in (b"", file.read_bytes()[:100]):
        file.write_bytes(content)
        assert ask(tree, cache) == ([0.5, 1.0], False)
        assert ask(tree, cache) == ([0.5, 1.0], True)


def test_a_folder_that_cannot_be_written_is_no_obstacle(tree: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    assert ask(tree, {"TOILE_CACHE_DIR": str(tmp_path / "file")}) == ([0.5, 1.0], False)


OTHER_USER = """
import json, numba, sys
def settings():
    return {name: repr(getattr(numba.config, name)) for name in dir(numba.config) if name.isupper()}
before = settings()
import toile.geometry.doubled
assert settings() == before, "numba.config has changed"
import other
assert other.twice(3) == 6
print(json.dumps([other.twice.stats.cache_path, toile.geometry.doubled.fill.stats.cache_path]))
"""


def test_numba_is_left_as_it_was_for_other_users(tree: Path, tmp_path: Path) -> None:
    (tree / "other.py").write_text(
        "from numba import njit\n@njit(cache=True)\ndef twice(n):\n    return 2 * n\n"
    )
    theirs, ours = answer(start(tree, {"TOILE_CACHE_DIR": str(tmp_path / "cache")}, OTHER_USER))
    assert theirs == str(tree / "__pycache__") and list((tree / "__pycache__").glob("other.twice-*.nbi"))
    assert Path(ours).is_relative_to(tmp_path / "cache")


def test_every_kernel_of_the_house_is_covered() -> None:
    sources = read_sources()
    covered = kernel_modules(sources)
    for name in sources:
        found = importlib.import_module(name)
        for value in vars(found).values():
            if isinstance(value, Dispatcher):
                assert value.py_func.__module__ in covered
    assert {"toile.geometry.kernel", "toile.geometry.fours", "toile.collide.pair_distance"} <= covered
    assert "toile.dressing.cli.main" not in covered
    everything = {module.name for module in pkgutil.walk_packages(toile.__path__, "toile.")}
    assert {name for name in everything if not name.startswith("toile.blender_addon")} - set(sources) <= {
        "toile.__main__"
    }


def names_in(node: ast.AST) -> set[str]:
    return {inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)}


def is_compiled(node: ast.AST) -> bool:
    """Whether a statement defines a kernel or a helper."""
    decorators = {"kernel", "packed_kernel", "helper"}
    return isinstance(node, ast.FunctionDef) and any(names_in(d) & decorators for d in node.decorator_list)


@pytest.mark.parametrize("module", sorted(kernel_modules(read_sources())))
def test_compiled_functions_take_names_from_covered_modules_only(module: str) -> None:
    """A name that is not in capitals, of a module without kernels, would not be part of the hash."""
    sources = read_sources()
    covered = kernel_modules(sources)
    tree = ast.parse(sources[module])
    wanted = {name for node in tree.body if is_compiled(node) for name in names_in(node)}
    for node in reversed(tree.body):
        # Constants of the module that are made of others.
        if isinstance(node, ast.Assign | ast.AnnAssign) and names_in(node) & wanted:
            wanted |= names_in(node)
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("toile"):
            for entry in node.names:
                inner = f"{node.module}.{entry.name}"
                if (entry.asname or entry.name) in wanted and not is_type(entry.name):
                    assert (inner if inner in sources else node.module) in covered, f"{module}: {entry.name}"


def is_type(name: str) -> bool:
    """Whether a name is a class's or a type's, which stands in annotations."""
    return name[0].isupper() and not CONSTANT.fullmatch(name)


def test_imports_are_followed() -> None:
    sources = {
        "toile.a": b"from toile.b import (\n    ONE,  # why\n    two as TWO,\n)\n    from toile.c import d\n",
        "toile.b": b"from toile.room import inner\n",
        "toile.c": b"",
        "toile.room": b"",
        "toile.room.inner": b"",
        "toile.e": b"from toile.b import two\n",
    }
    assert modules_behind(sources, "toile.a") == {"toile.a", "toile.b", "toile.c", "toile.room.inner"}
    kernels = sources | {"toile.a": b"from toile.geometry.kernel import kernel\n" + sources["toile.a"]}
    assert kernel_modules(kernels) == {"toile.a", "toile.b", "toile.room.inner"}


@pytest.fixture
def caches(tmp_path: Path) -> Path:
    """A folder with folders of twelve states of the sources, the first ones the oldest, and other things."""
    for age in range(12):
        folder = tmp_path / f"{age:016x}"
        (folder / "toile.room").mkdir(parents=True)
        (folder / "toile.room" / "code.nbc").write_bytes(b"code")
        (folder / LOCK).touch()
        os.utime(folder, (1e9 + age, 1e9 + age))
    (tmp_path / "collide_0123456789abcdef").mkdir()
    (tmp_path / "mannequin-0123456789abcdef.npz").write_bytes(b"")
    return tmp_path


def states(folder: Path) -> list[int]:
    return sorted(int(path.name, 16) for path in folder.iterdir() if len(path.name) == 16)


def test_the_newest_folders_stay(caches: Path) -> None:
    own = caches / f"{0:016x}"
    remove_old_folders(own)
    assert states(caches) == [0, *range(12 - KEPT + 1, 12)]
    assert (caches / "collide_0123456789abcdef").is_dir()
    assert (caches / "mannequin-0123456789abcdef.npz").is_file()
    assert len(list(caches.iterdir())) == KEPT + 2


@pytest.mark.skipif(fcntl is None, reason="Windows has no such locks")
def test_a_folder_in_use_stays(caches: Path) -> None:
    with open(caches / f"{1:016x}" / LOCK) as held:
        fcntl.flock(held, fcntl.LOCK_SH)
        remove_old_folders(caches / f"{11:016x}")
        assert states(caches) == [1, *range(12 - KEPT, 12)]
    remove_old_folders(caches / f"{11:016x}")
    assert states(caches) == list(range(12 - KEPT, 12))


def test_one_of_a_running_process_is_held(tree: Path, tmp_path: Path) -> None:
    if fcntl is None:
        pytest.skip("Windows has no such locks")
    code = "import toile.geometry.doubled, sys; print('ready', flush=True); sys.stdin.readline()"
    environment = os.environ | {"PYTHONPATH": str(tree), "TOILE_CACHE_DIR": str(tmp_path / "cache")}
    environment.pop("NUMBA_CACHE_DIR", None)
    process = subprocess.Popen(
        [sys.executable, "-c", code], cwd=tree, env=environment, text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    )  # fmt: skip
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    (folder,) = (tmp_path / "cache").iterdir()
    assert kernel_cache._is_held(folder)
    process.communicate("\n", timeout=60.0)
    assert not kernel_cache._is_held(folder)


def test_two_may_remove_at_once(caches: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from toile.geometry.kernel_cache import remove_old_folders; "
        "print(1, flush=True); sys.stdin.readline(); remove_old_folders(Path(sys.argv[1]))"
    )
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", code, str(caches / f"{11:016x}")], cwd=ROOT, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )
        for _ in range(2)
    ]  # fmt: skip
    for process in processes:
        assert process.stdout is not None and process.stdout.readline()
    for process in processes:
        assert process.stdin is not None
        process.stdin.write("\n")
        process.stdin.flush()
    for process in processes:
        _, error = process.communicate(timeout=60.0)
        assert process.returncode == 0, error
    assert states(caches) == list(range(12 - KEPT, 12))
    assert len(list(caches.iterdir())) == KEPT + 2
