"""What every measure of one mesh has in common: over which positions, and what is taken."""

from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from tol3d.gearing.grammar.measures.flank_measure import FlankMeasureSpec
from tol3d.gearing.grammar.moves import GearMeshSpec
from tol3d.scene.direction import At, FixedAngle, known_word, shape
from tol3d.scene.measure import MOST_POSITIONS, Take
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.strict import refused

FEWEST_POSITIONS = 4

Over = Annotated[
    Annotated[Literal["random", "turn", "long_period"], Tag("word")] | FixedAngle,
    Discriminator(shape),
    known_word("random", "turn", "long_period"),
]


class MeshMeasureSpec(FlankMeasureSpec):
    """A measure that is read on a mesh."""

    of: Name = Field(description="the mesh move")
    over: Over = Field(
        default="random",
        description="positions of the driver: random (uniform over the long period), {at: angle}, turn (one of the "
        "driver) or long_period (until the same teeth meet again)",
    )
    take: Take = Field(default="value", description="value at one position; min, max, range or curve of several")
    positions: int = Field(
        default=24,
        ge=FEWEST_POSITIONS,
        le=MOST_POSITIONS,
        description="positions a turn, for turn and long_period",
    )

    @property
    def gives_curve(self) -> bool:
        """Whether a trial gives a value at every position instead of one."""
        return self.take == "curve"

    @property
    def several_positions(self) -> bool:
        """Whether a trial is read at several positions."""
        return self.over in ("turn", "long_period")

    def references(self) -> tuple[Reference, ...]:
        """The mesh."""
        return (Reference(("of",), self.of, (GearMeshSpec,)),)

    @model_validator(mode="after")
    def _refuse_take_without_over(self) -> Self:
        over = "{at: …}" if isinstance(self.over, At) else self.over
        if self.several_positions and self.take == "value":
            got = "take: value" if "take" in self.model_fields_set else "no take"
            raise refused("take", f"min, max, range or curve beside over: {over}", got)
        superfluous = {"take": self.take != "value", "positions": "positions" in self.model_fields_set}
        for field, given in superfluous.items():
            if given and not self.several_positions:
                raise refused(field, "over: turn or over: long_period beside it", f"over: {over}")
        return self
