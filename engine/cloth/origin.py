"""The corners and faces of garment files that cloth was made from."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csr_array

from toile.geometry.arrays import Float, Int
from toile.geometry.by_value import ByValue
from toile.remesh.adapt.transfer import TransferMap


@dataclass(frozen=True, kw_only=True, eq=False)
class Origin(ByValue):
    """The file corners and faces behind every material vertex and face; file attributes follow from them.

    Attributes
    ----------
    weights
        Weight of every corner of the files in every material vertex, sparse (m, p); rows sum to 1.
    face
        Face of its own garment's file that every face lies in, shape (t,).
    first
        First corner of every garment, and the count of all, shape (g + 1,).
    """

    weights: csr_array
    face: Int
    first: Int

    @staticmethod
    def unknown(vertices: int, faces: int) -> "Origin":
        """Return the origin of cloth of which nobody knows where it comes from: no corners at all."""
        return Origin(
            weights=csr_array((vertices, 0)), face=np.full(faces, -1, np.int32),
            first=np.zeros(2, np.int32),
        )  # fmt: skip

    @staticmethod
    def together(origins: "Sequence[Origin | None]", sizes: Sequence[tuple[int, int]]) -> "Origin | None":
        """Return the origin of garments that become one cloth; None if none of them knows its own.

        `sizes` are their numbers of material vertices and faces.
        """
        if all(origin is None for origin in origins):
            return None
        parts = [origin or Origin.unknown(*size) for origin, size in zip(origins, sizes, strict=True)]
        counts = np.concatenate([np.diff(part.first) for part in parts])
        return Origin(
            weights=csr_array(block_diag([part.weights for part in parts], format="csr")),
            face=np.concatenate([part.face for part in parts]),
            first=np.concatenate([[0], np.cumsum(counts)]).astype(np.int32),
        )

    def carried(self, transfer: TransferMap) -> "Origin":
        """Return the origin of the same cloth on another mesh."""
        return Origin(
            weights=csr_array(transfer.vertices @ self.weights), face=self.face[transfer.faces],
            first=self.first,
        )  # fmt: skip

    def of_garment(self, index: int, vertices: Int, faces: Int) -> "Origin":
        """Return the origin of some material vertices and faces of one garment."""
        start, end = int(self.first[index]), int(self.first[index + 1])
        return Origin(
            weights=csr_array(self.weights[vertices][:, start:end]), face=self.face[faces],
            first=np.array([0, end - start], np.int32),
        )  # fmt: skip

    def at_vertices(self, values: Float) -> Float:
        """Return values of the corners, shape (p, ...), at the material vertices, shape (m, ...)."""
        flat = self.weights @ values.reshape(len(values), -1)
        return np.ascontiguousarray(flat.reshape(-1, *values.shape[1:]))

    def nearest(self) -> Int:
        """Corner that weighs most in every material vertex, shape (m,)."""
        heaviest = np.asarray(self.weights.argmax(axis=1))
        return heaviest.ravel().astype(np.int32)
