"""The command `toile view`."""

import argparse
from pathlib import Path

from toile.dressing.cli.parser import DONE, Commands, Parser
from toile.geometry.errors import InputError


def add_view(commands: "Commands[Parser]") -> None:
    """Add the view command."""
    view = commands.add_parser(
        "view",
        help="show a result in the browser, with its film",
        description="Write view.html into the folder of a result, with the frames of its film where it has "
        "any, and open it. The page needs no server and no network.",
    )
    view.add_argument("folder", type=Path, metavar="OUT", help="folder that toile dress wrote")
    view.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="write this page instead of OUT/view.html"
    )
    view.add_argument("--every", type=int, default=1, metavar="N", help="take every Nth frame of the film")
    view.add_argument("--no-open", action="store_true", help="only write the page")
    view.set_defaults(run=_run_view)


def _run_view(options: argparse.Namespace) -> int:
    """Write the page, and open it."""
    import webbrowser

    from toile.dressing.files.writers.atomic import writable_folder, write_atomic
    from toile.dressing.view.result_folder import folder_page

    if options.every < 1:
        raise InputError(f"--every must be at least 1, got {options.every}", field="--every")
    page = folder_page(options.folder, options.every)
    path: Path = options.output or options.folder / "view.html"
    writable_folder(path.absolute().parent)
    write_atomic(path, page.encode())
    print(f"wrote {path}: {len(page) / 1e6:.1f} MB")
    if not options.no_open:
        webbrowser.open(path.absolute().as_uri())
    return DONE
