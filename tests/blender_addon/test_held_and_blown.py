"""Pins that give way, wind, and a garment that starts inside the body, in real Blender."""

from typing import Any

import pytest

from tests.blender_addon.conftest import Blender


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return blender("held_and_blown.py", tmp_path_factory.mktemp("held"))


def test_pins_give_way_by_their_weight_and_stiffness(found: dict[str, Any]) -> None:
    """Rows of weight 1, 0.5 and 0 of a flag that moves along: the last sags most, the softer flag more."""
    assert found["state"] == "complete"
    for flag in ("soft", "stiff"):
        fixed, half, free = found[flag]["away"]
        assert fixed < 1e-6 and 5.0 * fixed < half < 0.5 * free
    assert found["soft"]["away"][1] > 10.0 * found["stiff"]["away"][1]


def test_weights_follow_onto_every_mesh(found: dict[str, Any]) -> None:
    """What is shown has the weights that the group has there, on another number of vertices."""
    for flag in ("soft", "stiff", "windy"):
        assert found[flag]["weights off"] < 1e-5 and found[flag]["vertices"] != 81


def test_winds_add_up_in_the_axes_of_the_engine(found: dict[str, Any]) -> None:
    """6 m/s along Blender's -Y with gusts of 0.5 m/s, and 2 m/s along X, which weaken with the distance."""
    velocity, gusts, seed, fan, _, velocities, places, falloff = found["air"]
    parts = [float(part) for part in velocity.partition("[")[2].strip("]").split(",")]
    assert parts == pytest.approx([0.0, 0.0, 6.0], abs=1e-5)
    assert float(gusts.partition("=")[2]) == pytest.approx(0.5 / 6.0, rel=1e-4) and seed == "seed = 7"
    assert fan == "[[air.fan]]" and falloff == "falloff = 1"
    assert velocities.startswith("velocities = [[2.000000, ") and places.startswith("places = [[0.000000, ")


def test_a_wind_from_below_lifts_the_flag(found: dict[str, Any]) -> None:
    assert found["windy"]["up"] > found["soft"]["up"] + 0.01


def test_force_fields_that_do_nothing_are_named(found: dict[str, Any]) -> None:
    assert found["notes"] == [
        "Warning: force field 'Whirl' does nothing: toile knows wind only, not vortex",
    ]
    assert len(found["notes at rest"]) == 3 and "(Simulate)" in found["notes at rest"][1]
    assert "blows at 200 m/s, toile takes up to 60" in found["storm"]


def test_a_ring_shut_up_in_the_body_is_told_and_selected(found: dict[str, Any]) -> None:
    assert "'Ring' has a piece that starts inside the body" in found["ring"] and "\n" not in found["ring"]
    assert found["ring selected"] == ["failed", 16]
