"""Spur gears on parallel shafts in one plane, turned until flanks touch: how far each shaft can go, a root held.

All is in one world and in true angles: no mesh has a frame of its own, no flank is called the working one, and no ratio
is used but that of the teeth. Each gear may be eccentric and its axis may lie aside. In a plane an involute gear that
turns off its axis is an ordinary gear about its own centre, so two flanks touch where the arcs by which each stands off
the line of centres, on the circles that roll there, are the same. Source: ISO 21771-1:2024, 5.3.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

ALPHA = np.radians(20.0)
ROUNDS = 12  # the driven gear's own turn moves its centre: each round gains a factor of e/r, 1e-3
BOTH = (1, -1)

Reach = tuple[np.ndarray, np.ndarray]
"""Least and largest angle (n,) of a shaft [rad]."""


def plane(angle: np.ndarray | float) -> np.ndarray:
    """Unit vectors (..., 2)."""
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def turned(vectors: np.ndarray, angle: np.ndarray | float) -> np.ndarray:
    """Vectors (n, 2) turned counter-clockwise."""
    (cos, sin), (x, y) = plane(angle).T, vectors.T
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


@dataclass(frozen=True)
class Gear:
    """A gear on a shaft.

    Args:
        shaft: its name.
        teeth, module: of 20 deg and no profile shift.
        sense: -1 where it faces backward: its own y and z go against the shaft's.
        phase: azimuth of its tooth 0 in its own frame, the shaft at 0 [rad].
        thickness: deviation [mm], (n,) or a number.
        centre: off its axis in the frame of its teeth, (n, 2) [mm].
        axis: off the shaft's, in its own frame at rest on the shaft, (n, 2) [mm].
        clocking: turn on its shaft about its own z [rad], (n,) or a number.
        run_out: of its shaft, in the shaft's frame and turning with it, (n, 2) [mm].
    """

    shaft: str
    teeth: int
    module: float = 2.0
    sense: int = 1
    phase: float = 0.0
    thickness: np.ndarray | float = 0.0
    centre: np.ndarray = field(default_factory=lambda: np.zeros((1, 2)))
    axis: np.ndarray = field(default_factory=lambda: np.zeros((1, 2)))
    clocking: np.ndarray | float = 0.0
    run_out: np.ndarray = field(default_factory=lambda: np.zeros((1, 2)))

    @property
    def base_radius(self) -> float:
        return self.module * self.teeth * np.cos(ALPHA) / 2

    def half_angle(self, working: np.ndarray) -> np.ndarray:
        """Half a tooth [rad] on the circle where the pressure angle is that."""
        reference = self.module * self.teeth / 2
        half = (np.pi * self.module / 2 + self.thickness) / (2 * reference)
        return half + (np.tan(ALPHA) - ALPHA) - (np.tan(working) - working)

    def in_plane(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors of its frame in its shaft's."""
        return vectors * [1.0, self.sense]


@dataclass(frozen=True)
class Mesh:
    """Two gears, and where the driven one's shaft lies: an azimuth in the driver's frame at rest [rad], a distance."""

    driver: str
    driven: str
    azimuth: float
    distance: float


@dataclass(frozen=True)
class Reducer:
    """A data-sheet reducer between two shafts; the play (n,) is the driven one's."""

    driver: str
    driven: str
    ratio: float
    play: np.ndarray


@dataclass(frozen=True)
class Shaft:
    """Position of a shaft [mm], the azimuth of its frame [rad], and its angle when the root is at an angle."""

    place: np.ndarray
    azimuth: float
    angle: float = 0.0


Links = Sequence[Mesh | Reducer]


@dataclass(frozen=True)
class Mechanism:
    """Gears and shafts that fit, the root at one angle."""

    gears: Mapping[str, Gear]
    shafts: Mapping[str, Shaft]
    links: Links

    def reach(self, shaft: str, *, as_meshes: bool = False) -> Reach:
        """Reach of a shaft, the first shaft standing; its ends pass each other where the load paths bind.

        Args:
            shaft: its name.
            as_meshes: take each mesh by itself, its driver where it would be without deviations, and add up.
        """
        paths = [
            self._behind(link, as_meshes=as_meshes)
            for link in self.links
            if (self.gears[link.driven].shaft if isinstance(link, Mesh) else link.driven) == shaft
        ]
        if not paths:
            angle = np.array([self.shafts[shaft].angle])
            return angle, angle
        return np.max([low for low, _ in paths], axis=0), np.min([high for _, high in paths], axis=0)

    def _behind(self, link: Mesh | Reducer, *, as_meshes: bool) -> Reach:
        if isinstance(link, Reducer):
            ends = self.reach(link.driver, as_meshes=as_meshes)
            drivers, driven = self.shafts[link.driver].angle, self.shafts[link.driven].angle
            each = [driven + (end - drivers) / link.ratio + side * link.play / 2 for end in ends for side in BOTH]
            return np.min(each, axis=0), np.max(each, axis=0)
        driver = self.gears[link.driver].shaft
        ends = self.reach(driver, as_meshes=as_meshes)
        if not as_meshes:
            each = [self.seat(link, end, side) for end in ends for side in BOTH]
            return np.min(each, axis=0), np.max(each, axis=0)
        still = np.array([self.shafts[driver].angle])
        first, last = self.gears[link.driver], self.gears[link.driven]
        rate = -first.teeth / last.teeth
        each = [self.seat(link, still, side) + rate * (end - still) for end in ends for side in BOTH]
        return np.min(each, axis=0), np.max(each, axis=0)

    def seat(self, mesh: Mesh, angle: np.ndarray, side: int) -> np.ndarray:
        """The driven shaft's angle where flanks touch; side 1: the driver's on the low side of its teeth, seen from +z.

        Teeth are the ones next to those that fit without deviations.
        """
        first, last = self.gears[mesh.driver], self.gears[mesh.driven]
        at, shaft = self.shafts[first.shaft], self.shafts[last.shaft]
        found = np.array([shaft.angle])
        for _ in range(ROUNDS):
            line = self.centre(last, found) - self.centre(first, angle)
            towards = np.arctan2(line[:, 1], line[:, 0])
            working = np.arccos((first.base_radius + last.base_radius) / np.hypot(line[:, 0], line[:, 1]))
            arc = at.azimuth + angle + first.sense * (first.phase + first.clocking) - towards
            arc = first.base_radius * (arc - side * first.half_angle(working))
            tooth = side * last.half_angle(working) - arc / last.base_radius + towards + np.pi
            stands = tooth - shaft.azimuth - last.sense * (last.phase + last.clocking)
            pitch = 2 * np.pi / last.teeth
            found = stands - pitch * np.round((stands - shaft.angle) / pitch)
        return found

    def centre(self, gear: Gear, angle: np.ndarray) -> np.ndarray:
        """Place of a gear's own centre, its shaft at an angle (n,): (n, 2) [mm]."""
        shaft = self.shafts[gear.shaft]
        axis = turned(gear.in_plane(gear.axis), shaft.azimuth)
        own = gear.sense * angle + gear.phase + gear.clocking
        runs_out = turned(gear.run_out, shaft.azimuth + angle)
        return shaft.place + axis + runs_out + turned(gear.in_plane(turned(gear.centre, own)), shaft.azimuth)


def assembled(gears: Mapping[str, Gear], links: Links, root: str, angle: float) -> Mechanism:
    """All shafts where they lie and turn to, the root at an angle [rad]; gears are turned on shafts with it at 0.

    The first link to a shaft places it: the driven gear's tooth 0 stands half a pitch past the far side of its axis
    when the driver's points at it. Any other link there has one gear turned on its shaft until the teeth fit: the
    driven one, or the driver, by less than half a pitch, where the driven one is in other meshes too.
    """
    _, fitted = _placed(gears, links, root, 0.0)
    shafts, fitted = _placed(fitted, links, root, angle)
    return Mechanism(fitted, shafts, links)


def _placed(
    gears: Mapping[str, Gear], links: Links, root: str, angle: float
) -> tuple[dict[str, Shaft], dict[str, Gear]]:
    known, shafts = dict(gears), {root: Shaft(np.zeros(2), 0.0, angle)}
    busy = Counter(name for link in links if isinstance(link, Mesh) for name in (link.driver, link.driven))
    for link in links:
        if isinstance(link, Reducer):
            before = shafts[link.driver]
            shafts[link.driven] = Shaft(before.place, before.azimuth, before.angle / link.ratio)
            continue
        first, last = known[link.driver], known[link.driven]
        at = shafts[first.shaft]
        line = at.azimuth + first.sense * link.azimuth
        off = first.sense * (at.azimuth + at.angle + first.sense * first.phase - line)
        tooth = line + first.sense * (np.pi + np.pi / last.teeth - off * first.teeth / last.teeth)
        if last.shaft not in shafts:
            place = at.place + link.distance * plane(line)
            shafts[last.shaft] = Shaft(place, line, tooth - line - last.sense * last.phase)
        else:
            there = shafts[last.shaft]
            missing = tooth - there.azimuth - there.angle - last.sense * last.phase
            if busy[link.driven] == 1:
                known[link.driven] = replace(last, phase=last.phase + last.sense * missing)
            else:
                pitch = 2 * np.pi / last.teeth
                rest = missing - pitch * np.round(missing / pitch)
                known[link.driver] = replace(first, phase=first.phase + first.sense * rest * last.teeth / first.teeth)
    return shafts, known
