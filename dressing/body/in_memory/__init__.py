"""Bodies that are arrays in memory."""
