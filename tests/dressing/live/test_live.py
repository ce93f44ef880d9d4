"""Live cloth from Python, its server and its page."""

import json
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import toile
from tests.dressing.browser import opened_page, until
from toile.dressing.cli.main import main
from toile.dressing.files.gltf.gltf_file import GltfFile
from toile.dressing.live.record import save_play
from toile.dressing.live.replay import replayed
from toile.dressing.live.server import LiveServer
from toile.dressing.live.wishes import Game
from toile.geometry.errors import InputError

SMALL = toile.Sheet(cells=10, side=0.5)


@pytest.fixture(scope="module")
def server() -> Iterator[LiveServer[Game]]:
    pytest.importorskip("websockets", reason="websockets is not installed")
    server = LiveServer(Game(SMALL))
    thread = threading.Thread(target=server.run)
    thread.start()
    yield server
    server.stop()
    thread.join(20.0)
    assert not thread.is_alive()


def talk(server: LiveServer[Game]) -> Any:
    from websockets.sync.client import connect

    own = f"http://127.0.0.1:{server.port}"
    return connect(f"ws://127.0.0.1:{server.port}/{server.token}/talk", origin=own)


def test_frames_come_and_are_audited_by_another_process() -> None:
    with toile.live(SMALL) as live:
        for frame in live:
            if frame.step >= 30 and live.audit_process is not None and live.audit_process.last:
                break
            assert frame.step < 3000, "no audit came"
        assert live.audit_process is not None and live.audit_process.last is not None
        assert live.audit_process.last.body + live.audit_process.last.cloth == 0
        assert frame.stretch < 0.02
        assert frame.positions.shape == (121, 3)


@pytest.mark.parametrize(
    ("field", "value"), [("cells", 1), ("cells", 2.5), ("pins", "nails"), ("object", "cat"), ("side", 0.0)]
)
def test_a_sheet_says_what_is_wrong_with_it(field: str, value: object) -> None:
    with pytest.raises(InputError, match=field):
        toile.Sheet(**{field: value})  # type: ignore[arg-type]


@pytest.mark.parametrize("pins", ["none", "corners", "one edge", "two edges", "four edges"])
def test_a_sheet_starts_clear_of_what_lies_below(pins: Any) -> None:
    for thing in ("ball", "table"):
        sheet = toile.Sheet(cells=6, pins=pins, object=thing)
        with toile.live(sheet) as live:
            assert live.frame.stretch < 0.01
            assert not live.audit().avatar.size


def test_a_saved_play_is_played_again_to_the_byte(tmp_path: Path) -> None:
    game = Game(SMALL)
    plan: dict[int, dict[str, Any]] = {
        3: {"do": "wind", "speed": 4.0}, 5: {"do": "grip", "node": 60},
        6: {"do": "pull", "offset": [0.1, 0.2, 0.0]},
        9: {"do": "unpin", "node": 0}, 12: {"do": "ball_moves", "on": True}, 15: {"do": "release"},
    }  # fmt: skip
    for step in range(20):
        if step in plan:
            game.carry_out(plan[step])
        game.advance()
    glb, play = save_play(game, tmp_path)
    assert [mesh["name"] for mesh in GltfFile(glb).content["meshes"]] == ["sheet", "ball"]
    again = replayed(play)
    assert again.live.frame.positions.tobytes() == game.live.frame.positions.tobytes()
    game.live.close()
    again.live.close()
    play.write_text('{"toile_live": 7}')
    with pytest.raises(InputError, match="no play that toile live saved"):
        replayed(play)


def test_a_film_is_recorded_and_pins_are_cut_one_after_another(tmp_path: Path) -> None:
    game = Game(SMALL)
    game.carry_out({"do": "record", "on": True})
    game.carry_out({"do": "move", "name": "ball", "offset": [0.0, -0.1, 0.0]})
    game.carry_out({"do": "cut", "seconds": 0.2})
    pinned = []
    for _ in range(16):
        game.advance()
        pinned.append(int(game.live.pinned.sum()))
    assert pinned[:13] == [4, 4, 4, 3, 3, 3, 2, 2, 2, 1, 1, 1, 0]
    film = GltfFile(save_play(game, tmp_path)[-1])
    (animation,) = film.content["animations"]
    assert [one["target"] for one in animation["channels"]] == [
        {"node": 0, "path": "weights"}, {"node": 1, "path": "translation"}
    ]  # fmt: skip
    assert len(film.content["meshes"][0]["primitives"][0]["targets"]) == 5, "every fourth of 16 steps"
    game.live.close()


def test_frames_carry_pressure_where_a_page_asks_for_it() -> None:
    game = Game(toile.Sheet(cells=10, side=0.5, pins="none"))
    game.carry_out({"do": "show", "values": "pressure"})
    game.carry_out({"do": "friction", "value": 0.9})
    for _ in range(90):
        game.advance()
    step, offsets, values = np.frombuffer(game.frame()[:12], "<u4")
    pressure = np.frombuffer(game.frame()[12:], "<f4")[offsets : offsets + values]
    assert (step, offsets, values) == (90, 3, 121)
    cloth = game.live.cloth
    # What lies on the ball weighs on it; it still moves, and hangs from the middle.
    weight = 9.81 * float(cloth.mass.sum())
    assert 0.5 * weight < float(pressure @ cloth.node_area) < 4.0 * weight
    assert game.live.cloth.fabrics[0].friction_self == 0.9
    game.live.close()


def test_wishes_that_make_no_sense_are_named() -> None:
    game = Game(SMALL)
    for wish, words in (
        ({"do": "fly"}, "nothing called 'fly'"), ({"do": "grip"}, "grip: KeyError"), 
        ({"do": "grip", "node": 9999}, "no node"),
        ({"do": "fabric", "name": "denim"}, "unknown fabric"), 
        ({"do": "cut", "seconds": -1}, "between 0 and 60"), ({"do": "friction", "value": 9}, "friction"),
        ({"do": "put", "name": "ball", "place": [0, 0.25, 0]}, "cut the cloth"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            game.carry_out(wish)
    assert not game.journal


def test_only_the_token_opens_the_page(server: LiveServer[Game]) -> None:
    with urllib.request.urlopen(server.url) as answer:
        assert "text/html" in answer.headers["Content-Type"]
        page = answer.read().decode()
    assert "http://" not in page.replace("http://www.w3.org", ""), "nothing from elsewhere"
    for path in ("/", "/wrong/", f"/{server.token}"):
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(f"http://127.0.0.1:{server.port}{path}")
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import connect

    address = f"ws://127.0.0.1:{server.port}/{server.token}/talk"
    with pytest.raises(InvalidStatus):
        connect(address, origin="http://elsewhere.example")


def test_a_page_that_lags_gets_fewer_frames_and_faults_are_said(server: LiveServer[Game]) -> None:
    with talk(server) as page:
        assert "scene" in json.loads(page.recv(10.0))
        assert "state" in json.loads(page.recv(10.0))
        frames = 0
        page.send(json.dumps({"do": "fabric", "name": "silk"}))
        said = ""
        end = time.monotonic() + 1.5
        while time.monotonic() < end:
            try:
                message = page.recv(0.3)
            except TimeoutError:
                continue
            if isinstance(message, bytes):
                frames += 1
            else:
                said = said or json.loads(message).get("say", "")
        assert frames == 2, "it never said that it has drawn one"
        assert "silk-charmeuse" in said
        page.send("drawn")
        until(lambda: isinstance(page.recv(5.0), bytes))
        page.send("{not json")
    until(lambda: not server.pages)
    step = server.game.live.frame.step
    time.sleep(0.3)
    assert server.game.live.frame.step <= step + 1, "without a page the cloth waits"


def test_the_cloth_is_pulled_pinned_and_paused_in_a_browser(server: LiveServer[Game]) -> None:
    with opened_page(own=f"http://127.0.0.1:{server.port}") as page:
        page.goto(server.url)
        page.wait_for_selector("[data-ready=yes]")
        live = server.game.live
        place = page.evaluate(
            "() => { const b = document.getElementById('canvas').getBoundingClientRect(), g = window.game;"
            "const p = g.stage.project([...g.cloth.positions.slice(3 * 49, 3 * 49 + 3)]);"
            "return [p[0] + b.left, p[1] + b.top]; }"
        )
        before = live.frame.positions[49].copy()
        page.mouse.move(*place)
        page.mouse.down()
        until(lambda: live.hand.holds)
        page.mouse.move(place[0], place[1] - 120, steps=5)
        until(lambda: live.frame.positions[49, 1] > before[1] + 0.03)
        assert live.frame.stretch < 0.12
        page.mouse.up()
        until(lambda: not live.hand.holds)
        page.locator("[data-set=wind]").fill("5")
        until(lambda: server.game.settings["wind"] == 5.0)
        page.select_option("[data-set=fabric]", "denim-12oz")
        until(lambda: live.cloth.fabrics[0].name == "denim-12oz")
        page.locator("[data-set=friction]").fill("0.8")
        until(lambda: live.cloth.fabrics[0].friction_body == 0.8)
        page.wait_for_function(
            "document.querySelector('[data-view=fabric]').textContent.startsWith("
            f"'{round(1e3 * live.cloth.fabrics[0].areal_density)} g/m²')"
        )
        page.check("[data-set=texture]")
        for colour, unit in (
            ("stretch", "%"),
            ("warp", "%"),
            ("weft", "%"),
            ("pressure", "Pa"),
            ("speed", "m/s"),
        ):
            page.select_option("[data-set=colour]", colour)
            page.wait_for_function(
                f"document.querySelector('[data-view=scale]').textContent.includes('{unit}')"
            )
        page.check("[data-set=floor]")
        until(lambda: live.ground is not None)
        page.wait_for_function("window.game.floor && window.game.floor.shown")
        page.click("[data-do=record]")
        until(lambda: server.game.film is not None)
        page.locator("[data-set=cut_seconds]").fill("0.5")
        page.click("text=Cut one by one")
        until(lambda: not live.pinned.any())
        until(lambda: not live.pinned.any())
        page.locator("[data-view=canvas]").focus()
        page.keyboard.press(" ")
        until(lambda: not server.game.running)
        step = live.frame.step
        page.keyboard.press("s")
        until(lambda: live.frame.step == step + 1)
        page.keyboard.press("r")
        until(lambda: server.game.live is not live and server.game.running)
        page.set_viewport_size({"width": 390, "height": 780})
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        assert not page.problems


def test_live_command_names_what_is_wrong(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["live", "--cloth", "10", "--garment", "tshirt"]) == 2
    assert "give one of" in capsys.readouterr().err
    assert main(["live", "--cloth", "1"]) == 2
    assert "cells must be" in capsys.readouterr().err


def test_a_port_in_use_is_named(server: LiveServer[Game]) -> None:
    with pytest.raises(InputError, match=f"--port {server.port}: cannot listen"):
        LiveServer(server.game, server.port)


def test_the_words_of_both_languages_are_the_same_in_number() -> None:
    from toile.dressing.live.page import live_page

    page = live_page("es")
    assert '<html lang="es">' in page and "<!--" not in page
    assert (
        np.ptp([page.count(f'{word}: "') for word in ("pause", "fabric", "wind", "grain", "lost", "saved")])
        == 0
    )
