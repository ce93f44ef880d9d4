"""The one error that means: the input is at fault, and this is what to do about it."""


class InputError(ValueError):
    """Bad input. The message is one line: the file, field or faces at fault, and what to do."""
