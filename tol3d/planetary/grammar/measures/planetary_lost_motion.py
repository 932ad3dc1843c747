"""Lost motion of a planetary set."""

from typing import Literal

from tol3d.planetary.grammar.measures.planetary_measure import PlanetaryFreeTurnSpec


class PlanetaryLostMotionSpec(PlanetaryFreeTurnSpec):
    """An angle: the free turn of the output while the input stands, or of the input while the output stands.

    Planets, and shafts that neither are held nor drive, turn with it as their meshes let them.
    """

    kind: Literal["planetary_lost_motion"]
