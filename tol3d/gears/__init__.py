"""Exact tooth geometry: closed forms only, no mesh, no CAD. Lengths in mm, angles in rad."""

from tol3d.gears.flank import LEFT, RIGHT, Flank
from tol3d.gears.involute import inverse_involute, involute
from tol3d.gears.spur_gear import SpurGear
from tol3d.gears.spur_pair import SpurPair

__all__ = ["LEFT", "RIGHT", "Flank", "SpurGear", "SpurPair", "inverse_involute", "involute"]
