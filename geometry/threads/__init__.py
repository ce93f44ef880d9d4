"""Work of kernels shared out over threads, in parts that give the same bytes with any number of them."""
