"""Where setuptools finds the packages: at the top level, installed under the one name `toile`.

A checkout on a system without symbolic links builds the same wheel.
"""

from setuptools import find_packages, setup

ROOMS = ("geometry", "collide", "remesh", "engine", "dressing", "studies", "blender_addon")
found = find_packages(include=[pattern for room in ROOMS for pattern in (room, f"{room}.*")])
setup(
    packages=["toile", *(f"toile.{name}" for name in found)],
    package_dir={"toile": "toile", **{f"toile.{room}": room for room in ROOMS}},
)
