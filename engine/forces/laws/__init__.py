"""Laws of fabrics beyond constant stiffness: stretch curves, damping of bending, folds, creases."""
