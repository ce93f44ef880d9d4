"""What the engine says in the words of the Blender scene: its axes, the names of its objects."""

import os
import re
from pathlib import Path
from typing import Any

import numpy as np

NUMBER = r"(-?\d+(?:\.\d+)?)"
PLACE = re.compile(rf"\({NUMBER}, {NUMBER}, {NUMBER}\) m\b")
"""Coordinates [m] in a sentence of the engine."""
AXIS = re.compile(r"\balong ([xyz])\b")
PASSING = ("compiling kernels", "loading kernels", "give the other up axis", "frames at ")
"""What is in sentences that matter only while they are true, or advise what Blender has settled."""


class Wording:
    """Translates sentences about a scene folder; `job` is what its job.json holds.

    Coordinates are turned by the matrix `turn` (3, 3) of the job, which leads from Blender's axes to the
    engine's. Files become objects, numbers of pieces become materials.
    """

    def __init__(self, folder: Path, job: dict[str, Any] | None = None) -> None:
        job = job or {}
        self._folder = folder
        self._back = np.array(job.get("turn", np.eye(3)), np.float64).T
        self._garments: list[dict[str, Any]] = job.get("garments", [])
        names = job.get("avatars", [])
        self._avatar = f"'{names[0]}'" if len(names) == 1 else "the avatars"

    def __call__(self, text: str) -> str:
        """Return a sentence in Blender's words, on one line."""
        text = " ".join(text.split()).replace(f"{self._folder}{os.sep}", "")
        text = PLACE.sub(self._place, text)
        text = AXIS.sub(lambda found: f"along {self._axis(found[1])}", text)
        text = text.replace(" of its file", " of its mesh")
        text = re.sub(r"(?<![\w'-])avatar(\.ply|\.npz)?(?=: )", self._avatar, text)
        text = re.sub(r"(?<![\w-])avatar\.(ply|npz)", self._avatar, text)
        for entry in sorted(self._garments, key=lambda entry: -len(entry["stem"])):
            stem = re.escape(entry["stem"])
            text = re.sub(rf"\bgarment {stem}: (piece \d+(?:, piece \d+)*)", self._pieces(entry), text)
            text = re.sub(rf"(?:\bgarment )?'{stem}'|(?<![\w'-]){stem}\.npz", f"\0{entry['name']}\0", text)
            text = re.sub(rf"(?:\bgarment )?(?<![\w'\0-]){stem}(?=: )", f"\0{entry['name']}\0", text)
        return text.replace("\0", "'")

    def is_lasting(self, text: str) -> bool:
        """Whether a sentence is still worth reading when the run is over."""
        return not any(word in text for word in PASSING)

    def _place(self, found: re.Match[str]) -> str:
        x, y, z = self._back @ [float(part) for part in found.groups()] + 0.0
        return f"({x:.2f}, {y:.2f}, {z:.2f}) m"

    def _axis(self, axis: str) -> str:
        """Return Blender's name of an axis of the engine."""
        return "xyz"[int(np.abs(self._back[:, "xyz".index(axis)]).argmax())]

    def _pieces(self, entry: dict[str, Any]) -> Any:
        """Return what names an object, and of its materials those meant."""
        names = entry["pieces"]

        def said(found: re.Match[str]) -> str:
            chosen = [int(number) for number in re.findall(r"\d+", found[1])]
            known = [names[number] for number in chosen if number < len(names) and names[number]]
            materials = f", material {', '.join(known)}" if len(names) > 1 and known else ""
            return f"\0{entry['name']}\0{materials}"

        return said
