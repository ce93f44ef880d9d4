"""Jobs from files and lists, their names and fingerprints; mistakes are said with file and line."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh

from toile.dressing.batch.fingerprint import UNREADABLE, Fingerprints
from toile.dressing.batch.job import BadJob, Job, job_name
from toile.dressing.batch.job_grid import JobGrid, unique_names
from toile.dressing.batch.jobs_file import JobsFile
from toile.dressing.body.avatar import Avatar
from toile.dressing.run.scene import AvatarFile, Garment, MannequinSize, Scene
from toile.geometry.errors import InputError


def write(path: Path, *lines: str) -> Path:
    path.write_text("".join(f"{line}\n" for line in lines))
    return path


def test_a_table_of_jobs(tmp_path: Path) -> None:
    table = write(
        tmp_path / "jobs.csv",
        "name,avatar,garment,fabric,quality,max_frames,height,remesh",
        "first,body.ply,tshirt; coat.obj,canvas;denim-12oz,preview,40,,false",
        ",,trousers,,,,1.8,",
    )
    jobs = JobsFile(table, {"quality": "accurate"})
    assert len(jobs) == 2
    first, second = good(jobs)
    assert first.name == "first"
    assert first.scene.avatar == AvatarFile(path=tmp_path / "body.ply")
    assert [garment.source for garment in first.scene.garments] == ["tshirt", tmp_path / "coat.obj"]
    assert [garment.fabric for garment in first.scene.garments] == ["canvas", "denim-12oz"]
    assert (first.scene.quality, first.scene.max_frames, first.scene.remesh) == ("preview", 40, False)
    assert second.name == "mannequin-h180__trousers"
    assert second.scene.avatar == MannequinSize(height=1.8)
    assert second.scene.quality == "accurate"


def test_lines_of_json(tmp_path: Path) -> None:
    lines = [
        {"name": "a", "avatar": "body.ply", "garment": "tshirt", "fabric": "canvas"},
        {"name": "b", "avatar": {"file": "b.obj", "units": "cm"}, "friction": 0.2,
         "garment": [{"source": "coat.obj", "warp_angle": 45}, "tshirt"]},
        {"name": "c", "garment": [{"source": "tshirt", "fabric": "mine"}],
         "fabric": {"mine": {"like": "canvas"}}},
    ]  # fmt: skip
    a, b, c = good(JobsFile(write(tmp_path / "jobs.jsonl", *map(json.dumps, lines), ""), {}))
    assert a.scene.garments[0].fabric == "canvas"
    assert b.scene.avatar == AvatarFile(path=tmp_path / "b.obj", units="cm")
    assert (b.scene.friction, b.scene.garments[0].warp_angle) == (0.2, 45)
    assert c.scene.fabrics["mine"].name == "mine"


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["name,garmnt", "a,tshirt"], "jobs.csv, line 1: unknown column 'garmnt'; did you mean 'garment'"),
        (["name,name,garment"], "line 1: column 'name' appears twice"),
        (["name,garment", "a,tshirt", "b,tshirt", "a,trousers"], "line 4: job 'a' appears twice, first in"),
        (["garment", "tshirt", "tshirt"], "line 3: job 'mannequin__tshirt' appears twice, first in line 2"),
        (["name,garment", "a,tshirt,x"], "line 2: has a different number of cells than line 1 has columns"),
        (["name,garment,max_frames", "a,tshirt,many"], "line 2: max_frames must be a number, got 'many'"),
        (["name,garment,fabric", "a,tshirt,denm"], "line 2: unknown fabric 'denm'; did you mean"),
        (["name,garment,quality", "a,tshirt,best"], "line 2: unknown quality 'best'"),
        (["name,garment,fabric", "a,tshirt,canvas;canvas"], "line 2: 2 fabrics for 1 garments"),
        (["name,garment", "a/b,tshirt"], "line 2: job name 'a/b': use letters"),
        (["name,garment"], "holds no jobs"),
        (["name,garment", 'a,tshirt', '"a'], "number of cells"),
        (['"name', 'garment"', "a"], "line 1: unknown column 'name garment'"),
        (["name,avatar", "a,body.obj"], "garment"),
    ],
)  # fmt: skip
def test_mistakes_in_a_table(lines: list[str], message: str, tmp_path: Path) -> None:
    said = ""
    try:
        jobs = JobsFile(write(tmp_path / "jobs.csv", *lines), {})
        (said,) = (job.message for job in jobs if isinstance(job, BadJob))
    except InputError as error:
        said = str(error)
    assert message in said and "\n" not in said


def test_a_bad_line_does_not_stop_the_others(tmp_path: Path) -> None:
    """What pandas writes for missing values is left out; lines at fault become jobs that have failed."""
    lines = [
        '{"name": "a", "avatar": null, "garment": "tshirt", "fabric": null, "max_frames": null}',
        '{"name": "b", "garment": null}',
        '{"name": "c", "garment": [{"source": "tshirt", "fabric": null}], "avatar": {"height": null}}',
        '{"name": "c", "garment": "trousers"}',
        "{]",
        '{"name": 3, "garment": "tshirt", "friction": "rough"}',
        '{"name": "d", "garment": "tshirt", "friction_between": [null, 3]}',
    ]
    jobs = list(JobsFile(write(tmp_path / "jobs.jsonl", *lines), {}))
    assert len(jobs) == 7
    plain, other = (job for job in jobs if isinstance(job, Job))
    assert plain.scene == Scene(garments=["tshirt"]) and (plain.name, other.name) == ("a", "c")
    assert other.scene == plain.scene
    bad = {job.name: job.message for job in jobs if isinstance(job, BadJob)}
    assert list(bad) == ["line_2", "line_4", "line_5", "line_6", "line_7"]
    assert all(f"jobs.jsonl, line {name[5:]}: " in message for name, message in bad.items())
    assert "the scene has no" in bad["line_2"] and "job 'c' appears twice" in bad["line_4"]
    with pytest.raises(InputError, match=r"line 1: .*the scene has no"):
        JobsFile(write(tmp_path / "jobs.jsonl", lines[1]), {})


def good(jobs: JobsFile) -> list[Job]:
    """The jobs of a file without faults."""
    assert not any(isinstance(job, BadJob) for job in jobs)
    return [job for job in jobs if isinstance(job, Job)]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('{"garment": "tshirt", "colour": 1}', "line 1: unknown key 'colour'"),
        ('{"garment": ', "line 1: not valid JSON"),
        ('["tshirt"]', "line 1: must be a JSON object"),
        ('{"garment": 3}', "line 1: garment must be a list of files"),
        ('{"garment": ["tshirt", 3]}', "line 1: garment must be a list of files"),
        ('{"garment": ["tshirt", 3], "fabric": "canvas"}', "line 1: garment must be a list of files"),
        ('{"garment": "tshirt", "avatar": [1]}', "line 1: avatar must be a file or a table"),
        ('{"garment": [{"source": "tshirt", "pin": [1]}]}', "line 1: unknown key 'pin'; did you mean 'pins'"),
    ],
)
def test_mistakes_in_json(line: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        JobsFile(write(tmp_path / "jobs.jsonl", line), {})


def test_no_such_file_and_no_such_kind(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such jobs file"):
        JobsFile(tmp_path / "jobs.csv", {})
    with pytest.raises(InputError, match="unknown kind of jobs file"):
        JobsFile(tmp_path / "jobs.xlsx", {})


def test_every_garment_on_every_body(tmp_path: Path) -> None:
    for name in ("a.ply", "b.obj", "README.md", "coat.obj"):
        write(tmp_path / name, "x")
    grid = JobGrid(
        [str(tmp_path / "[ab]*"), str(tmp_path / "R*"), "mannequin"][::2],
        [str(tmp_path / "coat.obj"), "T-shirt"],
        ["canvas", "denim-12oz"],
        {"quality": "preview"},
    )
    jobs = list(grid)
    assert len(jobs) == len(grid) == 3 * 2 * 2
    assert jobs[0].name == "a__coat__canvas" and jobs[-1].name == "mannequin__tshirt__denim-12oz"
    assert jobs[0].scene.avatar == AvatarFile(path=tmp_path / "a.ply")
    assert len({job.name for job in jobs}) == 12
    noted = JobGrid([str(tmp_path / "*")], ["tshirt"], [], {})
    assert noted.notes == [f"--avatars '{tmp_path}/*': 1 files of other kinds are left out"]


def test_brackets_in_names_of_folders_and_files(tmp_path: Path) -> None:
    """Where a name with brackets exists it is meant; else they are a set of signs."""
    folder = tmp_path / "bodies [v2]"
    folder.mkdir()
    for name in ("a.ply", "b.ply", "c[1].ply", "c1.ply"):
        write(folder / name, "x")
    for pattern, names in {
        "*.ply": ["a", "b", "c1", "c_1"],
        "[ab].ply": ["a", "b"],
        "c[1].ply": ["c_1"],
        "?[1]*": ["c1"],
        "[a]*": ["a"],
        "a.ply": ["a"],
    }.items():
        jobs = JobGrid([str(folder / pattern)], ["tshirt"], [], {})
        assert sorted(job.name.removesuffix("__tshirt") for job in jobs) == sorted(names)
    wild = JobGrid([str(tmp_path / "b* [v2]" / "a.ply")], ["tshirt"], [], {})
    assert [job.name for job in wild] == ["a__tshirt"]


def test_nothing_matches(tmp_path: Path) -> None:
    for avatars, garments in (([f"{tmp_path}/*.ply"], ["tshirt"]), ([], [f"{tmp_path}/*.json"])):
        with pytest.raises(InputError, match="no file matches; check the path, and put patterns in quotes"):
            JobGrid(avatars, garments, [], {})
    with pytest.raises(InputError, match="unknown fabric 'denm'"):
        JobGrid([], ["tshirt"], ["denm"], {})


def test_names_tell_files_apart() -> None:
    assert unique_names(["x/a.obj", "x/b.obj"]) == ["a", "b"]
    assert unique_names(["x/a.obj", "x/a.ply"]) == ["a.obj", "a.ply"]
    assert unique_names(["x/a.obj", "y/a.obj"]) == ["x_a.obj", "y_a.obj"]
    scene = Scene(avatar="b/Body 1.ply", garments=["tshirt", Garment("c.obj", fabric="canvas")])
    assert job_name(scene) == "Body_1__tshirt-c__canvas"
    with pytest.raises(InputError, match="use letters"):
        Job("../up", scene)


def test_fingerprints_follow_contents(tmp_path: Path) -> None:
    body, coat = write(tmp_path / "body.ply", "one"), write(tmp_path / "coat.obj", "coat")
    hashes = Fingerprints()

    def of(**options: object) -> str:
        return hashes.of(Scene(avatar=body, garments=[Garment(coat)], **options)).digest  # type: ignore[arg-type]

    first = of()
    assert of() == first == Fingerprints().of(Scene(avatar=body, garments=[Garment(str(coat))])).digest
    assert len({first, of(quality="preview"), of(fabric="canvas"), of(friction=0.1)}) == 4
    write(body, "two")
    os.utime(body, ns=(1, 1))
    changed = of()
    assert changed != first
    body.unlink()
    gone = hashes.of(Scene(avatar=body, garments=[Garment(coat)]))
    assert gone.inputs[str(body)] == UNREADABLE and gone.digest not in (first, changed)


def test_fingerprints_of_what_is_in_memory() -> None:
    ball = trimesh.creation.icosphere(subdivisions=1)
    faces = np.asarray(ball.faces, dtype=np.int32)

    def of(vertices: np.ndarray) -> str:
        scene = Scene(avatar=Avatar(name="b", vertices=vertices, faces=faces), garments=[Garment("tshirt")])
        return Fingerprints().of(scene).digest

    vertices = np.asarray(ball.vertices)
    assert of(vertices) == of(vertices.copy())
    moved = vertices.copy()
    moved[0, 0] = np.nextafter(moved[0, 0], 9.0)
    assert of(moved) != of(vertices)


def test_frames_of_a_folder_count(tmp_path: Path) -> None:
    for k in range(2):
        write(tmp_path / f"{k}.ply", str(k))
    scene = Scene(avatar=tmp_path, garments=[Garment("tshirt")])
    before = Fingerprints().of(scene)
    assert len(before.inputs) == 2
    write(tmp_path / "2.ply", "2")
    assert Fingerprints().of(scene).digest != before.digest


def test_table_says_how_bodies_are_read(tmp_path: Path) -> None:
    (tmp_path / "jobs.csv").write_text(
        "avatar,garment,front,only,without,measurements\nbody.obj,tshirt,-z,skin;face,,mine.toml\nbody.obj,trousers,,,hair*,\n"
    )
    first, second = (job.scene for job in good(JobsFile(tmp_path / "jobs.csv", {})))
    assert isinstance(first.avatar, AvatarFile) and isinstance(second.avatar, AvatarFile)
    assert first.avatar.front == "-z" and first.avatar.only == ("skin", "face")
    assert second.avatar.without == ("hair*",) and second.measurements is None
    assert first.measurements == tmp_path / "mine.toml"
