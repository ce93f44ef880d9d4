"""An avatar together with its measurements."""

from functools import cached_property

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.measurements import Measurements
from toile.dressing.body.place import Place
from toile.geometry.errors import InputError


class DressForm:
    """An avatar in its own frame, with its measurements, which are taken once, when first asked for.

    Attributes
    ----------
    avatar
        The body in its own frame.
    place
        Where it stands in the room of its file.
    """

    def __init__(self, avatar: Avatar) -> None:
        self.place = Place.of(avatar)
        self.avatar = self.place.own(avatar)

    @cached_property
    def measured(self) -> Measurements | InputError:
        """Measurements of the avatar, or why it has none (it sits, say, or holds its arms up)."""
        from toile.dressing.body.measure import measure

        try:
            return measure(self.avatar)
        except InputError as error:
            return error

    @property
    def measurements(self) -> Measurements:
        """Measurements of the avatar. Raises InputError if it cannot be measured."""
        if isinstance(self.measured, InputError):
            raise self.measured
        return self.measured
