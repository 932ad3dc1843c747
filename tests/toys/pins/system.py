"""All that a study asks of a disc between pins."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from tol3d.scene import Scene
from tol3d.scene.bases import ToleranceSpec
from tol3d.statistics.distributions import Distribution
from tol3d.study.system.draw import Each, Planar
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Answers, Method
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.plain import PlainSystem, contributors_of, measures_of
from tol3d.study.system.trials import Trials
from toys.pins.grammar import DiscSpec, OffCentreSpec, PinSpec, PlateSpec

Array = NDArray[np.float64]

STEEPEST = 0.3  # cosine of a pin's direction to x; flatter ones do not limit a slide
CLASHES = 1
PATHS = (slice(0, None, 2), slice(1, None, 2))  # even pins, odd pins


def directions(pins: int) -> Array:
    """Unit vectors (pins, 2) from the centre to each pin."""
    angles = 2 * np.pi * (np.arange(pins) + 0.25) / pins
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1)


@dataclass(frozen=True)
class PinsMethod:
    """Gaps (trials, pins) of some trials, and from them each measure."""

    system: "PinsSystem"
    gaps: Callable[[Trials], Array]

    chord_error: ClassVar[float] = 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        gaps = self.gaps(trials)
        found = {"least_gap": gaps.min(axis=1), "slide": slides(gaps)}
        kinds = {measure.name: str(self.system.describe(measure)["kind"]) for measure in measures}
        values = {name: found[kind][:, None] for name, kind in kinds.items()}
        codes = {name: np.where(own[:, 0] < 0.0, CLASHES, 0).astype(np.int8) for name, own in values.items()}
        details: dict[str, NDArray[np.generic]] = {"nearest pin": gaps.argmin(axis=1)}
        return Answers(values, details=details, status=codes)


def slides(gaps: Array) -> Array:
    """Slide of a disc along x (trials,): the intersection of the plays of the load paths."""
    along = directions(gaps.shape[1])[:, 0]
    highest, lowest = [], []
    for path in PATHS:
        own, cos = gaps[:, path], along[path]
        highest.append((own[:, cos > STEEPEST] / cos[cos > STEEPEST]).min(axis=1))
        lowest.append((own[:, cos < -STEEPEST] / cos[cos < -STEEPEST]).max(axis=1))
    return np.asarray(np.min(highest, axis=0) - np.max(lowest, axis=0))


@dataclass(frozen=True)
class PinsSystem(PlainSystem):
    """Implements System."""

    radius: float = 0.0
    pins: int = 0

    statuses: ClassVar[Statuses] = Statuses(
        ("ok", "clashes"), frozenset(("clashes",)), {"clashes": "clash"}, {"clashes": "clashing"}
    )

    def method(self, name: str, materials: Any) -> Method:
        return PinsMethod(self, self.first_order if name == "analytic" else self.placed)

    def first_order(self, trials: Trials) -> Array:
        """Gaps (trials, pins) [mm]; nothing of second order."""
        n = directions(self.pins)
        off = self.deviations(trials, "off_centre") + np.zeros(2)
        return self._each(trials) - off[:, :1] * n[:, 0] - off[:, 1:] * n[:, 1]

    def placed(self, trials: Trials) -> Array:
        """Gaps (trials, pins) [mm] by the distance of each pin from the disc's centre."""
        at = self.radius * directions(self.pins)
        off = self.deviations(trials, "off_centre") + np.zeros(2)
        return np.asarray(self._each(trials) + np.hypot(at[:, 0] - off[:, :1], at[:, 1] - off[:, 1:]) - self.radius)

    def _each(self, trials: Trials) -> Array:
        return self.deviations(trials, "pin_room") + self.deviations(trials, "pin") + np.zeros(self.pins)

    def cost(self, measures: Sequence[Measure]) -> int:
        """As many contacts as pins."""
        return self.pins * len(measures)


def pins_system(scene: Scene) -> PinsSystem:
    """System of a scene of a disc between pins."""
    ((_, plate),) = scene.of(PlateSpec).items()
    ((_, disc),) = scene.of(DiscSpec).items()

    def each(law: Distribution, _: ToleranceSpec) -> Each:
        return Each(law, tuple(f"{pin:02d}" for pin in range(plate.pins)))

    def anywhere(law: Distribution, _: ToleranceSpec) -> Planar:
        return Planar(law, None)

    contributors = contributors_of(scene, {PinSpec: each, OffCentreSpec: anywhere})
    measures = tuple(replace(own, keeps_overlap=True) for own in measures_of(scene, adds_up=False))
    return PinsSystem(scene.scene, contributors, measures, disc.radius.internal, plate.pins)
