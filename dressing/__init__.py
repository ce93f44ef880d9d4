"""What dresses bodies: files, bodies, patterns, garments, runs, batches and the command line."""
