"""What a contributor has in a measure by the stack-up."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Share:
    """A contributor's part in a measure.

    Args:
        name: the contributor's.
        coefficient: change of the measure per deviation, internal units (mm, rad, K).
        mean, variance: its part of the measure's mean [mm or rad] and variance.
    """

    name: str
    coefficient: float
    mean: float
    variance: float
