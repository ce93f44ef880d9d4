"""toile's own wheel for the extension: built of a checkout, or packed again from what is installed."""

import base64
import hashlib
import tomllib
from importlib.metadata import Distribution, distribution
from pathlib import Path
from typing import NamedTuple
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from toile.geometry.errors import InputError

ROOT = Path(__file__).resolve().parents[1]
"""The checkout, if there is one."""
NOT_PACKED = ("RECORD", "INSTALLER", "REQUESTED", "direct_url.json")
"""What an installer adds to the folder of facts about a distribution."""


class Project(NamedTuple):
    """What the extension must know about toile; `checkout` is None where it is installed from a wheel."""

    version: str
    dependencies: tuple[str, ...]
    checkout: Path | None


def project() -> Project:
    """Return the facts of the checkout, or else of the installed distribution."""
    file = ROOT / "pyproject.toml"
    if file.is_file():
        facts = tomllib.loads(file.read_text(encoding="utf-8"))["project"]
        return Project(facts["version"], tuple(facts["dependencies"]), ROOT)
    installed = distribution("toile")
    needed = [entry for entry in installed.requires or () if "extra ==" not in entry]
    return Project(installed.version, tuple(needed), None)


def packed_again(folder: Path) -> Path:
    """Pack the installed toile as a wheel into a folder; return its path.

    Raises InputError if the installation does not hold its files, as one in editable mode.
    """
    installed = distribution("toile")
    facts = f"toile-{installed.version}.dist-info"
    names = sorted(str(file) for file in installed.files or () if _belongs(file.parts, facts))
    if not any(name.startswith("toile/") for name in names):
        raise InputError("toile is installed without its files: build the extension in its checkout")
    tags = [line.removeprefix("Tag: ") for line in _text(installed, "WHEEL").splitlines() if "Tag: " in line]
    wheel = folder / f"toile-{installed.version}-{tags[0]}.whl"
    record = []
    with ZipFile(wheel, "w", ZIP_DEFLATED) as archive:
        for name in names:
            data = Path(str(installed.locate_file(name))).read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{name},sha256={digest},{len(data)}")
            # A fixed date: the same installation gives the same bytes.
            archive.writestr(ZipInfo(name), data, ZIP_DEFLATED)
        archive.writestr(
            ZipInfo(f"{facts}/RECORD"), "\n".join([*record, f"{facts}/RECORD,,", ""]), ZIP_DEFLATED
        )
    return wheel


def _belongs(parts: tuple[str, ...], facts: str) -> bool:
    """Whether an installed file was in the wheel."""
    own = parts[0] == "toile" and "__pycache__" not in parts
    return own or (parts[0] == facts and parts[-1] not in NOT_PACKED)


def _text(installed: Distribution, name: str) -> str:
    """Return a file of facts about a distribution."""
    text = installed.read_text(name)
    if text is None:
        raise InputError(f"toile is installed without its {name}: install it again, or use its checkout")
    return text
