"""DXF-AAMA and ASTM: areas, folds, notches, sizes and units of the samples; files that cannot be read."""

from pathlib import Path

import numpy as np
import pytest

from tests.dressing.pattern.drawn.drawing_math import OWN_TEE, bezier_area, fabric_area
from toile.dressing.pattern.drawn.dxf import read_dxf_pattern
from toile.dressing.pattern.drawn.piece import DrawnPattern, Piece
from toile.dressing.pattern.drawn.seams_file import apply_seams_file
from toile.dressing.pattern.drawn.unfold import panels_of
from toile.dressing.pattern.pattern_outline import default_segments, outline, signed_area
from toile.geometry.errors import InputError

SAMPLES = Path(__file__).parent / "samples"
AAMA, ASTM = "own_tee_valentina_aama_r12.dxf", "own_tee_valentina_astm_2013.dxf"
ACCUMARK, CLO = "synthetic_accumark_astm_teagan.dxf", "synthetic_clo_english_teagan.dxf"


def by_name(drawn: DrawnPattern) -> dict[str, Piece]:
    return {piece.name.upper(): piece for piece in drawn.pieces}


@pytest.mark.parametrize(("file", "units"), [(AAMA, "mm"), (ASTM, None)])
def test_areas_of_sew_lines_are_those_of_the_source(file: str, units: str | None) -> None:
    pieces = by_name(read_dxf_pattern(SAMPLES / file, units=units))
    for name, curves in OWN_TEE.items():
        assert pieces[name].area == pytest.approx(1e-4 * bezier_area(curves), rel=1e-3), name
        assert pieces[name].warp_degrees == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(("file", "units"), [(AAMA, "mm"), (ASTM, None)])
def test_notches_lie_on_the_sew_line_where_the_source_has_them(file: str, units: str | None) -> None:
    """Points of the .val file [cm], y down, measured from the piece's lower left corner."""
    marks = {
        "FRONT": [(18.5, 14.0), (25.0, 40.0)],
        "BACK": [(19.2, 14.0), (25.0, 40.0)],
        "SLEEVE": [(18.0, 0.0)],
    }
    heights = {"FRONT": 60.0, "BACK": 60.0, "SLEEVE": 30.0}
    for name, piece in by_name(read_dxf_pattern(SAMPLES / file, units=units)).items():
        low = piece.outline.min(axis=0)
        found = []
        for notch in piece.notches:
            edge = piece.edges[notch.edge]
            walked = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(edge, axis=0), axis=1))])
            found.append([np.interp(notch.along, walked, edge[:, axis]) for axis in (0, 1)] - low)
        assert len(found) == len(marks[name])
        for x, y in marks[name]:
            place = 0.01 * np.array([x, heights[name] - y])
            assert min(np.linalg.norm(point - place) for point in found) < 1e-3, name


def test_halves_unfold_to_twice_their_area(tmp_path: Path) -> None:
    for piece in read_dxf_pattern(SAMPLES / ACCUMARK, size="34", allowance=0.0).pieces:
        panels = panels_of(piece)
        area = sum(signed_area(outline(panel, default_segments(panel, 400))[0]) for panel in panels)
        assert area == pytest.approx(2.0 * piece.area, rel=1e-4)
        if piece.fold is not None:
            (panel,) = panels
            assert len(panel.edges) == 2 * (len(piece.edges) - 1)
            x = np.array(panel.vertices)[:, 0]
            assert x.max() == pytest.approx(-x.min(), abs=1e-9)


def test_pieces_of_one_design_have_one_area_in_every_layout() -> None:
    """The same Teagan from FreeSewing, as AccuMark and as CLO lay it out."""
    front, back, sleeve = (
        fabric_area(SAMPLES / "freesewing_teagan_34.svg", part) for part in ("front", "back", "sleeve")
    )
    halves = read_dxf_pattern(SAMPLES / ACCUMARK, size="34", allowance=0.0).pieces
    assert [piece.area for piece in halves] == pytest.approx([front, back, sleeve], rel=1e-3)
    assert [(p.fold is not None, p.pair) for p in halves] == [(True, False), (True, False), (False, True)]
    whole = read_dxf_pattern(SAMPLES / CLO, allowance=0.0).pieces
    assert [piece.area for piece in whole] == pytest.approx([2 * front, 2 * back, sleeve, sleeve], rel=1e-3)
    assert [len(piece.edges) for piece in whole] == [8, 8, 4, 4]
    assert [piece.warp_degrees for piece in halves] == pytest.approx([-90.0] * 3)


def test_a_size_is_chosen_and_takes_over_what_only_the_base_size_says() -> None:
    pieces = read_dxf_pattern(SAMPLES / ACCUMARK, size="42", allowance=0.0).pieces
    assert [piece.name for piece in pieces] == ["TEAGAN-FR", "TEAGAN-BA", "TEAGAN-SL"]
    assert pieces[0].length(0) == pytest.approx(0.32804)
    assert pieces[2].pair
    assert "SLEEVE" in pieces[2].words


def test_an_allowance_is_taken_off_but_not_at_the_fold() -> None:
    drawn = read_dxf_pattern(SAMPLES / ACCUMARK, size="34", allowance=0.01)
    full = read_dxf_pattern(SAMPLES / ACCUMARK, size="34", allowance=0.0)
    for piece, whole in zip(drawn.pieces, full.pieces, strict=True):
        rim = sum(whole.length(n) for n in range(len(whole.edges)) if n != whole.fold)
        # To first order; corners count for little.
        assert whole.area - piece.area == pytest.approx(0.01 * rim, rel=0.05)
        if whole.fold is not None:
            axis = int(np.ptp(whole.edges[whole.fold], axis=0).argmin())
            assert piece.edges[whole.fold][:, axis] == pytest.approx(0.0, abs=1e-9)


def test_ezdxf_sees_the_same_points() -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.readfile(SAMPLES / ASTM)
    lines = [e for block in document.blocks for e in block if e.dxf.layer == "14"]
    lengths = sorted(
        float(np.linalg.norm(np.diff(np.vstack([p, p[:1]]), axis=0), axis=1).sum())
        for p in (np.array([(x, y) for x, y, *_ in line.get_points()]) for line in lines)
    )
    ours = sorted(
        1e3 * sum(piece.length(n) for n in range(len(piece.edges)))
        for piece in read_dxf_pattern(SAMPLES / ASTM).pieces
    )
    assert ours == pytest.approx(lengths, abs=1e-4)


def block(name: str, points: str, *, closed: int = 1, text: str = "", mirror: str = "") -> str:
    """A block with one polyline on layer 1, perhaps a text, and a mirror line by its ends."""
    vertices = "".join(
        f"0\nVERTEX\n8\n1\n10\n{x}\n20\n{y}\n" for x, y in (p.split(",") for p in points.split())
    )
    words = f"0\nTEXT\n8\n1\n10\n0\n20\n0\n1\n{text}\n" if text else ""
    if mirror:
        x, y, to_x, to_y = mirror.replace(" ", ",").split(",")
        words += f"0\nLINE\n8\n6\n10\n{x}\n20\n{y}\n11\n{to_x}\n21\n{to_y}\n"
    return (
        f"0\nBLOCK\n8\n1\n2\n{name}\n70\n64\n{words}0\nPOLYLINE\n8\n1\n66\n1\n70\n{closed}\n{vertices}"
        "0\nSEQEND\n8\n1\n0\nENDBLK\n8\n1\n"
    )


def file_of(tmp_path: Path, *blocks: str, units: str = "UNITS: METRIC") -> Path:
    path = tmp_path / "p.dxf"
    words = f"0\nTEXT\n8\n1\n10\n0\n20\n0\n1\n{units}\n" if units else ""
    path.write_text(
        "0\nSECTION\n2\nBLOCKS\n"
        + "".join(blocks)
        + f"0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{words}0\nENDSEC\n0\nEOF\n"
    )
    return path


SQUARE = "0,0 300,0 300,300 0,300"


def test_inches_are_inches(tmp_path: Path) -> None:
    path = file_of(tmp_path, block("A", "0,0 10,0 10,20 0,20"), units="UNITS: ENGLISH")
    assert read_dxf_pattern(path, allowance=0.0).pieces[0].area == pytest.approx(200 * 0.0254**2)


def test_points_that_are_there_twice_or_on_a_side_make_no_corners(tmp_path: Path) -> None:
    path = file_of(tmp_path, block("A", "0,0 0,0 150,0 300,0 300,300 300,300 0,300 0,0"))
    (piece,) = read_dxf_pattern(path, allowance=0.0).pieces
    assert piece.area == pytest.approx(0.09)
    assert [piece.length(n) for n in range(len(piece.edges))] == pytest.approx([0.3] * 4)


def test_blocks_of_one_name_stay_apart(tmp_path: Path) -> None:
    path = file_of(tmp_path, block("DETAIL", SQUARE), block("DETAIL", "0,0 100,0 100,100 0,100"))
    drawn = read_dxf_pattern(path, allowance=0.0)
    assert [(p.name, round(p.area, 4)) for p in drawn.pieces] == [("DETAIL", 0.09), ("DETAIL_2", 0.01)]
    assert "'DETAIL' is there more than once" in drawn.notes[0]


def test_names_in_another_script_are_read(tmp_path: Path) -> None:
    path = file_of(tmp_path, block("A", SQUARE))
    path.write_bytes(path.read_bytes().replace(b"\nA\n", b"\n\xcf\xe5\xf0\xe5\xe4\n", 1))
    assert len(read_dxf_pattern(path, allowance=0.0).pieces) == 1


@pytest.mark.parametrize(
    ("blocks", "units", "options", "said"),
    [
        ([block("A", SQUARE)], "", {"allowance": 0.0}, "does not say its units"),
        ([block("A", SQUARE)], "UNITS: METRIC", {}, "'A' has no sew line"),
        ([block("A", SQUARE, closed=0)], "UNITS: METRIC", {"allowance": 0.0}, "has an open outline: 300 mm"),
        ([block("A", "0,0 300,0 600,0")], "UNITS: METRIC", {"allowance": 0.0}, "'A' has no area"),
        ([block("A", "0,0 300,300 300,0 0,300")], "UNITS: METRIC", {"allowance": 0.0}, "crosses|no area"),
        ([block("A", "0,0 300,x 300,300")], "UNITS: METRIC", {"allowance": 0.0}, "no number"),
        ([], "UNITS: METRIC", {"allowance": 0.0}, "no pattern pieces"),
        ([block("A", SQUARE).replace("\n70\n1\n", "\n70\n1e999\n")], "UNITS: METRIC", {}, "a POLYLINE on"),
        ([block("A", SQUARE, text="QUANTITY: " + 5000 * "9")], "UNITS: METRIC", {}, "'A' has no sew line"),
        ([block("A", SQUARE, mirror="9,9 9,9")], "UNITS: METRIC", {"allowance": 0.0}, "mirror line has no"),
        ([block("A", SQUARE)], "UNITS: METRIC", {"allowance": 0.0, "size": "40"}, "no size 40"),
        ([block("A", SQUARE)], "", {"allowance": 0.0, "units": "mile"}, "unit 'mile'"),
        (
            [block("A_38", SQUARE, text="SIZE: 38"), block("A_40", SQUARE, text="SIZE: 40")],
            "UNITS: METRIC",
            {"allowance": 0.0},
            "holds the sizes 38, 40; choose one",
        ),
        (
            [block("A_38", SQUARE, text="SIZE: 38"), block("A_40", SQUARE, text="SIZE: 40")],
            "UNITS: METRIC",
            {"allowance": 0.0, "size": "44"},
            "no size 44; the sizes are 38, 40",
        ),
    ],
)  # fmt: skip
def test_files_that_cannot_be_read_say_why_in_one_line(
    tmp_path: Path, blocks: list[str], units: str, options: dict[str, str], said: str
) -> None:
    with pytest.raises(InputError, match=said) as raised:
        read_dxf_pattern(file_of(tmp_path, *blocks, units=units), **options)  # type: ignore[arg-type]
    assert "\n" not in str(raised.value) and "p.dxf" in str(raised.value)


def test_what_is_no_dxf_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "p.dxf"
    path.write_text("hello\nworld\n")
    with pytest.raises(InputError, match="line 1: 'hello' is no group code"):
        read_dxf_pattern(path)
    path.write_bytes(b"AutoCAD Binary DXF\r\n")
    with pytest.raises(InputError, match="binary DXF"):
        read_dxf_pattern(path)


def test_a_seams_file_adds_folds_and_pairs(tmp_path: Path) -> None:
    drawn = read_dxf_pattern(SAMPLES / AAMA, units="mm")
    file = tmp_path / "s.toml"
    file.write_text("piece.FRONT.fold = 5\npiece.SLEEVE.pair = true\n")
    told = apply_seams_file(drawn, file).drawn
    assert by_name(told)["FRONT"].fold == 5 and by_name(told)["SLEEVE"].pair
    assert told.seams is None
