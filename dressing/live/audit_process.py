"""An audit in a process of its own: an audit of 2,601 nodes takes longer than three steps."""

import pickle
import subprocess
import sys
from threading import Thread
from typing import NamedTuple

from toile.dressing.run.kernels import module_path_environment
from toile.geometry.arrays import Float, Int

WORKER = "from toile.dressing.live.audit_worker import main; main()"


class Audited(NamedTuple):
    """Crossing pairs of triangles after a step: with obstacles, and within the cloth."""

    step: int
    body: int
    cloth: int


class AuditProcess:
    """Audits one state at a time; what comes while it is busy is left out.

    Attributes
    ----------
    last
        The last audit, or None.
    worst
        Most crossings in one audit.
    """

    def __init__(self) -> None:
        self.last: Audited | None = None
        self.worst = 0
        self.audits = 0
        self._busy = True
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", WORKER], env=module_path_environment(), stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )  # fmt: skip
        Thread(target=self._listen, daemon=True).start()

    def offer(
        self, step: int, x: Float, faces: Int, weld: Int, body: tuple[Float | None, Int | None]
    ) -> bool:
        """Audit the state after a step, unless it is busy; return whether it took it.

        `x` are nodes [m], shape (n, 3), `faces` triangles, (t, 3), `weld` as in `Auditor.audit`, `body`
        vertices and faces of the obstacles, or None and None.
        """
        if self._busy or self._process.stdin is None or self._process.poll() is not None:
            return False
        self._busy = True
        try:
            pickle.dump((step, x, faces, weld, body), self._process.stdin, protocol=5)
            self._process.stdin.flush()
        except (BrokenPipeError, ValueError):
            return False
        return True

    def close(self) -> None:
        """End the process."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        try:
            self._process.wait(5.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()

    def _listen(self) -> None:
        """Take what the process says."""
        assert self._process.stdout is not None
        try:
            for line in self._process.stdout:
                words = line.split()
                if len(words) == 3:
                    self.last = Audited(*map(int, words))
                    self.audits += 1
                    self.worst = max(self.worst, self.last.body + self.last.cloth)
                self._busy = False
        except ValueError:
            # The pipe was closed by this side.
            return
