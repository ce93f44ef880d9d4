"""The command `toile`. Only the standard library is imported here, so that help and errors are immediate."""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.cli.batch import add_batch
from toile.dressing.cli.bench import add_bench, add_stress
from toile.dressing.cli.fabric import add_fabric
from toile.dressing.cli.fit import add_fit
from toile.dressing.cli.live import add_live
from toile.dressing.cli.measure import add_measure
from toile.dressing.cli.parser import (
    BAD_INPUT,
    CANCELLED,
    DONE,
    FAILED,
    FELL_OFF,
    OVERSTRETCHED,
    Commands,
    Parser,
    add_posing,
    add_reading,
    body_length,
    reading_of,
)
from toile.dressing.cli.pattern import add_pattern, add_pattern_options
from toile.dressing.cli.scene_of_options import scene_of
from toile.dressing.cli.validate import add_validate
from toile.dressing.cli.verify import add_verify
from toile.dressing.cli.view import add_view
from toile.dressing.cli.yarns import add_yarns
from toile.geometry.cache_folder import cache_root
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.dressing.run.progress import ProgressState

FAILURE_EXIT_CODES = {"fell_off": FELL_OFF, "overstretched": OVERSTRETCHED}
"""Exit codes of failures with one of their own; all others have that of a failed simulation."""
EXIT_CODES = {"converged": DONE, "frame_limit": DONE, "failed": FAILED, "cancelled": CANCELLED}
EXAMPLES = """\
examples:
  toile dress --garment tshirt -o out
  toile dress --avatar body.obj --garment shirt_specification.json --fabric denim-12oz -o out
  toile dress scene.toml -o out
  toile batch --avatars 'bodies/*.obj' --garments tshirt trousers --job-timeout 600 -o out
  toile mannequin --height 182 --chest 104 -o body.glb

exit codes: 0 converged or frame limit reached, 2 bad input, 3 simulation failed or disk full,
4 the garment fell off, 5 cloth grew beyond reason, 130 cancelled"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    try:
        options = command_parser().parse_args(arguments)
    except SystemExit as done:
        return int(done.code or 0) if not isinstance(done.code, str) else BAD_INPUT
    try:
        code: int = options.run(options)
        return code
    except InputError as error:
        print(f"toile: {' '.join(str(error).split())}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("toile: cancelled", file=sys.stderr)
        return CANCELLED
    except BrokenPipeError:
        # The reader of our output has closed it, as in `toile fabrics | head`.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except Exception as error:
        if os.environ.get("TOILE_TRACEBACK"):
            raise
        if isinstance(error, OSError):
            print(f"toile: {_unwritten(error)}", file=sys.stderr)
            return FAILED
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        print(
            f"toile: the simulation failed unexpectedly ({reason}); this is a bug in toile, "
            "please report it with the output of TOILE_TRACEBACK=1 toile ...",
            file=sys.stderr,
        )
        return FAILED


def _unwritten(error: OSError) -> str:
    """Say in a line which file could not be written or read, and what to do."""
    from toile.dressing.batch.failure_classes import disk_is_full

    file = error.filename or "a file"
    reason = error.strerror or type(error).__name__
    if disk_is_full(error):
        return (
            f"{file}: the disk is full ({reason}); make room and run it again, a run that had begun with "
            "toile dress --resume OUTDIR"
        )
    return f"{file}: cannot be read or written ({reason}); check its folder, rights and disk"


def command_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands; the attribute `run` of its result runs the command."""
    parser = Parser(
        prog="toile",
        description="Puts garments on bodies: sewing pattern in, penetration-free drape out.",
        epilog=f"{EXAMPLES}\n\ncompiled kernels are kept in {cache_root()} (TOILE_CACHE_DIR)",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="store_true", help="print the version and exit")
    parser.set_defaults(run=lambda options: _print_version() if options.version else _print_help(parser))
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", parser_class=Parser)
    _add_dress(commands)

    mannequin = commands.add_parser("mannequin", help="write the built-in mannequin to a file")
    mannequin.add_argument("-o", "--output", type=Path, required=True, help=".obj, .ply, .stl or .glb file")
    for size in ("height", "chest", "waist", "hip"):
        mannequin.add_argument(
            f"--{size}", type=body_length, metavar="LENGTH", help=f"{size}: 175 or 175cm, 1.75 or 1.75m"
        )
    mannequin.set_defaults(run=_run_mannequin)

    fabrics = commands.add_parser("fabrics", help="list the fabric presets")
    fabrics.set_defaults(run=_run_fabrics)

    patterns = commands.add_parser("patterns", help="list or write the built-in patterns")
    patterns.add_argument("--write", type=Path, metavar="DIR", help="write NAME_specification.json files")
    patterns.add_argument("--avatar", type=Path, metavar="BODY", help="body to draft the patterns to")
    add_reading(patterns)
    _add_measurements(patterns)
    patterns.set_defaults(run=_run_patterns)

    add_fabric(commands)
    add_yarns(commands)
    add_measure(commands)
    add_fit(commands)
    add_verify(commands)
    add_pattern(commands)
    add_view(commands)
    add_live(commands)
    add_batch(commands)
    add_bench(commands)
    add_stress(commands)
    add_validate(commands)
    return parser


def _add_dress(commands: "Commands[Parser]") -> None:
    """Add the dress command."""
    dress = commands.add_parser(
        "dress",
        help="drape garments on a body",
        description="Drape garments on a body and write dressed.glb, preview.png, view.html, report.json "
        "and a PLY and OBJ per garment.",
    )
    dress.add_argument("scene", nargs="?", type=Path, metavar="SCENE.toml", help="scene file")
    dress.add_argument(
        "--avatar",
        type=Path,
        metavar="BODY",
        help="body: .obj .ply .stl .glb .vrm .usd .vtu .vtk .xdmf .inp or .msh, or one that moves: an .npz, "
        "an animated .glb, .gltf or .usd, or a folder with a mesh per frame (default: built-in mannequin)",
    )
    add_reading(dress)
    add_posing(dress)
    _add_measurements(dress)
    dress.add_argument(
        "--obstacle", type=Path, action="append", metavar="FILE",
        help="a solid beside BODY, such as furniture, in its units and axes; repeat for more",
    )  # fmt: skip
    dress.add_argument(
        "--garment", action="append", default=[], metavar="FILE|NAME",
        help="GarmentCode .json, DXF or FreeSewing .svg pattern, "
        "mesh (.obj .ply .glb .vtu .vtk .xdmf .inp .msh) or built-in name; repeat "
        "from the body outwards",
    )  # fmt: skip
    add_pattern_options(dress)
    dress.add_argument("--fabric", metavar="NAME", help="fabric preset (see: toile fabrics)")
    dress.add_argument("--quality", metavar="WORD", help="preview, standard (default) or accurate")
    dress.add_argument("--edge-length", type=float, metavar="M", help="edge length of the triangles [m]")
    dress.add_argument(
        "--remesh", action=argparse.BooleanOptionalAction,
        help="adapt the mesh to the folds (default), or keep it as it is",
    )  # fmt: skip
    dress.add_argument(
        "--ground", action=argparse.BooleanOptionalAction,
        help="a floor under the feet of a body that stands (default), or none",
    )  # fmt: skip
    dress.add_argument(
        "--wind", type=float, nargs=3, metavar=("X", "Y", "Z"),
        help="wind [m/s], Y up, on garments that follow a moving BODY; 0 0 0 is still air",
    )  # fmt: skip
    dress.add_argument(
        "--format",
        action="append",
        metavar="WORD",
        dest="formats",
        help="write garments in this format too, with panels, pattern coordinates and strain: vtu, vtk, "
        "xdmf, msh (Gmsh) or inp (Abaqus); films too as glb (one animated file) or mdd; repeat for more",
    )
    dress.add_argument(
        "--fit", action="store_true",
        help="write how garments fit: fit.json, fit.png and meshes with pressure, strain, tension and ease",
    )  # fmt: skip
    dress.add_argument(
        "--check", action="store_true",
        help="--fit with error bars: the garments are draped once more on another mesh",
    )  # fmt: skip
    dress.add_argument(
        "--certificate", action="store_true", default=None,
        help="write certificate.json, by which toile verify checks the result again",
    )  # fmt: skip
    dress.add_argument(
        "--threads", type=int, metavar="N",
        help="threads that share the work, with the same result (default: 2 where there are two cores)",
    )  # fmt: skip
    dress.add_argument("--max-frames", type=int, metavar="N", help="stop after N frames")
    dress.add_argument("--quiet", action="store_true", help="print nothing but errors")
    dress.add_argument("-o", "--output", type=Path, metavar="OUTDIR", help="output folder")
    dress.add_argument(
        "--resume", type=Path, metavar="OUTDIR", help="resume the interrupted run in this folder"
    )
    dress.epilog = "A scene file offers these options and more; toile dress --scene-keys lists its keys."
    dress.add_argument("--scene-keys", action=_PrintSceneKeys, help="list the keys of a scene file and exit")
    dress.set_defaults(run=_run_dress)


def _add_measurements(command: Parser) -> None:
    """Add the option that gives measurements by hand."""
    command.add_argument(
        "--measurements", type=Path, metavar="FILE",
        help="measurements of BODY instead of those toile takes, TOML or JSON: chest = 96 [cm] ..., named as "
        "toile measure --json does",
    )  # fmt: skip


class _PrintSceneKeys(argparse.Action):
    """Prints the keys of a scene file."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str | None = None) -> None:
        super().__init__(option_strings, dest, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print and exit."""
        from toile.dressing.run.scene_file import scene_keys_help

        print(scene_keys_help())
        parser.exit(DONE)


def _run_dress(options: argparse.Namespace) -> int:
    """Dress and return the exit code."""
    from toile.dressing.run.dress import dress, resume
    from toile.dressing.run.interrupt import CancelOnInterrupt
    from toile.dressing.run.progress import ProgressPrinter
    from toile.geometry.threads.crew import threads_for_one

    if (options.output is None) == (options.resume is None):
        raise InputError(
            "give an output folder with -o OUTDIR, or --resume OUTDIR to resume a run", field="--output"
        )
    folder = options.output or options.resume
    scene = None if options.resume else scene_of(options)
    say = None if options.quiet else _say
    printer = ProgressPrinter(sys.stderr, quiet=options.quiet)
    with CancelOnInterrupt() as interrupt:

        def on_frame(state: "ProgressState") -> bool:
            printer(state)
            return not interrupt.requested

        try:
            if scene is None:
                result = resume(
                    folder, on_frame, say, threads_for_one() if options.threads is None else options.threads
                )
            else:
                result = dress(scene, folder, on_frame, say)
        finally:
            printer.close()
    report = result.report
    if result.status == "failed":
        failure = report["failure"] or {"message": "no reason given", "where": ""}
        where = f" ({failure['where']})" if failure["where"] else ""
        print(
            f"toile: the simulation failed: {failure['message']}{where}; what was computed is in {folder}",
            file=sys.stderr,
        )
    elif not options.quiet:
        print(_summary(report, folder))
    if result.failure is not None:
        return FAILURE_EXIT_CODES.get(result.failure.kind, EXIT_CODES[result.status])
    return EXIT_CODES[result.status]


def _say(text: str) -> None:
    """Print what the program noticed."""
    print(text, flush=True)


def _summary(report: dict[str, object], folder: Path) -> str:
    """Return the last line that a user sees."""
    from typing import Any, cast

    facts = cast("dict[str, Any]", report)
    crossings = facts["intersections"]
    animation = facts.get("animation")
    motion = (
        ""
        if animation is None
        else f"; then {animation['frames']} frames of motion, "
        f"{animation['intersections_max']} intersections at most"
    )
    gap = "" if facts["min_gap_mm"] is None else f", smallest gap {facts['min_gap_mm']:.2f} mm"
    return (
        f"{facts['status'].replace('_', ' ')} after {facts['frames']} frames, {facts['wall_seconds']:.1f} s: "
        f"{facts['faces']['final']} faces, {crossings['avatar']} body and {crossings['self']} self "
        f"intersections{gap}{motion}; written to {folder}"
    )


def _run_mannequin(options: argparse.Namespace) -> int:
    """Write the mannequin."""
    from toile.dressing.body.write_body import FORMATS, body_bytes
    from toile.dressing.files.writers.atomic import writable_folder, write_atomic

    output: Path = options.output
    if output.suffix.lower() not in FORMATS:
        raise InputError(
            f"{output}: unknown format '{output.suffix}'; use one of {', '.join(FORMATS)}", file=output
        )
    from toile.dressing.body.mannequin import mannequin

    sizes = {
        size: value
        for size in ("height", "chest", "waist", "hip")
        if (value := getattr(options, size)) is not None
    }
    body = mannequin(**sizes)
    writable_folder(output.parent)
    write_atomic(output, body_bytes(body, output.suffix.lower()))
    print(f"wrote {output}: {len(body.vertices)} vertices, {len(body.faces)} faces, metres, Y up")
    return DONE


def _run_fabrics(options: argparse.Namespace) -> int:
    """Print the presets."""
    from toile.dressing.garment.fabrics import fabric_table

    print(fabric_table())
    return DONE


def _run_patterns(options: argparse.Namespace) -> int:
    """List or write the built-in patterns."""
    from toile.dressing.pattern.drafts import built_in, built_in_names

    if options.write is None:
        if options.avatar is not None:
            raise InputError("--avatar drafts patterns to a body, which needs --write DIR", field="--write")
        print("\n".join(built_in_names()))
        return DONE
    from toile.dressing.files.writers.atomic import writable_folder
    from toile.dressing.pattern.garmentcode_write import write_garmentcode
    from toile.dressing.run.scene import AvatarFile, MannequinSize
    from toile.dressing.run.scene_avatar import load_dress_form

    folder = writable_folder(options.write)
    reading = reading_of(options)
    source = MannequinSize() if options.avatar is None else AvatarFile(path=options.avatar, **reading)
    _, form = load_dress_form(source, options.measurements or {})
    for name in built_in_names():
        path = folder / f"{name}_specification.json"
        write_garmentcode(built_in(name, form.measurements), path)
        print(f"wrote {path}")
    return DONE


def _print_version() -> int:
    """Print the version."""
    from importlib.metadata import version

    print(f"toile {version('toile')}")
    return DONE


def _print_help(parser: argparse.ArgumentParser) -> int:
    """Print the help, as asked for by giving no command."""
    parser.print_help()
    return DONE


if __name__ == "__main__":
    sys.exit(main())
