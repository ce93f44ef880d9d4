"""The command `toile measure`."""

import argparse
import json
from pathlib import Path

from toile.dressing.cli.parser import DONE, Commands, Parser, add_reading, reading_of, say_progress
from toile.geometry.errors import InputError


def add_measure(commands: "Commands[Parser]") -> None:
    """Add the measure command."""
    measure = commands.add_parser(
        "measure",
        help="measure a body, and draw where",
        description="Measure a standing body with its arms away from the trunk [cm].",
    )
    measure.add_argument("body", type=Path, metavar="BODY", help="file of a body, as for toile dress")
    add_reading(measure)
    measure.add_argument("-o", "--output", type=Path, metavar="FILE.svg", help="picture of the measurements")
    measure.add_argument(
        "--json", action="store_true",
        help="print all measurements as JSON, under the names of FreeSewing, GarmentCode and Seamly too",
    )  # fmt: skip
    measure.set_defaults(run=_run_measure)


def _run_measure(options: argparse.Namespace) -> int:
    """Print the measurements of a body and draw where they were taken."""
    output: Path | None = options.output
    if output is not None and output.suffix.lower() != ".svg":
        raise InputError(f"{output}: the picture is an .svg file, which every browser shows", file=output)
    from toile.dressing.files.writers.atomic import writable_folder, write_atomic
    from toile.dressing.pictures.measure_picture import measure_picture, named_measurements
    from toile.dressing.run.scene import AvatarFile
    from toile.dressing.run.scene_avatar import load_dress_form

    _, form = load_dress_form(AvatarFile(path=options.body, **reading_of(options)), {})
    measured = form.measurements
    if options.json:
        from toile.dressing.body.tailoring.names import measurements_json
        from toile.dressing.body.tailoring.tailor_measurements import tailor_measurements

        print(json.dumps(measurements_json(measured, tailor_measurements(form.avatar, measured)), indent=2))
    else:
        for name, value in named_measurements(measured).items():
            print(f"{name:<10}{value:6.1f} cm")
    if output is not None:
        writable_folder(output.parent)
        write_atomic(output, measure_picture(form.avatar, measured))
        say_progress(f"wrote {output}") if options.json else print(f"wrote {output}")
    return DONE
