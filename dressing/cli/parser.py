"""The parser, exit codes and progress lines that all commands share."""

import argparse
import sys
from typing import NoReturn

DONE, MISSED, BAD_INPUT, FAILED, CANCELLED = 0, 1, 2, 3, 130
"""Exit codes."""


class Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        """Print one line and exit with the code for bad input."""
        self.exit(BAD_INPUT, f"{self.prog}: {message} (see {self.prog} --help)\n")


Commands = argparse._SubParsersAction
"""What commands are added to."""


def say_progress(line: str) -> None:
    """Print a line beside the results."""
    print(line, file=sys.stderr, flush=True)
