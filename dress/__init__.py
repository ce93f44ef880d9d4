"""Scenes, garments, avatars, recording and the command line."""
