"""What a run keeps in its output folder: a lock, its state, what an earlier run has left."""
