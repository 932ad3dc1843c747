"""Planetary gear sets: central gears on one axis, planets on a carrier; simple, compound and 3K (Wolfrom) by one code.

`model/tooth_set.py` is shared by all of it: tooth numbers, ratios, numbers of planets that can be assembled.
`model/efficiency.py` has their efficiencies; `tol3d.apps.design` finds sets.
"""

from tol3d.gearing.planetary.model.efficiency import (
    Drive,
    MeshEfficiencies,
    Sharing,
    efficiency,
    published_efficiencies,
    shared_sliding_factor,
    sliding_factor,
)
from tol3d.gearing.planetary.model.tooth_set import CARRIER, CentralMesh, ToothSet, compound, simple, wolfrom

__all__ = [
    "CARRIER",
    "CentralMesh",
    "Drive",
    "MeshEfficiencies",
    "Sharing",
    "ToothSet",
    "compound",
    "efficiency",
    "published_efficiencies",
    "shared_sliding_factor",
    "simple",
    "sliding_factor",
    "wolfrom",
]
