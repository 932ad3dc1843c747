"""A planetary set by search in the world: its centres lie anywhere, and planets turn while teeth let them.

Flanks are strings off base circles, cut where both run along one line. A planet is free at a turn of the shafts where
all its gaps on one side and all on the other leave room together; how far a shaft turns is bisected. Complex numbers.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

ALPHA: Final = np.radians(20.0)
HALVINGS: Final = 60
FARTHEST: Final = 0.03  # rad; no shaft turns so far freely
PLACES: Final = np.linspace(-FARTHEST, FARTHEST, 601)


def involute(angle: float) -> float:
    return float(np.tan(angle) - angle)


@dataclass(frozen=True)
class WholeSet:
    """One trial of a set with a sun and rings, whose planet k stands at 2 pi k over their number at the start.

    Args:
        module: of all gears [mm].
        meshes: by central gear its teeth and those of its planet gear, below 0 of a ring.
        distance: nominal centre distance [mm].
        planets: how many.
        thicker: arcs by which teeth of each central gear, and of each planet gear by its teeth, are thicker [mm].
        off: by shaft, where its axis lies in the world [mm]; the carrier's is "carrier".
        eccentric: by central gear, its teeth's centre in its own frame, x through tooth 0 [mm].
        pins: off their places, outwards and counter-clockwise (planets,) [mm].
    """

    module: float
    meshes: Mapping[str, tuple[int, int]]
    distance: float
    planets: int
    thicker: Mapping[object, float]
    off: Mapping[str, complex]
    eccentric: Mapping[str, complex] = field(default_factory=dict)
    pins: tuple[complex, ...] = ()

    def room(self, nominal: Mapping[str, float], turns: Mapping[str, float]) -> float:
        """Least turn that flanks leave a planet [rad], below 0 where they leave none.

        Args:
            nominal: turns of all shafts without backlash [rad], which planets follow.
            turns: those beyond.
        """
        return min(self._room(k, nominal, turns) for k in range(self.planets))

    def _room(self, k: int, nominal: Mapping[str, float], turns: Mapping[str, float]) -> float:
        around = 2 * np.pi * k / self.planets
        arm = nominal["carrier"] + turns.get("carrier", 0.0)
        pin = self.pins[k] if self.pins else 0.0
        planet = self.off.get("carrier", 0.0) + np.exp(1j * (arm + around)) * (self.distance + pin)
        left, right = zip(
            *(self._gaps(central, planet, around, nominal, turns) for central in self.meshes), strict=True
        )
        return float(min(left) + min(right))

    def _gaps(
        self, central: str, planet: complex, around: float, nominal: Mapping[str, float], turns: Mapping[str, float]
    ) -> tuple[float, float]:
        """Gaps of a planet whose teeth stand where they would without deviations, to both sides: turns of it [rad]."""
        teeth, own = self.meshes[central]
        ring, teeth = teeth < 0, abs(teeth)
        own_turn = nominal[central] - nominal["carrier"]
        r1, r2 = (self.module * z / 2 * np.cos(ALPHA) for z in (teeth, own))
        sense = -1 if ring else 1
        # tooth 0 of the first planet points outwards: there a ring has a space; inwards it has a tooth if it has even
        starts = np.pi / teeth if ring or own % 2 == 0 else 0.0
        turned = nominal[central] + turns.get(central, 0.0)
        centre = self.off.get(central, 0.0) + self.eccentric.get(central, 0.0) * np.exp(1j * (starts + turned))
        apart = planet - centre
        alpha, towards = np.arccos((r1 + sense * r2) / abs(apart)), np.angle(apart)
        along = abs(apart) * np.sin(alpha)
        pitch = 2 * np.pi * r1 / teeth
        facing = starts + turned + (np.pi / teeth if ring else 0.0)  # of a tooth, of a ring a space
        wide = (np.pi / 2 + sense * self.thicker.get(central, 0.0) / self.module) / teeth + involute(ALPHA)
        own_wide = (np.pi / 2 + self.thicker.get(own, 0.0) / self.module) / own + involute(ALPHA)
        # of the planet without deviations, a tooth that lies on the line of centres where the other's space does
        line = nominal["carrier"] + around
        lags = (starts + own_turn - around) * teeth / (2 * np.pi)  # of the central gear's tooth there, in pitches
        if ring:
            tooth = line + 2 * np.pi / own * (lags + 0.5)
            left = r1 * (facing + wide - (towards - alpha)) - along - r2 * (tooth + own_wide - (towards - alpha))
            right = r1 * (wide - facing + towards + alpha) - along - r2 * (own_wide - tooth + towards + alpha)
        else:
            tooth = line + np.pi - 2 * np.pi / own * (lags + 0.5)
            left = (
                along - r1 * (facing + wide - (towards - alpha)) - r2 * (tooth + own_wide - (towards - alpha) - np.pi)
            )
            right = along - r1 * (wide - facing + towards + alpha) - r2 * (own_wide - tooth + towards + alpha + np.pi)
        off_left, off_right = (own - pitch * np.round(own / pitch) for own in (left, right))
        return float(off_left / r2), float(off_right / r2)

    def play(self, nominal: Mapping[str, float], output: str) -> float:
        """Turn of a shaft while the others stand [rad]; NaN if there is no room anywhere."""
        rooms = [self.room(nominal, {output: float(turn)}) for turn in PLACES]
        best = float(PLACES[int(np.argmax(rooms))])
        if max(rooms) < 0.0:
            return float("nan")
        ends = []
        for outside in (-FARTHEST, FARTHEST):
            inside = best
            for _ in range(HALVINGS):
                middle = (inside + outside) / 2
                inside, outside = (middle, outside) if self.room(nominal, {output: middle}) >= 0 else (inside, middle)
            ends.append(inside)
        return ends[1] - ends[0]
