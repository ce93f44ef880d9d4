"""Run the fuzzer: python -m tests.fuzz [--count N] [READER...]; exits with 1 if it finds something."""

import argparse
import faulthandler
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.fuzz.fuzz import fuzz
from tests.fuzz.readers import READERS


def main() -> int:
    """Fuzz the readers asked for, one after the other."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("readers", nargs="*", metavar="READER", help=", ".join(READERS))
    parser.add_argument("--count", type=int, default=2000, help="inputs per reader (default 2000)")
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--keep", type=Path, help="folder for the inputs instead of a temporary one")
    options = parser.parse_args()
    for name in options.readers:
        if name not in READERS:
            parser.error(f"unknown reader {name}; choose from {', '.join(READERS)}")
    faulthandler.enable()
    found = 0
    for name in options.readers or READERS:
        own = 0
        with TemporaryDirectory() as folder:
            for finding in fuzz(name, options.count, options.keep or Path(folder), options.first):
                own += 1
                print(f"{finding.reader} {finding.number}: {finding.what}", flush=True)
        print(f"{name}: {options.count} inputs, {own} findings", flush=True)
        found += own
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
