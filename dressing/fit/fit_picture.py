"""fit.png: pressure on the body, and stretch, tension and gap of the garments, each with its scale."""

import numpy as np

from toile.dressing.files.palette import BODY
from toile.dressing.files.writers.png import png_bytes
from toile.dressing.fit.colour_scale import BANDS, ColourScale
from toile.dressing.fit.fit_maps import FitMaps
from toile.dressing.pictures.lettering import HEIGHT, WIDTH, write_text
from toile.dressing.pictures.preview import Pixels, PreviewMesh, render
from toile.geometry.arrays import Float

TILE = 640
"""Height of the view of one quantity [pixels]."""
LEGEND = 70
"""Room above it for its name and scale [pixels]."""
BAR = 16
PAPER = 246
"""Height of the bar of colours [pixels], and grey of the ground."""
LEAST = {"pressure": 100.0, "stretch": 1.0, "tension": 10.0, "gap": 10.0}
"""Least upper ends of scales: below them there is nothing to see [Pa, %, N/m, mm]."""


def fit_png(maps: FitMaps) -> bytes:
    """Return the picture of a fit from the front and the back, the body in its own frame."""
    garments = maps.garments
    stretch = [
        np.maximum(part.at_faces["stretch_warp_percent"], part.at_faces["stretch_weft_percent"])
        for part in garments
    ]
    tension = [np.maximum(part.at_faces["tension_N_m"], 0.0) for part in garments]
    gap = [part.at_faces["ease_mm"] for part in garments]
    on_faces = maps.body.pressure_Pa[maps.body.faces].mean(axis=1)
    pressing = on_faces[on_faces > 1.0]
    tiles = [
        _tile("Pressure on the body, Pa", maps, on_faces, None, ColourScale.of(pressing, LEAST["pressure"])),
        _tile("Stretch along warp or weft, %", maps, None, stretch, _scale(stretch, "stretch")),
        _tile("Tension, N/m", maps, None, tension, _scale(tension, "tension")),
        _tile("Gap to the body, mm", maps, None, gap, _scale(gap, "gap")),
    ]
    rows = [np.concatenate(tiles[:2], axis=1), np.concatenate(tiles[2:], axis=1)]
    return png_bytes(np.ascontiguousarray(np.concatenate(rows)))


def _scale(values: list[Float], name: str) -> ColourScale:
    return ColourScale.of(np.concatenate(values), LEAST[name])


def _tile(
    title: str, maps: FitMaps, body: Float | None, garments: list[Float] | None, scale: ColourScale
) -> Pixels:
    """Return the view of one quantity, given at the faces of the body or of every garment, with its scale."""
    meshes = [
        PreviewMesh(
            maps.body.vertices, maps.body.faces, BODY,
            shades=None if body is None else (scale.colours, scale.band(body)),
        )
    ]  # fmt: skip
    meshes += [
        PreviewMesh(part.positions, part.faces, BODY, True, (scale.colours, scale.band(values)))
        for part, values in zip(maps.garments, garments or [], strict=False)
    ]
    view = render(meshes, TILE)
    return np.concatenate([_legend(title, scale, view.shape[1]), view])


def _legend(title: str, scale: ColourScale, width: int) -> Pixels:
    """Return the strip with a quantity's name, its colours and their values."""
    strip = np.full((LEGEND, width, 3), PAPER, np.uint8)
    write_text(strip, 10, 16, title)
    left, right = 16, width - 40
    ends = np.linspace(left, right, BANDS + 1).astype(int)
    colours = np.rint(255.0 * np.array(scale.colours)).astype(np.uint8)
    for band in range(BANDS):
        strip[32 : 32 + BAR, ends[band] : ends[band + 1]] = colours[band]
    for band in range(0, BANDS + 1, 2):
        text = f"{scale.top * band / BANDS:.4g}"
        write_text(strip, 32 + BAR + 5, int(ends[band]) - WIDTH * len(text) // 2 + 2, text, 1 + (HEIGHT > 8))
    return strip
