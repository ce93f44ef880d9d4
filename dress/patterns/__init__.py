"""Built-in patterns, drafted to a body."""
