"""A page of one file that shows a view."""

import json
import uuid
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from toile.dressing.view.packed import Packed
from toile.dressing.view.view_part import ViewPart

STATIC = Path(__file__).resolve().parent / "static"
SCRIPTS = ("stage.js", "pieces.js", "viewer.js")
"""Scripts of the viewer, in their order."""
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>html, body {{ margin: 0; height: 100%; }}
{style}</style></head>
<body>
{body}
<script type="text/plain" id="numbers">{numbers}</script>
<script>
{scripts}
window.viewer = new Viewer(document.querySelector("[data-view=root]"));
window.viewer.show({header}, document.getElementById("numbers").textContent);
</script>
</body></html>
"""


def packed_view(
    title: str, parts: Sequence[ViewPart], facts: Mapping[str, str], fps: float = 0.0
) -> tuple[str, str]:
    """Return a view as the page takes it: header, as JSON that a script may hold, and numbers, as text."""
    block = Packed()
    header: dict[str, Any] = {
        "title": title,
        "fps": fps,
        "facts": list(facts.items()),
        "parts": [part.packed(block) for part in parts],
    }
    # In a script "</" would end it.
    return json.dumps(header, separators=(",", ":")).replace("</", "<\\/"), block.text()


def static(name: str) -> str:
    """Return the text of a file of the viewer."""
    return (STATIC / name).read_text(encoding="utf-8")


def view_page(title: str, parts: Sequence[ViewPart], facts: Mapping[str, str], fps: float = 0.0) -> str:
    """Return a page that shows meshes, at rest or as a film of `fps` frames per second, with facts beside."""
    header, numbers = packed_view(title, parts, facts, fps)
    return PAGE.format(
        title=escape(title),
        style=static("viewer.css"),
        body=static("viewer.html"),
        scripts="\n".join(static(name) for name in SCRIPTS),
        header=header,
        numbers=numbers,
    )


def framed(page: str, height: int = 560) -> str:
    """Return a page as a part of another, as notebooks show it, `height` [pixels] high."""
    return (
        f'<iframe title="toile view {uuid.uuid5(uuid.NAMESPACE_OID, page).hex[:8]}" '
        f'style="width:100%;height:{height}px;border:1px solid #dcdfe4" srcdoc="{escape(page)}"></iframe>'
    )
