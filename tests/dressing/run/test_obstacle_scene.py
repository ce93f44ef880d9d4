"""A cloth on a table that a moving ball lifts: obstacles in a drape and in its film, audited."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.obstacles.obstacle import Obstacle, ObstacleKey
from toile.dressing.run.dress import dress, resume
from toile.dressing.run.progress import ProgressState
from toile.dressing.run.result import Result
from toile.dressing.run.scene import Garment, Scene

SHIFT = 0.12
"""How far the ball rises under the cloth [m]."""


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    folder = tmp_path_factory.mktemp("furniture")
    along, across = np.linspace(-0.2, 0.5, 15), np.linspace(-0.2, 0.2, 9)
    with open(folder / "cloth.obj", "w", encoding="utf-8") as file:
        for x in along:
            file.writelines(f"v {x} 0.703 {z}\nvt {x} {-z}\n" for z in across)
        for i in range(14):
            for j in range(8):
                a, b = 9 * i + j + 1, 9 * (i + 1) + j + 1
                file.write(f"f {a}/{a} {a + 1}/{a + 1} {b + 1}/{b + 1}\nf {a}/{a} {b + 1}/{b + 1} {b}/{b}\n")
    table = trimesh.creation.box((0.6, 0.7, 0.5))
    ball = trimesh.creation.icosphere(2, 0.08)
    ball.apply_translation((0.4, 0.58, 0.0))
    table.apply_translation((0.0, 0.35, 0.0))
    ball.export(folder / "ball.obj")
    keys = (ObstacleKey(time=0.0), ObstacleKey(time=0.15, move=(0.0, SHIFT, 0.0)))
    return Scene(
        garments=[Garment(folder / "cloth.obj", units="m", up="y")], quality="preview", remesh=False,
        edge_length=0.05,
        avatar=Avatar(name="table", vertices=np.asarray(table.vertices), faces=np.asarray(table.faces)),
        obstacles=[Obstacle(folder / "ball.obj", keys=keys, friction=0.1, fps=20.0)],
    )  # fmt: skip


@pytest.fixture(scope="module")
def film(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Result]:
    folder = tmp_path_factory.mktemp("film")
    return folder, dress(scene, folder)


def test_the_film_lasts_as_long_as_the_ball_moves_and_nothing_crosses(film: tuple[Path, Result]) -> None:
    _, result = film
    assert result.status == "converged"
    assert result.report["intersections"] == {"avatar": 0, "self": 0, "worst_frame": 0}
    assert result.report["animation"]["frames"] == 3
    assert result.report["animation"]["intersections_max"] == 0
    (of,) = [entry for entry in result.report["inputs"] if entry["of"] == "obstacle ball"]
    assert of["file"] == "ball.obj"


def test_the_ball_lifts_the_cloth_that_hangs_over_it(scene: Scene, film: tuple[Path, Result]) -> None:
    _, result = film
    still = dress(replace(scene, obstacles=[replace(scene.obstacles[0], keys=())]))
    assert still.report["intersections"]["worst_frame"] == 0
    top = [one.avatar.vertices[one.avatar.obstacles[0].begin :, 1].max() for one in (still, result)]
    assert top[1] - top[0] == pytest.approx(SHIFT, abs=2e-3)
    for one, height in zip((still, result), top, strict=True):
        places = one.garments[0].positions
        above = np.hypot(places[:, 0] - 0.4, places[:, 2]) < 0.03
        assert above.any() and places[above, 1].min() > height - 0.008


def test_a_broken_off_film_goes_on_to_the_same_bytes(
    scene: Scene, film: tuple[Path, Result], tmp_path: Path
) -> None:
    started = False

    def stop(state: ProgressState) -> bool:
        nonlocal started
        started = started or (state.max_frames == 3 and state.frame == 0)
        return not (started and state.frame == 1)

    assert dress(scene, tmp_path, stop).status == "cancelled"
    assert resume(tmp_path).status == "converged"
    for path in (film[0] / "frames").iterdir():
        assert (tmp_path / "frames" / path.name).read_bytes() == path.read_bytes()
