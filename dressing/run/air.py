"""Air around garments that follow a body: still, a steady wind, gusts."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex

import numpy as np
import numpy.typing as npt

from toile.dressing.files.suggestion import unknown_name
from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.fan import FASTEST, Fan
from toile.engine.forces.gusts import Gusts
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, is_whole, shown

DENSITY = 1.2
"""Of air [kg/m^3]."""
MOST_DRAG = 4.0
"""Largest coefficient that makes sense: an open hemisphere against the wind has 1.4."""
LEAST_SPEED = 1.0
"""Speed for which still air resists [m/s]: about that of a body that walks."""


@dataclass(frozen=True, kw_only=True)
class Air:
    """Air that resists cloth in motion, and may blow.

    Attributes
    ----------
    velocity
        Mean wind [m/s], x, y, z of a scene with Y up; zero is still air.
    gusts
        Standard deviation of the gusts over the mean speed, 0 to 1; outdoors 0.1 to 0.2.
    eddies
        Size of the gusts [m].
    seed
        Which of all gusts of that kind.
    drag
        Drag coefficient of cloth across the flow; of a flat plate about 1.
    fans
        Winds beside the mean one that change over the film, or that differ from place to place.
    lift
        Lift coefficient, up to `drag`: the force on cloth with normal n in a flow of speed u along d is
        rho u^2/2 ((drag - lift) d + lift (n . d) n) per area. With lift = drag air presses along the normal
        only, as on a smooth plate; without lift it drags cloth along like dust.

    Raises InputError naming the field that is at fault.
    """

    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gusts: float = 0.0
    eddies: float = 2.0
    seed: int = 0
    drag: float = 1.0
    lift: float = 1.0
    fans: Sequence[Fan] = ()

    if TYPE_CHECKING:

        def __init__(
            self, *, velocity: Sequence[SupportsFloat] | npt.NDArray[Any] = (0.0, 0.0, 0.0),
            gusts: SupportsFloat = 0.0, eddies: SupportsFloat = 2.0, seed: SupportsIndex = 0,
            drag: SupportsFloat = 1.0, lift: SupportsFloat = 1.0, fans: Sequence[Fan] = (),
        ) -> None: ...  # fmt: skip

    def __post_init__(self) -> None:
        """Check every field."""
        wind = self.velocity.tolist() if isinstance(self.velocity, np.ndarray) else self.velocity
        numbers = isinstance(wind, list | tuple) and len(wind) == 3 and all(map(is_real, wind))
        if not numbers or math.hypot(*wind) > FASTEST:
            raise InputError(
                f"velocity of air must be three numbers, up to {FASTEST:g} m/s, got {shown(wind)}",
                field="velocity",
            )
        object.__setattr__(self, "velocity", tuple(float(part) for part in wind))
        if not is_real(self.gusts) or not 0.0 <= self.gusts <= 1.0:
            raise InputError(f"gusts of air must lie between 0 and 1, got {shown(self.gusts)}", field="gusts")
        if not is_real(self.eddies) or not self.eddies > 0.0:
            raise InputError(
                f"eddies of air must be longer than 0 m, got {shown(self.eddies)}", field="eddies"
            )
        if not is_whole(self.seed) or self.seed < 0:
            raise InputError(
                f"seed of air must be a whole number from 0, got {shown(self.seed)}", field="seed"
            )
        if not is_real(self.drag) or not 0.0 < self.drag <= MOST_DRAG:
            raise InputError(
                f"drag of air must lie between 0 and {MOST_DRAG:g}, got {shown(self.drag)}", field="drag"
            )
        if not is_real(self.lift) or not 0.0 <= self.lift <= self.drag:
            raise InputError(
                f"lift of air must lie between 0 and its drag {self.drag:g}, got {shown(self.lift)}",
                field="lift",
            )
        fans = tuple(self.fans) if isinstance(self.fans, list | tuple) else (self.fans,)
        if not all(isinstance(fan, Fan) for fan in fans):
            raise InputError(f"fans of air must be Fans, got {shown(self.fans)}", field="fans")
        object.__setattr__(self, "fans", fans)
        for name in ("gusts", "eddies", "drag", "lift"):
            object.__setattr__(self, name, float(getattr(self, name)))
        object.__setattr__(self, "seed", int(self.seed))

    def flow(self) -> AirFlow:
        """Return it as the engine takes it."""
        gusts = Gusts(intensity=self.gusts, length=self.eddies, seed=self.seed) if self.gusts else None
        speed = max(math.hypot(*self.velocity) + sum(fan.speed for fan in self.fans), LEAST_SPEED)
        return AirFlow(
            velocity=self.velocity, resistance=plate_resistance(speed, self.drag),
            friction=plate_resistance(speed, self.drag - self.lift), gusts=gusts, fans=tuple(self.fans),
        )  # fmt: skip


AIR_KEYS: dict[str, tuple[Any, str]] = {
    "velocity": (list, "mean wind [m/s], x, y, z with Y up, default still: [0, 0, 0]"),
    "gusts": ((int, float), "standard deviation of gusts over the mean speed, default 0"),
    "eddies": ((int, float), "size of gusts [m], default 2"),
    "seed": (int, "which gusts, default 0"),
    "drag": ((int, float), "drag coefficient of cloth across the flow, default 1"),
    "fan": (list, "tables: one [[air.fan]] for each wind that changes, or is weaker farther away"),
    "lift": ((int, float), "lift coefficient, from 0 (drag only) to that of drag, default 1"),
}
"""Keys of [air] to their accepted types and meanings."""
FAN_KEYS = ("times", "velocities", "places", "falloff", "nearest", "farthest")
"""Keys of [[air.fan]], those of `Fan`."""


def air_of(values: Mapping[str, Any]) -> Air:
    """Return the air of a scene file's table. Raises InputError naming the key that is at fault."""
    fans = []
    for table in values.get("fan", ()):
        if not isinstance(table, Mapping):
            raise InputError("fan of air must be a list of tables: write [[air.fan]]", field="fan")
        for name in table:
            if name not in FAN_KEYS:
                raise InputError(unknown_name("key", name, FAN_KEYS), field="fan")
        if "velocities" not in table:
            raise InputError("an [[air.fan]] needs velocities", field="fan")
        fans.append(Fan(**table))
    return Air(**{name: value for name, value in values.items() if name != "fan"}, fans=fans)


def plate_resistance(speed: float, coefficient: float = 1.0) -> float:
    """Linear resistance [N s/m^3] that equals the drag of a plate of that coefficient at `speed` [m/s]."""
    return 0.5 * DENSITY * coefficient * speed
