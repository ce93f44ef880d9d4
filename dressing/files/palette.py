"""Colours of body and garments in pictures and files."""

BODY = (0.80, 0.68, 0.60)
"""sRGB of the body: light clay."""

GARMENTS = (
    (0.38, 0.47, 0.59),
    (0.74, 0.42, 0.36),
    (0.86, 0.81, 0.72),
    (0.40, 0.52, 0.45),
    (0.56, 0.42, 0.55),
    (0.30, 0.33, 0.38),
)
"""sRGB of garments in scene order: dusty blue, terracotta, ecru, sage, plum, slate; then again."""


def garment_colour(index: int) -> tuple[float, float, float]:
    """Return the sRGB colour of the garment with that number."""
    return GARMENTS[index % len(GARMENTS)]


def linear(srgb: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return linear light from sRGB (IEC 61966-2-1)."""
    red, green, blue = (
        value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4 for value in srgb
    )
    return red, green, blue
