"""The RV reducer as a move: cycloid discs on crankshafts, with a first stage of spur gears."""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from tol3d.gearing.cycloid.grammar.parts import CrankCarrierSpec, CrankshaftSpec, CycloidDiscSpec, PinRingSpec
from tol3d.gearing.grammar.parts import SpurGearSpec
from tol3d.scene.bases import MoveSpec
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.strict import refused


class ReducerParts(NamedTuple):
    """Parts of the cycloid stage of a reducer."""

    ring: PinRingSpec
    disc: CycloidDiscSpec
    crank: CrankshaftSpec
    carrier: CrankCarrierSpec


class RVReducerSpec(MoveSpec):
    """Discs, evenly around the crankshafts' eccentrics, run in a fixed ring of pins and turn the carrier.

    The sun drives a planet on every crankshaft and is the input; without sun and planet the crankshafts are.
    """

    words: ClassVar[str] = "an RV reducer"

    kind: Literal["rv_reducer"]
    pin_ring: Name = Field(description="the ring of pins, which is fixed")
    disc: Name = Field(description="the cycloid disc, of which there may be several")
    discs: int = Field(default=2, ge=1, le=4, description="number of discs")
    crankshaft: Name = Field(description="the crankshaft, of which there are several")
    cranks: int = Field(default=3, ge=2, le=8, description="number of crankshafts")
    carrier: Name = Field(description="the part that holds the crankshafts: the output")
    sun: Name | None = Field(default=None, description="the gear of the input; none if the crankshafts are the input")
    planet: Name | None = Field(default=None, description="the gear on each crankshaft that meshes with the sun")
    window: float = Field(
        default=0.7,
        gt=0.0,
        lt=1.0,
        description="pins work whose lever is more than this share of the largest, a lobe count times the eccentricity",
    )

    @model_validator(mode="after")
    def _refuse_half_a_stage(self) -> Self:
        if (self.sun is None) != (self.planet is None):
            given, lacking = ("planet", "sun") if self.sun is None else ("sun", "planet")
            raise refused(lacking, f"a spur gear beside the {given}, or neither of them", "none")
        return self

    def references(self) -> tuple[Reference, ...]:
        """The parts."""
        gears = {"sun": self.sun, "planet": self.planet}
        return (
            Reference(("pin_ring",), self.pin_ring, (PinRingSpec,)),
            Reference(("disc",), self.disc, (CycloidDiscSpec,)),
            Reference(("crankshaft",), self.crankshaft, (CrankshaftSpec,)),
            Reference(("carrier",), self.carrier, (CrankCarrierSpec,)),
            *(Reference((role,), name, (SpurGearSpec,)) for role, name in gears.items() if name is not None),
        )

    def parts_among(self, parts: Mapping[str, Any]) -> ReducerParts:
        """Its own among the parts of a scene."""
        return ReducerParts(*(parts[name] for name in (self.pin_ring, self.disc, self.crankshaft, self.carrier)))
