"""glTF files: what they hold, and where their nodes, bones and morph targets put it."""
