"""A gearbox as a REXS file states it, in mm and rad: gears, stages, shafts, bearings, planetary stages."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from tol3d.numerics.arrays import Array

MOST_NAMED: Final = 3  # parts of one kind in a line
ROUNDED: Final = 1e-3  # mm or 1; numbers with a coarser last digit are those of a design
NOISE: Final = 1e-7  # mm; of normal backlashes, by the last bits of a double
COPY: Final = " @ "
"""Parts a name from the place of a copy, where a program repeats what each planet has."""


@dataclass(frozen=True)
class Allowance:
    """Limits of a tooth thickness.

    Args:
        measured: how it is measured, as YAML: `arc`, `normal`, `{span: 3}`, `{pins: 3.5 mm}`.
        lower, upper: deviations from nominal [mm].
        source: the file's words.
    """

    measured: str
    lower: float
    upper: float
    source: str


@dataclass(frozen=True)
class Gear:
    """A cylindrical gear.

    Args:
        id: of its component.
        name: in the file.
        teeth: their number, above 0 of rings too.
        internal: True for a ring.
        module: of the normal section [mm].
        helix_angle: at the reference cylinder, positive for a right hand [rad].
        pressure_angle: of the normal section [rad].
        face_width: [mm]; None if the file does not say it.
        profile_shift: x, positive for thicker teeth; None if the file does not say it.
        shift_guess: reason for a profile shift that the file does not say; "" for one that it says.
        shift_digit: a one in the last decimal of the profile shift as the file has it; 0 without decimals.
        tip_diameter: [mm]; None if the file does not say it, or one below the reference circle's.
        start: of its face along the shaft [mm]; None if the file does not say it.
        series: of DIN 3967, such as cd25; "" for none.
        allowances: limits stated otherwise.
        classes: of ISO 1328-1:2013, by the kind of tolerance that they are of.
    """

    id: int
    name: str
    teeth: int
    internal: bool
    module: float
    helix_angle: float
    pressure_angle: float
    face_width: float | None
    profile_shift: float | None
    tip_diameter: float | None
    start: float | None
    series: str
    allowances: Sequence[Allowance]
    classes: Mapping[str, int]
    shift_guess: str = ""
    shift_digit: float = 0.0

    @property
    def helical(self) -> bool:
        """True for teeth that are not straight."""
        return abs(self.helix_angle) > 1e-9

    @property
    def reference_diameter(self) -> float:
        """z m_n / cos β [mm]; ISO 21771."""
        return self.teeth * self.module / math.cos(self.helix_angle)

    @property
    def addendum(self) -> float | None:
        """Factor of the addendum of its tip diameter; None without one.

        h_aP* = |d_a - d| / (2 m_n) - x; a ring's tip lies inside its reference circle.
        """
        if self.tip_diameter is None:
            return None
        height = abs(self.tip_diameter - self.reference_diameter) / 2.0
        return height / self.module - (self.profile_shift or 0.0)

    @property
    def stated(self) -> bool:
        """True if the file has limits of its tooth thickness."""
        return bool(self.series or self.allowances)


@dataclass(frozen=True)
class Stage:
    """A mesh of two cylindrical gears.

    Args:
        id: of its component.
        name: in the file.
        first, second: its gears, as the file counts them.
        centre_distance: [mm]; positive with a ring too.
        field: grade of a js field of DIN 3964; None for none.
        allowance: lower and upper deviation of the centre distance [mm]; None for none.
        direction: of the second gear's axis seen from the first, about the first's axis from its w [rad]; None if the
            file does not say it.
        driven_by: the gear that the file says drives; None if it says none.
        backlash: smallest and largest normal backlash that the file's program worked out [mm]; None for none.
        distance_digit: a one in the last decimal of the centre distance as the file has it [mm]; 0 without decimals.
    """

    id: int
    name: str
    first: Gear
    second: Gear
    centre_distance: float
    field: int | None
    allowance: tuple[float, float] | None
    direction: float | None
    driven_by: int | None
    backlash: tuple[float, float] | None
    distance_digit: float = 0.0

    @property
    def gears(self) -> tuple[Gear, Gear]:
        """Both of them."""
        return self.first, self.second

    @property
    def ring(self) -> Gear | None:
        """Its ring; None of a pair of external gears."""
        return next((gear for gear in self.gears if gear.internal), None)

    @property
    def teeth_sum(self) -> int:
        """z1 + z2, with a ring the ring's less the pinion's."""
        sign = {own.id: 1 if own.internal or self.ring is None else -1 for own in self.gears}
        return sum(sign[own.id] * own.teeth for own in self.gears)

    def mate(self, gear: Gear) -> Gear:
        """The other gear."""
        return self.second if gear.id == self.first.id else self.first

    @property
    def working_angle(self) -> float | None:
        """α_wt of the transverse section [rad]; None where the axes lie nearer than the base circles allow.

        cos α_wt = (z1 + z2) m_t cos α_t / (2 a); ISO 21771.
        """
        cosine = (
            self.teeth_sum * self._transverse_module * math.cos(self._transverse_angle) / (2 * self.centre_distance)
        )
        return math.acos(cosine) if 0.0 < cosine <= 1.0 else None

    @property
    def tight_shift(self) -> float | None:
        """Sum of the profile shifts without backlash at the centre distance; None where there is none.

        Σx = s (z1 + z2)(inv α_wt - inv α_t) / (2 tan α_n), s = -1 with a ring, whose positive x thickens its tooth.
        """
        angle = self.working_angle
        if angle is None:
            return None
        rise = involute(angle) - involute(self._transverse_angle)
        return self._sense * self.teeth_sum * rise / (2.0 * math.tan(self.first.pressure_angle))

    @property
    def normal_backlash(self) -> float | None:
        """j_bn of the nominal gears [mm], below 0 where they interfere; None without both profile shifts.

        j_bt = 2 a cos α_wt (inv α_wt - inv α_w0) s, j_bn = j_bt cos β_b; the second angle is that without backlash.
        """
        tight, angle = self.tight_shift, self.working_angle
        shifts = [gear.profile_shift for gear in self.gears if gear.profile_shift is not None]
        if tight is None or angle is None or len(shifts) < 2:
            return None
        excess = (tight - sum(shifts)) * 2.0 * math.tan(self.first.pressure_angle) / self.teeth_sum
        return 2.0 * self.centre_distance * math.cos(angle) * excess * self._base_helix_cosine

    @property
    def by_rounding(self) -> float:
        """Largest normal backlash [mm] that rounding both profile shifts and the centre distance can take.

        j_bn falls by 2 m_n sin α_n per x, and by 2 sin α_wt cos β_b per length of the centre distance; each number is
        off by half of its last digit at most. Zeros at the end may be left out, so that both x have the finer digit.
        Numbers without a third decimal are taken as those of a design, which are not rounded.
        """
        shift = min((gear.shift_digit for gear in self.gears if gear.shift_digit), default=0.0)
        by_shifts = 2.0 * self.first.module * math.sin(self.first.pressure_angle) * _rounded(shift)
        angle, distance = self.working_angle or 0.0, _rounded(self.distance_digit)
        return by_shifts + math.sin(angle) * self._base_helix_cosine * distance + NOISE

    @property
    def _base_helix_cosine(self) -> float:
        return math.cos(math.asin(math.sin(self.first.helix_angle) * math.cos(self.first.pressure_angle)))

    @property
    def _sense(self) -> int:
        return 1 if self.ring is None else -1

    @property
    def _transverse_module(self) -> float:
        return self.first.module / math.cos(self.first.helix_angle)

    @property
    def _transverse_angle(self) -> float:
        """tan α_t = tan α_n / cos β."""
        return math.atan(math.tan(self.first.pressure_angle) / math.cos(self.first.helix_angle))


def _rounded(digit: float) -> float:
    """A last digit of a number that is rounded; 0 of one that is not."""
    return digit if digit <= ROUNDED else 0.0


def base_name(name: str) -> str:
    """A name without the place of a copy.

    >>> base_name("planet wheel @ 0.0° @ 240.0°")
    'planet wheel'
    """
    return name.partition(COPY)[0]


def counted(bearings: Sequence[str]) -> str:
    """A number of bearings with the first of their names.

    >>> counted(["a @ 0.0°", "a @ 120.0°"]), counted(["a"])
    ('2 bearings (a)', '1 bearing (a)')
    """
    names = list(dict.fromkeys(map(base_name, bearings)))
    told = ", ".join(names[:MOST_NAMED]) + (", …" if names[MOST_NAMED:] else "")
    return f"{len(bearings)} bearing{'s' if len(bearings) > 1 else ''} ({told})"


def involute(angle: float) -> float:
    """Inv α = tan α - α [rad]."""
    return math.tan(angle) - angle


@dataclass(frozen=True)
class Shaft:
    """Shafts that turn as one: those that couplings join.

    Args:
        ids: components that carry gears or the carrier; the first gives the frame.
        name: in the file.
        pose: world from the shaft's u, v, w axes (4, 4) [mm]; None if the file does not say it.
        gears: on it, in the order of the file.
        offsets: start of each component, and of that which carries each gear, along the first one's u [mm].
        held: True if a coupling joins it to the casing.
        loaded: True if a load acts on it.
    """

    ids: Sequence[int]
    name: str
    pose: Array | None
    gears: Sequence[Gear]
    offsets: Mapping[int, float]
    held: bool
    loaded: bool


@dataclass(frozen=True)
class Bearing:
    """A bearing between a shaft and the casing.

    Args:
        id: of its component.
        name: in the file.
        shaft: component that it carries.
        at: along that from its start [mm]; None if the file does not say it.
        clearance: lower and upper limit of the radial clearance, on the diameter [mm]; None for none.
        source: the file's words of it, or the class that it states instead.
    """

    id: int
    name: str
    shaft: int
    at: float | None
    clearance: tuple[float, float] | None
    source: str


@dataclass(frozen=True)
class Stop:
    """A bearing between a shaft and the casing that holds the shaft along its axis, or may.

    Args:
        name: in the file.
        shaft: component that it holds.
        both: True if to both sides; None if the file does not say it.
        play: lower and upper limit of its axial clearance [mm]; None for none.
        source: the file's words of it, or the class that it states instead.
    """

    name: str
    shaft: int
    both: bool | None
    play: tuple[float, float] | None
    source: str


@dataclass(frozen=True)
class PlanetarySet:
    """A planetary stage.

    Args:
        id: of its component.
        name: in the file.
        planets: their number.
        meshes: of one planet: each central gear with the gear of the planet.
        stages: the meshes of one planet, in that order.
        carrier: the shaft of its carrier.
        planet_shafts: components.
        held: id of the central gear that stands still, or 0 for the carrier.
        guessed: True if no coupling says what is held.
    """

    id: int
    name: str
    planets: int
    meshes: Sequence[tuple[Gear, Gear]]
    stages: Sequence[Stage]
    carrier: Shaft
    planet_shafts: Sequence[int]
    held: int
    guessed: bool


@dataclass(frozen=True)
class Gearbox:
    """A gearbox.

    Args:
        stages: meshes that are in no planetary stage.
        sets: planetary stages.
        shafts: those that carry gears, or a carrier.
        bearings: between these and the casing.
        stops: bearings that hold shafts along their axes.
        left_out: lines on what the file has besides.
    """

    stages: Sequence[Stage]
    sets: Sequence[PlanetarySet]
    shafts: Sequence[Shaft]
    bearings: Sequence[Bearing]
    stops: Sequence[Stop]
    left_out: Sequence[str]

    def shaft_of(self, gear: Gear) -> Shaft | None:
        """The shaft that carries a gear; None for a gear that is its own."""
        return next((own for own in self.shafts if any(each.id == gear.id for each in own.gears)), None)

    def stops_of(self, shaft: Shaft) -> list[Stop]:
        """Bearings that hold a shaft along its axis, or may."""
        return [own for own in self.stops if own.shaft in shaft.ids]

    @property
    def single_teeth(self) -> list[Gear]:
        """Gears whose single teeth deviate in scenes: those of external meshes alone."""
        in_rings = {gear.id for stage in self.stages if stage.ring for gear in stage.gears}
        found = {gear.id: gear for stage in self.stages for gear in stage.gears if gear.id not in in_rings}
        return list(found.values())
