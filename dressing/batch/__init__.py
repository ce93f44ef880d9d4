"""Batches: thousands of scenes, each dressed in a process of its own, with a ledger of the outcomes."""
