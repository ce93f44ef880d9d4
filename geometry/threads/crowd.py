"""How many pairs a search may find, counted while its parts are searched."""

from toile.geometry.errors import CrowdedError


class Crowd:
    """Pairs found so far in the parts of a search, of which `most` are allowed."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._found = 0

    def add(self, found: int) -> None:
        """Count pairs of a part, as soon as they are known. Raises CrowdedError if all are too many."""
        # Parts that end at the same time may count as one: `check` is the last word.
        self._found += found
        self.check(self._found)

    def check(self, found: int) -> None:
        """Raise CrowdedError if there are so many pairs."""
        if found > self._most:
            raise CrowdedError(
                f"over {self._most:.2g} pairs of triangles are close enough to touch, more than memory is "
                "for: cloth is thicker than its triangles are long, or a mesh far too fine (check thickness, "
                "edge length)"
            )
