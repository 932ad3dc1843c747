"""The gearbox of scenes/gearbox_in_housing.yaml worked out by hand: plain vector algebra, no code of the package.

All lengths in mm. Both drawings turn with their datum C about B, and the cover is put on the dowels, so that its
bores lie off those of the housing by a shift of dowel 1 and a turn about it. A gear lies where the line through the
middles of its shaft's bores passes the middle of its face.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from ruamel.yaml import YAML

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[Any]]

ALPHA: Final = math.radians(20)
SIN, COS = math.sin(ALPHA), math.cos(ALPHA)
STEEL, ALUMINIUM = 11.5e-6, 23e-6
UNITS: Final = {"mm": 1.0, "um": 1e-3, "K": 1.0}


def number(text: str) -> float:
    """`-50 um` in mm."""
    value, unit = text.split()
    return float(value) * UNITS[unit]


@dataclass(frozen=True)
class Gear:
    """A gear as its scene writes it."""

    teeth: int
    module: float
    face: float
    along: float  # its place on its shaft

    @property
    def base(self) -> float:
        """Radius of its base circle."""
        return self.teeth * self.module * COS / 2


@dataclass(frozen=True)
class Box:
    """Numbers of the scene, by the names that it uses."""

    said: Mapping[str, Any]

    @classmethod
    def read(cls, path: Path) -> "Box":
        """From its file."""
        return cls(YAML(typ="safe").load(path.read_text("utf-8")))

    def place(self, feature: str) -> Array:
        """The middle of a bore, a hole or a dowel nominally (3,); both parts have their frames in one place."""
        part, name = feature.split(".")
        solid, at = self.said["parts"][part]["builder"], self.said["parts"][part]["features"][name].get("at")
        if at is not None:
            return np.array([number(own) for own in at])
        hole = next(solid[kind][name] for kind in ("bores", "pins", "holes") if name in solid.get(kind, ()))
        x, y = (number(own) for own in hole["at"])
        if part == "cover":  # through the spigot too, where it is above that
            spigot, top = solid["spigot"], number(solid["thickness"])
            above = 2 * abs(x) < number(spigot["length"]) and 2 * abs(y) < number(spigot["width"])
            return np.array([x, y, (top - number(spigot["height"]) * above) / 2])
        stands = name in solid["pins"]
        bottom = number(solid["corner"][2]) + number(solid["floor"]) / 2
        return np.array([x, y, number(hole["height"]) / 2 if stands else bottom])

    def gear(self, name: str) -> Gear:
        """A gear."""
        own = self.said["parts"][name]
        at = next(
            part["carries"][name]["at"] for part in self.said["parts"].values() if name in part.get("carries", ())
        )
        return Gear(own["teeth"], number(own["module"]), number(own["face_width"]), number(at))

    def limits(self, tolerance: str) -> tuple[float, float]:
        """Lower and upper limit of a distribution."""
        own = self.said["tolerances"][tolerance]["distribution"]
        return number(own["lower"]), number(own["upper"])


def centre(columns: Columns, position: str) -> Array:
    """Offset of the middle of an axis in its zone (trials, 2)."""
    ends = [np.stack([columns[f"{position}.{end} {way} [um]"] for way in "xy"], axis=1) for end in ("start", "end")]
    return np.asarray((ends[0] + ends[1]) / 2000)


def lean(columns: Columns, position: str, length: float) -> Array:
    """Slopes of an axis in its zone along x and y (trials, 2)."""
    ends = [np.stack([columns[f"{position}.{end} {way} [um]"] for way in "xy"], axis=1) for end in ("start", "end")]
    return np.asarray((ends[1] - ends[0]) / (1000 * length))


def turned(arm: Array, angle: Array) -> Array:
    """Displacement of the end of an arm by a small turn (trials, 2)."""
    return np.stack([-angle * arm[1], angle * arm[0]], axis=1)


@dataclass(frozen=True)
class Laid:
    """Position of the cover on the housing: each of its bores against those of the housing, each in its own datums."""

    shift: Array  # of dowel 1 (trials, 2)
    turn: Array  # of the cover's drawing against that of the housing (trials,)
    about: Array  # dowel 1

    def moved(self, place: Array) -> Array:
        """A place on the cover's drawing against that on the housing's (trials, 2)."""
        return self.shift + turned((place - self.about)[:2], self.turn)


def laid(box: Box, columns: Columns) -> Laid:
    """Holes of the cover on the dowels, which stand askew out of holes that lean."""
    first, second = box.place("housing.dowel 1"), box.place("housing.dowel 2")
    hole = box.place("housing.dowel hole 2")
    depth = 2 * abs(hole[2])  # it begins in the rim
    shift = centre(columns, "dowel 1 seat")
    leaning = lean(columns, "dowel hole 2 position", depth) * (second - hole)[2]
    off = centre(columns, "dowel 2 seat") + leaning - shift
    return Laid(shift, off[:, 1] / (second - first)[0], first)


def axes(box: Box, columns: Columns, shaft: str, mesh_z: float) -> tuple[Array, Array]:
    """Offset of a shaft at a height, by the bores of the housing, and its slopes (trials, 2) each.

    Bearings let it lie aside by half of what is drawn of them, in the frame of the shaft.
    """
    x = shaft_x(box, shaft)
    near, far = box.place(f"housing.{shaft} bore"), box.place(f"cover.{shaft} bore")
    low = centre(columns, f"{shaft} bore position") + clearance(columns, f"{shaft} bearing", x) / 2
    high = centre(columns, f"cover {shaft} bore position") + laid(box, columns).moved(far)
    high = high + clearance(columns, f"far {shaft} bearing", x) / 2
    slope = (high - low) / (far - near)[2]
    return low + slope * (mesh_z - near[2]), slope


def shaft_x(box: Box, shaft: str) -> Array:
    """x of a shaft's frame (2,): the part's for the first one, of a driven one along the line of centres towards it."""
    if shaft == "input":
        return np.array([1.0, 0.0])
    return apart(box, FIRST if shaft == "middle" else SECOND)[1]


def clearance(columns: Columns, bearing: str, x: Array) -> Array:
    """Drawn clearance of a bearing (trials, 2), in the part's frame."""
    own = np.stack([columns[f"{bearing} clearance.{way} [um]"] for way in "xy"], axis=1) / 1000
    return np.asarray(own @ np.array([x, [-x[1], x[0]]]))


@dataclass(frozen=True)
class Stage:
    """A mesh: its gears, the shafts that carry them, and the sense in which the driver's push turns the wheel."""

    name: str
    driver: str
    driven: str
    shafts: tuple[str, str]
    eccentric: str
    pushed: int


FIRST: Final = Stage("first stage", "first pinion", "first wheel", ("input", "middle"), "first wheel eccentricity", 1)
SECOND: Final = Stage(
    "second stage", "second pinion", "second wheel", ("middle", "output"), "second wheel eccentricity", -1
)


def apart(box: Box, stage: Stage) -> tuple[float, Array]:
    """Nominal centre distance, and the direction of the line of centres (2,)."""
    places = [box.place(f"housing.{shaft} bore")[:2] for shaft in stage.shafts]
    way = places[1] - places[0]
    return float(np.hypot(*way)), way / np.hypot(*way)


def wheel_off(box: Box, columns: Columns, stage: Stage, backlash: Array | float) -> Array:
    """Offset of the middle of an eccentric wheel's teeth from its axis, along the line of centres and square to it.

    Tooth 0 of the wheel stands at pi + pi/z2 from that line when tooth 0 of the pinion is on it, and half of a backlash
    further, for flanks touch.
    """
    driver, driven = box.gear(stage.driver), box.gear(stage.driven)
    turn = np.radians(columns[f"position:{stage.name} [deg]"])
    turn = math.pi + math.pi / driven.teeth - driver.teeth / driven.teeth * turn
    turn = turn + stage.pushed * backlash / (2 * driven.base)
    x, y = (columns[f"{stage.eccentric}.{way} [um]"] / 1000 for way in "xy")
    return np.stack([x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)], axis=1)


@dataclass(frozen=True)
class Met:
    """Two gears in a trial: stretch of the line of centres, lean, thickness, temperatures."""

    along: Array
    aside: Array
    slopes: Array  # of one shaft against the other, along the line of centres and square to it (trials, 2)
    thickness: Array
    box_warm: Array
    gears_warm: Array


def met(box: Box, columns: Columns, stage: Stage, backlash: Array | float = 0.0) -> Met:
    """From the columns of a run."""
    _, way = apart(box, stage)
    frame = np.array([way, [-way[1], way[0]]])
    middles = [box.place(f"{part}.input bore")[2] for part in ("housing", "cover")]
    height = sum(middles) / 2 + box.gear(stage.driver).along  # shafts have their origins in the middle
    (one, slope), (other, its) = (axes(box, columns, shaft, height) for shaft in stage.shafts)
    off = (other - one) @ frame.T + wheel_off(box, columns, stage, backlash)
    thick = sum(columns[f"{gear} tooth thickness [um]"] for gear in (stage.driver, stage.driven)) / 1000
    return Met(
        off[:, 0],
        off[:, 1],
        (its - slope) @ frame.T,
        np.asarray(thick),
        np.asarray(columns["housing temperature [K]"]),
        np.asarray(columns["gear temperature [K]"]),
    )


def lost_by_leaning(box: Box, stage: Stage, slopes: Array, pressure: Array) -> Array:
    """Backlash lost at the ends of the faces, on both flanks together, at a working pressure angle (trials,)."""
    face = min(box.gear(name).face for name in (stage.driver, stage.driven))
    ways = np.abs(slopes) * np.stack([np.sin(pressure), np.cos(pressure)], axis=1)
    return np.asarray(face * ways.max(axis=1))


def to_first_order(box: Box, columns: Columns, stage: Stage) -> Array:
    """The normal backlash of a stage by the sum of effects (trials,)."""
    own = met(box, columns, stage)
    distance, _ = apart(box, stage)
    stretched = own.along + distance * (ALUMINIUM * own.box_warm - STEEL * own.gears_warm)
    lost = lost_by_leaning(box, stage, own.slopes, np.array([ALPHA]))
    return np.asarray(2 * SIN * stretched - COS * own.thickness - lost)


def involute(angle: Array) -> Array:
    """tan(angle) - angle."""
    return np.asarray(np.tan(angle) - angle)


def by_involutes(box: Box, columns: Columns, stage: Stage) -> Array:
    """The same by ISO 21771's involute function, of gears that grow; leaning shafts to first order (trials,)."""
    own = met(box, columns, stage, to_first_order(box, columns, stage))
    distance, _ = apart(box, stage)
    grown = 1 + STEEL * own.gears_warm
    base = (box.gear(stage.driver).base + box.gear(stage.driven).base) * grown
    real = np.hypot(distance * (1 + ALUMINIUM * own.box_warm) + own.along, own.aside)
    working = np.arccos(base / real)
    free = 2 * base * (involute(working) - involute(np.full(len(real), ALPHA)))
    return np.asarray(free - COS * own.thickness * grown - lost_by_leaning(box, stage, own.slopes, working))


# draws, by the laws of the drawing ------------------------------------------------------------------------


def in_disc(draws: np.random.Generator, count: int, radius: float) -> Array:
    """Points of a disc, as often by area (count, 2)."""
    length, angle = radius * np.sqrt(draws.random(count)), 2 * math.pi * draws.random(count)
    return np.stack([length * np.cos(angle), length * np.sin(angle)], axis=1)


def own_draws(box: Box, count: int, seed: int) -> dict[str, Array]:
    """Columns as a run has them of everything that moves a bore or is of gears, drawn here."""
    draws = np.random.default_rng(seed)
    found: dict[str, Array] = {}

    def add(name: str, points: Array) -> None:
        found.update({f"{name}{way} [um]": 1000 * own for way, own in zip("xy", points.T, strict=True)})

    for name, said in box.said["tolerances"].items():
        match said["kind"]:
            case "position" | "coaxiality":
                for end in ("start", "end"):
                    add(f"{name}.{end} ", in_disc(draws, count, number(said["zone"]["diameter"]) / 2))
            case "bearing_clearance":
                length, angle = draws.uniform(*box.limits(name), count), 2 * math.pi * draws.random(count)
                add(f"{name}.", np.stack([length * np.cos(angle), length * np.sin(angle)], axis=1))
            case "eccentricity":
                add(f"{name}.", number(said["distribution"]["scale"]) * draws.standard_normal((count, 2)))
            case "tooth_thickness":
                lower, upper = box.limits(name)
                own = (lower + upper) / 2 + (upper - lower) / 6 * draws.standard_normal(count)
                found[f"{name} [um]"] = 1000 * own
            case "temperature":
                law = said["distribution"]
                found[f"{name} [K]"] = number(law["mean"]) + number(law["sigma"]) * draws.standard_normal(count)
    for stage in (FIRST, SECOND):
        found[f"position:{stage.name} [deg]"] = 360 * box.gear(stage.driven).teeth * draws.random(count)
    return found
