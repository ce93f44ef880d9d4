"""The exception for faulty input; its message says what is wrong and what to do."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path


class InputError(ValueError):
    """Bad input. The message is one line: the file, field or faces at fault, and what to do.

    What the message names for people, the attributes name for programs.

    Attributes
    ----------
    file
        The file or folder at fault, or None.
    field
        Name of the argument, of the key of a file ("air.gusts", "garment.0.fabric", "pattern.panels.left") or
        of the command-line option ("--ratio") at fault, or None.
    garment
        Name of the garment at fault, or None.
    faces
        All faces at fault by their numbers in the file, where the message names some; else empty.
    """

    def __init__(
        self,
        message: str,
        faces: Iterable[int] = (),
        *,
        file: Path | None = None,
        field: str | None = None,
        garment: str | None = None,
    ) -> None:
        super().__init__(message)
        self.faces = tuple(sorted({int(face) for face in faces}))
        self.file = file
        self.field = field
        self.garment = garment

    def at(
        self,
        place: str,
        *,
        file: Path | None = None,
        field: str | None = None,
        garment: str | None = None,
    ) -> "InputError":
        """Return the same error with a place in front of its message; what is given wins over what it has."""
        return InputError(
            f"{place}: {self}",
            self.faces,
            file=file or self.file,
            field=field or self.field,
            garment=garment or self.garment,
        )


class CrowdedError(InputError):
    """More surfaces come close to each other than memory holds: cloth or mesh is out of proportion."""


@contextmanager
def about(
    *, file: Path | None = None, field: str | None = None, garment: str | None = None
) -> Iterator[None]:
    """Let every InputError raised inside name what it is about, where it does not do so itself.

    `field` is the field around that of the error: `about(field="avatar")` makes "units" "avatar.units".
    """
    try:
        yield
    except InputError as error:
        error.file = error.file or file
        error.garment = error.garment or garment
        error.field = ".".join(name for name in (field, error.field) if name) or None
        raise
