"""Published figures of cycloid stages, computed by formula."""

from collections.abc import Iterator, Mapping

from pydantic import Field

from tol3d.gearing.cycloid.grammar.moves import RVReducerSpec
from tol3d.scene import Scene
from tol3d.scene.name import Name, Remark
from tol3d.scene.place import KeyPath
from tol3d.scene.published import PublishedFigures
from tol3d.scene.published.figures import NotNegative, Percent
from tol3d.strict import Strict


class PublishedSource(Strict):
    """One source of transmission error; three standard deviations of the output's angle [arc second]."""

    tolerance_um: NotNegative | None = Field(default=None, description="tolerance of the source [um]")
    by_formula_arcsec: NotNegative | None = Field(default=None, description="by the paper's own formula [arc second]")
    first_principles_arcsec: NotNegative | None = Field(
        default=None, description="of the pin with the largest lever [arc second]"
    )
    arcsec_per_um: NotNegative | None = Field(default=None, description="rate [arc second/um]")


class PublishedTotals(Strict):
    """Cycloid stage and carrier added up; three standard deviations of the output's angle [arc second]."""

    cycloid_arcsec: NotNegative | None = Field(default=None, description="of the cycloid stage [arc second]")
    carrier_arcsec: NotNegative | None = Field(default=None, description="of the carrier [arc second]")
    added_arcsec: NotNegative | None = Field(default=None, description="both added")
    root_sum_square_arcsec: NotNegative | None = Field(
        default=None, description="root of the sum of both squares [arc second]"
    )


class PublishedFormulaTotals(PublishedTotals):
    """The same by a formula, with the law that it has."""

    cycloid_half_range_arcsec: NotNegative | None = Field(default=None, description="even about 0, 99.73 % of all")
    cycloid_coverage_percent: Percent | None = Field(default=None, description="of three standard deviations")


class PublishedCycloidStage(Strict):
    """The cycloid stage and carrier of an RV reducer."""

    sources: Mapping[Name, PublishedSource] = Field(default_factory=dict, description="by the words of summary.json")
    by_formula: PublishedFormulaTotals | None = Field(default=None, description="by the paper's own formula")
    first_principles: PublishedTotals | None = Field(default=None, description="of the pin with the largest lever")
    sun_held: NotNegative | None = Field(default=None, description="turn of the output per turn of a disc")
    description: Remark = Field(default="", description="remark on these numbers")


class PublishedCycloidStages(PublishedFigures):
    """Published figures of cycloid stages, computed by formula."""

    cycloid_stages: Mapping[Name, PublishedCycloidStage] = Field(
        default_factory=dict, description="RV reducers of the scene"
    )

    def problems(self, scene: Scene) -> Iterator[tuple[KeyPath, str]]:
        """Reducers that the scene does not have."""
        return self.strangers("cycloid_stages", self.cycloid_stages, scene.of(RVReducerSpec), "an RV reducer")
