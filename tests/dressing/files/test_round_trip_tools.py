"""Bodies that went through gltf-transform and gltfpack come back as they were.

The tools are looked for in the folder that TOILE_GLTF_TOOLS names (`npm install @gltf-transform/cli gltfpack`
in it) and on the path; without them these tests are skipped.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import trimesh

from tests.dressing.files.gltf_writer import Glb
from tests.dressing.files.test_round_trip import (
    Body,
    Feature,
    assert_comes_back,
    at_a_node,
    below_two_nodes,
    moved,
    skinned,
    some_place,
)
from toile.dressing.files.read_surface import read_surface
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

SHARED = 6
"""Nodes that show one mesh: enough for tools to make instances of them."""
QUANTISED = 2e-4
"""Tolerance where positions are rounded to 14 bits or more, relative to the size of everything."""
EIGHT_BITS = 5e-3
"""The same where weights of bones are rounded to eight bits, as gltfpack always does."""


def tool(name: str) -> str:
    """Path of a command; skips the test where there is none."""
    folder = os.environ.get("TOILE_GLTF_TOOLS")
    places = None if folder is None else str(Path(folder) / "node_modules" / ".bin")
    found = (shutil.which(name, path=places) if places else None) or shutil.which(name)
    if found is None:
        pytest.skip(f"no {name}: npm install @gltf-transform/cli gltfpack, folder in TOILE_GLTF_TOOLS")
    return found


class Source(NamedTuple):
    path: Path
    triangles: Float


def blob(random: np.random.Generator) -> Body:
    ball = trimesh.creation.icosphere(subdivisions=1)
    points = ball.vertices * random.uniform(0.5, 1.0, (len(ball.vertices), 1)) * random.uniform(0.3, 1.0, 3)
    return Body(points.astype(np.float32).astype(np.float64), np.asarray(ball.faces, np.int32), random)


def scene(path: Path, *features: Feature) -> Source:
    """A body per feature, and one in six places."""
    random = np.random.default_rng(11)
    glb, found = Glb(), []
    for feature in features:
        body = blob(random)
        triangles = feature(glb, body, "<f4")[body.faces]
        found.append(triangles[:, ::-1] if feature is below_two_nodes else triangles)
    body = blob(random)
    mesh = glb.mesh(body.points, body.faces)
    for _ in range(SHARED):
        place = some_place(body)
        turn, scale = np.linalg.qr(place[:3, :3])[0], random.uniform(0.5, 2.0)
        place[:3, :3] = scale * turn * np.sign(np.linalg.det(turn))
        glb.node(mesh=mesh, matrix=place.T.ravel().tolist())
        found.append(moved(body.points, place)[body.faces])
    return Source(glb.write(path), np.concatenate(found))


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Source:
    """A plain body, a mirrored one below two nodes, a posed one with bones, and one in six places."""
    path = tmp_path_factory.mktemp("source") / "source.glb"
    return scene(path, at_a_node, below_two_nodes, skinned)


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Source:
    """The same without bones."""
    return scene(tmp_path_factory.mktemp("rigid") / "source.glb", at_a_node, below_two_nodes)


def run(*command: str | Path) -> None:
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr


LOSSLESS = (
    "copy", "dedup", "prune", "weld", "unweld", "flatten", "join", "instance --min 2", "dequantize",
    "reorder", "unlit", "metalrough", "palette", "sparse", "partition", "resample",
    "optimize --compress false --simplify false --texture-compress false",
    "optimize --compress false --simplify false --texture-compress false --instance true --join false",
)  # fmt: skip


@pytest.mark.parametrize("command", LOSSLESS)
def test_what_gltf_transform_writes(command: str, source: Source, tmp_path: Path) -> None:
    name, *options = command.split()
    path = tmp_path / ("body.gltf" if name in ("partition", "copy") else "body.glb")
    run(tool("gltf-transform"), name, source.path, path, *options)
    assert_comes_back(path, source.triangles)


@pytest.mark.parametrize("volume", ["mesh", "scene"])
@pytest.mark.parametrize("bits", [14, 16])
def test_what_gltf_transform_quantises(volume: str, bits: int, source: Source, tmp_path: Path) -> None:
    path = tmp_path / "body.glb"
    options = f"--quantize-position {bits} --quantization-volume {volume} --quantize-weight 16".split()
    run(tool("gltf-transform"), "quantize", source.path, path, *options)
    assert_comes_back(path, source.triangles, QUANTISED)


EXACT = (
    "-noq", "-noq -kn", "-noq -km", "-noq -ke", "-noq -kv", "-noq -mm", "-noq -kn -mi",
    "-noq -vi", "-noq -gn 30", "-noq -kn -km -ke -kv",
)  # fmt: skip


@pytest.mark.parametrize("options", EXACT)
def test_what_gltfpack_writes(options: str, rigid: Source, tmp_path: Path) -> None:
    path = tmp_path / ("body.gltf" if options.endswith(("kn", "noq")) else "body.glb")
    run(tool("gltfpack"), "-i", rigid.path, "-o", path, *options.split())
    assert_comes_back(path, rigid.triangles)


@pytest.mark.parametrize(
    "options",
    [
        "", "-vpn", "-vp 16", "-vp 16 -vpn", "-vp 16 -mi", "-vp 16 -kn -vi", "-vpf", "-vpf -kn", "-vpf -mi",
        "-vpf -vtf -vnf", "-vpf -vi -kv", "-noq -mi",
    ],
)  # fmt: skip
def test_what_gltfpack_quantises(options: str, rigid: Source, tmp_path: Path) -> None:
    path = tmp_path / "body.glb"
    run(tool("gltfpack"), "-i", rigid.path, "-o", path, *options.split())
    assert_comes_back(path, rigid.triangles, QUANTISED)


@pytest.mark.parametrize("options", ["-noq", "-vpf", "-vp 16", "-vp 16 -vpn -kn"])
def test_bones_that_gltfpack_writes(options: str, source: Source, tmp_path: Path) -> None:
    path = tmp_path / "body.glb"
    run(tool("gltfpack"), "-i", source.path, "-o", path, *options.split())
    assert_comes_back(path, source.triangles, EIGHT_BITS)


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("gltf-transform", "draco", "Draco"),
        ("gltf-transform", "meshopt", "meshopt"),
        ("gltfpack", "-c", "meshopt"),
    ],
)
def test_compression_is_named(name: str, options: str, said: str, source: Source, tmp_path: Path) -> None:
    path = tmp_path / "body.glb"
    if name == "gltfpack":
        run(tool(name), "-i", source.path, "-o", path, options)
    else:
        run(tool(name), options, source.path, path)
    with pytest.raises(InputError, match=re.compile(said, re.IGNORECASE)):
        read_surface(path, "the body")
