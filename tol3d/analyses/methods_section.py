"""Section that a run keeps of the comparison of methods, in units of the measures."""

from collections.abc import Mapping

from pydantic import Field

from tol3d.study.runs.summary.values import (
    Count,
    Known,
    Label,
    MethodSection,
    NotNegative,
    Number,
    Section,
    Sentence,
    Unit,
)


class BuildFound(Section):
    """A build."""

    measured: Known = Field(description="of the measure, in its unit; null where it cannot be assembled")
    status: Label
    deviations: Mapping[Label, list[Number]] = Field(description="of each contributor that acts, in its unit")
    positions: Mapping[Label, Number] = Field(description="at which it is read")


class WorstFound(Section):
    """The worst builds that a search within all tolerances has found."""

    low: BuildFound | None
    high: BuildFound | None
    unseated: BuildFound | None = Field(description="a build within the tolerances that cannot be assembled")
    met: Count = Field(description="how many such builds were met")
    evaluations: Count


class FittedLaw(Section):
    """A law fitted to trials by their moments, and its test."""

    name: Label
    parameters: Mapping[Label, Number]
    low: Known = Field(description="its 0.135 % quantile")
    high: Known = Field(description="its 99.865 % quantile")
    statistic: NotNegative = Field(description="Anderson-Darling A²")
    p_value: NotNegative = Field(description="share of refitted samples of the law whose A² is as large")
    trials: Count = Field(description="that were fitted and tested")
    replicates: Count


class MethodsSample(Section):
    """Estimates of a measure by trials."""

    trials: Count
    failed: Count
    mean: Known
    sigma: NotNegative | None
    low_3sigma: Known
    high_3sigma: Known
    p0_135: Known = Field(validation_alias="p0.135", description="0.135 % quantile; null of too few trials")
    p99_865: Known = Field(validation_alias="p99.865")
    sample_min: Known
    sample_max: Known
    skewness: Known
    kurtosis: Known = Field(description="excess kurtosis")
    beyond_worst: Count = Field(description="trials beyond the worst found: of laws that draw beyond their limits")
    law: FittedLaw | None


class MeasureMethods(Section):
    """All methods for one measure."""

    unit: Unit
    lower_limit: Known
    upper_limit: Known
    mean: Known = Field(description="of the mean build")
    contributors: Count = Field(description="with a slope, features that are drawn each for itself one by one")
    by_slopes: NotNegative | None = Field(
        description="sum of all half tolerances by slopes at the mean build; null of a measure without slope there"
    )
    rss: NotNegative | None = Field(description="root of the sum of their squares; null likewise")
    factor: NotNegative | None = Field(description="C_f of modified RSS; null of one contributor")
    modified_rss: NotNegative | None
    worst: WorstFound | None = Field(description="null where it would take too many builds, or nothing acts")
    nothing_acts: Sentence = Field(default="", description="where no contributor was seen to act; else empty")
    simulation: MethodsSample
    evaluations: Count


class Methods(MethodSection):
    """Methods side by side."""

    scene: Label
    contributors: Mapping[Label, Label] = Field(description="units of all, in which builds have their deviations")
    measures: Mapping[Label, MeasureMethods]
    evaluations: Count
