"""Gears on a carrier, of which teeth and play are known."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tol3d.gearing.grammar.moves import LinkSpec
from tol3d.gearing.grammar.parts import ShaftReference
from tol3d.gearing.grammar.tolerances.gearing_tolerance import LinkToleranceSpec
from tol3d.gearing.links import FreeTurn, LinkTrials, StatedLink
from tol3d.scene import Scene
from tol3d.scene.bases import Length
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.units import Dimension


@dataclass(frozen=True, kw_only=True)
class Planet(StatedLink):
    """A mesh whose carrier turns; its play is a tolerance."""

    kind: ClassVar[str] = "planet"
    adds_up: ClassVar[bool] = True

    apart: float

    @property
    def driver_from_driven(self) -> NDArray[np.float64]:
        pose = np.eye(4)
        pose[0, 3] = self.apart
        return pose

    def exact(self, seen: LinkTrials) -> FreeTurn:
        return FreeTurn(seen.of("planet_play"))


class PlanetSpec(LinkSpec):
    """A gear on a carrier meshes with a sun, or a ring with it."""

    words: ClassVar[str] = "a planet's mesh"

    kind: Literal["planet"]
    carrier: Name
    teeth: tuple[int, int] = Field(strict=False)
    internal: bool = False
    apart: Length

    def references(self) -> tuple[Reference, ...]:
        return (*super().references(), ShaftReference(("carrier",), self.carrier))

    def link(self, name: str, scene: Scene) -> Planet:
        rate = Fraction(*self.teeth) * (1 if self.internal else -1)
        apart = self.apart.internal * (-1 if self.internal else 1)
        return Planet(
            name=name, driver=self.driver, driven=self.driven, carrier=self.carrier, rate=rate, apart=apart
        )  # fmt: skip


class PlanetPlaySpec(LinkToleranceSpec):
    """Free turn of the driven gear."""

    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)
    link_spec: ClassVar[type[Any]] = PlanetSpec

    kind: Literal["planet_play"]
