"""Hard cases that break cloth simulators."""
