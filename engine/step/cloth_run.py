"""State that drapes and films share: cloth, still or growing avatar, stepper, auditor, clock."""

from dataclasses import replace

from toile.collide.audit import Auditor, Crossings
from toile.collide.avatar_surface import AvatarSurface
from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.membrane import Membrane
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.memory import Memory
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float, Int
from toile.geometry.stage_clock import StageClock


class ClothRun:
    """State that drapes and films share.

    Attributes
    ----------
    cloth
        The cloth; its positions are those of the last frame.
    stepper
        Makes steps on the cloth's present topology; its positions are the current ones.
    surface
        The avatar as it is now, or None.
    auditor
        Finds crossings with the avatar as it is; None when it has moved since.
    clock
        Time spent per stage.
    """

    def __init__(
        self, cloth: Cloth, avatar: tuple[Float, Int] | None, options: StepOptions, clock: StageClock
    ) -> None:
        self.cloth = cloth
        self.clock = clock
        self.surface = None if avatar is None else AvatarSurface(*avatar)
        self.auditor: Auditor | None = None
        self.stepper = cloth_stepper(cloth, self.surface, options, clock)

    def restart(
        self, cloth: Cloth, anchors: Float | None = None, memory: Memory | None = None,
        options: StepOptions | None = None,
    ) -> None:  # fmt: skip
        """Continue with a cloth of another topology, its friction anchors [m], (n, 3), and memory of steps.

        Without them anchors start at the nodes, and steps know no past. Options stay unless others are given.
        """
        self.cloth = cloth
        options = self.stepper.options if options is None else options
        stepper = self.stepper = cloth_stepper(cloth, self.surface, options, self.clock)
        stepper.put(cloth.positions, cloth.velocities, memory)
        if anchors is not None and stepper.collisions is not None:
            stepper.collisions.anchor[: len(anchors)] = anchors

    def audit(self) -> Crossings:
        """Find crossings of the cloth as it is; the auditor is made anew after the avatar has moved."""
        now = self.clock.now()
        if self.auditor is None:
            self.auditor = Auditor(*self.body())
        crossings = self.auditor.audit(self.stepper.x, self.cloth.face_nodes, self.cloth.weld)
        self.clock.add("audit", now)
        return crossings

    def body(self) -> tuple[Float | None, Int | None]:
        """Vertices [m], shape (v, 3), and faces, (t, 3), of the whole avatar as it is."""
        return (None, None) if self.surface is None else (self.surface.vertices, self.surface.faces)

    def audited_cloth(self) -> Crossings:
        """Take the stepper's positions and velocities over into the cloth; return its crossings."""
        self.cloth = replace(self.cloth, positions=self.stepper.x.copy(), velocities=self.stepper.v.copy())
        return self.audit()

    def warp_weft_strain(self) -> Float:
        """Strain along warp and weft of every face now, shape (t, 2)."""
        membrane = self.stepper.force(Membrane)
        assert membrane is not None
        return membrane.warp_weft_strain(self.stepper.x)

    def anchors(self) -> Float | None:
        """Friction anchors of the nodes now [m], shape (n, 3); None without contact."""
        collisions = self.stepper.collisions
        return None if collisions is None else collisions.anchor[: len(self.stepper.x)].copy()

    def smallest_gap(self) -> float | None:
        """Smallest distance between cloth and avatar or cloth now [m]; None if nothing is within reach."""
        collisions = self.stepper.collisions
        if collisions is None:
            return None
        gaps = collisions.detect(self.stepper.x).gap
        return float(gaps.min()) if len(gaps) else None
