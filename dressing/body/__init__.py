"""Bodies: avatars read and repaired, the built-in mannequin, measurements."""
