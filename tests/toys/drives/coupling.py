"""A jaw coupling: a slack between jaws at a radius."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Literal

import numpy as np

from tol3d.gearing.grammar.moves import LinkSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import LinkToleranceSpec
from tol3d.gearing.links import FreeTurn, LinkTrials, StatedLink
from tol3d.scene import Scene
from tol3d.scene.bases import Length


@dataclass(frozen=True, kw_only=True)
class Coupling(StatedLink):
    """Slack s between jaws at a radius r leaves a chord free: 2 asin(s / 2 r), to first order s / r."""

    kind: ClassVar[str] = "jaw_coupling"
    adds_up: ClassVar[bool] = True

    slack: float
    radius: float

    @property
    def remark(self) -> str:
        return f"jaws with {1e3 * self.slack:g} um of slack"

    def _slack(self, seen: LinkTrials) -> np.ndarray:
        return self.slack + seen.of("jaw_wear")[:, :1]

    def exact(self, seen: LinkTrials) -> FreeTurn:
        return FreeTurn(2 * np.arcsin(self._slack(seen) / (2 * self.radius)))

    def analytic(self, seen: LinkTrials) -> FreeTurn:
        return FreeTurn(self._slack(seen) / self.radius)


class CouplingSpec(LinkSpec):
    """Two coaxial shafts coupled by jaws."""

    words: ClassVar[str] = "a jaw coupling"

    kind: Literal["jaw_coupling"]
    slack: Length
    radius: Length

    def link(self, name: str, scene: Scene) -> Coupling:
        return Coupling(
            name=name,
            driver=self.driver,
            driven=self.driven,
            rate=Fraction(1),
            offset=40.0,
            slack=self.slack.internal,
            radius=self.radius.internal,
        )


class JawWearSpec(LinkToleranceSpec):
    """A length that adds to the slack."""

    link_spec: ClassVar[type[Any]] = CouplingSpec

    kind: Literal["jaw_wear"]
