"""The parser, exit codes and progress lines that all commands share."""

import argparse
import sys
from typing import Any, NoReturn

DONE, MISSED, BAD_INPUT, FAILED, FELL_OFF, OVERSTRETCHED, CANCELLED = 0, 1, 2, 3, 4, 5, 130
"""Exit codes."""


class Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        """Print one line and exit with the code for bad input."""
        self.exit(BAD_INPUT, f"{self.prog}: {message} (see {self.prog} --help)\n")


Commands = argparse._SubParsersAction
"""What commands are added to."""


LONGEST_IN_METRES = 5.0
"""A plain number up to this is a length in metres, a larger one in centimetres: no body is 5 cm around."""


def body_length(text: str) -> float:
    """Return a length of a body [m] from "1.75", "1.75m", "175" or "175cm"."""
    number, factor = text.strip().lower(), None
    for unit, metres in (("cm", 0.01), ("mm", 0.001), ("m", 1.0)):
        if number.endswith(unit):
            number, factor = number.removesuffix(unit), metres
            break
    try:
        value = float(number)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no length; write 1.75m or 175cm") from None
    if factor is None:
        factor = 1.0 if value <= LONGEST_IN_METRES else 0.01
    return value * factor


def lead_in(text: str) -> float | str:
    """Return the length of a lead-in [s], or "off"."""
    try:
        return text if text == "off" else float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number of seconds nor off") from None


READING = ("units", "up", "front", "only", "without", "fps", "time", "clip")
"""Options that say how the file of a body is read, by the names of AvatarFile."""


def add_reading(command: argparse.ArgumentParser) -> None:
    """Add the options that say how the file of a body is read."""
    command.add_argument("--units", metavar="UNIT", help="units of BODY: m, cm or mm (default: recognised)")
    command.add_argument("--up", metavar="AXIS", help="up axis of BODY: y or z (default: recognised)")
    command.add_argument(
        "--front",
        metavar="AXIS",
        help="axis of its file that BODY faces: x, z ... or --front=-z (default: recognised)",
    )
    command.add_argument(
        "--only",
        action="append",
        metavar="PART",
        help="part (group, object) of BODY that is the body; repeat",
    )
    command.add_argument(
        "--without", action="append", metavar="PART", help="part of BODY that is none; repeat for more"
    )
    command.add_argument("--fps", type=float, metavar="N", help="frames per second of a moving BODY")
    command.add_argument(
        "--time", type=float, metavar="S", help="take a moving BODY as it stands at S seconds"
    )
    command.add_argument(
        "--clip", metavar="NAME", help="animation of a .glb or .gltf BODY (default: the first)"
    )


def add_posing(command: argparse.ArgumentParser) -> None:
    """Add the options of made motions: to a pose, and from one in which sleeves can be sewn."""
    command.add_argument(
        "--pose",
        action="append",
        metavar="FILE",
        help="BODY in another pose, to which it moves (repeat for more), or clip.glb@SECONDS",
    )
    command.add_argument(
        "--lead-in",
        type=lead_in,
        metavar="SECONDS|off",
        help="motion from a rest pose, or from open arms, into the clip of BODY (default: 1 s where arms "
        "hang); off leaves the arms of a body that stands",
    )


def reading_of(options: argparse.Namespace) -> dict[str, Any]:
    """Return the options of `add_reading` that were given."""
    return {name: value for name in READING if (value := getattr(options, name)) is not None}


def say_progress(line: str) -> None:
    """Print a line beside the results."""
    print(line, file=sys.stderr, flush=True)
