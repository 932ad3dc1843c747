"""A toothed belt between parallel shafts."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from tol3d.gearing.effects import LinkDeviation
from tol3d.gearing.grammar.moves import LinkSpec
from tol3d.gearing.grammar.parts import ShaftReference
from tol3d.gearing.grammar.tolerances.gearing_tolerance import LinkToleranceSpec, Meaning
from tol3d.gearing.links import FreeTurn, LinkTrials, StatedLink
from tol3d.scene import Scene
from tol3d.scene.bases import Length
from tol3d.scene.entry import Contradiction, Reference
from tol3d.scene.name import Name


@dataclass(frozen=True, kw_only=True)
class Belt(StatedLink):
    """Sag s of the span and offset (x, y) of the driver's pulley, which turns with it, at a driven radius r.

    Free are (s + x cos a - y sin a) / r at the driver's angle a, about (x sin a + y cos a) / 2 r.
    """

    kind: ClassVar[str] = "belt"
    has_middle: ClassVar[bool] = True

    radius: float
    distance: float

    @property
    def turns(self) -> Fraction:
        return Fraction(1)

    @property
    def driver_from_driven(self) -> Any:
        pose = np.eye(4)
        pose[0, 3] = self.distance
        return pose

    def exact(self, seen: LinkTrials) -> FreeTurn:
        offset, angle = seen.of("pulley_offset"), seen.angles
        x, y = offset[:, :1], offset[:, -1:]
        play = seen.of("belt_sag")[:, :1] + x * np.cos(angle) - y * np.sin(angle)
        return FreeTurn(play / self.radius, (x * np.sin(angle) + y * np.cos(angle)) / (2 * self.radius))


class BeltSpec(LinkSpec):
    """A belt and two pulleys."""

    words: ClassVar[str] = "a belt"

    kind: Literal["belt"]
    teeth: tuple[int, int] = Field(strict=False, description="of the driver's pulley and the driven one's")
    radius: Length
    distance: Length
    carrier: Name | None = None

    def references(self) -> tuple[Reference, ...]:
        own = super().references()
        return own if self.carrier is None else (*own, ShaftReference(("carrier",), self.carrier))

    def contradictions(self, parts: Any, moves: Any) -> Iterator[Contradiction]:
        if min(self.teeth) < 1:
            yield Contradiction(("teeth",), "teeth", str(min(self.teeth)))

    def link(self, name: str, scene: Scene) -> Belt:
        return Belt(
            name=name,
            driver=self.driver,
            driven=self.driven,
            carrier=self.carrier,
            rate=Fraction(*self.teeth),
            radius=self.radius.internal,
            distance=self.distance.internal,
        )


class SpanSpec(LinkToleranceSpec):
    """Give of the slack span."""

    link_spec: ClassVar[type[Any]] = BeltSpec

    kind: Literal["belt_sag"]


class PulleyOffsetSpec(LinkToleranceSpec):
    """Offset of the driver's pulley in a random direction of its own."""

    link_spec: ClassVar[type[Any]] = BeltSpec

    kind: Literal["pulley_offset"]

    def meaning(self, nominal: Any) -> Meaning:
        return Meaning(LinkDeviation(self.of), planar=True)
