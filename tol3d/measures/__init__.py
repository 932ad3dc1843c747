"""Measures read a seated mesh."""

from tol3d.measures.backlash import measure_backlash

__all__ = ["measure_backlash"]
