"""Collision detection: surfaces in, close pairs and safe moves out."""
