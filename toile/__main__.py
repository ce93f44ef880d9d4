"""`python -m toile`: the command line."""

import sys

from toile.dressing.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
