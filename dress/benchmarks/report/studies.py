"""The scenes of the report, and running them."""

from collections.abc import Iterator, Sequence

from toile.dress.benchmarks.report.cantilever import study_cantilever
from toile.dress.benchmarks.report.hang import study_hang
from toile.dress.benchmarks.report.point import Chart, Effort, Study
from toile.dress.benchmarks.report.shirt import study_shirt
from toile.dress.benchmarks.report.sphere import study_sphere
from toile.dress.benchmarks.report.swing import study_swing

STUDIES: dict[str, Study] = {
    "cantilever": study_cantilever,
    "swing": study_swing,
    "hang": study_hang,
    "sphere": study_sphere,
    "shirt": study_shirt,
}
"""All scenes, the quick ones first."""


def run_studies(names: Sequence[str], effort: Effort) -> Iterator[Chart]:
    """Measure scenes one after the other; every chart comes as it is done."""
    for name in names:
        yield from STUDIES[name](effort)
