"""The planetary set as a move: planets between central gears."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.moves import HelicalMoveSpec
from tol3d.gearing.grammar.parts import GearSpec
from tol3d.gearing.planetary.grammar.parts import CarrierSpec, PlanetSpec
from tol3d.scene.bases import Length
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name


class PlanetarySpec(HelicalMoveSpec):
    """Planets, evenly spaced on their carrier, each in mesh with every central gear: sun gears and rings.

    One shaft is held, one drives, one is driven; the others turn freely. So simple sets, compound ones, and those with
    two rings (3K, Wolfrom) differ by what they name. Of helical gears planets and rings that mesh have one hand, a sun
    has the other.
    """

    words: ClassVar[str] = "a planetary set"

    kind: Literal["planetary"]
    planet: Name = Field(description="the planet, of which there are several")
    planets: int = Field(ge=1, le=12, description="number of planets")
    carrier: Name = Field(description="the part that holds their pins")
    meshes: Mapping[Name, Name] = Field(
        min_length=2, description="each central gear, a sun or a ring, with the gear of the planets that it meshes with"
    )
    centre_distance: Length | None = Field(
        default=None,
        description="from the common axis to the pins; default: that of the first mesh's reference circles",
    )
    held: Name = Field(description="the central gear that is fixed, or the carrier")
    input: Name = Field(description="the central gear that drives, or the carrier")
    output: Name = Field(description="the central gear that is driven, or the carrier")
    friction: float | None = Field(
        default=None,
        ge=0.0,
        le=0.5,
        description="coefficient of friction of the teeth, for efficiencies; default: none are worked out",
    )

    def references(self) -> tuple[Reference, ...]:
        """The planet, the carrier, the gears."""
        shafts = (GearSpec, CarrierSpec)
        return (
            Reference(("planet",), self.planet, (PlanetSpec,)),
            Reference(("carrier",), self.carrier, (CarrierSpec,)),
            *(Reference(("meshes", mesh), mesh, (GearSpec,)) for mesh in self.meshes),
            *(Reference(("meshes", own), gear, (GearSpec,)) for own, gear in self.meshes.items()),
            *(Reference((role,), getattr(self, role), shafts) for role in ("held", "input", "output")),
        )
