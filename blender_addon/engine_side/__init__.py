"""The engine's process: the worker, and the frames it writes. No bpy here."""
