"""A T-shirt from DXF-AAMA, with six lines for what the file does not say, hangs on the mannequin."""

from pathlib import Path

import pytest

import toile

SAMPLE = Path(__file__).parents[1] / "pattern" / "drawn" / "samples" / "own_tee_valentina_aama_r12.dxf"
TABLE = """\
seams = ["SLEEVE.2 = FRONT~.2 + BACK.2", "FRONT.1 = BACK~.1", "FRONT.3 = BACK~.3", "SLEEVE.1 = SLEEVE.3"]
worn = "top"
[piece]
FRONT = { fold = 5 }
BACK = { fold = 5 }
SLEEVE = { pair = true }
"""


@pytest.mark.slow
def test_a_drawn_shirt_hangs_without_crossings(tmp_path: Path) -> None:
    table = tmp_path / "tee.seams.toml"
    table.write_text(TABLE)
    garment = toile.Garment(SAMPLE, units="mm", seams=table, fabric="cotton-interlock")
    result = toile.dress(toile.Scene(garments=[garment], quality="preview"), output=tmp_path / "out")
    assert result.status == "converged"
    assert result.report["intersections"] == {"avatar": 0, "self": 0, "worst_frame": 0}
    assert result.garments[0].panel_names == ("SLEEVE", "SLEEVE~", "BACK", "FRONT")
