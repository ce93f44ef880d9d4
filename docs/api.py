"""Builds the API reference from docstrings: python docs/api.py [FOLDER], by default build/api.

It holds the public names of `toile` and the modules of the engine.
"""

import sys
from pathlib import Path

import pdoc

import toile

ROOT = Path(__file__).resolve().parents[1]
ONLY_ENGINE = r"!toile\.(?!engine(\.|$))"
"""What pdoc leaves out: every module below toile but the engine's."""


def build(folder: Path) -> None:
    """Write the pages into a folder; index.html leads to toile.html."""
    for name in toile.__all__:
        # pdoc sees only names that are loaded.
        getattr(toile, name)
    pdoc.render.configure(docformat="numpy", footer_text=f"toile {toile.__version__}", show_source=False)
    pdoc.pdoc("toile", "toile.engine", ONLY_ENGINE, output_directory=folder)


if __name__ == "__main__":
    build(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build" / "api")
