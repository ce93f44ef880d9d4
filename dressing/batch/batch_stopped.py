"""The error that means: a batch could not go on, and nothing is lost."""


class BatchStopped(Exception):
    """A batch had to stop: a full disk, say. The message is one line; the same call goes on where it was."""
