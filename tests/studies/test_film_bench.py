"""`toile bench film` and `memory`: distances by material point, versions, rows and bars, the command."""

import json
import subprocess
import tracemalloc
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toile.dressing.cli.main import main
from toile.dressing.files.writers.ply import read_own_ply
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError
from toile.remesh.panel.rectangle import rectangle
from toile.studies.film import bench_film, film_memory, garment_film, toile_version
from toile.studies.film.bench_film import DressRun, Effort
from toile.studies.film.blender_film import BlenderFilm, crossings_of, edge_strain
from toile.studies.film.film_row import BLENDER, FORMAT, FilmRow, film_bars, film_table, store_rows
from toile.studies.film.material_distance import Worn, material_distances, rms_and_largest
from toile.studies.film.toile_version import THIS, ToileVersion, other_version, this_version
from toile.studies.scenes.walking_mannequin import TURN_SECONDS

OTHER = "older"


def bent(flat: Float) -> Float:
    """Points of a plane, (n, 2), on a cylinder of 0.3 m, (n, 3): lengths stay."""
    angle = flat[:, 0] / 0.3
    return np.column_stack((0.3 * np.sin(angle), flat[:, 1], 0.3 * np.cos(angle)))


def worn(edge: float, lifted: float = 0.0, panels: int = 1) -> Worn:
    """Bent squares of a mesh of its own, side by side, each a panel; moved by `lifted` [m]."""
    flat, faces = rectangle(0.4, 0.4, edge)
    positions = np.concatenate([bent(flat) + np.array([0.0, lifted + k, 0.0]) for k in range(panels)])
    every = np.concatenate([faces + k * len(flat) for k in range(panels)])
    return Worn(
        positions, every, np.concatenate([flat] * panels), every, np.repeat(np.arange(panels), len(faces))
    )


def test_states_on_different_meshes_are_compared_by_points_of_the_pattern() -> None:
    fine, coarse = worn(0.02, panels=2), worn(0.07, panels=2)
    # A chord lies up to length^2/8r inside the cylinder. Panels lie over each other in the pattern only.
    corners = coarse.uv[coarse.uv_faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    distances, shares = material_distances(coarse, fine)
    sagitta = longest**2 / (8.0 * 0.3)
    assert 0.5 * sagitta < distances.max() < 1.1 * sagitta
    assert shares.sum() == pytest.approx(1.0)
    same, _ = material_distances(fine, fine)
    assert same.max() < 1e-12
    rms, largest = rms_and_largest([fine, fine], [worn(0.02, 0.003, 2), worn(0.02, 0.004, 2)])
    assert largest == pytest.approx(0.004)
    assert rms == pytest.approx(np.sqrt((0.003**2 + 0.004**2) / 2.0))


def test_a_point_in_a_large_triangle_amid_small_ones_is_found() -> None:
    """Forty slivers have centroids nearer to the point than that of the triangle that it lies in."""
    along = np.linspace(0.0, 1.0, 41)
    uv = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 10.0], *((x, -0.01) for x in along)])
    rim = np.arange(3, 44)
    faces = np.array([[0, 1, 2], *((rim[k], rim[k + 1], 0) for k in range(40))], np.int32)
    state = Worn(np.column_stack((uv, 0.0 * uv[:, 0])), faces, uv, faces, np.zeros(len(faces), np.int32))
    probe = np.array([[0.5, 0.001], [0.52, 0.001], [0.5, 0.002]])
    face = np.array([[0, 1, 2]], np.int32)
    other = Worn(np.column_stack((probe, np.zeros(3))), face, probe, face, np.zeros(1, np.int32))
    assert material_distances(state, other)[0].max() < 1e-12


def test_films_of_other_garments_or_lengths_are_not_compared() -> None:
    with pytest.raises(ValueError, match="different garments"):
        material_distances(worn(0.1), worn(0.1, panels=2))
    with pytest.raises(ValueError):
        rms_and_largest([worn(0.1)], [worn(0.1)] * 2)


def row(version: str, **changes: Any) -> FilmRow:
    usual = FilmRow(
        film="walk", version=version, still=False, frames=10, faces=100, repeats=1, cpu=0.5, cpu_spread=0.1,
        wall=1.0, steps=30, newton_iterations=90, crossings=0, strain=5.0, distance_rms=1.0, distance_max=9.0,
    )  # fmt: skip
    return replace(usual, **changes)


def test_bars_compare_this_version_with_the_others() -> None:
    rows = [
        row(THIS, wall_two_threads=0.5), row(OTHER, cpu=2.1),
        row(f"{BLENDER}5", cpu=0.6, crossings=500, strain=90.0), row(f"{BLENDER}10", cpu=0.1),
    ]  # fmt: skip
    bars = film_bars(rows, 4.0)
    assert all(bar.met for bar in bars) and len(bars) == 7
    missed = {
        "CPU time": [replace(rows[0], cpu=0.55), *rows[1:]],
        "crossings": [replace(rows[0], crossings=1), *rows[1:]],
        "strain": [replace(rows[0], strain=5.1), *rows[1:]],
        "distance": [replace(rows[0], distance_rms=1.1), *rows[1:]],
        "wall time": [replace(rows[0], wall_two_threads=0.7), *rows[1:]],
        "Blender": [*rows[:2], replace(rows[2], cpu=0.4), rows[3]],
        "failures": [replace(rows[0], failure="motion frame 3"), *rows[1:]],
    }
    for said, changed in missed.items():
        (wrong,) = [bar for bar in film_bars(changed, 4.0) if not bar.met]
        assert said in wrong.claim
    # Nothing is asked of films for which nothing was set, and of others' failures.
    assert not [bar for bar in film_bars(rows, None) if "CPU time of" in bar.claim]
    assert len(film_bars([rows[0], replace(rows[1], failure="tangled")], 4.0)) == 3
    table = film_table(rows, bars)
    assert "| walk | older | 2.1 |" in table and "at least 4" in table


def test_rows_are_stored_without_infinities(tmp_path: Path) -> None:
    path = tmp_path / "film.json"
    rows = [row(THIS, distance_rms=float("inf"))]
    store_rows(path, rows, film_bars(rows, None), {"machine": {"cores": "2"}})
    stored = json.loads(path.read_text())
    assert stored["format"] == FORMAT and stored["rows"][0]["distance_rms"] is None
    assert [bar["met"] for bar in stored["bars"]] == [True, True]
    with pytest.raises(InputError, match="cannot be written"):
        store_rows(tmp_path / "nowhere" / "film.json", rows, [], {})


def test_revisions_and_wheels_are_unpacked_for_a_while(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    checkout = tmp_path / "checkout"
    module = checkout / "studies" / "film" / "toile_version.py"
    module.parent.mkdir(parents=True)
    (checkout / "toile").mkdir()
    (checkout / "toile" / "__init__.py").write_text("OLD = True\n")
    git = ["git", "-C", str(checkout), "-c", "user.name=a", "-c", "user.email=a@b"]
    subprocess.run(["git", "init", "-q", str(checkout)], check=True)
    subprocess.run([*git, "add", "-A"], check=True)
    subprocess.run([*git, "commit", "-qm", "Begin"], check=True)
    monkeypatch.setattr(toile_version, "__file__", str(module))
    with other_version("HEAD") as version:
        assert (version.path / "toile" / "__init__.py").read_text() == "OLD = True\n"
    assert version.name == "HEAD" and not version.path.exists()
    with pytest.raises(InputError, match="git knows no such revision"), other_version("no-such-revision"):
        pass

    wheel = tmp_path / "toile-0.1.0-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("toile/__init__.py", "OLD = True\n")
    with other_version(str(wheel)) as version:
        assert version.name == "toile-0.1.0" and (version.path / "toile" / "__init__.py").is_file()
    wheel.write_bytes(b"no archive")
    for source, said in ((str(wheel), "cannot be read as a wheel"), ("gone.whl", "there is no such wheel")):
        with pytest.raises(InputError, match=said), other_version(source):
            pass


def run(cpu: float, frames: int, threads: bool = False, crossings: int = 0) -> DressRun:
    """Return a run of which only the figures count; the cloth rises by a millimetre per CPU second."""
    report = {
        "failure": None, "strain_percent": {"warp_max": 3.0, "weft_max": 2.0},
        "intersections": {"worst_frame": crossings}, "steps": 7, "newton_iterations": 8, "frames": 30,
        "animation": {
            "frames": frames, "steps": 3 * frames, "newton_iterations": 9 * frames,
            "intersections_max": crossings, "strain_percent_max": 4.0,
        },
    }  # fmt: skip
    facts = {"cpu": cpu, "wall": 2.0 * cpu, "status": "converged", "report": report, "threads": threads}
    return DressRun(facts, [worn(0.1, 1e-3 * cpu)] * (frames + 1))


class Fakes:
    """Versions that take given CPU times, one after the other; who was asked what, in order."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: list[tuple[str, float, int, str]] = []
        self.times = {THIS: iter((1.0, 3.0, 2.0, 1.5)), OTHER: iter((10.0, 12.0, 11.0, 11.5))}
        self.interrupted_after = 100
        monkeypatch.setattr(bench_film, "run_version", self.run_version)
        monkeypatch.setattr(bench_film, "blender_film", self.blender)

    def run_version(self, version: ToileVersion, job: dict[str, Any], folder: Path) -> DressRun:
        if len(self.asked) == self.interrupted_after:
            raise KeyboardInterrupt
        self.asked.append((version.name, job["step_share"], job["threads"], job["quality"]))
        if job["threads"] == 2:
            return run(0.5, 4)
        return run(next(self.times[version.name]), 4, threads=version.name == THIS)

    def blender(self, *_: object) -> BlenderFilm:
        return BlenderFilm(5, 100, 2.0, (0, 3, 9, 2, 1), 0.5, "4.5")


def test_versions_take_turns_and_medians_are_shown(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fakes = Fakes(monkeypatch)
    versions = (ToileVersion(THIS, tmp_path), ToileVersion(OTHER, tmp_path))
    effort = Effort(
        versions=versions, blender="python", still=False, quality="preview", frames=4, repeats=3,
        say=lambda line: None,
    )  # fmt: skip
    *_, rows = bench_film.bench_film(garment_film.FILMS["walk"], effort, tmp_path)
    assert fakes.asked == [
        *[(THIS, 1.0, 1, "preview"), (THIS, 1.0, 2, "preview"), (OTHER, 1.0, 1, "preview")] * 3,
        (THIS, 0.25, 1, "preview"), (OTHER, 0.25, 1, "preview"),
    ]  # fmt: skip
    this, other, five, ten = rows
    assert (this.version, other.version, five.version, ten.version) == (
        THIS, OTHER, f"{BLENDER}5", f"{BLENDER}10",
    )  # fmt: skip
    assert (this.cpu, this.cpu_spread, this.wall, this.wall_two_threads) == (0.5, 0.5, 1.0, 0.25)
    assert (this.steps, this.newton_iterations, this.crossings, this.strain) == (12, 36, 0, 4.0)
    # The first run rose by 1 mm, the fine one by 1.5 mm.
    assert this.distance_rms == pytest.approx(0.5) and this.distance_max == pytest.approx(0.5)
    assert other.cpu == 2.75 and other.wall_two_threads is None
    assert (five.cpu, five.crossings, five.strain, five.wall) == (0.5, 9, 50.0, None)


def test_the_command_keeps_what_was_measured_and_tells_by_its_exit_code(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fakes = Fakes(monkeypatch)
    stored = tmp_path / "film.json"
    options = ["bench", "film", "skirt", "--frames", "4", "--json", str(stored)]
    fakes.interrupted_after = 2
    assert main([*options, "--repeats", "3"]) == 130
    assert json.loads(stored.read_text())["rows"][0]["cpu"] == 0.25
    assert "| skirt | this | 0.25 |" in capsys.readouterr().out

    fakes = Fakes(monkeypatch)
    monkeypatch.setattr(toile_version, "_unpack_revision", lambda _, folder: (folder / "toile").mkdir())
    assert main([*options, "--repeats", "1", "--against", OTHER]) == 0
    assert fakes.asked[0][0] == THIS and {name for name, *_ in fakes.asked} == {THIS, OTHER}
    fakes = Fakes(monkeypatch)
    fakes.times[OTHER] = iter((3.9, 4.0))
    assert main([*options, "--repeats", "1", "--against", OTHER]) == 1
    assert "CPU time of older over this: 3.9 (at least 4) missed" in capsys.readouterr().out

    fakes = Fakes(monkeypatch)
    fakes.times[OTHER] = iter((1.8, 4.0))
    assert main(["bench", "film", "walk", "--still", "--repeats", "1", "--against", OTHER]) == 0
    assert [quality for *_, quality in fakes.asked] == ["standard"] * 3 + ["accurate"] * 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["film", "wlak"], "did you mean 'walk'"),
        (["film", "walk", "--frames", "0"], "--frames must be at least 1"),
        (["film", "--quick"], "--quick does not apply to toile bench film"),
        (["film", "--garment", "tshirt"], "--garment goes with --avatar"),
        (["film", "walk", "--avatar", "body.npz"], "give --avatar or the film 'walk', not both"),
        (["film", "--avatar", "gone.npz"], "gone.npz"),
        (["film", "--quality", "preveiw"], "did you mean 'preview'"),
        (["film", "--still", "--blender", "python"], "leave out --still"),
        (["film", "--json", "nowhere/film.json"], "nowhere/film.json: cannot be written"),
        (["film", "--against", "gone.whl"], "gone.whl: there is no such wheel"),
        (["swing", "--against", "HEAD"], "--against does not apply to toile bench swing"),
        (["memory", "walk"], "memory takes no names"),
    ],
)
def test_a_slip_of_the_pen_is_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_a_film_is_run_as_its_user_would_and_in_shorter_steps(tmp_path: Path) -> None:
    body = garment_film.FILMS["walk"].write_body(tmp_path, 1, still=False)
    job = {"garments": ["tshirt"], "avatar": str(body), "quality": "preview", "step_share": 1.0, "threads": 1}
    usual = bench_film.run_version(this_version(), job, tmp_path)
    fine = bench_film.run_version(this_version(), job | {"step_share": 0.25}, tmp_path)
    assert len(usual.frames) == len(fine.frames) == 2
    steps = [one.facts["report"]["animation"]["steps"] for one in (usual, fine)]
    assert steps[1] > 2 * steps[0]
    # Both films begin with one and the same drape, and differ by their steps.
    assert np.array_equal(usual.frames[0].positions, fine.frames[0].positions)
    assert 1e-6 < rms_and_largest(usual.frames, fine.frames)[0] < 0.01
    for one in (usual, fine):
        # What is timed is the film, not the drape before it.
        assert 0.0 < one.facts["cpu"] < one.facts["report"]["cpu_seconds"]
    with pytest.raises(InputError, match=r"toile this cannot be measured: .*gone"):
        bench_film.run_version(this_version(), job | {"avatar": "gone.npz"}, tmp_path)
    nowhere = ToileVersion("nowhere", tmp_path)
    with pytest.raises(InputError, match="toile nowhere cannot be measured: Python finds another"):
        bench_film.run_version(nowhere, job, tmp_path)


def test_bodies_of_films_move_as_said_and_stand_in_drapes(tmp_path: Path) -> None:
    frames = round(TURN_SECONDS * 24.0) + 1
    turned = np.load(garment_film.FILMS["skirt"].write_body(tmp_path, frames, still=False))["vertices"]
    assert len(turned) == frames + 1
    assert turned[-1][:, [0, 2]] == pytest.approx(-turned[0][:, [0, 2]], abs=1e-9)
    still = read_own_ply(garment_film.FILMS["skirt"].write_body(tmp_path, None, still=True))
    assert still.positions == pytest.approx(turned[0])


def test_blender_is_judged_by_the_audit_and_by_edges() -> None:
    flat, faces = rectangle(0.2, 0.2, 0.05)
    sheet = np.column_stack((flat, np.full(len(flat), 0.1)))
    floor, floor_faces = rectangle(1.0, 1.0, 0.5)
    body = np.column_stack((floor - 0.4, np.zeros(len(floor))))
    tilted = sheet + np.column_stack((0.0 * flat, 2.0 * (flat[:, 0] - 0.1) - 0.1))
    film = np.array([sheet, tilted])
    apart, through = crossings_of(film, faces, (np.array([body, body]), floor_faces))
    assert apart == 0 and through > 0
    assert edge_strain(film, faces) == pytest.approx(np.sqrt(5.0) - 1.0)


def test_memory_stays_flat_over_a_looped_walk() -> None:
    """A few seconds of the film of `toile bench memory`.

    In so short a film resident memory still grows into what the allocator keeps: it shows only what is large,
    such as a hierarchy of the body, of some MB. What Python and numpy hold is told exactly.
    """
    held: list[float] = []

    def traced() -> float:
        # From the first frame on: it makes the drape before that slow.
        if not tracemalloc.is_tracing():
            tracemalloc.start()
        held.append(film_memory.resident())
        return 1e-3 * tracemalloc.get_traced_memory()[0]

    try:
        live = film_memory.film_memory(20, lambda line: None, edge_length=0.05, measure=traced)
    finally:
        tracemalloc.stop()
    # The cloth of one frame alone takes 17 kB.
    assert live < 8.0
    assert film_memory.growth(np.array(held)) < 500.0


def test_growth_is_fitted_after_the_caches_have_filled() -> None:
    held = np.concatenate([np.linspace(0.0, 1e5, 30), 1e5 + 3.0 * np.arange(60)])
    assert film_memory.growth(held) == pytest.approx(3.0)
