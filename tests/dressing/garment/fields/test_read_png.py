"""Brightness of images against the writer of toile and Pillow."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from toile.dressing.garment.fields.read_png import read_brightness
from toile.geometry.errors import InputError


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "LA", "I;16"])
def test_brightness(tmp_path: Path, mode: str) -> None:
    """Pillow filters rows in every way."""
    generator = np.random.default_rng(3)
    smooth = np.cumsum(generator.integers(0, 9, (23, 37)), axis=1) % 256
    path = tmp_path / "image.png"
    if mode == "I;16":
        Image.fromarray((smooth * 257).astype(np.uint16)).save(path)
    else:
        Image.fromarray(smooth.astype(np.uint8)).convert(mode).save(path)
    assert read_brightness(path) == pytest.approx(smooth / 255.0, abs=1e-9)


@pytest.mark.parametrize(
    ("content", "said"),
    [(b"GIF89a", "no PNG"), (b"\x89PNG\r\n\x1a\n", "save it as PNG"), (None, "check the path")],
)  # fmt: skip
def test_what_is_no_image_is_refused(tmp_path: Path, content: bytes | None, said: str) -> None:
    path = tmp_path / "image.png"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=said):
        read_brightness(path)


def test_a_palette_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "image.png"
    Image.new("P", (4, 4)).save(path)
    with pytest.raises(InputError, match="palette"):
        read_brightness(path)
