"""Jobs on machines that do not see the batch's disk: input files travel with the job, results come back."""

import io
import shutil
import tarfile
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from toile.dressing.batch.dress_job import JobRequest
from toile.dressing.batch.job_folder import RESULTS, put_in_place, work_folder
from toile.dressing.batch.outcome import Outcome
from toile.dressing.batch.pool import Pool
from toile.dressing.batch.processes.isolated_call import Ended, Limits
from toile.dressing.body.posing.posed_body import moved_poses
from toile.dressing.certificate.input_files import files_of
from toile.dressing.run.garment_source import built_in_name
from toile.dressing.run.scene import AvatarFile, Garment, Scene


@dataclass(frozen=True, kw_only=True)
class Shipment:
    """A job with its input: contents of files by path, relative to a folder that the scene's paths are in."""

    work: Callable[[JobRequest], Outcome]
    request: JobRequest
    files: dict[str, bytes]


@dataclass(frozen=True, kw_only=True)
class Arrival:
    """An outcome, with the job's results as a tar archive."""

    outcome: Outcome
    archive: bytes


class ShippingPool:
    """A pool whose jobs take their input files along and send their results."""

    def __init__(self, pool: Pool) -> None:
        self._pool = pool

    @property
    def room(self) -> int:
        """Number of calls that it can take now."""
        return self._pool.room

    @property
    def unfinished(self) -> int:
        """Calls that have not ended yet."""
        return self._pool.unfinished

    @property
    def running(self) -> int:
        """Those of them that run; the others wait."""
        return self._pool.running

    def start(self, key: Any, function: Callable[[Any], Any], argument: Any, limits: Limits) -> None:
        """Send a job (`argument`) and its input."""
        shipment = shipped(function, argument)
        self._pool.start(key, work_away, shipment, limits)

    def wait(self, seconds: float) -> list[tuple[Any, Ended]]:
        """Return jobs that have ended; their results are in place."""
        return [
            (request, self._unpacked(request, ended) if ended.how == "returned" else ended)
            for request, ended in self._pool.wait(seconds)
        ]

    def withdraw(self) -> list[Any]:
        """Take back the calls that wait, and return their keys."""
        return self._pool.withdraw()

    def close(self) -> None:
        """End everything that still runs."""
        self._pool.close()

    def _unpacked(self, request: JobRequest, ended: Ended) -> Ended:
        """Put what has arrived into the batch's folder."""
        arrival: Arrival = ended.value
        box = work_folder(request.folder, request.name)
        with tarfile.open(fileobj=io.BytesIO(arrival.archive)) as archive:
            archive.extractall(box, filter="data")
        if arrival.outcome.published:
            put_in_place(request.folder, box / RESULTS / request.name, request.name, request.fingerprint)
        shutil.rmtree(box, ignore_errors=True)
        return replace(ended, value=arrival.outcome)


def shipped(work: Callable[[JobRequest], Outcome], request: JobRequest) -> Shipment:
    """Return a job with the contents of its files. A file that is missing is missing there too."""
    files: dict[str, bytes] = {}

    def pack(path: Path) -> Path:
        box = f"input{len(files)}"
        root = path.parent
        for file in files_of(path):
            if file.is_file():
                files[f"{box}/{file.relative_to(root)}"] = file.read_bytes()
        return Path(box) / path.name

    scene = request.scene
    avatar = scene.avatar
    if isinstance(avatar, AvatarFile):
        avatar = replace(avatar, path=pack(avatar.path), pose=moved_poses(avatar.pose, pack))
    measurements = scene.measurements
    if isinstance(measurements, Path):
        measurements = pack(measurements)
    garments = tuple(
        garment if _in_memory(garment) else replace(garment, source=pack(Path(str(garment.source))))
        for garment in scene.garments
    )
    packed = replace(scene, avatar=avatar, measurements=measurements, garments=garments)
    return Shipment(work=work, request=replace(request, scene=packed), files=files)


def work_away(shipment: Shipment) -> Arrival:
    """On another machine, do a job in a folder of its own and return all that it made."""
    with tempfile.TemporaryDirectory(prefix="toile-") as name:
        folder = Path(name)
        for path, content in shipment.files.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_bytes(content)
        (folder / RESULTS).mkdir()
        request = shipment.request
        request = replace(
            request,
            folder=folder,
            work=work_folder(folder, request.name),
            scene=_moved(request.scene, folder),
        )
        outcome = shipment.work(request)
        buffer = io.BytesIO()
        with tarfile.open(fileobj=buffer, mode="w") as archive:
            archive.add(folder / RESULTS, arcname=RESULTS)
        return Arrival(outcome=outcome, archive=buffer.getvalue())


def _moved(scene: Scene, folder: Path) -> Scene:
    """Return a packed scene with its files in a folder."""
    avatar = scene.avatar
    if isinstance(avatar, AvatarFile):
        avatar = replace(
            avatar, path=folder / avatar.path, pose=moved_poses(avatar.pose, lambda path: folder / path)
        )
    measurements = scene.measurements
    if isinstance(measurements, Path):
        measurements = folder / measurements
    garments = tuple(
        garment if _in_memory(garment) else replace(garment, source=folder / str(garment.source))
        for garment in scene.garments
    )
    return replace(scene, avatar=avatar, measurements=measurements, garments=garments)


def _in_memory(garment: Garment) -> bool:
    """Whether a garment needs no file."""
    return not isinstance(garment.source, str | Path) or built_in_name(garment.source) is not None
