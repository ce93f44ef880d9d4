"""The exception for what cannot be done, with one line for the user."""


class Problem(Exception):
    """Says what is wrong and what to do; `garment` and `faces` name the polygons at fault, if known."""

    def __init__(self, message: str, garment: str = "", faces: tuple[int, ...] = ()) -> None:
        super().__init__(message)
        self.garment = garment
        self.faces = faces
