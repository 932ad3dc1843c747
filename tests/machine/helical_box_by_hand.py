"""The gearbox of scenes/helical_gearbox.yaml worked out by hand: plain vector algebra, no code of the package.

All lengths in mm. Three axes in one line along x, so that every shaft's frame has the axes of the housing. A gear lies
where the line through the middles of its shaft's bores passes the middle of its face. Across the axes helical gears are
spur gears of the transverse section, and along the normals all of it counts cos(beta_b) times. Where axes lean a pair
touches at an end of its contact line.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from machine.box_by_hand import in_disc, involute, number
from numpy.typing import NDArray
from places import SCENES
from ruamel.yaml import YAML

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[Any]]

SAID: Final = YAML(typ="safe").load((SCENES / "helical_gearbox.yaml").read_text("utf-8"))
APART: Final = 190.0
SPAN: Final = 276.0  # from the middle of one end wall to that of the other
ALPHA: Final = math.radians(20)
STEEL, IRON = 11.5e-6, 10.5e-6
GROOVES: Final = 0.04 * 12.7  # between the centres of both grooves of a 6210, whose balls touch both
SERIES: Final = {"cd25": (-145.0, -95.0), "c25": (-165.0, -115.0), "c26": (-195.0, -115.0)}
"""DIN 3967 for reference diameters of 125 to 280 mm [um], as its tables print them."""


@dataclass(frozen=True)
class Gear:
    """A gear as its scene writes it."""

    name: str

    @property
    def said(self) -> Mapping[str, Any]:
        said: Mapping[str, Any] = SAID["parts"][self.name]
        return said

    @property
    def teeth(self) -> int:
        return int(self.said["teeth"])

    @property
    def module(self) -> float:
        return number(self.said["module"])

    @property
    def beta(self) -> float:
        return math.radians(float(self.said["helix_angle"].split()[0]))

    @property
    def hand(self) -> int:
        return 1 if self.said["hand"] == "right" else -1

    @property
    def shift(self) -> float:
        return float(self.said["profile_shift"])

    @property
    def face(self) -> float:
        return number(self.said["face_width"])

    @property
    def reference(self) -> float:
        """r."""
        return self.teeth * self.module / math.cos(self.beta) / 2

    @property
    def transverse(self) -> float:
        """alpha_t."""
        return math.atan2(math.tan(ALPHA), math.cos(self.beta))

    @property
    def base(self) -> float:
        """r_b."""
        return self.reference * math.cos(self.transverse)

    @property
    def base_helix(self) -> float:
        """beta_b."""
        return math.asin(math.sin(self.beta) * math.cos(ALPHA))

    @property
    def twist(self) -> float:
        """Azimuth of a tooth per height [rad/mm]."""
        return self.hand * math.tan(self.beta) / self.reference

    @property
    def half(self) -> float:
        """Half a tooth at the base circle [rad]."""
        normal = self.module * (math.pi / 2 + 2 * self.shift * math.tan(ALPHA))
        return normal / math.cos(self.beta) / (2 * self.reference) + math.tan(self.transverse) - self.transverse

    @property
    def tip(self) -> float:
        """tan(alpha_at)."""
        return math.sqrt(((self.reference + self.module * (1 + self.shift)) / self.base) ** 2 - 1)

    @property
    def thickness(self) -> tuple[float, float]:
        """Limits of its deviation."""
        low, high = SERIES[SAID["tolerances"][f"{self.name} tooth thickness"]["distribution"]["din_3967"]]
        return low / 1000, high / 1000


@dataclass(frozen=True)
class Stage:
    """A mesh: its gears, the shafts that carry them, and the sense in which the driver's push turns the wheel."""

    name: str
    driver: Gear
    driven: Gear
    shafts: tuple[str, str]
    pushed: int

    @property
    def bases(self) -> float:
        return self.driver.base + self.driven.base

    @property
    def pressure(self) -> float:
        """alpha_wt."""
        return math.acos(self.bases / APART)

    @property
    def cosine(self) -> float:
        """cos(beta_b)."""
        return math.cos(self.driver.base_helix)

    @property
    def opening(self) -> float:
        """Normal backlash by a stretch of the line of centres."""
        return 2 * math.sin(self.pressure) * self.cosine

    @property
    def height(self) -> float:
        """Middle of the faces, from the middle between the walls."""
        shaft = SAID["parts"][self.shafts[0]]
        return number(shaft["carries"][self.driver.name]["at"])

    @property
    def face(self) -> float:
        return min(self.driver.face, self.driven.face)

    @property
    def path(self) -> tuple[float, float]:
        """Ends of the path of contact, from the pitch point."""
        at_pitch = math.tan(self.pressure)
        return -self.driven.base * (self.driven.tip - at_pitch), self.driver.base * (self.driver.tip - at_pitch)

    @property
    def pitch(self) -> float:
        """p_bn."""
        return math.pi * self.driver.module * math.cos(ALPHA)

    def mean_line_end(self) -> float:
        """Mean place of the end of a contact line that touches first, leans to both senses alike.

        (b/2) cos(beta_b) + (u2 - u1)/2 sin(beta_b) - p_bn/2 sin(beta_b) cos(beta_b)
        """
        sine, (first, last) = math.sin(self.driver.base_helix), self.path
        return self.face / 2 * self.cosine + (last - first) / 2 * sine - self.pitch / 2 * sine * self.cosine

    def first_ends(self, side: int, turn: Array) -> tuple[Array, Array]:
        """Least and largest l of all contact lines of the driver's flanks of a side, the driver at a turn (trials,)."""
        gear, alpha, (first, last) = self.driver, self.pressure, self.path
        sine, half = side * gear.hand * math.sin(gear.base_helix), self.face / 2
        tooth = np.arange(-5, 6) + np.round(-turn * gear.teeth / (2 * math.pi))[:, None]
        roll = alpha + gear.half - side * (turn[:, None] + 2 * math.pi * tooth / gear.teeth) - math.tan(alpha)
        at_middle, fall = gear.base * roll, sine / self.cosine
        ends = np.sort([(at_middle - first) / fall, (at_middle - last) / fall], axis=0)
        low, high = np.maximum(ends[0], -half), np.minimum(ends[1], half)
        along = np.stack([z * self.cosine - sine * (at_middle - fall * z) for z in (low, high)])
        least = np.where(low <= high, along, np.inf).min(axis=(0, 2))
        return np.asarray(least), np.asarray(np.where(low <= high, along, -np.inf).max(axis=(0, 2)))


FIRST: Final = Stage("first stage", Gear("first pinion"), Gear("first wheel"), ("input", "middle"), 1)
SECOND: Final = Stage("second stage", Gear("second pinion"), Gear("second wheel"), ("middle", "output"), -1)
STAGES: Final = {"first normal backlash": FIRST, "second normal backlash": SECOND}
GEARS: Final = (FIRST.driver, FIRST.driven, SECOND.driver, SECOND.driven)

PER_FIRST: Final = SECOND.driver.teeth / SECOND.driven.teeth / (FIRST.driven.base * FIRST.cosine)
PER_SECOND: Final = 1 / (SECOND.driven.base * SECOND.cosine)
"""Turn of the output by the normal backlash of each stage [rad/mm]."""

SLIDING: Final = {
    "input": abs(FIRST.driven.twist) * SECOND.driver.teeth / SECOND.driven.teeth,
    "middle": abs(FIRST.driven.twist - SECOND.driver.twist) * SECOND.driver.teeth / SECOND.driven.teeth,
    "output": abs(SECOND.driven.twist),
}
"""Turn of the output by the axial play of each shaft [rad/mm]: the thrust of a mesh moves what slides as it yields."""


def limits(tolerance: str) -> tuple[float, float]:
    """Lower and upper limit of a distribution."""
    own = SAID["tolerances"][tolerance]["distribution"]
    return number(own["lower"]), number(own["upper"])


def aside(columns: Columns, shaft: str, height: float) -> tuple[Array, Array]:
    """Offset of a shaft at a height, its slopes (trials, 2): bores that lie aside, bearings by half their clearance."""
    ends = []
    for far in ("", "far "):
        position, bearing = f"{far}{shaft} bore position", f"{far}{shaft} bearing clearance"
        off = np.stack([columns[f"{bearing}.{way} [um]"] for way in "xy"], axis=1) / 2
        if position in SAID["tolerances"]:
            points = [
                np.stack([columns[f"{position}.{end} {way} [um]"] for way in "xy"], axis=1) for end in ("start", "end")
            ]
            off = off + (points[0] + points[1]) / 2
        ends.append(off / 1000)
    slope = (ends[1] - ends[0]) / SPAN
    return np.asarray((ends[0] + ends[1]) / 2 + slope * height), np.asarray(slope)


def turned(columns: Columns, gear: Gear, turn: Array) -> Array:
    """Offset of the middle of an eccentric gear's teeth, its tooth 0 at a turn (trials, 2)."""
    x, y = (columns[f"{gear.name} eccentricity.{way} [um]"] / 1000 for way in "xy")
    return np.stack([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y], axis=1)


def apart(columns: Columns, stage: Stage, rest: Array | float) -> tuple[Array, Array]:
    """Offset of the driven gear's teeth from the driver's, and its slopes against it (trials, 2).

    Tooth 0 of the wheel stands at pi + pi/z2 from the line of centres when that of the pinion is on it, and half of a
    backlash further.
    """
    turn = np.radians(columns[f"position:{stage.name} [deg]"])
    its = math.pi + math.pi / stage.driven.teeth - stage.driver.teeth / stage.driven.teeth * turn
    its = its + stage.pushed * rest / (2 * stage.driven.base * stage.cosine)
    (one, slope), (other, its_slope) = (aside(columns, shaft, stage.height) for shaft in stage.shafts)
    off = other + turned(columns, stage.driven, its) - one - turned(columns, stage.driver, turn)
    return off, its_slope - slope


def lost(columns: Columns, stage: Stage, slopes: Array) -> Array:
    """Normal backlash lost by leaning, at the contact lines of the trial's position (trials,)."""
    turn, total = np.radians(columns[f"position:{stage.name} [deg]"]), np.zeros(len(slopes))
    for side in (1, -1):
        lean = slopes @ [math.sin(stage.pressure), -side * math.cos(stage.pressure)]
        least, largest = stage.first_ends(side, turn)
        total -= np.where(lean > 0.0, lean * least, lean * largest)
    return np.asarray(total)


def thinner(columns: Columns, stage: Stage) -> Array:
    """Thinning of both gears together, in the normal section (trials,)."""
    return np.asarray(-sum(columns[f"{own.name} tooth thickness [um]"] for own in (stage.driver, stage.driven)) / 1000)


def to_first_order(columns: Columns, stage: Stage) -> Array:
    """The normal backlash of a stage by the sum of effects (trials,); the nominal one grows with the driven gear."""
    off, slopes = apart(columns, stage, 0.0)
    stretched = off[:, 0] + APART * (
        IRON * columns["housing temperature [K]"] - STEEL * columns["gear temperature [K]"]
    )
    grown = 1 + STEEL * columns["gear temperature [K]"]
    tight = nominal(stage) * grown + math.cos(ALPHA) * thinner(columns, stage)
    return np.asarray(tight + stage.opening * stretched - lost(columns, stage, slopes))


def nominal(stage: Stage) -> float:
    """Normal backlash by the profile shifts: 2 (r_b1 + r_b2) cos(beta_b) (inv alpha_wt - inv alpha_w0)."""
    alpha, z = stage.driver.transverse, stage.driver.teeth + stage.driven.teeth
    tight = math.tan(alpha) - alpha + 2 * (stage.driver.shift + stage.driven.shift) * math.tan(ALPHA) / z
    return 2 * stage.bases * stage.cosine * (math.tan(stage.pressure) - stage.pressure - tight)


def by_involutes(columns: Columns, stage: Stage) -> Array:
    """The same by the involute function, of gears that grow; leaning shafts to first order (trials,)."""
    rest = to_first_order(columns, stage)
    off, slopes = apart(columns, stage, rest)
    grown = 1 + STEEL * columns["gear temperature [K]"]
    real = np.hypot(APART * (1 + IRON * columns["housing temperature [K]"]) + off[:, 0], off[:, 1])
    working = np.arccos(stage.bases * grown / real)
    opened = involute(working) - involute(np.full(len(real), stage.pressure))
    free = grown * (
        2 * stage.bases * stage.cosine * opened + nominal(stage) + math.cos(ALPHA) * thinner(columns, stage)
    )
    return np.asarray(free - lost(columns, stage, slopes))


def lost_motion(columns: Columns, first: Array, second: Array) -> Array:
    """Free turn of the output [rad] by the normal backlashes of both stages, and by shafts that slide (trials,)."""
    plays = {shaft: columns[f"{shaft} axial play [um]"] / 1000 for shaft in ("middle", "output")}
    across = np.hypot(*(columns[f"input bearing clearance.{way} [um]"] / 1000 for way in "xy"))
    plays["input"] = 2 * np.sqrt(GROOVES**2 - (GROOVES - across / 2) ** 2)
    slid = sum(rate * plays[shaft] for shaft, rate in SLIDING.items())
    return np.asarray(PER_FIRST * first + PER_SECOND * second + slid)


def own_draws(count: int, seed: int) -> dict[str, Array]:
    """Columns as a run has them, drawn here."""
    draws = np.random.default_rng(seed)
    found: dict[str, Array] = {}

    def add(name: str, points: Array) -> None:
        found.update({f"{name}{way} [um]": 1000 * own for way, own in zip("xy", points.T, strict=True)})

    for name, said in SAID["tolerances"].items():
        match said["kind"]:
            case "position":
                for end in ("start", "end"):
                    add(f"{name}.{end} ", in_disc(draws, count, number(said["zone"]["diameter"]) / 2))
            case "axial_play":
                found[f"{name} [um]"] = 1000 * draws.uniform(*limits(name), count)
            case "bearing_clearance":
                length, angle = draws.uniform(*limits(name), count), 2 * math.pi * draws.random(count)
                add(f"{name}.", np.stack([length * np.cos(angle), length * np.sin(angle)], axis=1))
            case "eccentricity":
                add(f"{name}.", number(said["distribution"]["scale"]) * draws.standard_normal((count, 2)))
            case "tooth_thickness":
                lower, upper = Gear(said["of"]).thickness
                own = (lower + upper) / 2 + (upper - lower) / 6 * draws.standard_normal(count)
                found[f"{name} [um]"] = 1000 * own
            case "temperature":
                law = said["distribution"]
                found[f"{name} [K]"] = number(law["mean"]) + number(law["sigma"]) * draws.standard_normal(count)
    for stage in (FIRST, SECOND):
        found[f"position:{stage.name} [deg]"] = 360 * stage.driven.teeth * draws.random(count)
    return found
