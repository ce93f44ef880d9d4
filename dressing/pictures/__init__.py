"""Pictures, rendered on the CPU."""
