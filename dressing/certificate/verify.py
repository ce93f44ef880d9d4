"""Checks a result against its certificate, from the files alone."""

import json
from pathlib import Path
from typing import Any

from toile.dressing.certificate.certificate import FORM, NAME, crossings_of, seal_of
from toile.dressing.certificate.input_files import sha256_of
from toile.geometry.errors import InputError

KEYS = {"certificate", "versions", "inputs", "settings", "status", "residual_m", "shapes", "outputs", "seal"}


def read_certificate(folder: Path) -> dict[str, Any]:
    """Return the certificate of a result. Raises InputError if there is none that can be read."""
    path = folder / NAME
    try:
        certificate = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(
            f"{path}: there is no certificate; make results with toile dress --certificate", file=path
        ) from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a certificate ({error})", file=path) from None
    if not isinstance(certificate, dict) or certificate.keys() != KEYS:
        raise InputError(f"{path}: is no certificate of toile", file=path)
    if certificate["certificate"] != FORM:
        raise InputError(f"{path}: has another form than this version of toile reads", file=path)
    return certificate


def verify(folder: Path) -> list[str]:
    """Return what is wrong with a result, a sentence each; nothing if all of it is as it was certified.

    The certificate's own seal, then every output by its hash, then, where these are whole, all triangles of
    every shape by the audit. Raises InputError if there is no certificate.
    """
    certificate = read_certificate(folder)
    if certificate["seal"] != seal_of(certificate):
        return [f"{NAME}: was changed after it was sealed"]
    wrong = []
    for name, digest in certificate["outputs"].items():
        try:
            if sha256_of(folder / name) != digest:
                wrong.append(f"{name}: is not what was written")
        except FileNotFoundError:
            wrong.append(f"{name}: is missing")
        except OSError as error:
            wrong.append(f"{name}: cannot be read ({error.strerror})")
    return wrong or [text for shape in certificate["shapes"] for text in _shape_faults(folder, shape)]


def _shape_faults(folder: Path, shape: dict[str, Any]) -> list[str]:
    """Return what the audit finds in a shape that its certificate does not say."""
    found = crossings_of(folder, shape)
    return [
        f"{shape['body']}: {found[kind]} pairs of triangles of the cloth cross {other}, certified are {count}"
        for kind, other, count in (
            ("body", "the body", shape["crossings"]["body"]), ("cloth", "cloth", shape["crossings"]["cloth"])
        )
        if found[kind] != count
    ]  # fmt: skip
