"""Cloth that goes on step by step while somebody plays with it."""
