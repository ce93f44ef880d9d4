"""Cloth and garments to play with: from Python, and in a browser through a server on this machine."""
