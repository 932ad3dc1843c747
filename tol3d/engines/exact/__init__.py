"""The exact engine: compiled contact of mathematical flanks."""

from tol3d.engines.exact.engine import ExactEngine

__all__ = ["ExactEngine"]
