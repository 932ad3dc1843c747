"""Region of low stiffness of a planetary set on a flexible carrier."""

from typing import Literal

from tol3d.planetary.grammar.measures.planetary_measure import PlanetaryFreeTurnSpec


class PlanetaryLowStiffnessSpec(PlanetaryFreeTurnSpec):
    """An angle: how far a shaft turns against the springs of a flexible carrier alone, both ways together.

    From where springs hold the planets, beyond the breakaway torque, to where contacts stop them for good: the region
    in which the set is as stiff as its springs. The lost motion that springs leave is not in it.
    """

    kind: Literal["planetary_low_stiffness"]
