"""Sizing fields: metrics from curvature, motion and obstacles, and their algebra."""
