"""The exact engine: compiled contact of mathematical flanks."""

from tol3d.gearing.engines.exact.engine import ExactEngine

__all__ = ["ExactEngine"]
