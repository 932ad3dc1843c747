"""The result of an allocation, as a run keeps it."""

from pydantic import Field

from tol3d.runs.summary.values import Count, Known, Label, NotNegative, Number, Ppm, PpmRange, Section, Sentence


class Allocated(Section):
    """A tolerance: its factor, its cost, and the reason for it."""

    factor: NotNegative
    cost: Number
    before: Label
    after: Label
    held: Sentence = Field(description='"", or what holds it: a bound, what is physical, frozen, cannot be scaled')


class TargetFound(Section):
    """Builds beyond limits [ppm], as asked for and as found."""

    measure: Label
    sides: list[Label]
    wanted: Ppm
    scene: Ppm
    first_order: Ppm
    ppm: Ppm
    interval: PpmRange


class CostAt(Section):
    """The least cost for a share out of limits [ppm], by first order as corrected; None where no factors reach it."""

    ppm: Ppm
    cost: Known


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
