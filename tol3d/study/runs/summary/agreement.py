"""Difference of the methods of a measure, its explanation, and the findings of the witness; in the measure's unit."""

from collections.abc import Mapping

from pydantic import Field

from tol3d.study.runs.summary.values import LEFT_OUT, Count, Known, Label, Maybe, NotNegative, Number, Section, Sentence


class LinearPart(Section):
    """Contribution of a contributor to the difference of the methods."""

    contributor: Label
    percent: Number = Field(description="of its own effect")
    standard_errors: Number
    by: Sentence


class Explanation(Section):
    """Explanation of the difference of the methods, in the measure's unit."""

    undecided: Sentence
    faults: list[Sentence]
    linear: list[LinearPart]
    largest_percent: Number
    neglected: Mapping[Label, Number]
    second_order_rms: Known
    second_order_mean: Known
    second_order_of: list[Label]
    left_rms: Known
    mean_left: Known
    mean_allowed: Known
    largest_trial: Count | None = Field(description="the trial with the largest difference")


class Agreement(Section):
    """3D simulation - analytic, trial by trial, in the measure's unit."""

    max_abs_difference: Known
    rms_difference: Known
    mean_difference: Known
    compared: Count
    explanation: Maybe[Explanation | None] = LEFT_OUT


class Witnessed(Section):
    """Witness - engine of one measure, in its unit."""

    max_abs_difference: Known
    mean_difference: Known
    rms_difference: Known
    trial_of_the_largest: Count | None
    compared: Count
    expected_at_most: NotNegative = Field(description="largest part explained by chord errors")
    allowance: NotNegative = Field(description="further allowed error of the witness")


class WitnessSummary(Section):
    """Findings of the witness for some trials."""

    engine: Label
    trials: Count
    chord_error_um: NotNegative
    measures: Mapping[Label, Witnessed]
    status_differences: Count
