"""One comparison with theory or measured cloth, and the table of all."""

import math
from dataclasses import asdict, dataclass


@dataclass(frozen=True, kw_only=True)
class ValidationRow:
    """One comparison.

    Attributes
    ----------
    case, variant
        What was done, and on which mesh, fabric or integrator.
    quantity
        What was measured, with its unit.
    measured, expected
        Its values.
    error, bar
        How far they are apart, and how far they may be, both in percent where `relative`, else in the unit of
        the quantity.
    relative
        Whether errors are shares of what is expected.
    """

    case: str
    variant: str
    quantity: str
    measured: float
    expected: float
    error: float
    bar: float
    relative: bool

    @property
    def met(self) -> bool:
        """Whether the error is within the bar; one that is not a number is not."""
        return bool(self.error <= self.bar)


def relative_row(
    case: str, variant: str, quantity: str, measured: float, expected: float, percent: float
) -> ValidationRow:
    """Return a comparison whose error may be so many percent of what is expected."""
    return ValidationRow(
        case=case, variant=variant, quantity=quantity, measured=measured, expected=expected,
        error=100.0 * abs(measured / expected - 1.0), bar=percent, relative=True,
    )  # fmt: skip


def absolute_row(
    case: str, variant: str, quantity: str, measured: float, expected: float, bar: float
) -> ValidationRow:
    """Return a comparison whose error may be so much in the quantity's own unit."""
    return ValidationRow(
        case=case, variant=variant, quantity=quantity, measured=measured, expected=expected,
        error=abs(measured - expected), bar=bar, relative=False,
    )  # fmt: skip


def stored(row: ValidationRow) -> dict[str, object]:
    """Return what is kept of a comparison: numbers that are not finite as None."""
    figures = {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in asdict(row).items()
    }
    return {**figures, "met": row.met}


def validation_table(rows: list[ValidationRow]) -> str:
    """Return the comparisons as a text table; bars that were missed are marked with a star."""
    table = [("case", "variant", "quantity", "measured", "expected", "error", "bar", "")]
    for row in rows:
        unit = " %" if row.relative else ""
        table.append(
            (
                row.case, row.variant, row.quantity, f"{row.measured:.5g}", f"{row.expected:.5g}",
                f"{row.error:.2g}{unit}", f"{row.bar:.2g}{unit}", "met" if row.met else "MISSED *",
            )
        )  # fmt: skip
    widths = [max(len(line[column]) for line in table) for column in range(len(table[0]))]
    lines = [
        "  ".join(
            cell.rjust(width) if 3 <= column <= 6 else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in table
    ]
    missed = sum(not row.met for row in rows)
    return "\n".join([*lines, f"{len(rows)} comparisons, {missed} beyond their bar"])
