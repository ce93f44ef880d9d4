"""The scene that options of the command line describe, or change."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.cli.parser import READING, reading_of
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.dressing.run.scene import Scene


def scene_of(options: argparse.Namespace) -> "Scene":
    """Return the scene of a file, of the options, or of a file with options that win over it."""
    from dataclasses import replace

    from toile.dressing.pattern.drawn.read_drawn import DRAWN_FORMATS
    from toile.dressing.run.air import Air
    from toile.dressing.run.scene import AvatarFile, Garment, Scene
    from toile.dressing.run.scene_file import load_scene
    from toile.geometry.threads.crew import threads_for_one

    given = {
        name: value
        for name in (
            "measurements",
            "fabric",
            "quality",
            "edge_length",
            "remesh",
            "max_frames",
            "formats",
            "ground",
            "certificate",
            "threads",
        )
        if (value := getattr(options, name)) is not None
    }
    if options.fit or options.check:
        given["fit"] = "checked" if options.check else "maps"
    reading = reading_of(options)
    if options.lead_in is not None:
        reading["lead_in"] = options.lead_in
    if options.pose:
        reading["pose"] = options.pose
    if options.avatar is None and reading:
        words = ", ".join(f"--{name}" for name in (*READING, "lead-in", "pose"))
        raise InputError(f"{words} describe the file of --avatar, which is missing", field="--avatar")
    if options.avatar is not None:
        given["avatar"] = AvatarFile(path=options.avatar, **reading)
    garments = tuple(
        Garment(
            source, size=options.size, allowance=options.allowance, seams=options.seams,
            units=options.pattern_units,
        )
        if Path(source).suffix.lower() in DRAWN_FORMATS
        else Garment(source)
        for source in options.garment
    )  # fmt: skip
    obstacles = tuple(options.obstacle or ())
    wind = None if options.wind is None else tuple(options.wind)
    if options.scene is None:
        if not garments:
            raise InputError("nothing to dress: give --garment FILE|NAME or a scene file", field="--garment")
        air = None if wind is None else Air(velocity=wind)
        return Scene(
            garments=garments, air=air, obstacles=obstacles, **{"threads": threads_for_one(), **given}
        )
    if options.scene.suffix.lower() != ".toml":
        raise InputError(
            f"{options.scene}: a scene file ends in .toml; garments are given with --garment",
            file=options.scene,
        )
    scene = load_scene(options.scene)
    given.setdefault("threads", scene.threads or threads_for_one())
    if "fabric" in given:
        given["garments"] = tuple(replace(garment, fabric=None) for garment in scene.garments)
    if garments:
        given["garments"] = garments
    given["obstacles"] = (*scene.obstacles, *obstacles)
    if wind is not None:
        given["air"] = replace(scene.air or Air(), velocity=wind)
    return replace(scene, **given)
