"""The exception for a batch that had to stop; no result is lost."""


class BatchStopped(Exception):
    """A batch had to stop, by a full disk, say. The message is one line; the same call resumes it."""
