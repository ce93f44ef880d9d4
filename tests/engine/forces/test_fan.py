"""Winds that change over a film, and with the distance from where they stand."""

import numpy as np
import pytest

from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.fan import Fan
from toile.engine.forces.wind import Wind
from toile.geometry.errors import InputError

X = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [9.0, 0.0, 0.0]])


def test_it_blows_between_its_keys() -> None:
    fan = Fan(times=[1.0, 3.0], velocities=[(0, 0, 0), (0, 4, 0)])
    speeds = [fan.velocity(seconds, X)[2, 1] for seconds in (0.0, 1.0, 2.5, 3.0, 9.0)]
    assert speeds == pytest.approx([0.0, 0.0, 3.0, 4.0, 4.0])
    assert fan.later(10.0).velocity(12.5, X)[0, 1] == pytest.approx(3.0)


def test_it_weakens_with_the_distance() -> None:
    fan = Fan(velocities=[(0, 2, 0)], places=[(0, 0, 0)], falloff=2.0, nearest=1.0, farthest=5.0)
    assert fan.velocity(0.0, X)[:, 1] == pytest.approx([2.0, 2.0, 2.0 / 9.0, 0.0])
    moves = Fan(times=[0, 1], velocities=[(0, 2, 0)] * 2, places=[(0, 0, 0), (3, 0, 0)], falloff=1.0)
    assert moves.velocity(1.0, X)[2, 1] == pytest.approx(2.0)
    assert moves.velocity(0.0, X)[2, 1] == pytest.approx(0.5)


def test_winds_add_up_on_the_cloth() -> None:
    """A fan that is uniform is the same as a wind of that velocity."""
    faces = np.array([[0, 1, 2]], np.int32)
    fans = (Fan(velocities=[(1, 0, 0)]), Fan(velocities=[(0, 0, 2)]))
    together = AirFlow(velocity=(0.0, 3.0, 0.0), resistance=1.0, fans=fans)
    assert np.array_equal(together.velocity_around(0.0, X), np.tile([1.0, 3.0, 2.0], (4, 1)))
    assert Wind(faces, 3, together).air.tolist() == [0.0, 3.0, 0.0]
    plain = AirFlow(velocity=(0.0, 3.0, 0.0), resistance=1.0)
    assert plain.velocity_around(0.0, X).shape == (3,)


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"velocities": [(0, 0)]}, "velocities of a fan must be three numbers for each of its 1 times"),
        ({"velocities": [(0, 0, 1)], "times": [0, 1]}, "for each of its 2 times"),
        ({"velocities": [(0, 0, 1)] * 2, "times": [1, 0]}, "times of a fan must be numbers that rise"),
        ({"velocities": [(0, 0, 400)]}, "up to 60 m/s, got 400"),
        ({"velocities": [(0, 0, 1)], "falloff": -1}, "falloff of a fan must be a number from 0"),
        ({"velocities": [(0, 0, 1)], "farthest": "far"}, "farthest of a fan must be a number from 0"),
        ({"velocities": [(0, 0, float("nan"))]}, "velocities of a fan must be three numbers"),
    ],
)
def test_what_is_wrong_is_named(fields: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        Fan(**fields)  # type: ignore[arg-type]
