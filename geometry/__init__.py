"""Arrays, triangles, bending patches: shared ground that knows no physics."""
