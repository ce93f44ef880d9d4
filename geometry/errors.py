"""The one error that means: the input is at fault, and this is what to do about it."""

from collections.abc import Iterable


class InputError(ValueError):
    """Bad input. The message is one line: the file, field or faces at fault, and what to do.

    Attributes
    ----------
    faces
        All faces at fault by their numbers in the file, where the message names some.
    """

    def __init__(self, message: str, faces: Iterable[int] = ()) -> None:
        super().__init__(message)
        self.faces = tuple(sorted({int(face) for face in faces}))
