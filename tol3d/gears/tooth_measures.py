"""Tooth thickness as shops measure it: the span over teeth, and the size over or between two pins or balls.

Closed forms of ISO 21771-1 for spur and helical gears. Sizes of an internal gear are those of its spaces, which have
the shape of the teeth of an external one. All forms and their inverses are exact for rigid involutes. Lengths in mm.

An internal helical gear is measured between balls alone: its flanks are hollow, so that the anvils of a span would
touch them side by side along the axis, and a straight pin that touches both flanks of a space cuts them further on.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Final

import numpy as np

from tol3d.errors import GeometryError
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.involute import inverse_involute, involute
from tol3d.numerics.arrays import Array

SAME_NOMINAL: Final = 0.005  # mm; a drawing rounds a size to one hundredth at the coarsest
PIN_STEP = 0.05  # mm; diameters of proposed pins are multiples of it
BISECTIONS = 60  # of an angle below a right one: to rounding
REACH_SLACK = 1e-9  # mm; contact at the very end of a flank is allowed


@dataclass(frozen=True)
class Span:
    """The span W_k: distance of two parallel faces over k teeth, of an internal gear over k spaces.

    W_k = m_n cos alpha_n (pi (k - 1/2) + z inv alpha_t + 2 x tan alpha_n) (ISO 21771-1); internal: - 2 x tan alpha.
    The faces touch W_k sin beta_b apart along the axis. Internal helical gears have none.

    Args:
        teeth: k; the number of spaces of an internal gear.
    """

    teeth: int

    @classmethod
    def nearest(cls, gear: CylindricalGear, size: float) -> "Span":
        """The span whose nominal size is nearest to one [mm]; of no teeth where that is too small for any."""
        return cls(1 + max(round((size - cls(1).size(gear)) / (2 * math.pi * gear.section_arm / gear.teeth)), -1))

    @property
    def words(self) -> str:
        """Its name."""
        return f"span over {self.teeth} teeth"

    def size(self, gear: CylindricalGear) -> float:
        """W_k [mm]."""
        return gear.section_arm * (2 * math.pi * (self.teeth - 1) / gear.teeth + 2 * _convex_half_angle(gear))

    def thickness(self, gear: CylindricalGear, size: float) -> float:
        """Tooth thickness [mm], the arc at the reference circle, of a gear with a span `size` [mm]."""
        half = size / (2 * gear.section_arm) - math.pi * (self.teeth - 1) / gear.teeth
        return _thickness(gear, half)

    def touches_at(self, gear: CylindricalGear) -> float:
        """Radius [mm] of contact of both faces in the symmetric position: r_y^2 = r_b^2 + (W_k cos beta_b/2)^2."""
        return math.hypot(gear.base_radius, self.size(gear) * gear.base_helix_cosine / 2)

    def least_face_width(self, gear: CylindricalGear) -> float:
        """Face width [mm] that the faces need to touch teeth on both sides: W_k sin beta_b, and no reserve."""
        return self.size(gear) * math.sin(gear.base_helix_angle)

    def require_reach(self, gear: CylindricalGear) -> None:
        """Refuse a span whose faces touch no involute, or whose contacts lie further apart than the face is wide.

        Raises:
            GeometryError: with the possible numbers of teeth, or balls of an internal helical gear.
        """
        if _has_balls_alone(gear):
            raise GeometryError(f"{NO_SPAN}{_proposed_balls(gear)}")
        if 1 <= self.teeth <= gear.teeth and _on_flank(gear, self.touches_at(gear)):
            if (least := self.least_face_width(gear)) > gear.face_width:
                raise GeometryError(
                    f"the faces of a {self.words} touch {least:.4f} mm apart along the axis, on a face only "
                    f"{gear.face_width:g} mm wide: choose fewer teeth, or balls"
                )
            return
        possible = [span.teeth for span in spans_of(gear)]
        over = f"expected {_range_words(possible)}" if possible else "no number of teeth does on this gear; use pins"
        raise GeometryError(
            f"the faces of a {self.words} touch at a diameter of {2 * self.touches_at(gear):.4f} mm, "
            f"outside the involute ({_flank_words(gear)}): {over}"
        )


@dataclass(frozen=True)
class OverPins:
    """The size M over two pins in opposite spaces; between them for an internal gear.

    M = 2 r_K + D_M, for an odd number of teeth 2 r_K cos(pi/(2 z)) + D_M, inv alpha_K = D_M/(2 r_b cos beta_b) + eta_b
    - pi/z, r_K = r_b/cos alpha_K, eta_b half the angle of a tooth at the base circle. For an internal gear D_M is
    negative, and inv alpha_K = D_M/(2 r_b cos beta_b) + eta_b with half the angle of a space (ISO 21771-1). A pin lies
    along its space: of a helical gear a straight one leans, and between parallel anvils two of them stand exactly
    opposite for any number of teeth, M = 2 r_K + D_M.

    Args:
        diameter: D_M of the pins [mm].
    """

    diameter: float

    bodies: ClassVar[str] = "pins"
    shorter: ClassVar[str] = "balls, or a smaller diameter"

    @property
    def words(self) -> str:
        """Its name."""
        return f"size over {self.bodies} of {self.diameter:g} mm"

    def opposite(self, gear: CylindricalGear) -> float:
        """Distance of the centres over their diameter 2 r_K: 1, of spur gears cos(pi/(2 z)) if z is odd."""
        return 1.0 if gear.helix_angle else _opposite(gear)

    def size(self, gear: CylindricalGear) -> float:
        """M [mm].

        Raises:
            GeometryError: pins so small that they touch no involute.
        """
        centre = gear.base_radius / math.cos(self._angle(gear))
        return 2 * centre * self.opposite(gear) + gear.iso_sign * self.diameter

    def thickness(self, gear: CylindricalGear, size: float) -> float:
        """Tooth thickness [mm], the arc at the reference circle, of a gear with a size `size` [mm].

        Raises:
            GeometryError: a size at which the pins' centres lie within the base circle.
        """
        centre = (size - gear.iso_sign * self.diameter) / (2 * self.opposite(gear))
        if centre < gear.base_radius:
            least = 2 * gear.base_radius * self.opposite(gear) + gear.iso_sign * self.diameter
            raise GeometryError(f"expected a {self.words} of at least {least:.4f} mm, got {size:.4f} mm")
        half = involute(math.acos(gear.base_radius / centre)) - gear.iso_sign * self._turn(gear)
        return _thickness(gear, math.pi / gear.teeth + half if gear.iso_sign > 0 else half)

    def least_face_width(self, gear: CylindricalGear) -> float:
        """Face width [mm] that holds all contacts: a pin or ball touches both flanks D_M sin beta_b apart.

        Between parallel anvils straight pins over an odd number of helical teeth lie half an axial pitch apart.
        """
        apart = math.pi / (gear.teeth * abs(gear.twist)) if self.opposite(gear) != _opposite(gear) else 0.0
        return apart + self.diameter * math.sin(gear.base_helix_angle)

    def touches_at(self, gear: CylindricalGear) -> float:
        """Radius [mm] at which a pin touches both flanks of its space; if below the base circle, it touches none.

        Its roll is tan alpha_K - D_M cos beta_b/(2 r_b).
        """
        roll = math.tan(self._angle(gear)) - gear.iso_sign * self._turn(gear) * gear.base_helix_cosine**2
        return gear.base_radius * (math.hypot(1.0, roll) if roll > 0.0 else 1.0 + roll)

    def require_reach(self, gear: CylindricalGear) -> None:
        """Refuse pins that touch no involute, that touch the root, or that do not stand out beyond the tips.

        Raises:
            GeometryError: with the remedy.
        """
        if _has_balls_alone(gear) and not isinstance(self, OverBalls):
            raise GeometryError(f"{NO_PINS}{_proposed_balls(gear)}")
        pins = pins_of(gear, type(self))
        advice = f"; {pins.diameter:g} mm does" if pins else ""
        try:
            centre, sign = gear.base_radius / math.cos(self._angle(gear)), gear.iso_sign
        except GeometryError as error:
            raise GeometryError(f"{error}{advice}") from None
        in_root = sign * (centre - sign * self.diameter / 2 - gear.root_radius) < 0.0
        stands_out = sign * (centre + sign * self.diameter / 2 - gear.tip_radius) > 0.0
        if _on_flank(gear, self.touches_at(gear)) and stands_out and not in_root:
            if (least := self.least_face_width(gear)) > gear.face_width:
                words = f"touch up to {least:.4f} mm apart along the axis, on a face only {gear.face_width:g} mm wide"
                raise GeometryError(f"{self.bodies} of {self.diameter:g} mm {words}: choose {self.shorter}{advice}")
            return
        why = (
            f"touch at a diameter of {2 * self.touches_at(gear):.4f} mm, outside the involute ({_flank_words(gear)})"
            if not _on_flank(gear, self.touches_at(gear))
            else ("touch the root circle" if in_root else "do not stand out beyond the tip circle")
        )
        raise GeometryError(f"{self.bodies} of {self.diameter:g} mm {why}: choose another diameter{advice}")

    def _turn(self, gear: CylindricalGear) -> float:
        """D_M/(2 r_b cos beta_b) [rad]: a flank turned by it is the surface at the distance D_M/2."""
        return self.diameter / (2 * gear.section_arm)

    def _angle(self, gear: CylindricalGear) -> float:
        """alpha_K [rad], the pressure angle at a pin's centre."""
        half = _convex_half_angle(gear)
        space = half - math.pi / gear.teeth if gear.iso_sign > 0 else half
        value = space + gear.iso_sign * self._turn(gear)
        if value < 0.0:
            raise GeometryError(
                f"{self.bodies} of {self.diameter:g} mm touch no involute of this gear: choose "
                f"{'thicker' if gear.iso_sign > 0 else 'thinner'} ones"
            )
        return inverse_involute(value)


@dataclass(frozen=True)
class OverBalls(OverPins):
    """The size M over two balls in one transverse plane; spur teeth give the same as over pins.

    Args:
        diameter: D_M of the balls [mm].
    """

    bodies: ClassVar[str] = "balls"
    shorter: ClassVar[str] = "a smaller diameter"

    def opposite(self, gear: CylindricalGear) -> float:
        """Distance of the centres over their diameter: 1, or cos(pi/(2 z)) for an odd number of teeth."""
        return _opposite(gear)


ToothMeasure = Span | OverPins

NO_SPAN: Final = "an internal helical gear has no span, its flanks are hollow: measure between balls"
NO_PINS: Final = "straight pins cut the flanks of an internal helical gear: measure between balls"


def _has_balls_alone(gear: CylindricalGear) -> bool:
    """True of internal helical gears."""
    return gear.iso_sign < 0 and gear.helix_angle > 0.0


def _proposed_balls(gear: CylindricalGear) -> str:
    balls = pins_of(gear, OverBalls)
    return f", such as {{balls: {balls.diameter:g} mm}}" if balls else ""


@dataclass(frozen=True)
class PinScale:
    """Deviation of the tooth thickness, the arc at the reference circle, from that of the size over pins, and back.

    Args:
        gear: the nominal gear.
        pins: over which it is measured.
    """

    gear: CylindricalGear
    pins: OverPins

    @property
    def words(self) -> str:
        """Name of the measured size."""
        return self.pins.words

    @cached_property
    def _nominal(self) -> float:
        """inv alpha_K of the nominal gear [rad]."""
        return involute(self.pins._angle(self.gear))

    @property
    def _lever(self) -> float:
        """Change of the size per change of r_K/r_b [mm]."""
        return 2 * self.pins.opposite(self.gear) * self.gear.base_radius

    def deviation(self, measured: Array) -> Array:
        """Deviations of the thickness (n,) from those of the size (n,) [mm]; pin centres stop at the base circle.

        inv alpha_K = sqrt(q^2 - 1) - arctan sqrt(q^2 - 1) with q = r_K/r_b; the arc changes by 2 r cos beta times its
        change, of an internal gear by -2 r times.
        """
        far = 1.0 / math.cos(self.pins._angle(self.gear)) + measured / self._lever
        roll = np.sqrt(np.maximum(far * far - 1.0, 0.0))
        arc = self.gear.iso_sign * 2 * self.gear.thickness_radius
        return np.asarray(arc * (roll - np.arctan(roll) - self._nominal))

    def measured(self, deviation: Array) -> Array:
        """Deviations of the size (n,) from those of the thickness (n,) [mm]."""
        arc = self.gear.iso_sign * 2 * self.gear.thickness_radius
        angles = [inverse_involute(max(self._nominal + change / arc, 0.0)) for change in deviation.tolist()]
        return np.asarray(self._lever * (1.0 / np.cos(angles) - 1.0 / math.cos(self.pins._angle(self.gear))))


def spans_of(gear: CylindricalGear) -> list[Span]:
    """Every span whose faces touch the involute, and both sides of it within the face."""
    if _has_balls_alone(gear):
        return []
    spans = (Span(teeth) for teeth in range(1, gear.teeth // 2 + 1))
    touching = (span for span in spans if span.size(gear) > 0.0 and _on_flank(gear, span.touches_at(gear)))
    return [span for span in touching if span.least_face_width(gear) <= gear.face_width]


def span_of(gear: CylindricalGear) -> Span | None:
    """The span whose faces touch nearest to the circle of radius r + x m; None if none touches the involute."""
    return min(spans_of(gear), key=lambda span: abs(span.touches_at(gear) - _middle(gear)), default=None)


def pins_of(gear: CylindricalGear, kind: type[OverPins] = OverPins) -> OverPins | None:
    """Pins or balls, in steps of PIN_STEP, that touch near the circle of radius r + x m; None if none do.

    Balls of an internal helical gear.
    """
    return next(_possible_pins(gear, OverBalls if _has_balls_alone(gear) else kind), None)


def _possible_pins(gear: CylindricalGear, kind: type[OverPins]) -> Iterator[OverPins]:
    """Pins by distance from the diameter that touches at the middle of the flank."""
    roll = gear.roll_at(_middle(gear))
    half, sign = _convex_half_angle(gear), gear.iso_sign
    angle = roll + math.pi / gear.teeth - half if sign > 0 else roll - half
    if not 0.0 < angle < math.pi / 2:
        return
    wanted = sign * 2 * gear.base_radius * (math.tan(angle) - roll)
    if gear.helix_angle:
        wanted = _screw_pin(gear, roll, angle)
    nearest = round(wanted / PIN_STEP)
    for step in range(round(gear.module / PIN_STEP) + 1):
        for count in (nearest + step, nearest - step):
            if count > 0 and _is_possible(gear, pins := kind(round(count * PIN_STEP, 6))):
                yield pins


def _screw_pin(gear: CylindricalGear, roll: float, angle: float) -> float:
    """Diameter D [mm] of a pin that touches screw flanks at a roll t [rad].

    tan alpha_K = t + D cos beta_b/(2 r_b) and inv alpha_K = D/(2 r_b cos beta_b) + t - angle meet where the first less
    alpha_K is the second: by bisection over alpha_K, which is below the spur gear's `angle`. Inside, where D counts
    negative, it is above that and below arctan t, at which D = 0.
    """
    cosine, low, high = gear.base_helix_cosine, 0.0, angle
    if gear.iso_sign < 0:
        low, high = angle, math.atan(roll)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        turn = (math.tan(middle) - roll) / cosine**2  # D/(2 r_b cos beta_b)
        low, high = (middle, high) if involute(middle) > turn + roll - angle else (low, middle)
    return gear.iso_sign * 2 * gear.base_radius * (math.tan(low) - roll) / cosine


def _is_possible(gear: CylindricalGear, pins: OverPins) -> bool:
    try:
        angle = pins._angle(gear)
    except GeometryError:
        return False
    centre, sign = gear.base_radius / math.cos(angle), gear.iso_sign
    return (
        _on_flank(gear, pins.touches_at(gear))
        and sign * (centre + sign * pins.diameter / 2 - gear.tip_radius) > 0.0
        and sign * (centre - sign * pins.diameter / 2 - gear.root_radius) >= 0.0
        and pins.least_face_width(gear) <= gear.face_width
    )


def _middle(gear: CylindricalGear) -> float:
    """r + x m [mm], r - x m of an internal gear, kept within the involute."""
    low, high = sorted((gear.form_radius, gear.tip_radius))
    return min(max(gear.reference_radius + gear.iso_sign * gear.profile_shift * gear.module, low), high)


def _convex_half_angle(gear: CylindricalGear) -> float:
    """Half angle at the base circle [rad] of a tooth of an external gear, of a space of an internal one."""
    return gear.base_half_angle if gear.iso_sign > 0 else math.pi / gear.teeth - gear.base_half_angle


def _thickness(gear: CylindricalGear, convex_half_angle: float) -> float:
    """The arc of a tooth at the reference circle, in the normal section [mm]."""
    half = convex_half_angle - involute(gear.transverse_pressure_angle)
    return 2 * gear.thickness_radius * (half if gear.iso_sign > 0 else math.pi / gear.teeth - half)


def _opposite(gear: CylindricalGear) -> float:
    """Distance of two opposite spaces over their diameter: 1, or cos(pi/(2 z)) for an odd number of teeth."""
    return math.cos(math.pi / (2 * gear.teeth)) if gear.teeth % 2 else 1.0


def _on_flank(gear: CylindricalGear, radius: float) -> bool:
    low, high = sorted((gear.form_radius, gear.tip_radius))
    return low - REACH_SLACK <= radius <= high + REACH_SLACK


def _flank_words(gear: CylindricalGear) -> str:
    low, high = sorted((gear.form_radius, gear.tip_radius))
    return f"{2 * low:.4f} to {2 * high:.4f} mm"


def _range_words(counts: list[int]) -> str:
    ends = f"{counts[0]} to {counts[-1]}" if len(counts) > 1 else str(counts[0])
    return f"{ends} teeth"
