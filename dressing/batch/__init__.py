"""Thousands of scenes, each dressed in a process of its own, with a ledger of what became of them."""
