"""A reducer from a data sheet."""

from fractions import Fraction
from typing import Annotated, ClassVar, Final, Literal

from pydantic import AfterValidator, Field

from tol3d.gearing.grammar.moves.link import LinkSpec
from tol3d.gearing.grammar.moves.ratio import Ratio
from tol3d.gearing.links import Reducer
from tol3d.scene import Scene
from tol3d.scene.vector import Coordinate
from tol3d.strict import refused
from tol3d.units import Of, Quantity

MOST_RATIO: Final = 1e6  # beyond it somebody's finger slipped


def _not_negative(angle: Quantity) -> Quantity:
    if angle.number < 0.0:
        raise refused("", "an angle of zero or more", angle)
    return angle


class ReducerSpec(LinkSpec):
    """Two coaxial shafts with a bought reducer between them, of which ratio and backlash are known and nothing else."""

    words: ClassVar[str] = "a reducer"

    kind: Literal["reducer"]
    ratio: Ratio = Field(description="turns of the driver per turn of the driven; negative: they turn opposite ways")
    backlash: Annotated[Quantity, Of("angle"), AfterValidator(_not_negative)] | None = Field(
        default=None,
        description="the data sheet's maximum at the driven shaft, taken in every trial; a tolerance of kind "
        "reducer_backlash gives a distribution instead",
    )
    offset: Coordinate = Field(
        default=Quantity(0.0, "mm"),
        description="of the driven shaft's origin from the driver's, along z",
        json_schema_extra={"default": "0 mm"},
    )

    def link(self, name: str, scene: Scene) -> Reducer:
        """What the data sheet says.

        Raises:
            SceneError: a ratio that nobody builds.
        """
        if not 1 / MOST_RATIO <= abs(self.ratio) <= MOST_RATIO:
            raise scene.refuse(
                ("moves", name, "ratio"),
                f"expected a ratio of 1/{MOST_RATIO:g} to {MOST_RATIO:g}, either sign, got {self.ratio:g}",
            )
        return Reducer(
            name=name,
            driver=self.driver,
            driven=self.driven,
            rate=1 / Fraction(str(self.ratio)),
            offset=self.offset.internal,
            backlash=0.0 if self.backlash is None else self.backlash.internal,
        )
