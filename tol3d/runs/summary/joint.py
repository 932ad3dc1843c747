"""Joint results of the measures of a run: the share of trials within all limits, and correlations of measures."""

from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import Field, model_validator

from tol3d.runs.summary.values import LEFT_OUT, MOST_ENTRIES, Count, Label, Maybe, Method, Ppm, PpmRange, Section
from tol3d.strict import refused

MOST_CORRELATED = 1000  # measures; a matrix of a million numbers

Names = Annotated[list[Label], Field(max_length=MOST_CORRELATED)]
R = Annotated[float, Field(ge=-1.0, le=1.0)]
Row = Annotated[list[R | None], Field(max_length=MOST_CORRELATED)]
Matrix = Annotated[list[Row], Field(max_length=MOST_CORRELATED)]
CountRow = Annotated[list[Count], Field(max_length=MOST_CORRELATED)]
CountMatrix = Annotated[list[CountRow], Field(max_length=MOST_CORRELATED)]


class JointYield(Section):
    """One method's trials in which every measure that has a limit is valid and within its limits."""

    trials: Count = Field(description="all of them, failed ones too")
    within: Count
    yield_ppm: Ppm | None = Field(description="share of all trials")
    yield_ppm_95: PpmRange | None = Field(
        description="bounds of the true share, 95 % confidence; null for fewer than two replicates"
    )

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.within > self.trials:
            raise refused("within", f"at most the {self.trials} trials", self.within)
        return self


class Correlations(Section):
    """One method's correlations, each over the trials that have both values; rows and columns as `correlated`."""

    r: Matrix = Field(description="Pearson's; null where a measure does not vary or fewer than two trials have both")
    r_low_95: Matrix | None = Field(description="bounds of the true correlation, 95 % confidence, by Fisher's artanh r")
    r_high_95: Matrix | None = Field(description="null where trials are not independent")
    trials: CountMatrix = Field(description="number with both values; on the diagonal, with one")


class Joint(Section):
    """Joint results of measures."""

    limited: Annotated[list[Label], Field(max_length=MOST_ENTRIES)] = Field(description="measures that have a limit")
    yields: Maybe[Mapping[Method, JointYield]] = LEFT_OUT
    correlated: Names = Field(description="the measures of the matrices, in the order of their rows and columns")
    correlated_of: Maybe[Count] = Field(
        default=LEFT_OUT, description="number of measures with correlations in correlations.csv, if that is more"
    )
    correlations: Maybe[Mapping[Method, Correlations]] = LEFT_OUT

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if bool(self.limited) != bool(self.yields):
            raise refused("yields", "a yield where measures have limits, else none", "otherwise")
        if bool(self.correlated) != bool(self.correlations):
            raise refused("correlations", "matrices where measures are correlated, else none", "otherwise")
        size = len(self.correlated)
        for method, own in (self.correlations or {}).items():
            for key in ("r", "r_low_95", "r_high_95", "trials"):
                matrix = own[key]
                if matrix is not None and [len(row) for row in matrix] != [size] * size:
                    raise refused(f"correlations.{method}.{key}", f"{size} rows of {size}, as correlated", "others")
        return self
