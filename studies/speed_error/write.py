"""The report's files: JSON, Markdown with its pictures, and HTML."""

from pathlib import Path

from toile.dressing.files.writers.atomic import write_atomic
from toile.studies.speed_error.page_html import html_page
from toile.studies.speed_error.page_markdown import markdown_page, picture_name
from toile.studies.speed_error.plot import chart_svg
from toile.studies.speed_error.stored import Report, write_report

NAME = "speed_error"


def write_pages(folder: Path, report: Report, command: str) -> None:
    """Write speed_error.json, .md and .html and a picture per chart into a folder that can be written."""
    write_report(folder / f"{NAME}.json", report)
    for chart in report.charts:
        write_atomic(folder / picture_name(chart), chart_svg(chart).encode())
    write_atomic(folder / f"{NAME}.md", markdown_page(report, command).encode())
    write_atomic(folder / f"{NAME}.html", html_page(report, command).encode())
