"""Hard cases: what makes cloth simulators fail."""
