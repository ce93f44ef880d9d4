"""Studies of the engine: validation, hard cases, speed against error."""
