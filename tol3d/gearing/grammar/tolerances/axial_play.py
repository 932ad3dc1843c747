"""Play of shafts along their axes."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.effects import NOTHING, AxialPlay
from tol3d.gearing.grammar.parts import (
    BearingSpec,
    BevelGearSpec,
    PinnedSpec,
    ShaftReference,
    ShaftSpec,
    TurningSpec,
    gears_on,
)
from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearingToleranceSpec, Meaning, Nominal
from tol3d.scene.bases import MoveSpec, PartSpec
from tol3d.scene.entry import Contradiction, Entry, Reference
from tol3d.scene.name import Name


@dataclass(frozen=True)
class SlidingReference(ShaftReference):
    """The name of a shaft, of a bearing of one, or of a planet."""

    specs: tuple[type[Entry], ...] = (ShaftSpec, TurningSpec, PinnedSpec, BearingSpec)

    @property
    def expected(self) -> str:
        """As of any reference."""
        return "a shaft, of a gear that none carries, of a planet or of a bearing"


def shaft_at(of: str, parts: Mapping[str, PartSpec]) -> str:
    """The shaft that is named, or that of a bearing."""
    part = parts[of]
    return part.shaft if isinstance(part, BearingSpec) else of


class AxialPlaySpec(GearingToleranceSpec):
    """A length of zero or more: the shaft's total play along its axis, from one stop to the other.

    Where the load changes sides, the thrust of helical gears moves the shaft through it, and they screw in their mates'
    teeth: lost motion, angular backlash and what a tip does of it grow by c |tan(beta)/r| of one gear, of two gears on
    the shaft by the difference of theirs, each with its hand. Normal backlash stays, and so does all of spur gears. In
    planetary sets central gears and carrier slide, and each planet on its pin, if its gears differ in their leads.
    """

    kind: Literal["axial_play"]
    of: Name = Field(
        description="the shaft, a gear that is its own, the bearing that holds the shaft along its axis, or a planet: "
        "each has its own play"
    )

    nominal: ClassVar[str] = "clearance"

    def references(self) -> tuple[Reference, ...]:
        """The shaft or bearing."""
        return (SlidingReference(("of",), self.of),)

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The teeth of bevel gears open as they slide."""
        for gear in gears_on(shaft_at(self.of, parts), parts):
            if isinstance(parts[gear], BevelGearSpec):
                expected = "a shaft without bevel gears, whose backlash depends on where they lie along their axis"
                yield Contradiction(("of",), expected, f"{self.of!r} with {gear!r} on it")

    def meaning(self, nominal: Nominal) -> Meaning:
        """The shaft slides; one without gears moves nothing."""
        shaft = shaft_at(self.of, nominal.scene.parts)
        return Meaning(AxialPlay(shaft) if nominal.carried_by(shaft) else NOTHING, least=0.0)
