"""Everything about garments and bodies: files, bodies, patterns, garments, runs, batches, command line."""
