"""Displacement of an arm's point by the lost motion of its train."""

from typing import Literal

from pydantic import Field

from tol3d.gearing.grammar.measures.tip_measure import TipMeasureSpec
from tol3d.scene.direction import RandomOrFixed


class TipDisplacementSpec(TipMeasureSpec):
    """A length: how far the point goes from one end of the lost motion to the other."""

    kind: Literal["tip_displacement"]
    over: RandomOrFixed = Field(
        default="random", description="position of the train's driven shaft: random or {at: angle}"
    )
