"""What docs/extending.md promises a newcomer: each recipe is short, complete, shown as it is, and works."""

import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import toile
from toile.dressing.garment import readers
from toile.dressing.garment.fabrics import checked_fabric
from toile.dressing.pattern import drafts
from toile.dressing.pattern.garmentcode import check_pattern
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float

ROOT = Path(__file__).resolve().parents[2]
RECIPES = ("own_force", "own_fabric", "own_garment_reader", "own_draft")
PAGE = (ROOT / "docs" / "extending.md").read_text()


@pytest.mark.parametrize("name", RECIPES)
def test_recipe_is_short_and_shown_whole(name: str) -> None:
    text = (ROOT / "examples" / f"{name}.py").read_text()
    lines = len([line for line in text.splitlines() if line.strip()])
    assert lines <= (40 if name == "own_force" else 60)
    assert f"`examples/{name}.py`\n\n```python\n{text}```" in PAGE
    row = re.search(rf"\| `{name}.py` \| (\d+) \|", PAGE)
    assert row is not None and int(row.group(1)) == lines


def differences(function: object, x: Float, step: float) -> Float:
    """Central differences of a function of positions, one row per coordinate."""
    assert callable(function)
    rows = []
    for index in range(x.size):
        shift = np.zeros(x.size)
        shift[index] = step
        away = shift.reshape(x.shape)
        rows.append((function(x + away) - function(x - away)) / (2.0 * step))
    return np.array(rows)


def test_force_has_the_derivatives_it_says() -> None:
    example = import_module("examples.own_force")
    generator = np.random.default_rng(5)
    # Half of the nodes within the width of the well, where the Hessian is positive, and half farther out.
    reach = np.repeat([0.05, 0.25], 4)[:, None]
    direction = generator.normal(size=(8, 3))
    x = example.PLACE + reach * direction / np.linalg.norm(direction, axis=1)[:, None]
    magnet = example.Magnet(generator.uniform(0.5, 2.0, 8))

    def gradient(x: Float) -> Float:
        into = np.zeros_like(x)
        magnet.add_gradient(x, into)
        return into.ravel()

    found = gradient(x)
    assert found == pytest.approx(differences(magnet.energy, x, 1e-6), abs=1e-6 * np.abs(found).max())

    hessian, added = Hessian(8, []), np.zeros_like(x)
    magnet.linearise(x, added, hessian)
    assert np.array_equal(added.ravel(), found)
    dense, exact = hessian.to_dense(), differences(gradient, x, 1e-6)
    assert dense[:12, :12] == pytest.approx(exact[:12, :12], abs=1e-6 * np.abs(exact).max())
    assert np.linalg.eigvalsh(dense).min() > -1e-12 * np.abs(dense).max()
    # Farther out the negative direction is left out and the two others are kept.
    for node in range(4, 8):
        own = slice(3 * node, 3 * node + 3)
        kept = np.maximum(np.linalg.eigvalsh(exact[own, own]), 0.0)
        assert np.linalg.eigvalsh(dense[own, own]) == pytest.approx(kept, abs=1e-6 * kept.max())


def test_fabric_is_physical() -> None:
    felt = import_module("examples.own_fabric").FELT
    assert checked_fabric(felt) is felt


def test_reader_reads_its_drawing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(readers, "_READERS", dict(readers._READERS))
    example = import_module("examples.own_garment_reader")
    file = tmp_path / "drawn.SVG"
    file.write_text(example.DRAWING)
    toile.register_reader(".svg", example.read_svg)

    pattern = readers.read_garment(file)

    assert isinstance(pattern, toile.Pattern)
    assert [panel.name for panel in pattern.panels] == ["front", "back"]
    assert pattern.panels[0].vertices[0] == (-0.48, 0.88)
    # Sewn edges are mirror images: of the same length, and the end of one lies on the start of the other.
    for stitch in pattern.stitches:
        front, back = pattern.panel(stitch.panel_a), pattern.panel(stitch.panel_b)
        a, b = front.edges[stitch.edge_a], back.edges[stitch.edge_b]
        assert front.vertices[a.end] == back.vertices[b.start]
        assert front.vertices[a.start] == back.vertices[b.end]


@pytest.mark.parametrize(
    ("drawing", "message"),
    [("<svg", "not valid SVG"), ("missing seam", "'front' has 9 edges, data-sewn names 8")],
)
def test_reader_names_what_is_wrong(drawing: str, message: str, tmp_path: Path) -> None:
    example = import_module("examples.own_garment_reader")
    file = tmp_path / "drawn.svg"
    file.write_text(drawing if drawing == "<svg" else example.DRAWING.replace('"- - arm_l', '"- arm_l', 1))
    with pytest.raises(toile.InputError, match=message):
        example.read_svg(file)


def test_draft_fits_who_wears_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drafts, "_DRAFTS", dict(drafts._DRAFTS))
    draft = import_module("examples.own_draft").a_line_skirt
    toile.register_draft("a_line_skirt", draft)
    body = toile.measure(toile.mannequin(height=1.60, waist=0.80))

    pattern = drafts.built_in("A-line skirt", body)

    check_pattern(pattern)
    waist = [
        abs(panel.vertices[edge.end][0] - panel.vertices[edge.start][0])
        for panel in pattern.panels
        for edge in panel.edges
        if edge.label == "lower_interface"
    ]
    assert len(waist) == 2 and sum(waist) == pytest.approx(body.waist + 0.01)
