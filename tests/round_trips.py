"""Run the round trips of bodies through other programs and count them: python -m tests.round_trips.

Prints a table of writers with the combinations of format, option and feature that came back as they were,
that did not, and that were left out for want of a program. TOILE_GLTF_TOOLS and TOILE_BPY name the folders of
gltf-transform and gltfpack, and of bpy. Exits with 1 if any did not come back, or fewer than FEWEST did.
"""

import sys
from collections import Counter

import pytest

FEWEST = 60
TESTS = (
    "tests/dressing/files/test_round_trip.py", "tests/dressing/files/test_round_trip_tools.py",
    "tests/blender_addon/test_bodies_it_writes.py",
)  # fmt: skip
WRITERS = {
    "trimesh_writes": "trimesh",
    "meshio_writes": "meshio",
    "gltf_of_every_feature": "glTF by hand",
    "compression_is_named": "compressed glTF, refused by name",
    "gltf_transform": "gltf-transform",
    "gltfpack": "gltfpack",
    "blender_writes": "Blender",
}
"""What a test's name holds, and the writer in the table."""


class Tally:
    """A pytest plugin that counts combinations by writer and outcome.

    A test of many combinations says how many in its property `combinations`.
    """

    def __init__(self) -> None:
        self.counts: dict[str, Counter[str]] = {writer: Counter() for writer in WRITERS.values()}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Count a finished test, or one that was skipped or failed before it began."""
        if report.when != "call" and not (report.when == "setup" and report.outcome != "passed"):
            return
        writer = next(writer for part, writer in WRITERS.items() if part in report.nodeid)
        many = dict(report.user_properties).get("combinations", 1)
        self.counts[writer][report.outcome] += int(str(many))

    def table(self) -> str:
        """Return the table as text, with a row of sums."""
        outcomes = ("passed", "failed", "skipped")
        rows = [(writer, *(counts[o] for o in outcomes)) for writer, counts in self.counts.items()]
        rows.append(("together", *(sum(counts[o] for counts in self.counts.values()) for o in outcomes)))
        lines = [f"{'writer':34}{'came back':>10}{'did not':>9}{'left out':>10}"]
        return "\n".join([*lines, *(f"{name:34}{p:10}{f:9}{s:10}" for name, p, f, s in rows)])


def main() -> int:
    """Run the tests and print the table."""
    tally = Tally()
    status = pytest.main(["-q", "-m", "", *TESTS], plugins=[tally])
    print(tally.table())
    passed = sum(counts["passed"] for counts in tally.counts.values())
    return 0 if status == pytest.ExitCode.OK and passed >= FEWEST else 1


if __name__ == "__main__":
    sys.exit(main())
