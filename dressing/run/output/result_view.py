"""The page of a result: `view.html`, which is written beside its files and shown in notebooks."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from toile.dressing.files.palette import BODY, garment_colour
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.view.report_facts import facts_of_report
from toile.dressing.view.stretch import posed
from toile.dressing.view.view_page import view_page
from toile.dressing.view.view_part import Field, Pose, Shape, ViewPart

if TYPE_CHECKING:
    from toile.dressing.run.result import DressedGarment, Result

NAME = "view.html"


def result_page(result: "Result") -> str:
    """Return a page that shows a result."""
    avatar = result.avatar
    body = Pose(Shape(avatar.faces), avatar.vertices)
    parts = [ViewPart(name="body", kind="body", colour=BODY, poses=(body,))]
    parts += [_garment(garment, garment_colour(k)) for k, garment in enumerate(result.garments)]
    title = " and ".join(garment.name for garment in result.garments)
    return view_page(title, parts, facts_of_report(result.report))


def save_view(folder: Path, result: "Result") -> Path:
    """Write the page of a result into its folder and return its path."""
    return write_atomic(folder / NAME, result_page(result).encode())


def _garment(garment: "DressedGarment", colour: tuple[float, float, float]) -> ViewPart:
    """Return a garment, coloured by its stretch and by the strain of its threads."""
    node = np.zeros(len(garment.uv), dtype=np.int32)
    node[garment.uv_faces] = garment.faces
    shape, fields = Shape(garment.uv_faces, garment.uv, garment.panel), tuple[Field, ...]()
    if garment.strain is not None:
        warp, weft = 100.0 * garment.strain.T
        fields = (Field("strain along warp", "%", warp), Field("strain along weft", "%", weft))
    return ViewPart(
        name=garment.name, kind="garment", colour=colour, panel_names=garment.panel_names,
        poses=(posed(shape, garment.positions[node], fields),),
    )  # fmt: skip
