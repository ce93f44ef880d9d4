"""Where toile keeps compiled kernels and the mannequin for later runs; loads nothing heavy."""

import os
from pathlib import Path


def cache_root() -> Path:
    """Return the folder of what toile keeps for later runs.

    It is `TOILE_CACHE_DIR`, or else `toile` in the user's folder for caches.
    """
    base = os.environ.get("TOILE_CACHE_DIR")
    return Path(base) if base else Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "toile"
