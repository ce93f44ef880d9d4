"""A cloth mesh made to fit a sizing field: splits, flips, collapses, and data carried over."""
