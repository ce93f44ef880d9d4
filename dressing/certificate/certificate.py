"""certificate.json: hashes of inputs and outputs, settings, and the audit of every shape that was written."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from toile.collide.audit import Auditor
from toile.dressing.certificate.input_files import files_of, paths_in, plain_data, sha256_of
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.files.writers.ply import read_own_ply

NAME = "certificate.json"
FORM = 1
"""Number of the form of certificates."""
WHOLE = (
    "dressed.glb", "preview.png", "report.json", "dressed.usdc", "fit.json", "fit.png", "body.ply",
    "view.html",
)  # fmt: skip
FOLDERS = ("frames", "fit")
"""Files of a result beside those of its garments, and folders of which all files are."""
UNREADABLE = "unreadable"


class CertifiedGarment(NamedTuple):
    """Stem of a garment's files, and how many of its last faces are rigid trims, which nothing audits."""

    stem: str
    trim_faces: int


def write_certificate(
    folder: Path, scene: Any, report: dict[str, Any], garments: Sequence[CertifiedGarment]
) -> Path:
    """Write the certificate of a result that lies in a folder; return its path.

    Parameters
    ----------
    folder
        Where all files of the result are, report.json and body.ply included.
    scene
        The settings: dataclasses.
    report
        The report, as in report.json.
    garments
        Of the scene, in its order.
    """
    certificate: dict[str, Any] = {
        "certificate": FORM,
        "versions": report["versions"],
        "inputs": _inputs(scene),
        "settings": plain_data(scene),
        "status": report["status"],
        "residual_m": report["residual"],
        "shapes": [_audited(folder, shape) for shape in _shapes(folder, garments)],
        "outputs": {
            path.relative_to(folder).as_posix(): sha256_of(path) for path in _outputs(folder, garments)
        },
    }
    certificate["seal"] = seal_of(certificate)
    content = json.dumps(certificate, indent=1, allow_nan=False) + "\n"
    return write_atomic(folder / NAME, content.encode())


def seal_of(certificate: dict[str, Any]) -> str:
    """Return the hash of everything in a certificate but its seal."""
    rest = {key: value for key, value in certificate.items() if key != "seal"}
    return hashlib.sha256(json.dumps(rest, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def crossings_of(folder: Path, shape: dict[str, Any]) -> dict[str, int]:
    """Return how many pairs of triangles cross in the files of a shape: with the body, and of cloth."""
    body = read_own_ply(folder / shape["body"])
    positions, faces, count = [], [], 0
    for garment in shape["garments"]:
        mesh = read_own_ply(folder / garment["file"])
        cloth = mesh.faces[: len(mesh.faces) - garment["trim_faces"]]
        positions.append(mesh.positions)
        faces.append(cloth + count)
        count += len(mesh.positions)
    auditor = Auditor(body.positions, np.ascontiguousarray(body.faces, np.int32))
    found = auditor.audit(
        np.ascontiguousarray(np.concatenate(positions)),
        np.ascontiguousarray(np.concatenate(faces), np.int32),
        np.arange(count, dtype=np.int32),
    )
    return {"body": len(found.avatar), "cloth": len(found.cloth)}


def _inputs(scene: Any) -> dict[str, str]:
    """Return the hashes of the files of a scene, by their last names."""
    found: dict[str, str] = {}
    for path in paths_in(scene):
        for file in files_of(path):
            name = file.name if file.name not in found else f"{file.parent.name}/{file.name}"
            try:
                found[name] = sha256_of(file)
            except OSError:
                found[name] = UNREADABLE
    return found


def _audited(folder: Path, shape: dict[str, Any]) -> dict[str, Any]:
    return shape | {"crossings": crossings_of(folder, shape)}


def _shapes(folder: Path, garments: Sequence[CertifiedGarment]) -> list[dict[str, Any]]:
    """Return the shapes of a result: the last one, and before it the frames of a film."""
    frames = sorted((folder / "frames").glob("body.*.ply"))
    shapes = [
        _shape(f"frames/{path.name}", f"frames/{{}}.{path.name.split('.')[1]}.ply", garments)
        for path in frames
    ]
    return [*shapes, _shape("body.ply", "{}.ply", garments)]


def _shape(body: str, pattern: str, garments: Sequence[CertifiedGarment]) -> dict[str, Any]:
    return {
        "body": body,
        "garments": [
            {"file": pattern.format(garment.stem), "trim_faces": garment.trim_faces} for garment in garments
        ],
    }


def _outputs(folder: Path, garments: Sequence[CertifiedGarment]) -> list[Path]:
    """Return the files of a result that are there."""
    stems = {garment.stem for garment in garments}
    found = [folder / name for name in WHOLE if (folder / name).is_file()]
    found += [path for path in folder.iterdir() if path.is_file() and path.name.rpartition(".")[0] in stems]
    for name in FOLDERS:
        if (folder / name).is_dir():
            found += [path for path in (folder / name).iterdir() if path.is_file()]
    return sorted(set(found))
