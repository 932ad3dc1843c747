"""The result of an allocation, as a run keeps it."""

from typing import Annotated

from pydantic import Field

from tol3d.runs.summary.shows import Shows
from tol3d.runs.summary.values import Count, Known, Label, NotNegative, Number, Ppm, PpmRange, Section, Sentence


class Allocated(Section):
    """A tolerance: its factor, its cost, and the reason for it."""

    factor: Annotated[NotNegative, Shows("factor", ".4g")]
    cost: Annotated[Number, Shows("cost", ".4g")]
    before: Annotated[Label, Shows("before", "words")]
    after: Annotated[Label, Shows("after", "words")]
    held: Annotated[Sentence, Shows("", "words")] = Field(
        description='"", or what holds it: a bound, what is physical, frozen, cannot be scaled'
    )


class TargetFound(Section):
    """Builds beyond limits [ppm], as asked for and as found."""

    measure: Label
    sides: list[Label]
    wanted: Annotated[Ppm, Shows("wanted", "ppm")]
    scene: Annotated[Ppm, Shows("scene", "ppm")]
    first_order: Annotated[Ppm, Shows("first order", "ppm")]
    ppm: Annotated[Ppm, Shows("by sampling", "ppm")]
    interval: Annotated[PpmRange, Shows("95 %", "ppm range")]


class CostAt(Section):
    """The least cost for a share out of limits [ppm], by first order as corrected; None where no factors reach it."""

    ppm: Ppm
    cost: Annotated[Known, Shows("cost", ".4g")]


class Allocation(Section):
    """Factors of least cost, and their results by simulation."""

    targets: list[TargetFound]
    tolerances: dict[Label, Allocated]
    cost: Number
    scene_cost: Number
    equal_factor: Known
    equal_cost: Known
    trade_off: list[CostAt]
    rounds: Count
    draws: Count
    evaluations: Count

    @property
    def factors(self) -> dict[str, float]:
        """By tolerance."""
        return {name: own.factor for name, own in self.tolerances.items()}
