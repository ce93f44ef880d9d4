"""The gate of remeshing: refuses flips and collapses that cross, close a gap or add too much energy."""

import numpy as np

from toile.collide.patch_clearance import PatchChanges, clear_proposals
from toile.engine.adapt.patch_energy import patch_energies
from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.laws.stretch_laws import stretch_laws
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Bool, Float, Int
from toile.remesh.adapt.acceptance import Proposals

LEAST_GAP = 1e-4
"""Gap that flips and collapses leave to other cloth and to the avatar [m]."""
ENERGY_BUDGET = 0.002
"""How much they may add to the elastic energy in one pass, as a share of it."""

ROUNDING = 1e-7
"""Strain that is no more than rounding: flat cloth at rest has no energy to take a share of."""


class PatchGate:
    """Accepts changes of patches during one pass of remeshing.

    Fabric hardly stretches, so that another triangulation of a curved patch may hold many times its energy.
    Changes are taken from the cheapest on, as far as a budget goes; what lowers the energy adds to it.

    Attributes
    ----------
    left
        Energy that may still be added [J].
    """

    def __init__(self, cloth: Cloth, stepper: ClothStepper) -> None:
        self._weld = cloth.weld
        self._avatar = None if stepper.collisions is None else stepper.collisions.avatar
        names = ("stretch_warp", "stretch_weft", "shear", "compression")
        self._stiffness = np.stack([cloth.per_face(name) for name in names], axis=1)
        warp, weft, _, compression = self._stiffness.T
        self._laws = stretch_laws(cloth.fabrics, cloth.fabric, warp, weft, compression)
        self._scale = cloth.rest_scale(cloth.now)
        rounding = float((self._stiffness[:, 0] * np.abs(cloth.rest_area)).sum()) * ROUNDING**2
        self.left = ENERGY_BUDGET * stepper.elastic_energy() + rounding

    def __call__(self, positions: Float, proposals: Proposals) -> Bool:
        """Tell which proposals are accepted, shape (p,); nodes beyond the cloth's are new ones."""
        added = self._added_energy(positions, proposals)
        order = np.argsort(added, kind="stable")
        accepted = np.zeros(len(added), bool)
        accepted[order[np.cumsum(added[order]) <= self.left]] = True
        rows, removed = accepted[proposals.owner], accepted[proposals.removed_owner]
        number = np.cumsum(accepted, dtype=np.int32) - np.int32(1)
        weld = np.arange(len(positions), dtype=np.int32)
        weld[: len(self._weld)] = self._weld
        changes = PatchChanges(
            np.ascontiguousarray(proposals.triangles[rows]), number[proposals.owner[rows]],
            proposals.removed[removed], number[proposals.removed_owner[removed]], int(accepted.sum()),
        )  # fmt: skip
        clear = clear_proposals(
            positions, proposals.face_nodes, weld, changes, self._avatar, LEAST_GAP, LEAST_GAP
        )
        accepted[accepted] = clear
        self.left -= float(added[accepted].sum())
        return accepted

    def _added_energy(self, positions: Float, proposals: Proposals) -> Float:
        """Membrane energy that each proposal adds [J], shape (p,)."""
        count = proposals.proposal_count
        new = patch_energies(
            positions, proposals.triangles, self._natural(proposals.rest_corners, proposals.origin),
            self._stiffness, proposals.origin, self._laws,
        )  # fmt: skip
        old = patch_energies(
            positions, proposals.face_nodes[proposals.removed],
            self._natural(proposals.removed_rest_corners, proposals.removed_origin),
            self._stiffness, proposals.removed_origin, self._laws,
        )  # fmt: skip
        after = np.bincount(proposals.owner, weights=new, minlength=count)
        return np.asarray(after - np.bincount(proposals.removed_owner, weights=old, minlength=count))

    def _natural(self, rest_corners: Float, like: Int) -> Float:
        """Return rest corners (q, 3, 2) [m] scaled as those of the faces `like`, shape (q,), are."""
        return rest_corners if self._scale is None else rest_corners * self._scale[like][:, None]
