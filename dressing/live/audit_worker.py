"""The process that audits: cloth comes on standard input, counts of crossings go out.

It shares the audit with all runs, and no memory with what it audits.
"""

import pickle
import sys

from toile.collide.audit import Auditor


def main() -> None:
    """Audit whatever comes until the other side closes the pipe."""
    source, sink = sys.stdin.buffer, sys.stdout.buffer
    sink.write(b"ready\n")
    sink.flush()
    while True:
        try:
            step, x, faces, weld, body = pickle.load(source)
        except (EOFError, pickle.UnpicklingError):
            return
        found = Auditor(*body).audit(x, faces, weld)
        sink.write(f"{step} {len(found.avatar)} {len(found.cloth)}\n".encode())
        sink.flush()


if __name__ == "__main__":
    main()
