"""Published figures for trains."""

import re
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Final, Self

from pydantic import Field, model_validator

from tol3d.gearing.grammar.moves import TrainSpec
from tol3d.scene.name import Name, Remark
from tol3d.scene.nearest import hint
from tol3d.scene.place import KeyPath
from tol3d.scene.published import PublishedFigures
from tol3d.scene.published.figures import Figure, NotNegative, Percent
from tol3d.strict import Strict, refused
from tol3d.units import Of, Quantity

if TYPE_CHECKING:
    from tol3d.scene.schema import Scene

IN_PARALLEL: Final = re.compile(r" ∥ | \+ ")  # in the name of parallel load paths, between those of their links

Angle = Annotated[Quantity, Of("angle")]


class PublishedEnds(Strict):
    """Lost motion of a stage at its driven shaft, or the sum of the stages' ends at the shaft that is read."""

    low_3sigma: Angle | None = Field(default=None, description="mean - 3 sigma")
    mean: Angle | None = Field(default=None, description="mean")
    high_3sigma: Angle | None = Field(default=None, description="mean + 3 sigma")
    sigma: Angle | None = Field(default=None, description="standard deviation")
    sample_min: Angle | None = Field(default=None, description="smallest of the trials")
    sample_max: Angle | None = Field(default=None, description="largest of the trials")
    share_percent: Percent | None = Field(default=None, description="share of the variance of the sum")

    @model_validator(mode="after")
    def _refuse_disorder(self) -> Self:
        for keys in (("low_3sigma", "mean", "high_3sigma"), ("sample_min", "sample_max")):
            known = [(key, own) for key in keys if (own := getattr(self, key)) is not None]
            for (low, below), (high, above) in pairwise(known):
                if not below.internal <= above.internal:
                    raise refused(low, f"at most {high} ({above})", below)
        return self


class PublishedStage(PublishedEnds):
    """A link of a train."""

    ratio: Figure | None = Field(default=None, description="turns of its driving shaft per turn of its driven one")
    factor: Figure | None = Field(
        default=None, description="turn of the shaft that is read per turn of the driven shaft"
    )


class PublishedTrain(Strict):
    """A train and its stages."""

    ratio: Figure | None = Field(default=None, description="turns of the driven shaft per turn of the output")
    lever_mm: NotNegative | None = Field(
        default=None, description="distance of the tip from the axis of the output [mm]"
    )
    stages: Mapping[Name, PublishedStage] = Field(default_factory=dict, description="by the name of the link")
    sums: PublishedEnds | None = Field(default=None, description="sums of the stages' ends at the shaft that is read")
    description: Remark = Field(default="", description="remark on these numbers")


class PublishedTrains(PublishedFigures):
    """Published figures for trains."""

    trains: Mapping[Name, PublishedTrain] = Field(default_factory=dict, description="trains of the scene")

    def problems(self, scene: "Scene") -> Iterator[tuple[KeyPath, str]]:
        """Refuse trains and links that do not exist in the scene."""
        trains = scene.of(TrainSpec)
        links = [name for name, move in scene.moves.items() if not isinstance(move, TrainSpec)]
        yield from self.strangers("trains", self.trains, trains, "the name of a train")
        for name, train in self.trains.items():
            for link in train.stages:
                if not set(IN_PARALLEL.split(link)) <= set(links):
                    near = hint(link, links)
                    yield ("trains", name, "stages", link), f"expected the name of a link, got {link!r}{near}"
