"""Measures read a seated mesh."""

from tol3d.measures.backlash import measure_backlash, read_backlash, turning_gear

__all__ = ["measure_backlash", "read_backlash", "turning_gear"]
