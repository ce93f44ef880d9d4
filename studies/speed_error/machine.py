"""Description of the machine that measured."""

import os
import platform
from pathlib import Path


def machine() -> dict[str, str]:
    """Return processor, its cores, and the operating system."""
    return {"processor": _processor(), "cores": str(os.cpu_count() or 1), "system": platform.system()}


def _processor() -> str:
    """Return the name of the processor, where the system tells."""
    facts = Path("/proc/cpuinfo")
    lines = facts.read_text().splitlines() if facts.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
