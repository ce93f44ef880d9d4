"""How long edges should be: metrics from curvature, motion and obstacles, and their algebra."""
