"""The page of live cloth, in one piece."""

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
        ("SCRIPTS", "\n".join([static("stage.js"), own("words.js"), own("live.js")])),
    ):  # fmt: skip
        page = page.replace(f"<!--{mark}-->", content).replace(f"/*{mark}*/", content)
    return page
