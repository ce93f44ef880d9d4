"""Files that hold a whole film, made of its frames on disk."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from toile.dressing.files.palette import BODY, garment_colour, linear
from toile.dressing.files.writers.mdd import write_mdd
from toile.dressing.files.writers.moving_glb import MovingMesh, write_moving_glb
from toile.dressing.files.writers.ply import PlyMesh, read_own_ply
from toile.dressing.run.output.earlier_run import FILM, FRAMES, MOVING
from toile.dressing.run.result import DressedGarment, file_stem

BODY_NAME = "body"


def frame_path(frames: Path, name: str, index: int) -> Path:
    """Return the path of the mesh of that name and frame."""
    return frames / f"{file_stem(name)}.{index:04d}.ply"


def write_film(
    folder: Path, garments: tuple[DressedGarment, ...], fps: float, count: int, formats: Sequence[str]
) -> list[str]:
    """Write dressed.usdc of the `count` frames on disk, and other `formats`; return what could not be."""

    def frames(name: str) -> Iterator[PlyMesh]:
        return (read_own_ply(frame_path(folder / FRAMES, name, index)) for index in range(count))

    said = []
    names = [(BODY_NAME, linear(BODY))]
    names += [(garment.name, linear(garment_colour(index))) for index, garment in enumerate(garments)]
    try:
        from toile.dressing.files.writers.usd import UsdMesh, write_usd
    except ImportError:
        said.append("no dressed.usdc: USD is not installed (pip install 'toile[usd]'); frames are in frames/")
    else:
        usd = [UsdMesh(name=file_stem(name), colour=colour, frames=frames(name)) for name, colour in names]
        write_usd(folder / FILM, fps, usd)
    if "glb" in formats:
        meshes = [MovingMesh(name, colour, frames(name), name != BODY_NAME) for name, colour in names]
        if write_moving_glb(folder / MOVING, fps, meshes) is None:
            said.append(f"no {MOVING}: it would be larger than 4 GB; take fewer frames")
    if "mdd" in formats:
        for garment in garments:
            path = folder / f"{file_stem(garment.name)}.mdd"
            if write_mdd(path, fps, count, frames(garment.name)) is None:
                said.append(f"no {path.name}: its mesh changes from frame to frame; ask for remesh=False")
    return said
