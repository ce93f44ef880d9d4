"""Preconditioners of the conjugate gradient method, one per file."""
