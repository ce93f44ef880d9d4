"""The scenes of the report, and running them."""

from collections.abc import Iterator, Sequence

from toile.studies.speed_error.cantilever import study_cantilever
from toile.studies.speed_error.hang import study_hang
from toile.studies.speed_error.point import Chart, Effort, Study
from toile.studies.speed_error.shirt import study_shirt
from toile.studies.speed_error.sphere import study_sphere
from toile.studies.speed_error.swing import study_swing

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
