"""Measures read a seated mesh."""

from tol3d.gearing.measures.backlash import measure_backlash, read_backlash, turning_gear
from tol3d.gearing.measures.lost_motion import moved, moved_rates

__all__ = ["measure_backlash", "moved", "moved_rates", "read_backlash", "turning_gear"]
