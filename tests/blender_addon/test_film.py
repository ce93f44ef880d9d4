"""A moving body dressed by script in real Blender: frames, attributes, files; the same as without Blender."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.blender_addon.conftest import Blender
from toile.dressing.run.dress import dress
from toile.dressing.run.result import DressedGarment
from toile.dressing.run.scene_file import load_scene


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("film")


@pytest.fixture(scope="module")
def found(blender: Blender, folder: Path) -> dict[str, Any]:
    return blender("film.py", folder)


def test_the_operator_works_without_an_event_loop(found: dict[str, Any]) -> None:
    assert found["answer"] == ["FINISHED"] and found["state"] == "complete"
    assert found["sidecar"]["state"] == "complete" and set(found["sidecar"]["fingerprints"]) == {
        "settings", "topology"
    }  # fmt: skip
    assert found["sidecar"]["report"]["animation"]["intersections_max"] == 0


def test_topology_changes_on_scrub(found: dict[str, Any]) -> None:
    counts = [(frame["vertices"], frame["faces"]) for frame in found["frames"]]
    assert len(set(counts)) > 1 and all(faces > vertices for vertices, faces in counts)


def test_materials_uvs_groups_and_attributes_follow(found: dict[str, Any]) -> None:
    """Every attribute of the sheet is a function of its UVs, and so it is in every frame."""
    assert max(found["errors"].values()) < 1e-5
    for frame in found["frames"]:
        assert frame["materials"] == [0, 1] and frame["smooth"] and frame["uv"] == pytest.approx([0.0, 1.0])


def test_velocities_are_there_for_motion_blur(found: dict[str, Any]) -> None:
    assert found["frames"][0]["speed"] == 0.0 and found["frames"][4]["speed"] > 0.1


def test_the_original_mesh_is_untouched(found: dict[str, Any]) -> None:
    assert found["original kept"] and found["original shown"]


def test_frames_are_found_again(found: dict[str, Any]) -> None:
    """Saved, moved and opened without the add-on; linked into another file; exported."""
    assert found["path"].startswith("//") and all(found["moved"])
    assert found["linked"] == found["frames"][3]["vertices"]
    assert min(found["exported"]) > 10_000


def test_a_frame_can_be_applied(found: dict[str, Any]) -> None:
    assert found["applied"] == [True, [], 2, "NONE"]


def test_frames_are_those_of_the_engine(found: dict[str, Any], folder: Path) -> None:
    """The same scene folder without Blender gives the same positions, to the single precision of USD."""
    frames: list[DressedGarment] = []
    dress(load_scene(folder / "engine" / "scene.toml"), record=lambda _, garments: frames.append(garments[0]))
    assert len(frames) == len(found["frames"])
    for number, (garment, matrix) in enumerate(zip(frames, np.load(folder / "to_local.npy"), strict=True), 1):
        local = garment.positions @ matrix[:3, :3].T + matrix[:3, 3]
        assert np.array_equal(local.astype(np.float32), np.load(folder / f"shown_{number}.npy"))
