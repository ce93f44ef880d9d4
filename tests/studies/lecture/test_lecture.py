"""The lecture: stable steps, cloth that explodes beyond them, and its page in both languages."""

import threading
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from tests.dressing.browser import opened_page, until
from toile.dressing.cli.main import main
from toile.dressing.live.server import LiveServer
from toile.geometry.errors import InputError
from toile.studies.lecture.lecture import Lecture, compared
from toile.studies.lecture.lessons import STEPS
from toile.studies.lecture.setup import Setup
from toile.studies.lecture.stable_step import fastest, longest_step
from toile.studies.lecture.teaching_cloth import TeachingCloth
from toile.studies.scenes.spring_cloth import SpringNet

STIFF = Setup(method="symplectic", cells=6, damping=0.0)


@pytest.mark.parametrize("method", ["explicit", "symplectic"])
@pytest.mark.parametrize("frequency", [3.0, 80.0])
@pytest.mark.parametrize("lag", [0.0, 1e-3, 0.02, 0.5])
def test_the_longest_step_is_where_a_mode_stops_dying_out(method: str, frequency: float, lag: float) -> None:
    def growth(h: float) -> float:
        """Largest factor of a mode in one step: the matrix of both methods on x'' = -w^2 (x + lag x')."""
        w = frequency**2
        slow = np.array([1.0 * -h * w, 1.0 - h * w * lag])
        x = np.array([1.0, h]) if method == "explicit" else np.array([1.0, 0.0]) + h * slow
        return float(np.abs(np.linalg.eigvals(np.array([x, slow]))).max())

    longest = longest_step(method, frequency, lag)
    if longest == 0.0:
        assert method == "explicit" and lag == 0.0 and growth(1e-6) > 1.0
        return
    assert growth(0.999 * longest) <= 1.0 + 1e-9 < growth(1.001 * longest)


def test_two_masses_on_a_spring_swing_as_the_formula_says() -> None:
    net = SpringNet(
        np.array([[0, 1]], np.int32), np.array([1.0]), np.array([12.0]), np.array([0.5, 2.0]),
        np.empty((0, 3), np.int32),
    )  # fmt: skip
    x = np.array([[0.0, 0.0, 0.0], [0.6, 0.8, 0.0]])
    free, held = np.zeros(2, bool), np.array([False, True])
    assert fastest(net, x, free) == pytest.approx(np.sqrt(12.0 * (1 / 0.5 + 1 / 2.0)), rel=1e-6)
    assert fastest(net, x, held) == pytest.approx(np.sqrt(12.0 / 0.5), rel=1e-6)


def test_an_explicit_cloth_explodes_beyond_its_longest_step_and_not_below() -> None:
    limit = TeachingCloth(STIFF).limit
    for share, explodes in ((0.9, False), (1.15, True)):
        cloth = TeachingCloth(replace(STIFF, step=share * limit))
        # Something in every mode.
        noise = np.random.default_rng(1).normal(size=cloth.x.shape) * 1e-3
        cloth.stepper.put(np.where(cloth.pinned[:, None], cloth.x, cloth.x + noise), cloth.v)
        cloth.advance(1.0)
        assert (cloth.exploded is not None) == explodes
        assert np.isfinite(cloth.x).all(), "what it shows stays finite"
    implicit = TeachingCloth(replace(STIFF, method="implicit", step=0.1))
    implicit.advance(2.0)
    assert implicit.exploded is None


def test_energy_is_kept_and_errors_fall_with_the_step() -> None:
    cloth = TeachingCloth(replace(STIFF, step=1e-3))
    cloth.advance(0.5)
    kinetic, elastic, height = cloth.energies()
    assert kinetic > 0.05 and kinetic + elastic + height == pytest.approx(0.0, abs=0.02 * kinetic)
    errors = []
    for step in (1 / 60, 1 / 120):
        coarse = TeachingCloth(replace(STIFF, method="implicit", step=step, damping=0.05))
        twin = coarse.twin()
        assert twin is not None
        coarse.advance(0.3)
        twin.advance(0.3, exactly=True)
        errors.append(coarse.distance(twin))
    assert 1e-3 < errors[1] < 0.65 * errors[0], "of first order"


def test_springs_and_triangles_of_the_same_numbers_fall_alike() -> None:
    end = []
    for model in ("springs", "triangles"):
        cloth = TeachingCloth(Setup(model=model, cells=8, method="bdf2", step=1 / 240))
        cloth.advance(0.25)
        end.append(cloth)
    fallen = float(np.linalg.norm(end[0].x - end[0].start, axis=1).mean())
    assert fallen > 0.1 and end[0].distance(end[1]) < 0.03 * fallen


def test_a_setup_says_what_is_wrong_with_it() -> None:
    for wrong in (
        {"model": "cloth"}, {"step": 0.0}, {"cells": 2.5}, {"ball": True}, {"stiffness": float("nan")},
        {"model": "adaptive", "method": "explicit"},
    ):  # fmt: skip
        with pytest.raises(InputError):
            Setup(**wrong)


def test_a_lecture_does_what_it_is_asked() -> None:
    lecture = compared()
    lecture.advance()
    assert lecture.carry_out({"do": "set", "name": "stiffness", "value": 200.0})
    assert [pane.setup.stiffness for pane in lecture.panes] == [200.0, 200.0]
    assert lecture.panes[1].seconds > 0.0, "it goes on where it was"
    lecture.carry_out({"do": "set", "name": "cells", "value": 5, "pane": 1})
    assert [len(pane.x) for pane in lecture.panes] == [169, 36]
    assert all(pane.seconds == 0.0 for pane in lecture.panes), "another mesh begins anew, and both together"
    lecture.carry_out({"do": "grip", "pane": 0, "node": 0})
    lecture.carry_out({"do": "pull", "offset": [0.0, 3.0, 0.0]})
    for _ in range(20):
        lecture.advance()
    assert min(pane.x[:, 1].max() for pane in lecture.panes) > 0.3, "both are pulled up"
    lecture.carry_out({"do": "release"})
    assert not lecture.panes[0].push.force.any()
    for wish in (
        {"do": "fly"}, {"do": "turn", "at": 9}, {"do": "grip", "pane": 0, "node": 999}, {"do": "set"},
        {"do": "set", "name": "springs", "value": "all"}, {"do": "weave", "ends_per_cm": 500},
    ):  # fmt: skip
        with pytest.raises(InputError):
            lecture.carry_out(wish)


def test_the_adaptive_pane_gets_other_triangles_and_sends_them() -> None:
    lecture = Lecture()
    lecture.carry_out({"do": "turn", "at": [step.name for step in STEPS].index("remeshing")})
    for _ in range(45):
        lecture.advance()
    adaptive = lecture.panes[1]
    assert adaptive.version > 0 and len(adaptive.faces) > len(lecture.panes[0].faces)
    frame = np.frombuffer(lecture.frame(), "<f4")
    second = frame[1 + 7 + 3 * len(lecture.panes[0].x) :]
    assert second[:3].tolist() == [adaptive.version, len(adaptive.x), adaptive.faces.size]
    assert np.array_equal(second[-adaptive.faces.size :].astype(int), adaptive.faces.ravel())


@pytest.fixture
def server(request: pytest.FixtureRequest) -> Iterator[LiveServer[Lecture]]:
    pytest.importorskip("websockets", reason="websockets is not installed")
    server = LiveServer(Lecture(), language=request.param)
    thread = threading.Thread(target=server.run)
    thread.start()
    yield server
    server.stop()
    thread.join(20.0)
    assert not thread.is_alive()


@pytest.mark.parametrize("server", ["en", "es"], indirect=True)
def test_the_lecture_is_gone_through_in_a_browser(server: LiveServer[Lecture]) -> None:
    width = 390 if server.language == "es" else 1280
    with opened_page(width, 800, own=f"http://127.0.0.1:{server.port}") as page:
        page.goto(server.url)
        page.wait_for_selector("[data-ready=yes]")
        titles = set()
        for k, step in enumerate(STEPS):
            if k:
                page.keyboard.press("PageDown")
            page.wait_for_selector(f"[data-lesson={step.name}]")
            text = page.inner_text(".panel") + page.inner_text(".left")
            assert "undefined" not in text and "NaN" not in text
            titles.add(page.inner_text("h1"))
            assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert len(titles) == 8 and not page.problems
        if server.language == "es":
            assert "sarga 2/2" in page.inner_text("[data-weave=weave]")
            return
        before = page.inner_html("[data-view=picture]")
        page.select_option("[data-weave=weave]", "satin")
        page.wait_for_function(
            "before => document.querySelector('[data-view=picture]').innerHTML !== before", arg=before
        )
        assert server.game.weave["weave"] == "satin"
        explicit = [step.name for step in STEPS].index("explicit")
        page.locator("nav button").nth(explicit).click()
        page.wait_for_selector("[data-lesson=explicit]")
        page.wait_for_selector(".stage p.exploded")
        page.locator("[data-set=step1] input").evaluate(
            "input => { input.value = 150; input.dispatchEvent(new Event('change')); }"
        )
        page.wait_for_selector(".stage p.exploded", state="detached")
        until(lambda: server.game.panes[1].setup.step < 5e-4)
        assert page.evaluate("window.lecture.curves.length") == 2
        page.locator("[data-do=pause]").click()
        until(lambda: not server.game.running)
        assert not page.problems


def test_the_command_says_what_does_not_go_with_a_lecture(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["live", "lecture", "--cloth", "10"]) == 2
    assert "--cloth does not apply to toile live lecture" in capsys.readouterr().err
