"""Scenes that studies share."""
