"""What summary.json holds of a cycloid stage by formula: the published one as reconstructed, and first principles."""

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from tol3d.runs.summary.run import RunSummary
from tol3d.runs.summary.values import LEFT_OUT, MOST_ENTRIES, Label, Maybe, Number, Section


class SourceByFormula(Section):
    """One source of transmission error; three standard deviations of the output's angle [arc second]."""

    tolerance_um: Number = Field(description="tolerance or run-out that its standard deviation stands for")
    by_formula_arcsec: Number
    first_principles_arcsec: Number
    arcsec_per_um: Number = Field(description="first principles: turn of a disc whose best pin alone touches")


class StageTotals(Section):
    """Cycloid stage and carrier added up; three standard deviations [arc second]."""

    cycloid_arcsec: Number
    carrier_arcsec: Number
    added_arcsec: Number = Field(description="both added")
    root_sum_square_arcsec: Number


class FormulaTotals(StageTotals):
    """The same by the published formula, with the law that it has."""

    cycloid_half_range_arcsec: Number = Field(description="even about 0, 99.73 % of all: its law is not normal")
    cycloid_coverage_percent: Number = Field(description="what three standard deviations cover")


class CycloidStageSummary(Section):
    """The cycloid stage and carrier of an RV reducer by formula."""

    sources: Mapping[Label, SourceByFormula]
    by_formula: FormulaTotals = Field(description="the published formula, as reconstructed")
    first_principles: StageTotals = Field(description="of the pin with the largest lever alone")
    sun_held: Maybe[Number] = Field(
        default=LEFT_OUT, description="turn of the output while the sun stands per turn of a disc"
    )
    left_out: Annotated[list[Label], Field(max_length=MOST_ENTRIES)] = Field(
        description="contributors that the formula does not know"
    )


class CycloidOfRun(RunSummary):
    """The cycloid stages of a run."""

    cycloid_stages: Maybe[Mapping[Label, CycloidStageSummary]] = LEFT_OUT
