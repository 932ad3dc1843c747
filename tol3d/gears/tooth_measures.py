"""Tooth thickness as shops measure it: the span over teeth, and the size over or between two pins or balls.

Closed forms of ISO 21771-1 for spur gears; of an internal gear the sizes are those of its spaces, which have the shape
of the teeth of an external one. Each is exact for rigid involutes, and so is its inverse. Lengths in mm.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tol3d.errors import GeometryError
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.involute import inverse_involute, involute
from tol3d.numerics.arrays import Array

PIN_STEP = 0.05  # mm; pins that are proposed have diameters of so many of it
REACH_SLACK = 1e-9  # mm; a face may touch at the very end of a flank


@dataclass(frozen=True)
class Span:
    """The span W_k: between two parallel faces that touch flanks k teeth apart, inside k spaces.

    W_k = m cos alpha (pi (k - 1/2) + z inv alpha + 2 x tan alpha) (ISO 21771-1), inside with -2 x tan alpha.

    Args:
        teeth: k, of an internal gear the number of spaces.
    """

    teeth: int

    @property
    def words(self) -> str:
        """Its name."""
        return f"span over {self.teeth} teeth"

    def size(self, gear: CylindricalGear) -> float:
        """W_k [mm]."""
        return gear.base_radius * (2 * math.pi * (self.teeth - 1) / gear.teeth + 2 * _convex_half_angle(gear))

    def thickness(self, gear: CylindricalGear, size: float) -> float:
        """The arc at the reference circle [mm] of a gear with that span."""
        half = size / (2 * gear.base_radius) - math.pi * (self.teeth - 1) / gear.teeth
        return _thickness(gear, half)

    def touches_at(self, gear: CylindricalGear) -> float:
        """Radius [mm] at which both faces touch where they stand alike: r_y^2 = r_b^2 + (W_k/2)^2."""
        return math.hypot(gear.base_radius, self.size(gear) / 2)

    def require_reach(self, gear: CylindricalGear) -> None:
        """Refuse a span whose faces touch no involute.

        Raises:
            GeometryError: with the numbers of teeth that do.
        """
        if 1 <= self.teeth <= gear.teeth and _on_flank(gear, self.touches_at(gear)):
            return
        possible = [own.teeth for own in spans_of(gear)]
        over = f"expected {_range_words(possible)}" if possible else "no number of teeth does on this gear; use pins"
        raise GeometryError(
            f"the faces of a {self.words} touch at a diameter of {2 * self.touches_at(gear):.4f} mm, "
            f"outside the involute ({_flank_words(gear)}): {over}"
        )


@dataclass(frozen=True)
class OverPins:
    """The size M over two pins or balls in opposite spaces; between them, of an internal gear.

    M = 2 r_K + D_M, of an odd number of teeth 2 r_K cos(pi/(2 z)) + D_M, inv alpha_K = D_M/(2 r_b) + eta_b - pi/z,
    r_K = r_b/cos alpha_K, eta_b half a tooth at the base circle; inside D_M counts negative (ISO 21771-1).

    Args:
        diameter: D_M of the pins or balls [mm]; spur teeth give the same with either.
    """

    diameter: float

    @property
    def words(self) -> str:
        """Its name."""
        return f"size over pins of {self.diameter:g} mm"

    def size(self, gear: CylindricalGear) -> float:
        """M [mm].

        Raises:
            GeometryError: pins so small that they touch no involute.
        """
        centre = gear.base_radius / math.cos(self._angle(gear))
        return 2 * centre * _opposite(gear) + gear.iso_sign * self.diameter

    def thickness(self, gear: CylindricalGear, size: float) -> float:
        """The arc at the reference circle [mm] of a gear with that size.

        Raises:
            GeometryError: a size at which the pins' centres lie within the base circle.
        """
        centre = (size - gear.iso_sign * self.diameter) / (2 * _opposite(gear))
        if centre < gear.base_radius:
            least = 2 * gear.base_radius * _opposite(gear) + gear.iso_sign * self.diameter
            raise GeometryError(f"expected a {self.words} of at least {least:.4f} mm, got {size:.4f} mm")
        half = involute(math.acos(gear.base_radius / centre)) - gear.iso_sign * self._turn(gear)
        return _thickness(gear, math.pi / gear.teeth + half if gear.iso_sign > 0 else half)

    def touches_at(self, gear: CylindricalGear) -> float:
        """Radius [mm] at which a pin touches both flanks of its space; below the base circle it touches no involute."""
        roll = math.tan(self._angle(gear)) - gear.iso_sign * self._turn(gear)
        return gear.base_radius * (math.hypot(1.0, roll) if roll > 0.0 else 1.0 + roll)

    def require_reach(self, gear: CylindricalGear) -> None:
        """Refuse pins that touch no involute, that touch the root, or that do not stand out beyond the tips.

        Raises:
            GeometryError: with the remedy.
        """
        pins = pins_of(gear)
        advice = f"; {pins.diameter:g} mm does" if pins else ""
        try:
            centre, sign = gear.base_radius / math.cos(self._angle(gear)), gear.iso_sign
        except GeometryError as error:
            raise GeometryError(f"{error}{advice}") from None
        in_root = sign * (centre - sign * self.diameter / 2 - gear.root_radius) < 0.0
        stands_out = sign * (centre + sign * self.diameter / 2 - gear.tip_radius) > 0.0
        if _on_flank(gear, self.touches_at(gear)) and stands_out and not in_root:
            return
        why = (
            f"touch at a diameter of {2 * self.touches_at(gear):.4f} mm, outside the involute ({_flank_words(gear)})"
            if not _on_flank(gear, self.touches_at(gear))
            else ("touch the root circle" if in_root else "do not stand out beyond the tip circle")
        )
        raise GeometryError(f"pins of {self.diameter:g} mm {why}: choose another diameter{advice}")

    def _turn(self, gear: CylindricalGear) -> float:
        return self.diameter / (2 * gear.base_radius)

    def _angle(self, gear: CylindricalGear) -> float:
        """alpha_K [rad], the pressure angle at a pin's centre."""
        half = _convex_half_angle(gear)
        space = half - math.pi / gear.teeth if gear.iso_sign > 0 else half
        value = space + gear.iso_sign * self._turn(gear)
        if value < 0.0:
            raise GeometryError(
                f"pins of {self.diameter:g} mm touch no involute of this gear: choose "
                f"{'thicker' if gear.iso_sign > 0 else 'thinner'} ones"
            )
        return inverse_involute(value)


ToothMeasure = Span | OverPins


@dataclass(frozen=True)
class PinScale:
    """The deviation of the arc at the reference circle by that of the size over pins: exact, both ways.

    Args:
        gear: nominal.
        pins: over which it is measured.
    """

    gear: CylindricalGear
    pins: OverPins

    @property
    def words(self) -> str:
        """Name of the measured quantity."""
        return self.pins.words

    @cached_property
    def _nominal(self) -> float:
        """inv alpha_K."""
        return involute(self.pins._angle(self.gear))

    @property
    def _lever(self) -> float:
        """Lever of the size by r_K/r_b [mm]."""
        return 2 * _opposite(self.gear) * self.gear.base_radius

    def deviation(self, measured: Array) -> Array:
        """Arcs (n,) of sizes (n,), both less the nominal one [mm]; no pin lies within the base circle.

        inv alpha_K = sqrt(q^2 - 1) - arctan sqrt(q^2 - 1) with q = r_K/r_b, and the arc changes by 2 r as much, inside
        by -2 r.
        """
        far = 1.0 / math.cos(self.pins._angle(self.gear)) + measured / self._lever
        roll = np.sqrt(np.maximum(far * far - 1.0, 0.0))
        arc = self.gear.iso_sign * 2 * self.gear.reference_radius
        return np.asarray(arc * (roll - np.arctan(roll) - self._nominal))

    def measured(self, deviation: Array) -> Array:
        """Sizes (n,) of arcs (n,), both less the nominal one [mm]."""
        arc = self.gear.iso_sign * 2 * self.gear.reference_radius
        angles = [inverse_involute(max(self._nominal + own / arc, 0.0)) for own in deviation.tolist()]
        return np.asarray(self._lever * (1.0 / np.cos(angles) - 1.0 / math.cos(self.pins._angle(self.gear))))


def spans_of(gear: CylindricalGear) -> list[Span]:
    """Every span whose faces touch the involute."""
    found = (Span(teeth) for teeth in range(1, gear.teeth // 2 + 1))
    return [own for own in found if own.size(gear) > 0.0 and _on_flank(gear, own.touches_at(gear))]


def span_of(gear: CylindricalGear) -> Span | None:
    """The span whose faces touch nearest to the circle of radius r + x m; None where none touches the involute."""
    return min(spans_of(gear), key=lambda own: abs(own.touches_at(gear) - _middle(gear)), default=None)


def pins_of(gear: CylindricalGear) -> OverPins | None:
    """Pins that touch near the circle of radius r + x m, in steps of PIN_STEP; None where none does."""
    return next(_possible_pins(gear), None)


def _possible_pins(gear: CylindricalGear) -> Iterator[OverPins]:
    roll = gear.roll_at(_middle(gear))
    half, sign = _convex_half_angle(gear), gear.iso_sign
    angle = roll + math.pi / gear.teeth - half if sign > 0 else roll - half
    if not 0.0 < angle < math.pi / 2:
        return
    wanted = sign * 2 * gear.base_radius * (math.tan(angle) - roll)
    nearest = round(wanted / PIN_STEP)
    for step in range(round(gear.module / PIN_STEP) + 1):
        for count in (nearest + step, nearest - step):
            if count > 0 and _is_possible(gear, own := OverPins(round(count * PIN_STEP, 6))):
                yield own


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
    )


def _middle(gear: CylindricalGear) -> float:
    """r + x m [mm], held within the involute."""
    low, high = sorted((gear.form_radius, gear.tip_radius))
    return min(max(gear.reference_radius + gear.iso_sign * gear.profile_shift * gear.module, low), high)


def _convex_half_angle(gear: CylindricalGear) -> float:
    """Half angle of the convex body at the base circle [rad]: a tooth outside, a space inside."""
    return gear.base_half_angle if gear.iso_sign > 0 else math.pi / gear.teeth - gear.base_half_angle


def _thickness(gear: CylindricalGear, convex_half_angle: float) -> float:
    """The arc of a tooth at the reference circle [mm]."""
    half = convex_half_angle - involute(gear.pressure_angle)
    return 2 * gear.reference_radius * (half if gear.iso_sign > 0 else math.pi / gear.teeth - half)


def _opposite(gear: CylindricalGear) -> float:
    """Distance of two opposite spaces over that of diametral ones: cos(pi/(2 z)) of an odd number of teeth."""
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
