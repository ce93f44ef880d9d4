"""The engine's process: starting, listening, stopping. Knows nothing of Blender's data."""

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy

import toile
from toile.blender_addon.problem import Problem

BOOT = (
    "import sys; sys.path[:0] = sys.argv.pop(1).split(chr(10)); sys.path.append(sys.argv.pop(1)); "
    "from toile.blender_addon.engine_side.worker import main; sys.exit(main(sys.argv[1:]))"
)


class EngineProcess:
    """A run of `toile.blender_addon.engine_side.worker`; `paths` lead its imports beside toile's own.

    Blender's numpy is found last: where an environment has its own, that one belongs to its scipy.
    """

    def __init__(self, task: str, folder: Path, paths: list[str], environment: dict[str, str]) -> None:
        own, numpy_folder = (str(Path(module.__file__ or "").parents[1]) for module in (toile, numpy))
        self._errors = (folder / "errors.txt").open("wb")
        self._process = subprocess.Popen(
            [sys.executable, "-I", "-c", BOOT, "\n".join([own, *paths]), numpy_folder, task, str(folder)],
            stdout=subprocess.PIPE, stderr=self._errors, stdin=subprocess.DEVNULL,
            env=os.environ | environment,
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )  # fmt: skip
        self._lines: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        # It only moves bytes; Blender's data belong to the main thread.
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._lines.put(line)
        self._lines.put(None)

    def messages(self) -> Iterator[dict[str, Any] | None]:
        """Yield what the engine says, None whenever it has said nothing; raise Problem where it fails."""
        spoken = False
        while True:
            try:
                line = self._lines.get_nowait()
            except queue.Empty:
                yield None
                continue
            if line is None:
                break
            message: dict[str, Any] = json.loads(line)
            if "error" in message:
                raise Problem(message["error"], message.get("garment", ""), tuple(message.get("faces", ())))
            spoken = spoken or "done" in message
            yield message
        if not spoken:
            raise Problem(f"the engine ended unexpectedly: {self._last_error() or 'no reason given'}")

    def _last_error(self) -> str:
        self._process.wait()
        text = Path(self._errors.name).read_text(errors="replace").strip()
        return text.splitlines()[-1] if text else f"exit code {self._process.returncode}"

    def is_stopped(self) -> bool:
        """Ask the engine to stop; return whether it has."""
        if self._process.poll() is None:
            self._process.kill()
        return self._process.poll() is not None

    def end(self) -> None:
        """Stop the engine if it still runs; frames on disk are whole."""
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        self._errors.close()
