"""Exact tooth geometry: closed forms only, no mesh, no CAD. Lengths in mm, angles in rad.

One gear: `spur_gear`, `internal_gear`, `bevel_gear`; two of them: `spur_pair`, `internal_pair`, `bevel_pair`. Measures
of teeth (`tooth_measures`) and classes of flanks (`iso1328`) beside them. No scene, draw or trial is known here. Read
`pair.py` first, what every pair offers.
"""

from tol3d.gears.bevel_gear import BevelGear, pitch_angles
from tol3d.gears.bevel_pair import BevelPair
from tol3d.gears.flank import LEFT, LEFT_HAND, RIGHT, RIGHT_HAND, Flank, Hand, opposite
from tol3d.gears.internal_gear import InternalGear
from tol3d.gears.internal_pair import InternalPair
from tol3d.gears.involute import inverse_involute, involute
from tol3d.gears.pair import Displaced, Gear, GearPair, driver_teeth_at_one_tooth, one_tooth_acts, one_tooth_share
from tol3d.gears.spherical_involute import inverse_spherical_involute, spherical_involute
from tol3d.gears.spur_gear import SpurGear
from tol3d.gears.spur_pair import SpurPair
from tol3d.gears.undercut import RACK_ADDENDUM

__all__ = [
    "LEFT",
    "LEFT_HAND",
    "RACK_ADDENDUM",
    "RIGHT",
    "RIGHT_HAND",
    "BevelGear",
    "BevelPair",
    "Displaced",
    "Flank",
    "Gear",
    "GearPair",
    "Hand",
    "InternalGear",
    "InternalPair",
    "SpurGear",
    "SpurPair",
    "driver_teeth_at_one_tooth",
    "inverse_involute",
    "inverse_spherical_involute",
    "involute",
    "one_tooth_acts",
    "one_tooth_share",
    "opposite",
    "pitch_angles",
    "spherical_involute",
]
