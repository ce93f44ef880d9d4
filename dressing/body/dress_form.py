"""An avatar together with its measurements."""

from copy import copy
from dataclasses import replace
from functools import cached_property

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.given_measurements import Given, completed
from toile.dressing.body.measurements import Measurements
from toile.dressing.body.place import Place
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError


class DressForm:
    """An avatar in its own frame, with its measurements, which are taken once, when first asked for.

    Attributes
    ----------
    avatar
        The body in its own frame.
    place
        Where it stands in the room of its file.
    given
        Measurements that the user gave [m, rad], instead of those taken.
    """

    def __init__(self, avatar: Avatar, given: Given | None = None) -> None:
        self.place = Place.of(avatar)
        self.avatar = self.place.own(avatar)
        self.given = dict(given or {})

    def with_avatar(self, avatar: Avatar) -> "DressForm":
        """Return the form with another avatar, in its own frame, and the measurements of this one."""
        other = copy(self)
        other.__dict__["_completed"] = self._completed
        other.avatar = avatar
        return other

    def with_skin(self, vertices: Float) -> "DressForm":
        """Return the form with its skin elsewhere [m], shape (v, 3), and the measurements of this one."""
        return self.with_avatar(replace(self.avatar, vertices=vertices))

    def in_pose(self, vertices: Float, motion: VertexMotion) -> "DressForm":
        """Return the form with its body in another pose [m], shape (v, 3), measured anew, and moving."""
        other = copy(self)
        other.__dict__.pop("_completed", None)
        other.avatar = replace(self.avatar, vertices=vertices, motion=motion)
        return other

    @cached_property
    def _completed(self) -> tuple[Measurements | InputError, tuple[str, ...]]:
        """Measurements, or why there are none, and notes."""
        from toile.dressing.body.measure import measure

        measured: Measurements | InputError
        try:
            measured = measure(self.avatar.alone)
        except InputError as error:
            measured = error
        return completed(self.avatar, measured, self.given) if self.given else (measured, ())

    @property
    def measured(self) -> Measurements | InputError:
        """Measurements of the avatar, or why it has none (it sits, say, or holds its arms up)."""
        return self._completed[0]

    @property
    def notes(self) -> tuple[str, ...]:
        """What there is to say about measurements that were given."""
        return self._completed[1]

    @property
    def measurements(self) -> Measurements:
        """Measurements of the avatar. Raises InputError if it cannot be measured."""
        if isinstance(self.measured, InputError):
            raise self.measured
        return self.measured
