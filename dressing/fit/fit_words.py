"""What a scene may say of fit."""

from toile.dressing.files.suggestion import unknown_name
from toile.geometry.errors import InputError

CHECKED = "checked"
FIT_WORDS = ("off", "maps", CHECKED)
"""Nothing; maps; maps with error bars."""


def check_fit(word: object) -> None:
    """Raise InputError for a word that is none of these."""
    if word not in FIT_WORDS:
        raise InputError(unknown_name("fit", str(word), FIT_WORDS), field="fit")
