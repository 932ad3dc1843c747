"""Planetary gear sets: central gears on one axis, planets on a carrier; simple, compound and 3K (Wolfrom) by one code.

`model/tooth_set.py` is what all of it shares: tooth numbers, ratios, which numbers of planets can be assembled.
`design/` finds sets and their efficiencies.
"""

from tol3d.planetary.model.tooth_set import CARRIER, CentralMesh, ToothSet, compound, simple, wolfrom

__all__ = ["CARRIER", "CentralMesh", "ToothSet", "compound", "simple", "wolfrom"]
