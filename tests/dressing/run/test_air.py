"""Air: what can be asked for, in Python, in a scene file and by command."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toile.dressing.cli.main import main
from toile.dressing.run.air import Air
from toile.dressing.run.scene_file import load_scene
from toile.engine.forces.fan import Fan
from toile.geometry.errors import InputError

SCENE = """
[air]
velocity = [0, 0, {speed}]
gusts = 0.2

[[garment]]
source = "tshirt"
"""


def test_a_plate_across_the_wind_feels_its_pressure_drag() -> None:
    flow = Air(velocity=(3.0, 0.0, 4.0)).flow()
    assert flow.resistance * 5.0 == pytest.approx(0.5 * 1.2 * 5.0**2)
    assert flow.gusts is None and np.array_equal(flow.velocity_at(7.0), [3.0, 0.0, 4.0])
    assert Air().flow().resistance > 0.0


def test_without_lift_cloth_is_dragged_along() -> None:
    air = Air(velocity=(0.0, 0.0, 5.0), drag=1.2, lift=0.0).flow()
    assert air.friction == air.resistance == pytest.approx(0.5 * 1.2 * 1.2 * 5.0)
    assert Air(drag=1.2, lift=0.9).flow().friction == pytest.approx(0.5 * 1.2 * 0.3)
    assert Air().flow().friction == 0.0


def test_gusts_are_those_of_their_seed() -> None:
    one, same, other = (Air(velocity=(5.0, 0.0, 0.0), gusts=0.2, seed=seed).flow() for seed in (1, 1, 2))
    assert np.array_equal(one.velocity_at(3.0), same.velocity_at(3.0))
    assert not np.array_equal(one.velocity_at(3.0), other.velocity_at(3.0))


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ({"velocity": (1.0, 2.0)}, "velocity"),
        ({"velocity": (0.0, float("nan"), 0.0)}, "velocity"),
        ({"velocity": (0.0, 0.0, 400.0)}, "velocity"),
        ({"gusts": 2.0}, "gusts"),
        ({"eddies": 0.0}, "eddies"),
        ({"seed": 1.5}, "seed"),
        ({"drag": 0.0}, "drag"),
        ({"lift": 1.5}, "lift"),
    ],
)
def test_a_wrong_field_is_named(values: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError, match=f"^{field} of air"):
        Air(**values)


def test_a_scene_file_names_its_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE.format(speed=4))
    assert load_scene(path).air == Air(velocity=(0.0, 0.0, 4.0), gusts=0.2)
    path.write_text(SCENE.format(speed=400))
    assert main(["dress", str(path), "-o", str(tmp_path / "out")]) == 2
    assert f"{path}, line 3: velocity of air" in capsys.readouterr().err


def test_fans_of_a_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    fan = "[[air.fan]]\ntimes = [0, 1]\nvelocities = [[0, 0, 0], [0, 0, 9]]\nfarthest = 3\n"
    path.write_text(f"[air]\n{fan}[[garment]]\nsource = 'tshirt'\n")
    air = load_scene(path).air
    assert air == Air(fans=[Fan(times=[0, 1], velocities=[(0, 0, 0), (0, 0, 9)], farthest=3)])
    assert air is not None and air.flow().resistance == Air(velocity=(0, 0, 9)).flow().resistance
    for wrong, said in (
        ("time = 3", "unknown key 'time'; did you mean 'times'"), ("falloff = -1", "falloff of a fan"),
    ):  # fmt: skip
        fan = f"[[air.fan]]\nvelocities = [[0, 0, 1]]\n{wrong}\n"
        path.write_text(f"[air]\n{fan}[[garment]]\nsource = 'tshirt'\n")
        with pytest.raises(InputError, match=said):
            load_scene(path)
