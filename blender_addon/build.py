"""Build script of the extension: python -m toile.blender_addon.build -o dist/ makes one zip per platform.

A zip holds a manifest, a few lines that register, and wheels: toile itself and what it computes with, except
numpy, which Blender brings along. Blender 4.5 and 5.0 have another Python than 5.1 and later, so another zip.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple
from zipfile import ZIP_STORED, ZipFile

from toile.blender_addon.own_wheel import packed_again, project
from toile.dressing.files.writers.atomic import replacing, writable_folder
from toile.geometry.errors import InputError

FOLDER = Path(__file__).resolve().parent
INIT = '''"""Toile in Blender; the code is in the wheels."""

import sys

import bpy


def register():
    import toile.blender_addon as addon

    addon.register(bpy.utils.extension_path_user(__package__, path="kernels", create=True))


def unregister():
    import toile.blender_addon as addon

    addon.unregister()
    # What is registered next may be another version.
    for name in [name for name in sys.modules if name.partition(".")[0] == "toile"]:
        del sys.modules[name]
'''
PLATFORMS = {
    "linux-x64": [f"manylinux_2_{minor}_x86_64" for minor in (28, 27, 24, 17, 12, 5)]
    + ["manylinux2014_x86_64"],
    "windows-x64": ["win_amd64"],
    "macos-arm64": [f"macosx_{major}_0_arm64" for major in (14, 13, 12, 11)],
}
"""Blender's platforms, and the tags of wheels that run there."""


class Target(NamedTuple):
    """A range of Blender versions with one Python, and the numpy in them."""

    python: str
    blender_min: str
    blender_max: str
    numpy: str


TARGETS = {
    "3.11": Target("3.11", "4.5.0", "5.1.0", "numpy==1.26.4"),
    "3.13": Target("3.13", "5.1.0", "6.0.0", "numpy>=2,<2.4"),
}


def build(output: Path, platform: str, target: Target) -> Path:
    """Build one zip and return its path. Raises InputError where wheels cannot be had."""
    facts = project()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if facts.checkout is None:
            packed_again(folder)
        else:
            _pip("wheel", "--no-deps", "-w", name, str(facts.checkout))
        tags = [argument for tag in PLATFORMS[platform] for argument in ("--platform", tag)]
        wanted = [entry for entry in facts.dependencies if not entry.startswith("numpy")]
        _pip("download", "--only-binary=:all:", "--python-version", target.python, *tags,
             "-d", name, *wanted, target.numpy)  # fmt: skip
        wheels = sorted(path for path in folder.glob("*.whl") if not path.name.startswith("numpy-"))
        manifest = (FOLDER / "blender_manifest.toml").read_text(encoding="utf-8")
        manifest = manifest.format(
            version=facts.version, platform=platform, blender_min=target.blender_min,
            blender_max=target.blender_max,
            wheels="\n".join(f'    "./wheels/{path.name}",' for path in wheels),
        )  # fmt: skip
        made = output / f"toile-{facts.version}-{platform}-py{target.python.replace('.', '')}.zip"
        with replacing(made) as temporary, ZipFile(temporary, "w", ZIP_STORED) as archive:
            archive.writestr("blender_manifest.toml", manifest)
            archive.writestr("__init__.py", INIT)
            archive.writestr("LICENSE", (FOLDER / "LICENSE").read_text(encoding="utf-8"))
            for path in wheels:
                archive.write(path, f"wheels/{path.name}")
    return made


def _pip(*arguments: str) -> None:
    """Run pip; raise InputError with its last line where it fails."""
    done = subprocess.run(
        [sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet", *arguments],
        capture_output=True, text=True,
    )  # fmt: skip
    if done.returncode:
        told = done.stderr.strip().splitlines() or ["no reason given"]
        lines = [line for line in told if line.startswith("ERROR")]
        raise InputError(f"pip {arguments[0]} failed: {(lines or told)[-1]}")


def main(arguments: list[str] | None = None) -> int:
    """Build what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m toile.blender_addon.build", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("dist"), help="folder of the zips")
    parser.add_argument("--platform", action="append", choices=PLATFORMS, help="default: all")
    parser.add_argument("--python", action="append", choices=TARGETS, help="default: all")
    options = parser.parse_args(arguments)
    try:
        output = writable_folder(options.output)
        for platform in options.platform or PLATFORMS:
            for python in options.python or TARGETS:
                made = build(output, platform, TARGETS[python])
                print(f"wrote {made}: {made.stat().st_size / 1e6:.0f} MB")
    except InputError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
