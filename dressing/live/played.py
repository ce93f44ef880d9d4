"""What a server of live cloth plays."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol


class Played(Protocol):
    """Something that goes on step by step, is shown on a page, and does what the page wishes.

    Attributes
    ----------
    running
        Whether steps are made.
    single
        Steps to make although it is paused.
    """

    running: bool
    single: int

    def advance(self) -> None:
        """Go on by 1/60 s."""

    def carry_out(self, wish: Mapping[str, Any]) -> bool:
        """Do what is wished; return whether the scene is another now. Raises InputError."""

    def page(self, language: str) -> str:
        """Return the page, in "en" or "es"."""

    def scene(self) -> dict[str, Any]:
        """Return what a page needs to draw frames."""

    def frame(self) -> bytes:
        """Return the state after the last step, as the page takes it."""

    def state(self) -> dict[str, Any]:
        """Return what the page shows as numbers."""

    def save(self, folder: Path) -> list[Path]:
        """Write what was played; return the files."""

    def close(self) -> None:
        """End all that belongs to it."""
