"""Adaptation of a cloth mesh to a field of wanted edge lengths.

Source of the method: Narain, Samii and O'Brien 2012, "Adaptive anisotropic remeshing for cloth simulation".
"""

from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Bool, Float
from toile.remesh.adapt.acceptance import Accept, Gate
from toile.remesh.adapt.collapse import CollapseRound, collapse_round, collapsible
from toile.remesh.adapt.flip import flip_edges
from toile.remesh.adapt.mesh_in_work import MeshInWork
from toile.remesh.adapt.split import long_edges, split_round
from toile.remesh.adapt.transfer import TransferMap
from toile.remesh.mesh.cloth_mesh import ClothMesh


class AdaptResult(NamedTuple):
    """A new mesh, how data follow onto it, and what was done.

    Faces, nodes and material vertices that survive stay in order, new ones come after them. A face that is
    split keeps its row for one half; a flip keeps both rows. `rounds` counts batches of splits and collapses.
    """

    mesh: ClothMesh
    transfer: TransferMap
    splits: int
    flips: int
    collapses: int
    rounds: int


def adapt(
    mesh: ClothMesh, tensors: Float, accept: Accept | None = None, *, few: int = 0, least: int = 0
) -> AdaptResult:
    """Flip, split and collapse edges until none is longer than 1 in the metric or could well be longer.

    `tensors` (m, 3, 3) [1/m^2] give the wanted edge length 1 / sqrt(e . M e) in direction e at every
    material vertex. Flips and collapses, which move the surface, are carried out where `accept` lets them;
    splits leave it in place. The rest shape, and with it mass, stays exactly what it is. Batches of at most
    `few` collapses end the pass: what they would leave undone is small, and cheaper done in the next. It ends
    after the first flips where fewer than `least` splits and collapses could be made at once.

    Raises ValueError if `tensors` do not fit the mesh.
    """
    if tensors.shape != (len(mesh.rest), 3, 3):
        raise ValueError(f"tensors must have shape ({len(mesh.rest)}, 3, 3), got {tensors.shape}")
    work, gate = MeshInWork.start(mesh, tensors), Gate(accept)
    splits = collapses = rounds = 0
    flips = flip_edges(work, gate)
    if least and long_edges(work) + collapsible(work) < least:
        return AdaptResult(*work.finish(mesh), 0, flips, 0, 0)
    while (done := split_round(work))[0]:
        splits, rounds = splits + done[0], rounds + 1
        flips += flip_edges(work, gate, done[1])
    # neither a collapse nor a flip makes an edge that would have to be split
    last: CollapseRound | None = None
    while True:
        batches, last, changed = _collapse(work, gate, last, few)
        collapses, rounds = collapses + sum(batches), rounds + len(batches)
        flipped = flip_edges(work, gate, changed)
        flips += flipped
        if not flipped or (batches and batches[-1] <= few):
            break
        last = last._replace(touched=changed)
    return AdaptResult(*work.finish(mesh), splits, flips, collapses, rounds)


def _collapse(
    work: MeshInWork, gate: Gate, last: CollapseRound | None, few: int
) -> tuple[list[int], CollapseRound, Bool]:
    """Collapse until nothing is left to do, or at most `few` at once.

    Returns the sizes of the batches, the last one, and the faces that changed in any, shape (t,).
    """
    changed = np.zeros(len(work.faces), bool)
    batches: list[int] = []
    while True:
        last = collapse_round(work, gate, last)
        changed = changed[last.kept] | last.touched
        if not last.merged:
            return batches, last, changed
        batches.append(last.merged)
        if last.merged <= few:
            return batches, last, changed
