"""One implicit step: inertia, contacts, Newton iterations, safe moves."""
