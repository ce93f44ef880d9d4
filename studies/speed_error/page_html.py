"""The report as one self-contained HTML file; its pictures are SVG with points that name themselves."""

from html import escape

from toile.studies.speed_error.page_markdown import (
    BLENDER,
    INTRODUCTION,
    TITLE,
    bar_text,
    cells,
    columns,
    front_text,
    measured_on,
    said_error,
)
from toile.studies.speed_error.plot import chart_svg
from toile.studies.speed_error.point import Chart
from toile.studies.speed_error.stored import Report

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body {{ font: 15px/1.5 sans-serif; color: #23272e; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }}
svg {{ max-width: 100%; height: auto; }}
table {{ border-collapse: collapse; font-size: 13px; }}
th, td {{ padding: .15rem .5rem; border-bottom: 1px solid #dcdad4; text-align: right; white-space: nowrap; }}
th:nth-child(-n+2), td:nth-child(-n+2) {{ text-align: left; }}
details {{ overflow-x: auto; }}
.missed {{ color: #b3261e; font-weight: bold; }}
</style></head>
<body><h1>{title}</h1><p><code>{command}</code>: {measured}.</p>{introduction}
{sections}
</body></html>
"""


def html_page(report: Report, command: str) -> str:
    """Return the page."""
    return PAGE.format(
        title=TITLE,
        command=escape(command),
        measured=escape(measured_on(report)),
        introduction="".join(f"<p>{_marked(text)}</p>" for text in (INTRODUCTION, BLENDER)),
        sections="\n".join(_section(chart) for chart in report.charts),
    )


def _section(chart: Chart) -> str:
    """Return heading, picture, bars, front and table of a chart."""
    bars = "".join(
        f'<li class="{"met" if bar.met else "missed"}">{escape(bar_text(bar).replace("**", ""))}</li>'
        for bar in chart.bars
    )
    head = "".join(f"<th>{escape(name)}</th>" for name in columns(chart))
    rows = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells(chart, point)) + "</tr>"
        for point in chart.points
    )
    return (
        f"<section><h2>{escape(chart.scene)}: {escape(chart.title)}</h2>"
        f"<p>{escape(said_error(chart))}</p>"
        f"{chart_svg(chart)}"
        + (f"<ul>{bars}</ul>" if bars else "")
        + f"<p>Pareto front: {escape(front_text(chart))}.</p>"
        f"<details><summary>All points</summary><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{rows}</tbody></table></details></section>"
    )


def _marked(text: str) -> str:
    """Return a paragraph of Markdown with its code as HTML."""
    pieces = escape(text.strip()).split("`")
    return "".join(f"<code>{piece}</code>" if k % 2 else piece for k, piece in enumerate(pieces))
