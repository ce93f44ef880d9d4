"""A server on this machine that shows live cloth in the browser and takes what is done to it.

One thread steps; one thread per page passes its wishes on, and one sends it frames. A page says when it has
drawn a frame; until then it gets one more at most, so that a page that lags drops frames and nothing queues.
"""

import http
import json
import logging
import secrets
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Generic, TypeVar

from toile.dressing.live.played import Played
from toile.engine.live.live_cloth import STEP
from toile.geometry.errors import InputError

HOST = "127.0.0.1"
ON_THE_WAY = 2
"""Frames that a page may have outstanding."""
JOIN = "join"
"""What a page asks for when it comes."""
STATE_EVERY = 0.25
"""Time between two messages about the state [s]."""

QUIET = logging.getLogger("toile.live")
"""Browsers open connections that they never use: that is no news."""
QUIET.setLevel(logging.CRITICAL + 1)

P = TypeVar("P", bound=Played)


class Page:
    """A page that is connected: what it still has to draw, and whether it needs the scene anew."""

    def __init__(self, socket: Any) -> None:
        self.socket = socket
        self.outstanding = 0
        self.wake = threading.Event()
        self.frame: bytes | None = None
        self.texts: deque[str] = deque(maxlen=50)


class LiveServer(Generic[P]):
    """Serves what is played at `url` until `stop`.

    Raises InputError where the port is in use or the extra `live` is missing.
    """

    def __init__(self, game: P, port: int = 0, language: str = "en", folder: Path = Path()) -> None:
        try:
            from websockets.sync.server import serve
        except ImportError:
            raise InputError("toile live needs websockets: pip install 'toile[live]'") from None
        self.game = game
        self.language = language
        self.folder = folder
        self.token = secrets.token_urlsafe(12)
        self.pages: list[Page] = []
        self.wishes: deque[tuple[Page, dict[str, Any]]] = deque()
        self.steps_per_second = 0.0
        self._stopped = threading.Event()
        self._lock = threading.Lock()
        try:
            bound = socket.create_server((HOST, port))
        except OSError as error:
            raise InputError(
                f"--port {port}: cannot listen there ({error.strerror}); choose another"
            ) from None
        self.port = bound.getsockname()[1]
        own = f"http://{HOST}:{self.port}"
        self.url = f"{own}/{self.token}/"
        self._server = serve(
            self._converse, sock=bound, process_request=self._answer, origins=[own], compression=None,
            max_size=65536, logger=QUIET,
        )  # fmt: skip

    # Threads.

    def run(self, on_page: Callable[[], None] | None = None) -> None:
        """Serve and step until `stop` is called."""
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        if on_page is not None:
            on_page()
        try:
            self._loop()
        finally:
            self._server.shutdown()
            self.game.close()

    def stop(self) -> None:
        """End `run`."""
        self._stopped.set()

    def _loop(self) -> None:
        """Carry out wishes, step, and offer frames; as fast as cloth moves, and no faster."""
        told, counted, steps = time.perf_counter(), time.perf_counter(), 0
        due = time.perf_counter()
        while not self._stopped.is_set():
            self._carry_out_wishes()
            game = self.game
            if self.pages and (game.running or game.single):
                game.single = max(0, game.single - 1)
                game.advance()
                steps += 1
                self._offer_frame()
            now = time.perf_counter()
            if now - told >= STATE_EVERY:
                self.steps_per_second, steps, counted, told = steps / (now - counted), 0, now, now
                self._tell_all(self._state())
            # Behind the clock it goes slower; it does not run to catch up.
            due = max(due + STEP, now - STEP)
            if due > now:
                self._stopped.wait(due - now)

    def _carry_out_wishes(self) -> None:
        while self.wishes:
            page, wish = self.wishes.popleft()
            if wish.get("do") == "stop":
                self.stop()
                continue
            if wish.get("do") == JOIN:
                page.texts += [json.dumps(self._scene()), json.dumps(self._state())]
                page.frame = self.game.frame()
                page.wake.set()
                continue
            try:
                if wish.get("do") == "save":
                    paths = self.game.save(self.folder)
                    page.texts.append(json.dumps({"say": ", ".join(map(str, paths))}))
                    page.wake.set()
                elif self.game.carry_out(wish):
                    self._tell_all(self._scene())
                    self._offer_frame()
            except InputError as error:
                page.texts.append(json.dumps({"say": str(error)}))
                page.wake.set()

    def _offer_frame(self) -> None:
        """Give every page the frame to send next; one that it has not sent yet is dropped."""
        frame = self.game.frame()
        for page in list(self.pages):
            page.frame = frame
            page.wake.set()

    def _tell_all(self, message: Mapping[str, Any]) -> None:
        text = json.dumps(message)
        for page in list(self.pages):
            page.texts.append(text)
            page.wake.set()

    # Connections.

    def _answer(self, connection: Any, request: Any) -> Any:
        """Answer a request: the page, or None for what talks on."""
        path = request.path.split("?")[0]
        if path == f"/{self.token}/talk":
            return None
        if path != f"/{self.token}/":
            return connection.respond(
                http.HTTPStatus.NOT_FOUND, "Open the address that toile live printed.\n"
            )
        response = connection.respond(http.HTTPStatus.OK, self.game.page(self.language))
        del response.headers["Content-Type"]
        response.headers["Content-Type"] = "text/html; charset=utf-8"
        response.headers["Cache-Control"] = "no-store"
        return response

    def _converse(self, connection: Any) -> None:
        """Talk with a page until it goes."""
        from websockets.exceptions import ConnectionClosed

        page = Page(connection)
        with self._lock:
            self.pages.append(page)
        # Only the thread that steps looks at the cloth.
        self.wishes.append((page, {"do": JOIN}))
        sender = threading.Thread(target=self._send, args=(page,), daemon=True)
        sender.start()
        try:
            for message in connection:
                if message == "drawn":
                    page.outstanding = max(0, page.outstanding - 1)
                    page.wake.set()
                    continue
                self.wishes.append((page, _wish(message)))
        except (ConnectionClosed, InputError):
            pass
        finally:
            with self._lock:
                self.pages.remove(page)
            if not self.pages:
                self.wishes.append((page, {"do": "release"}))
            page.wake.set()

    def _send(self, page: Page) -> None:
        """Send a page what is there for it, until it goes."""
        from websockets.exceptions import ConnectionClosed

        try:
            while page in self.pages and not self._stopped.is_set():
                page.wake.wait(1.0)
                page.wake.clear()
                while page.texts:
                    page.socket.send(page.texts.popleft())
                if page.frame is not None and page.outstanding < ON_THE_WAY:
                    frame, page.frame = page.frame, None
                    page.outstanding += 1
                    page.socket.send(frame)
        except (ConnectionClosed, OSError):
            return

    # What is sent.

    def _scene(self) -> dict[str, Any]:
        """Return what a page needs to draw frames."""
        return {"scene": self.game.scene()}

    def _state(self) -> dict[str, Any]:
        """Return what the page shows as numbers."""
        mine = {
            "rate": round(self.steps_per_second, 1), "pages": len(self.pages), "running": self.game.running
        }  # fmt: skip
        return {"state": self.game.state() | mine}


def _wish(message: str | bytes) -> dict[str, Any]:
    """Return what a page asks for; nothing where it is no JSON object."""
    try:
        wish = json.loads(message)
    except ValueError:
        return {"do": "?"}
    return wish if isinstance(wish, dict) else {"do": "?"}
