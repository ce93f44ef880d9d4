"""A shirt that hangs stays where it is on a still body."""

import numpy as np
import pytest

from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.garment.fabrics import fabric
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.drafts import built_in
from toile.dressing.run.quality import quality_preset
from toile.dressing.wear.drape_types import DrapeOptions
from toile.dressing.wear.put_on import drape
from toile.engine.film.plan import PUSHED_NEWTON, PUSHED_TOLERANCE, FilmFrame, FilmPlan
from toile.engine.film.simulate import Simulation
from toile.geometry.arrays import Float

FPS = 24


@pytest.mark.slow
def test_a_shirt_does_not_creep_down_a_still_body() -> None:
    """A second after time begins to run, nodes move by less than 0.1 mm/s in the mean over a second."""
    quality = quality_preset("preview")
    body = mannequin()
    mesh = mesh_pattern(built_in("tshirt", measure(body)), edge_length=quality.edge_length)
    options = DrapeOptions(
        edge_length=quality.edge_length, max_frames=quality.max_frames, tolerance=quality.tolerance
    )
    hung = drape(DressForm(body), [(mesh, fabric("cotton-poplin"))], options, lambda _: True)
    assert hung.status == "converged"
    places: list[Float] = []

    def keep(frame: FilmFrame) -> bool:
        places.append(frame.cloth.positions.copy())
        return True

    plan = FilmPlan(
        step=hung.step, frame_seconds=1.0 / FPS, newton=PUSHED_NEWTON, newton_tolerance=PUSHED_TOLERANCE
    )
    record = Simulation(hung.cloth, (body.vertices, body.faces), plan, keep).run(2.0)
    assert not any(map(sum, record.crossings))
    moved = places[-1] - places[-1 - FPS]
    assert np.linalg.norm(moved, axis=1).mean() < 1e-4
    assert abs(moved[:, 1].mean()) < 2e-5
