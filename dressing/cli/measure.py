"""The command `toile measure`."""

import argparse
from pathlib import Path

from toile.dressing.cli.parser import DONE, Commands, Parser
from toile.geometry.errors import InputError


def add_measure(commands: "Commands[Parser]") -> None:
    """Add the measure command."""
    measure = commands.add_parser(
        "measure",
        help="measure a body, and draw where",
        description="Measure a standing body with its arms away from the trunk [cm].",
    )
    measure.add_argument("body", type=Path, metavar="BODY", help="OBJ, PLY, STL or GLB file")
    measure.add_argument("--units", metavar="UNIT", help="units of BODY: m, cm or mm (default: recognised)")
    measure.add_argument("--up", metavar="AXIS", help="up axis of BODY: y or z (default: recognised)")
    measure.add_argument("-o", "--output", type=Path, metavar="FILE.svg", help="picture of the measurements")
    measure.set_defaults(run=_run_measure)


def _run_measure(options: argparse.Namespace) -> int:
    """Print the measurements of a body and draw where they were taken."""
    output: Path | None = options.output
    if output is not None and output.suffix.lower() != ".svg":
        raise InputError(f"{output}: the picture is an .svg file, which every browser shows", file=output)
    from toile.dressing.body.avatar import load_avatar
    from toile.dressing.body.measure import measure
    from toile.dressing.files.writers.atomic import writable_folder, write_atomic
    from toile.dressing.pictures.measure_picture import measure_picture, named_measurements

    avatar = load_avatar(options.body, units=options.units, up=options.up)
    measured = measure(avatar)
    for name, value in named_measurements(measured).items():
        print(f"{name:<10}{value:6.1f} cm")
    if output is not None:
        writable_folder(output.parent)
        write_atomic(output, measure_picture(avatar, measured))
        print(f"wrote {output}")
    return DONE
