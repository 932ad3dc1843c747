"""Trains worked out shaft by shaft: where each comes to rest, and how deviations look in the frame of each mesh.

A train is a list of stages from the held shaft on. Each is seated with the angle at which the shaft before it really
came to rest, once with all flanks that work and once with all others: what its end turns between the two is found
without any ratio.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tol3d.gears.flank import Flank, opposite

Seat = Callable[[np.ndarray, Flank], np.ndarray]
"""Driver's angles [rad] and its flank (1 right, -1 left) to the driven gear's at rest, all in the mesh's frame."""


@dataclass(frozen=True)
class OnShaft:
    """Seat of a gear: sense -1 where it faces backward, azimuth of its tooth 0 [rad]."""

    sense: int = 1
    phase: float = 0.0

    def gear_angle(self, shaft: np.ndarray) -> np.ndarray:
        """Azimuth of tooth 0 about the gear's own z, the shaft turned."""
        return self.sense * shaft + self.phase

    def shaft_angle(self, gear: np.ndarray) -> np.ndarray:
        """The inverse."""
        return self.sense * (gear - self.phase)


@dataclass(frozen=True)
class Mesh:
    """A mesh as a stage.

    Args:
        seat: brings it to rest.
        working: the driver's working flank.
        driver, driven: how the gears sit.
        azimuth: of the mate about the driver's axis [rad], in the driver's frame.
    """

    seat: Seat
    working: Flank
    driver: OnShaft = OnShaft()
    driven: OnShaft = OnShaft()
    azimuth: float = 0.0

    def driver_angle(self, shaft: np.ndarray) -> np.ndarray:
        """Turn of the driver from its line of centres."""
        return self.driver.gear_angle(shaft) - self.azimuth

    def at_rest(self, shaft: np.ndarray, side: Flank) -> np.ndarray:
        """The driven shaft's angle, the driver's given; side 1: on the working flanks, -1: on the others."""
        flank = self.working if side == 1 else opposite(self.working)
        return self.driven.shaft_angle(self.seat(self.driver_angle(shaft), flank))


@dataclass(frozen=True)
class Reducer:
    """A data-sheet reducer as a stage.

    Args:
        ratio: turns of the driver per turn of the driven.
        play: free turn of the driven [rad], (n,).
        drives: sense in which the driven shaft goes when the working flanks push it.
    """

    ratio: float
    play: np.ndarray
    drives: int

    def at_rest(self, shaft: np.ndarray, side: Flank) -> np.ndarray:
        """The load holds it back by half the play; the other way it is ahead by as much."""
        return shaft / self.ratio - side * self.drives * self.play / 2


def rests(stages: Sequence[Mesh | Reducer], held: np.ndarray, side: Flank) -> list[np.ndarray]:
    """Angles (n,) of all shafts behind the held one, each seated with that of the one before."""
    angles = [held]
    for stage in stages:
        angles.append(stage.at_rest(angles[-1], side))
    return angles[1:]


def free_turn(stages: Sequence[Mesh | Reducer], held: np.ndarray) -> np.ndarray:
    """Turn (n,) of the last shaft between its two ends, the first one held."""
    return np.abs(rests(stages, held, 1)[-1] - rests(stages, held, -1)[-1])


def turned(vectors: np.ndarray, degrees: float) -> np.ndarray:
    """Plane vectors (n, 2) turned counter-clockwise: seen from a frame that is turned back by as much."""
    angle = np.radians(degrees)
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([cos * vectors[:, 0] - sin * vectors[:, 1], sin * vectors[:, 0] + cos * vectors[:, 1]], axis=1)


def seen_backward(vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 2) of a shaft in the frame of a gear that faces backward: x stays, y turns round."""
    return vectors * [1.0, -1.0]


def at_height(lower: np.ndarray, upper: np.ndarray, heights: tuple[float, float], height: float) -> np.ndarray:
    """Point of a straight shaft at a height, its points at two heights moved by vectors (n, 2)."""
    share = (height - heights[0]) / (heights[1] - heights[0])
    return (1 - share) * lower + share * upper


def lean(lower: np.ndarray, upper: np.ndarray, heights: tuple[float, float]) -> np.ndarray:
    """x and y (n, 2) of the rotation vector that leans its z that way."""
    slope = (upper - lower) / (heights[1] - heights[0])
    return np.stack([-slope[:, 1], slope[:, 0]], axis=1)


# the robot's shoulder in closed form ----------------------------------------------------------------------------

ALPHA = math.radians(20.0)
Terms = Mapping[str, tuple[float, float, float]]
"""By contributor: change of the normal backlash, mean and sigma [um]; what has a direction counts by its scale."""


def robot_pairs() -> tuple[tuple[Terms, float], tuple[Terms, float]]:
    """Spur and bevel pair of Jiang et al. 2024, sections 2.1 and 3.1, each with the arm of its driven gear [mm].

    That is what makes a turn of a normal backlash: 137.5 mm, or half the bevel gear's mean diameter, times cos(alpha).
    """
    sin, cos = math.sin(ALPHA), math.cos(ALPHA)
    spur = {
        "pinion tooth thickness": (-cos, -24.5, 11 / 6),
        "wheel tooth thickness": (-cos, -26.5, 11 / 6),
        "centre distance": (2 * sin, 0.0, 40 / 6),
        "wheel eccentricity": (2 * sin, 0.0, 31 / 6),
        "wheel bearing clearance": (sin, 16.0, 28 / 6),
        "pinion eccentricity": (2 * sin, 0.0, 4.5),
        "reducer run-out": (2 * sin, 0.0, 8 / 6),
    }
    along = math.sqrt(2) * sin
    bevel = {f"bevel {gear} tooth thickness": (-cos, -42.5, 3.5) for gear in ("driver", "driven")}
    bevel |= {f"bevel {gear} eccentricity": (along, 0.0, 4.714045) for gear in ("driver", "driven")}
    bevel |= {f"bevel {gear} bearing clearance": (along / 2, 20.0, 10 / 3) for gear in ("driver", "driven")}
    bevel |= {"shaft angle": (2 * sin, 0.0, 10 / 3), "axes offset": (along, 0.0, 3.0)}
    bevel |= dict.fromkeys(("driver back face", "driven back face", "housing face", "end cover"), (along, 0.0, 2.0))
    return (spur, 137.5 * cos), (bevel, (108.5 - 9 * math.sqrt(0.5)) / 2 * cos)


def moments(terms: Terms) -> tuple[float, dict[str, float]]:
    """Mean and variances by contributor of what the terms add up to."""
    mean = sum(coefficient * middle for coefficient, middle, _ in terms.values())
    return mean, {name: (coefficient * sigma) ** 2 for name, (coefficient, _, sigma) in terms.items()}


def robot_lost_motion() -> tuple[float, dict[str, float]]:
    """Mean and variances by contributor of the shoulder's lost motion [rad]: 1' over 110/28, both pairs in full."""
    mean, variances = math.radians(1 / 60) * 28 / 110, dict[str, float]()
    for terms, arm in robot_pairs():
        own, each = moments(terms)
        mean += own * 1e-3 / arm
        variances |= {name: variance * 1e-6 / arm**2 for name, variance in each.items()}
    return mean, variances


# the indexing table in closed form -------------------------------------------------------------------------------

UM = 1e-3  # mm


def involute(angle: float) -> float:
    return math.tan(angle) - angle


def arms() -> Mapping[str, float]:
    """Angle at the encoder [rad] per um of normal backlash: over the driven base radius, times what follows."""
    encoder = {"first mesh": 31 / 60 * 48 / 32, "second mesh": 48 / 32, "third mesh": 1.0}
    radii = {"first mesh": 15.5, "second mesh": 30.0, "third mesh": 12.8}
    return {mesh: UM * encoder[mesh] / (radii[mesh] * math.cos(ALPHA)) for mesh in radii}


def table_lost_motion() -> tuple[float, float, dict[str, float]]:
    """Nominal value, mean and variances by contributor [rad] of the lost motion at three_stage_train.yaml's encoder.

    Its shaft stands upright; what its two bearings do comes on top.
    """
    first, second, third = arms().values()
    working = math.acos(25.5 * math.cos(ALPHA) / 25.75)
    cos, sin, opened = math.cos(ALPHA), math.sin(ALPHA), math.sin(working)
    nominal = first * 1e3 * (2 * 25.5 * cos * (involute(working) - involute(ALPHA)) - 2 * 0.25 * sin)
    gearbox = math.radians(1 / 60) * 20 / 60 * 48 / 32  # of an arcmin
    means = {
        "gearbox play": gearbox * (2 + 4 + 9) / 3,
        "pinion tooth thickness": first * cos * 30,
        "idler tooth thickness": (first + second) * cos * 30,
        "table gear tooth thickness": second * cos * 40,
        "encoder driver tooth thickness": third * cos * 32,
        "encoder gear tooth thickness": third * cos * 28,
        # half of 9 um away from the pinion, and by 60 deg of it towards the table's gear
        "idler bearing clearance": 4.5 * (2 * opened * first - 2 * sin * math.cos(math.radians(60)) * second),
    }
    # an offset of the idler's centre opens both: away from the pinion at 0 deg, from the table's gear at 240 deg
    at_idler = 2 * opened * first + 2 * sin * second * np.exp(1j * math.radians(240))
    # on the table's shaft away from the idler is 0 deg; its upper gear looks down and sees the encoder at -75 deg,
    # 75 deg of the shaft: away is 255 deg
    low, high = 2 * sin * second, 2 * sin * third * np.exp(1j * math.radians(255))
    # both marks stand at 7 deg of the shaft: 12 and 8 um swing together, each takes half of what they share
    shared = 12 * 8 * (low * high.conjugate()).real / 2
    variances = {
        "gearbox play": gearbox**2 * (4 + 16 + 81 - 8 - 36 - 18) / 18,
        "pinion tooth thickness": (first * cos * 16 / 6) ** 2,
        "idler tooth thickness": ((first + second) * cos * 16 / 6) ** 2,
        "table gear tooth thickness": (second * cos * 20 / 6) ** 2,
        "encoder driver tooth thickness": (third * cos * 16 / 6) ** 2,
        "encoder gear tooth thickness": (third * cos * 12 / 6) ** 2,
        "pinion eccentricity": (2 * opened * first * 3) ** 2,
        "idler eccentricity": abs(at_idler * 5) ** 2,
        "table gear eccentricity": low**2 * (12**2 + 1) / 2 + shared,
        "encoder driver eccentricity": abs(high) ** 2 * (8**2 + 1) / 2 + shared,
        "table shaft run-out": abs(2 * (low + high)) ** 2,
        "first centre distance": (2 * opened * first * 5) ** 2,
        "second centre distance": (2 * sin * second * 6) ** 2,
        "third centre distance": (2 * sin * third) ** 2 * 24**2 / 12,
        "idler bearing clearance": (opened * first - sin * math.cos(math.radians(60)) * second) ** 2 * 12**2 / 12,
    }
    return nominal, nominal + sum(means.values()), variances
