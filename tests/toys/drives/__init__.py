"""Links of shafts from elsewhere: their kinds stand in scenes of gears, which nothing of the package knows.

coupling   jaws with a slack: both methods differ to third order
belt       a toothed belt: its play depends on the position, and has a middle of its own
planet     a gear on a carrier
"""

from typing import Final

from tol3d.study.system.mechanism import Mechanism
from toys.drives.belt import BeltSpec, PulleyOffsetSpec, SpanSpec
from toys.drives.coupling import CouplingSpec, JawWearSpec
from toys.drives.planet import PlanetPlaySpec, PlanetSpec

DRIVES: Final = Mechanism(
    name="drives",
    tolerances=(JawWearSpec, SpanSpec, PulleyOffsetSpec, PlanetPlaySpec),
    moves=(CouplingSpec, BeltSpec, PlanetSpec),
    extends=("gearing",),
    requires=("jsonschema",),
)
