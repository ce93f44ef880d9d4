"""Thousands of scenes, each dressed in a process of its own, with a ledger of what became of them."""

import os

if not hasattr(os, "fork"):
    raise ImportError("batches need a system that can fork, Linux or macOS; on Windows use WSL")
