"""What every kind of gear has in common."""

from typing import Annotated, ClassVar

from pydantic import AfterValidator, Field

from tol3d.gearing.grammar.parts.turning import TurningSpec
from tol3d.scene.part import Length
from tol3d.strict import refused
from tol3d.units import Of, Positive, Quantity

MOST_TEETH = 10_000  # far more than anyone hobs; keeps a slip of the finger from building for days

LEAST_FACE_WIDTH = 1e-6  # mm; a solid ten times thinner has no two sides for the CAD kernel


def _wide_enough(width: Quantity) -> Quantity:
    if width.internal < LEAST_FACE_WIDTH:
        raise refused("", f"at least {LEAST_FACE_WIDTH:g} mm", repr(str(width)))
    return width


class GearSpec(TurningSpec):
    """A gear by the words of ISO 21771-1; profile_shift, addendum and dedendum count in modules."""

    words: ClassVar[str] = "a gear"

    teeth: int = Field(ge=1, le=MOST_TEETH, description="number of teeth z")
    module: Length = Field(description="module m; of a bevel gear at the outer end")
    pressure_angle: Annotated[Quantity, Of("angle"), Positive()] = Field(
        default=Quantity(20.0, "deg"),
        description="pressure angle at the reference circle, or on the pitch cone",
        json_schema_extra={"default": "20 deg"},  # pydantic would show the Quantity's fields
    )
    face_width: Annotated[Length, AfterValidator(_wide_enough)] = Field(description="face width b")
    profile_shift: float = Field(default=0.0, description="profile shift coefficient x; positive is a thicker tooth")
    addendum: float = Field(default=1.0, gt=0.0, description="addendum factor, in modules")
    dedendum: float = Field(default=1.25, gt=0.0, description="dedendum factor, in modules")


class BoredGearSpec(GearSpec):
    """A gear that sits around its shaft."""

    bore: Length | None = Field(default=None, description="diameter of the bore; none if not given")
