"""Scenes that ship with tol3d: examples and tests at once."""
