"""seams.toml and FreeSewing files: what they add, and what is wrong with them."""

from pathlib import Path

import pytest

from toile.dressing.pattern.drawn.freesewing_svg import read_freesewing_svg
from toile.dressing.pattern.drawn.piece import DrawnPattern
from toile.dressing.pattern.drawn.read_drawn import DrawnOptions, told_or_sure
from toile.dressing.pattern.drawn.seams_file import apply_seams_file, seams_toml
from toile.dressing.pattern.drawn.suggest import suggest_seams
from toile.dressing.pattern.drawn.unfold import unfolded
from toile.dressing.pattern.garmentcode import check_pattern
from toile.dressing.pattern.split_seams import split_seams
from toile.geometry.errors import InputError

SAMPLES = Path(__file__).parent / "samples"


@pytest.fixture(scope="module")
def teagan() -> DrawnPattern:
    return read_freesewing_svg(SAMPLES / "freesewing_teagan_34.svg")


def test_freesewing_pieces_have_folds_notches_and_grain(teagan: DrawnPattern) -> None:
    front, back, sleeve = teagan.pieces
    assert (front.fold, back.fold, sleeve.fold, sleeve.pair) == (5, 5, None, True)
    assert [round(1e3 * notch.along) for notch in sleeve.notches] == [116, 348]
    assert [notch.back for notch in sleeve.notches] == [False, True]
    assert abs(sleeve.warp_degrees) < 0.1
    band = read_freesewing_svg(SAMPLES / "freesewing_penelope_34.svg").pieces[2]
    assert band.length(0) == pytest.approx(0.37879) and abs(band.warp_degrees) == pytest.approx(90.0)


def test_seams_of_one_side_are_sewn_on_both(teagan: DrawnPattern, tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text(seams_toml(teagan, suggest_seams(teagan).sure, ()))
    pattern = unfolded(apply_seams_file(teagan, file).drawn)
    assert len(pattern.panels) == 4
    assert len(pattern.seams) == 8
    sewn = split_seams(pattern)
    check_pattern(sewn)
    # Two sides of shoulder, side, underarm; each cap meets two armholes, which notches cut in two.
    assert len(sewn.stitches) == 6 + 2 * 4
    assert not any(stitch.right_wrong for stitch in sewn.stitches)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("seam = []", "line 1: unknown key 'seam'"),
        ("seams = 1", "line 1: seams must be a list"),
        ("seams = ['front.1']", "line 1: seam 'front.1' has only one side"),
        ("seams = [3]", "line 1: a seam is a text"),
        ("[piece.frond]\nfold = 1", "line 1: unknown piece 'frond'"),
        ("[piece.front]\nfolded = 1", "line 2: unknown key 'folded'"),
        ("[piece.front]\nfold = 77", r"no edge 77, only 0\.\.5"),
        ("[piece.front]\nfold = true", "line 2: fold must be"),
        ("[piece.front]\npair = true", "on the fold or as a pair, not both"),
        ("[piece.front]\nplace = 'nose'", "line 2: unknown place 'nose'"),
        ("worn = 'inside'", "line 1: worn must be"),
        ("open = 2\nseams = []", "line 1: 2 questions about seams are open"),
        ("seams = [", "not a valid TOML file"),
        pytest.param(
            f"seams = ['front.{5000 * '9'} = back.1']", "is no edge; write PANEL.NUMBER", id="number"
        ),
        pytest.param("seams = " + 5000 * "[", "its brackets are nested too deeply", id="deep"),
        ("piece = 3", "piece must be tables"),
    ],
)
def test_faults_of_a_seams_file_are_named(teagan: DrawnPattern, tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "s.toml"
    file.write_text(text)
    with pytest.raises(InputError, match=said) as raised:
        apply_seams_file(teagan, file)
    assert "\n" not in str(raised.value) and "s.toml" in str(raised.value)


@pytest.mark.parametrize(
    ("seam", "said"),
    [
        ("frond.1 = back~.1", "unknown piece 'frond'"),
        ("front.8 = back~.1", r"piece 'front' has no edge 8, only 0\.\.5"),
        ("front.5 = back~.1", r"front\.5 lies on the fold"),
        ("front.1 = back~.1 + back~.1", "overlap"),
    ],
)
def test_seams_of_what_does_not_exist_are_refused(
    teagan: DrawnPattern, tmp_path: Path, seam: str, said: str
) -> None:
    file = tmp_path / "s.toml"
    file.write_text(f'seams = ["{seam}"]')
    with pytest.raises(InputError, match=said):
        split_seams(unfolded(apply_seams_file(teagan, file).drawn))


def test_a_mirrored_side_needs_a_mirror(teagan: DrawnPattern, tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text('seams = ["sleeve.1 = sleeve~.1"]\n[piece.sleeve]\npair = false\n')
    with pytest.raises(InputError, match="has no mirrored side; say 'pair = true'"):
        unfolded(apply_seams_file(teagan, file).drawn)


def copied(tmp_path: Path, name: str) -> Path:
    path = tmp_path / name
    path.write_bytes((SAMPLES / name).read_bytes())
    return path


def test_what_is_sure_is_sewn_and_written_down(tmp_path: Path) -> None:
    path = copied(tmp_path, "freesewing_teagan_34.svg")
    said = told_or_sure(path, DrawnOptions())
    assert said.drawn.seams is not None and len(said.drawn.seams) == 4
    written = (tmp_path / "freesewing_teagan_34.seams.toml").read_text()
    assert "open" not in written
    # The file that was written says the same when it is read.
    assert told_or_sure(path, DrawnOptions()).drawn.seams == said.drawn.seams
    assert "2: 46.3 cm" in (tmp_path / "freesewing_teagan_34.seams.svg").read_text()


def test_what_is_open_stops_and_stays_stopped_until_it_is_answered(tmp_path: Path) -> None:
    path = copied(tmp_path, "freesewing_aaron_34.svg")
    with pytest.raises(InputError, match=r"what is sewn is not sure: .*front\.3 = back~\.3"):
        told_or_sure(path, DrawnOptions())
    with pytest.raises(InputError, match="questions about seams are open"):
        told_or_sure(path, DrawnOptions())
    file = tmp_path / "freesewing_aaron_34.seams.toml"
    file.write_text("\n".join(line for line in file.read_text().splitlines() if not line.startswith("open")))
    assert len(told_or_sure(path, DrawnOptions()).drawn.seams or ()) == 2


SQUARE = '<path class="fabric" d="M 0,0 L 50,0 L 50,50 L 0,50 z"/>'


def drawing(body: str, root: str = 'width="100mm" viewBox="0 0 100 100" freesewing="4"') -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {root}><g id="fs-stack-a.b-part-a.b">{body}</g></svg>'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<svg", "not a valid SVG"),
        (drawing("", 'freesewing="4"'), "without scale"),
        (drawing("", 'width="100%" viewBox="0 0 1 1" freesewing="4"'), "without scale"),
        (drawing("", 'width="100mm" viewBox="0 0 0 1" freesewing="4"'), "without scale"),
        (drawing("", 'width="100mm" viewBox="0 0 100 100"'), "FreeSewing did not write"),
        (drawing(""), "no pattern pieces"),
        (drawing('<path class="fabric" d="M 0,0 L 50,0 L 0,0"/>'), "'b' has no area"),
        (drawing('<path class="fabric" d="M 0,0 L 50,50 L 50,0 L 0,40 z"/>'), "'b' crosses itself"),
        (drawing('<path class="fabric" d="M 0,0 A 5,5 0 0 0 9,9 z"/>'), "path command 'A' is not known"),
        (drawing('<path class="fabric" d="M 0,0 L 5"/>'), "lacks numbers"),
        (drawing('<path class="fabric" d="M 0,0 L 1e999,0 L 0,9 z"/>'), "a coordinate that is not finite"),
        (drawing('<path class="fabric" d=""/>'), "its outline draws nothing"),
        (
            drawing(SQUARE + '<path marker-start="url(#cutonfoldFrom)" d="M 0,9 L 0,9"/>'),
            "fold line has no length",
        ),
        (drawing(SQUARE + '<use href="#notch" x="9mm"/>'), "a notch lies at x='9mm'"),
        ('<?xml version="1.0" encoding="latin9000"?>' + drawing(SQUARE), "unknown encoding"),
        ('<?xml version="1.0" encoding="hex"?>' + drawing(SQUARE), "not a valid SVG"),
    ],
)
def test_faults_of_an_svg_are_named(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "p.svg"
    path.write_text(text)
    with pytest.raises(InputError, match=said) as raised:
        read_freesewing_svg(path)
    assert "\n" not in str(raised.value) and "p.svg" in str(raised.value)


def test_lines_that_draw_nothing_are_no_fault(tmp_path: Path) -> None:
    path = tmp_path / "p.svg"
    path.write_text(drawing(SQUARE + '<path class="note" d=""/><path class="fabric" d="M 3,3"/>'))
    (piece,) = read_freesewing_svg(path).pieces
    assert piece.area == pytest.approx(0.05**2) and piece.lines == ()


def test_options_of_dxf_do_not_fit_an_svg(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="size is for DXF patterns"):
        told_or_sure(copied(tmp_path, "freesewing_teagan_34.svg"), DrawnOptions(size="34"))
