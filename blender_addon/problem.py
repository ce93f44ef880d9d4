"""What cannot be done, with one line for the user."""

from typing import Any


class Problem(Exception):
    """Says what is wrong and what to do; `garment` and `faces` name the polygons at fault, if known."""

    def __init__(self, message: str, garment: str = "", faces: tuple[int, ...] = ()) -> None:
        super().__init__(message)
        self.garment = garment
        self.faces = faces


def check_editable(obj: Any) -> None:
    """Raise Problem for a linked object, whose changes Blender would not save."""
    if obj.library is not None:
        raise Problem(
            f"'{obj.name}' is linked from {obj.library.name}, so what is set here is not saved: set it in "
            "that file, or make a library override"
        )
