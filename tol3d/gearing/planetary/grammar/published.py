"""Published figures of planetary sets."""

from collections.abc import Iterator, Mapping

from pydantic import Field

from tol3d.gearing.planetary.grammar.moves import PlanetarySpec
from tol3d.scene import Scene
from tol3d.scene.name import Name, Remark
from tol3d.scene.place import KeyPath
from tol3d.scene.published import PublishedFigures
from tol3d.scene.published.figures import Figure, NotNegative
from tol3d.strict import Strict


class PublishedEfficiency(Strict):
    """Published efficiency of a set [%]."""

    forward_percent: Figure | None = Field(default=None, description="driven at the input [%]")
    backward_percent: Figure | None = Field(default=None, description="driven at the output [%]")


class PublishedPlanetarySet(Strict):
    """A planetary set: its efficiencies, however they were found."""

    ratio: Figure | None = Field(default=None, description="turns of the input per turn of the output")
    friction: NotNegative | None = Field(default=None, description="coefficient of friction of the teeth")
    meshes_percent: Mapping[Name, Figure] = Field(
        default_factory=dict, description="efficiency of each mesh, by its central gear [%]"
    )
    efficiency: PublishedEfficiency | None = Field(default=None, description="measured, or by a balance of torques")
    efficiency_by_formula: PublishedEfficiency | None = Field(default=None, description="by a closed form")
    description: Remark = Field(default="", description="remark on these numbers")


class PublishedPlanetarySets(PublishedFigures):
    """Published figures of planetary sets."""

    planetary_sets: Mapping[Name, PublishedPlanetarySet] = Field(
        default_factory=dict, description="planetary sets of the scene"
    )

    def problems(self, scene: Scene) -> Iterator[tuple[KeyPath, str]]:
        """Sets that the scene does not have."""
        return self.strangers("planetary_sets", self.planetary_sets, scene.of(PlanetarySpec), "a planetary set")
