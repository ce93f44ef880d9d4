"""The parser, exit codes and progress lines that all commands share."""

import argparse
import sys
from typing import NoReturn

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


def say_progress(line: str) -> None:
    """Print a line beside the results."""
    print(line, file=sys.stderr, flush=True)
