"""Validation: comparisons of the engine with theory and measured cloth, each with a bar."""

from collections.abc import Callable, Iterable, Iterator

from toile.studies.validation.validate_buckling import validate_buckling
from toile.studies.validation.validate_cantilever import validate_cantilever
from toile.studies.validation.validate_curvature import validate_curvature
from toile.studies.validation.validate_drape import validate_drape
from toile.studies.validation.validate_friction import validate_friction
from toile.studies.validation.validate_orders import validate_orders
from toile.studies.validation.validate_patch import validate_patch
from toile.studies.validation.validate_stick_slip import validate_stick_slip
from toile.studies.validation.validate_stretch import validate_stretch
from toile.studies.validation.validate_yarns import validate_yarns
from toile.studies.validation.validation_row import ValidationRow

VALIDATIONS: dict[str, Callable[[], Iterator[ValidationRow]]] = {
    "patch": validate_patch,
    "stretch": validate_stretch,
    "curvature": validate_curvature,
    "cantilever": validate_cantilever,
    "buckling": validate_buckling,
    "stick_slip": validate_stick_slip,
    "orders": validate_orders,
    "friction": validate_friction,
    "yarns": validate_yarns,
    "drape": validate_drape,
}
"""All cases, the quick ones first."""


def run_validation(names: Iterable[str]) -> Iterator[ValidationRow]:
    """Run cases one after the other; every comparison comes as it is done."""
    for name in names:
        yield from VALIDATIONS[name]()
