"""The page of live cloth, in one piece."""

import json
from pathlib import Path

from toile.dressing.garment.fabrics import fabrics
from toile.dressing.live.sheet import OBJECTS, PINS
from toile.dressing.view.view_page import static

STATIC = Path(__file__).resolve().parent / "static"


def live_page(language: str) -> str:
    """Return the page, in "en" or "es"."""

    def own(name: str) -> str:
        return (STATIC / name).read_text(encoding="utf-8")

    def options(values: "tuple[str, ...] | list[str]") -> str:
        return "".join(f"<option>{value}</option>" for value in values)

    page = own("live.html").replace("LANGUAGE", language)
    for mark, content in (
        ("FABRICS", options(list(fabrics()))), ("PINS", options(PINS)), ("OBJECTS", options(OBJECTS)),
        ("STYLE", static("viewer.css") + own("live.css")),
        ("SCRIPTS", "\n".join([static("stage.js"), fabric_numbers(), own("words.js"), own("live.js")])),
    ):  # fmt: skip
        page = page.replace(f"<!--{mark}-->", content).replace(f"/*{mark}*/", content)
    return page


def fabric_numbers() -> str:
    """Return what the page says of every fabric, as a script."""
    numbers = {
        name: {
            "density": round(1e3 * one.areal_density), "thickness": round(1e3 * one.thickness, 2),
            "bending": f"{1e6 * one.bending_warp:.3g} / {1e6 * one.bending_weft:.3g}",
            "stretch": f"{one.stretch_warp:.4g} / {one.stretch_weft:.4g}", "shear": round(one.shear),
        }
        for name, one in fabrics().items()
    }  # fmt: skip
    return f"const FABRICS = {json.dumps(numbers)};"
