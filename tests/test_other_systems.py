"""What Windows and macOS lack is asked for by nothing but the batches, which say so."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIKE_WINDOWS = """
import os, pkgutil, signal, sys
from importlib import import_module
for name in "fcntl resource pwd grp termios pty tty syslog".split():
    sys.modules[name] = None
for name in "fork forkpty wait4 waitid geteuid getuid sched_getaffinity register_at_fork".split():
    if hasattr(os, name):
        delattr(os, name)
for name in "SIGKILL SIGCHLD SIGALRM SIGHUP SIGUSR1 SIGSTOP".split():
    if hasattr(signal, name):
        delattr(signal, name)
"""
"""Takes away what Python on Windows does not have."""


def run(code: str, folder: Path, **variables: str) -> "subprocess.CompletedProcess[str]":
    """Run code in a process that lacks what Windows does."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | variables
    return subprocess.run(
        [sys.executable, "-c", LIKE_WINDOWS + code], cwd=folder, env=environment, capture_output=True,
        text=True,
    )  # fmt: skip


EVERYTHING = """
import toile
names = [module.name for module in pkgutil.walk_packages(toile.__path__, "toile.")]
wanted = [name for name in names if not name.startswith("toile.blender_addon.") and name != "toile.__main__"]
assert len(wanted) > 250, wanted
for name in wanted:
    import_module(name)
for name in toile.__all__:
    getattr(toile, name)
"""


def test_everything_imports(tmp_path: Path) -> None:
    done = run(EVERYTHING, tmp_path)
    assert done.returncode == 0, done.stderr


DRESS = """
import toile
result = toile.dress(toile.Scene(garments=["tshirt"], edge_length=0.05, max_frames=2), "out")
assert result.report["frames"] == 2
"""


def test_a_garment_is_dressed(tmp_path: Path) -> None:
    done = run(DRESS, tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "report.json").is_file()


KERNEL = """
import toile.collide.cover
from toile.geometry import kernel_cache
assert kernel_cache.fcntl is None
kernel_cache.remove_old_folders(kernel_cache.CACHE_DIR)
print(len(list(kernel_cache.CACHE_DIR.rglob("*.nbc"))))
"""


def test_kernels_are_kept(tmp_path: Path) -> None:
    done = run(KERNEL, tmp_path, TOILE_CACHE_DIR=str(tmp_path), NUMBA_CACHE_DIR="")
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 0


BATCH = """
from toile.dressing.cli.main import main
sys.exit(main("batch --garments tshirt -o out".split()))
"""


def test_a_batch_says_what_it_needs(tmp_path: Path) -> None:
    done = run(BATCH, tmp_path)
    assert done.returncode == 2
    assert done.stderr == "toile: batches need a system that can fork, Linux or macOS; on Windows use WSL\n"
    assert not (tmp_path / "out").exists()
