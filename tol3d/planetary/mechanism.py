"""Planetary sets, as a mechanism: planets between central gears, solved together."""

from typing import Final

from tol3d.planetary.grammar import measures, moves, parts, tolerances
from tol3d.scene.grammar import specs_in
from tol3d.system.mechanism import Mechanism

PLANETARY: Final = Mechanism(
    name="planetary",
    parts=specs_in(parts),
    tolerances=specs_in(tolerances),
    moves=specs_in(moves),
    measures=specs_in(measures),
    includes=("gearing",),
    engines=("exact",),
    system="tol3d.planetary.from_scene:planetary_system",
    presenter="tol3d.planetary.presenting",
    requires=("cadquery",),
)
