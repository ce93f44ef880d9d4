"""The frame loop of a drape on a still body: sew the seams, grow the body, settle to equilibrium.

Draping asks for the equilibrium, not for the movie: every step starts at rest, so an implicit step of
size h is a damped Newton step on the static problem, and growing h turns it into the Newton step itself.
"""

from toile.engine.drape.growing import grow
from toile.engine.drape.merging import join_touching
from toile.engine.drape.passable import let_pass_crossings
from toile.engine.drape.pinning import take_hold
from toile.engine.drape.plan import DrapeRecord
from toile.engine.drape.settling import ease, settle
from toile.engine.drape.sewing import sew
from toile.engine.drape.state import DrapeState
from toile.engine.drape.tangles import close_late, relax_tangles
from toile.engine.drape.unpicking import leave_open, sew_again

HOPELESS = 0.15
"""Gap of a stitch that no later phase closes [m]: they pull from 2 cm on, and less."""


class Drape(DrapeState):
    """A drape in progress: call `run`.

    The avatar is given as it is while seams close (vertices, faces); `growth` lists the shapes it then takes
    on one after the other, the last being its true one (none: it has it already).
    """

    def run(self) -> DrapeRecord:
        """Sew, settle, stop at equilibrium, at the step limit or when on_frame returns False."""
        join_touching(self)
        # A mesh garment may cross the avatar or itself at the start: there it passes until it is free.
        let_pass_crossings(self, self.audit())
        self.close_frame(0)
        if self.phase == "sewing":
            sew(self)
        relax_tangles(self)
        # Another mesh is cheaper than a second attempt on this one.
        if self._gives_up(bool(self.ghost.any())):
            return self.record
        if self._can_go_back():
            sew_again(self)
            relax_tangles(self)
        if self._is_hopeless():
            self.close_frame(0)
            return self.record
        self._put_on()
        if self._is_open():
            take_hold(self)
            if self.remesh():
                # What does not close in coarse triangles may do so in finer ones.
                close_late(self)
        if self._gives_up(bool(self.ghost.any()) or self._is_open()):
            return self.record
        if self._can_go_back():
            leave_open(self)
            self._put_on()
        take_hold(self)
        self.remesh()
        ease(self)
        self.remesh()
        if not self.stopped():
            self.phase = "settling"
            # What is still open may close while the garment hangs, but not by crossing itself.
            self.solid = True
            settle(self)
        if self.audited != self.record.steps:
            self.close_frame(0)
        return self.record

    def hang(self) -> DrapeRecord:
        """Let cloth that is sewn and in its place find equilibrium."""
        self.phase, self.solid = "settling", True
        self.close_frame(0)
        settle(self)
        if self.audited != self.record.steps:
            self.close_frame(0)
        return self.record

    def _gives_up(self, jammed: bool) -> bool:
        """Whether to end here, its seams jammed, since the caller may start again on another mesh."""
        self.record.gave_up = jammed and not self.plan.persistent and not self.over()
        return self.record.gave_up

    def _is_open(self) -> bool:
        """Whether stitches are open that can be seen."""
        return bool((self.gaps() > self.plan.closed_gap).any())

    def _is_hopeless(self) -> bool:
        """Whether seams gape so far after the last attempt that nothing will close them."""
        return self.plan.persistent and bool((self.gaps() > HOPELESS).any())

    def _can_go_back(self) -> bool:
        """Whether cloth is tangled, and its seams can be unpicked."""
        return bool(self.ghost.any()) and self.before_passing is not None and not self.over()

    def _put_on(self) -> None:
        """Draw sewn cloth apart where it is tangled, and let the avatar take on its true shape."""
        relax_tangles(self)
        if len(self.growth) > 1:
            ease(self, self.plan.falling_steps)
        for shape in self.growth:
            if not self.stopped():
                self.phase = "growing"
                grow(self, shape.vertices, shape.per_step)
        close_late(self)
