"""Skins of an avatar that meet."""
