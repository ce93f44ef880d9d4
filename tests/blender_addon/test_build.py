"""The zip: built, valid by Blender's own judgement, small, and at work in a clean Blender."""

import ast
import os
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest

from tests.blender_addon.conftest import Blender
from toile.blender_addon.build import FOLDER, main

MAX_SIZE, MAX_LINES = 120e6, 1500


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if sys.platform != "linux":
        pytest.skip("the zip that is tried out is the one for Linux")
    folder = tmp_path_factory.mktemp("dist")
    assert main(["-o", str(folder), "--platform", "linux-x64", "--python", "3.11"]) == 0
    return next(folder.glob("*.zip"))


def test_zip_is_small_and_valid(archive: Path, bpy_folder: Path) -> None:
    assert archive.stat().st_size < MAX_SIZE
    script = next(bpy_folder.glob("bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
    done = subprocess.run(
        [sys.executable, str(script), "validate", str(archive)], capture_output=True, text=True,
        env=os.environ | {"PYTHONPATH": str(bpy_folder)},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


def test_an_installed_toile_packs_the_same_wheel(archive: Path, tmp_path: Path) -> None:
    """Away from the checkout, from what an installer made of the wheel in the zip."""
    site, made = tmp_path / "site", tmp_path / "made"
    made.mkdir()
    with ZipFile(archive) as file:
        name = next(name for name in file.namelist() if name.startswith("wheels/toile-"))
        file.extract(name, tmp_path)
    with ZipFile(tmp_path / name) as file:
        file.extractall(site)
    (next(site.glob("toile-*.dist-info")) / "INSTALLER").write_text("pip")
    code = (
        "from pathlib import Path; from toile.blender_addon.own_wheel import packed_again, project; "
        f"print(project()); print(packed_again(Path({str(made)!r})))"
    )
    paths = [str(site), *(path for path in sys.path if "site-packages" in path)]
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = {paths}; {code}"], capture_output=True, text=True,
        cwd=made, env={key: value for key, value in os.environ.items() if key != "PYTHONPATH"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "checkout=None" in done.stdout and "numba" in done.stdout and "extra" not in done.stdout
    with ZipFile(next(made.glob("*.whl"))) as ours, ZipFile(tmp_path / name) as theirs:
        assert sorted(ours.namelist()) == sorted(theirs.namelist())
        for entry in ours.namelist():
            assert entry.endswith("RECORD") or ours.read(entry) == theirs.read(entry)


@pytest.mark.parametrize("task", ["look", pytest.param("dress", marks=pytest.mark.slow)])
def test_installs_into_a_clean_blender(
    archive: Path, bare_blender: Blender, tmp_path: Path, task: str
) -> None:
    """Its engine starts there from the wheels: it judges the size of a body, or dresses it (slow)."""
    found = bare_blender("install.py", tmp_path, archive, task)
    assert found["from"].startswith(str(tmp_path / "blender")) and found["enabled"] and found["disabled"]
    assert found["seconds"] < 0.5 and found["loaded"] == []
    if task == "dress":
        assert found["state"] == "complete"
    else:
        assert "avatar" in found["message"] and "0.006" in found["message"]


def test_add_on_is_thin() -> None:
    """Code without blank lines, comments and docstrings."""
    total = 0
    for path in FOLDER.glob("*.py"):
        text = path.read_text(encoding="utf-8")
        told: set[int] = set()
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
                told |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        lines = enumerate(text.splitlines(), start=1)
        total += sum(number not in told and line.strip()[:1] not in ("", "#") for number, line in lines)
    assert total < MAX_LINES
