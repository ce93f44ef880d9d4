"""Poses that are made of a body without a skeleton."""
