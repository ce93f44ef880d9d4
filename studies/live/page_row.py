"""A figure of the page of live cloth, with its bar."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class PageRow:
    """One figure.

    Attributes
    ----------
    name
        What was measured.
    value
        What came out, the smaller the better.
    unit
        Its unit.
    bar
        What it may be at most.
    note
        What else is to be said.
    """

    name: str
    value: float
    unit: str
    bar: float
    note: str = ""

    def missed(self) -> bool:
        """Whether the bar was missed."""
        return not self.value <= self.bar


def page_table(rows: list[PageRow]) -> str:
    """Return rows as text."""
    return "\n".join(
        f"{row.name:12s} {row.value:8.2f} {row.unit:4s} (bar {row.bar:g})  {row.note}"
        + ("  missed" if row.missed() else "")
        for row in rows
    )
