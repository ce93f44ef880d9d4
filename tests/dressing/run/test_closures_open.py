"""Buttons that open one after the other while their wearer moves."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.body.mannequin import mannequin
from toile.dressing.garment.fields.closure import Closure
from toile.dressing.pattern.drafts import register_draft
from toile.dressing.run.dress import dress
from toile.dressing.run.scene import Garment, Scene
from toile.engine.cloth.fields.keyed import Keyed


@pytest.mark.slow
def test_a_vest_opens_in_a_film_and_nothing_crosses(tmp_path: Path) -> None:
    body = mannequin()
    ahead = np.zeros((13, 1, 3))
    ahead[:, 0, 2] = 0.002 * np.arange(13)
    np.savez(tmp_path / "body.npz", vertices=body.vertices + ahead, faces=body.faces, fps=24.0)
    register_draft("vest", import_module("examples.buttoned_vest").vest)
    buttons = Closure(
        kind="buttons", over="-left.5", under="-right.1", count=6, inset=0.015, ends=0.03,
        closed=Keyed((0.05, 0.35), (1.0, 0.0)),
    )  # fmt: skip
    garment = Garment("vest", closures=(buttons,))
    result = dress(
        Scene(garments=[garment], avatar=tmp_path / "body.npz", quality="preview"), tmp_path / "out"
    )
    assert result.status == "converged"
    assert result.report["animation"]["frames"] == 12
    assert result.report["animation"]["intersections_max"] == 0
