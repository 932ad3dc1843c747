"""What flanks that deviate one by one take from each flank side of a spur pair: the pair that stands out most touches.

On the tangent of both base circles, T = a sin(alpha_w) long, a pair of flanks touches r_b1 t_1 from its one end and
r_b2 t_2 = T - r_b1 t_1 from the other; t_1 falls by as much as the driver's tooth goes on. To first order each pair
loses what both flanks stand out by there, and a pair with parallel axes loses it at the end of the common face where
that is more. Beyond the path of contact the tip edge of one gear may still touch first, where its pair stands out by
more than the edge has left the mate's flank.

Neglected: what goes with the curvature of a deviation, and that deviations move the path of contact.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.effects import FORM, HELIX, SHAPES, SLOPE, UNIFORM, FlankDeviation
from tol3d.gearing.model import Contributor, Mesh, Model, Reading
from tol3d.gearing.stack_up.term import Role
from tol3d.gears import SpurGear, SpurPair

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

BEYOND: Final = 0.5
"""Pitches beyond the path of contact in which pairs are looked at."""

NUMBERS_AT_ONCE: Final = 4_000_000
"""Deviations of rows that are held at once: 32 MB."""

FAR: Final = 0.1
"""mm; a pair that takes so much less than the first one does not come before it by another look."""

LOOKS: Final = 3
"""At pairs; a look moves what an edge takes by a twentieth of what the look before did."""


@dataclass(frozen=True, eq=False)
class ToothFlanks:
    """Deviations of the flanks of one gear, of which both sides of each tooth have SHAPES numbers.

    Args:
        gear: whose.
        ahead: by how many teeth its tooth 0 stands ahead of the one that the mesh counts as such.
        acting: effects, each with the columns of its contributor in the deviations.
    """

    gear: SpurGear
    ahead: int
    acting: Sequence[tuple[slice, FlankDeviation]]

    def numbers(self, deviations: Array) -> Array:
        """Of trials (trials, components): (trials, teeth, 2, SHAPES) [mm], right flanks first."""
        found = np.zeros((self.gear.teeth, 2, SHAPES, len(deviations)))
        for columns, effect in self.acting:
            own = deviations[:, columns]
            for component, places in enumerate(effect.places):
                for place in places:
                    side = 0 if place.flank == 1 else 1
                    found[place.tooth, side, effect.shape] += place.factor * own[:, component]
        return np.moveaxis(found, -1, 0)

    def waves(self) -> float:
        """Of the form of its flanks."""
        return next((effect.waves for _, effect in self.acting if effect.shape == FORM), 0.0)

    def along(self, numbers: Array, roll: Array) -> tuple[Array, Array]:
        """What flanks stand out by in the middle of the face, and more at its upper end [mm], at rolls [rad]."""
        t_form, t_tip = self.gear.form_roll, self.gear.tip_roll
        u = (np.clip(roll, t_form, t_tip) - (t_form + t_tip) / 2) / (t_tip - t_form)
        waves = self.waves()
        out = numbers[..., UNIFORM] + numbers[..., SLOPE] * u
        if numbers[..., FORM].any():
            out += numbers[..., FORM] * (1 / 3 - 4 * u**2 if waves == 0 else np.cos(2 * math.pi * waves * u) / 2)
        return out, numbers[..., HELIX] / self.gear.face_width

    def slope(self, numbers: Array, roll: Array) -> Array:
        """Change of what flanks stand out by per roll [mm/rad], at rolls [rad]."""
        length = self.gear.tip_roll - self.gear.form_roll
        u = (np.clip(roll, self.gear.form_roll, self.gear.tip_roll) - self.gear.form_roll) / length - 0.5
        waves = 2 * math.pi * self.waves()
        shape = -8 * u if waves == 0 else -waves * np.sin(waves * u) / 2
        return np.asarray((numbers[..., SLOPE] + numbers[..., FORM] * shape) / length)


@dataclass(frozen=True, eq=False)
class ToothPairs:
    """The pairs of flanks of a mesh of spur gears, at least one of which has flanks that deviate one by one."""

    pair: SpurPair
    reading: Reading
    working_flank: int
    driver: ToothFlanks
    driven: ToothFlanks

    def taken(
        self,
        side: int,
        deviations: Array,
        driver_angle: Array,
        lean: Array,
        turns: Role | None = "driven",
        apart: Array | None = None,
    ) -> Array:
        """What flanks take from a flank side [mm], (rows,): positive where it touches earlier.

        Args:
            side: 1 where the driver's right flanks touch, -1 where its left ones do.
            deviations: (rows, components); rows of one trial lie together.
            driver_angle: (rows,) [rad].
            lean: (rows,), what leaning axes take at the upper end of the common face, signed [mm].
            turns: the gear that turns until the side touches; None reads its gap as the gears stand.
            apart: by which the side stands open before [mm], (rows,), where anything but the driven gear turns.
        """
        rows, trial = _trials(deviations)
        teeth = self._teeth(side, driver_angle)
        mating = -teeth - (0 if side == 1 else 1)
        first, second = self.driver.gear, self.driven.gear
        numbers = [
            flanks.numbers(rows)[trial[:, None], (own - flanks.ahead) % flanks.gear.teeth, 0 if side == 1 else 1]
            for flanks, own in ((self.driver, teeth), (self.driven, mating))
        ]
        psi = side * (driver_angle[:, None] + teeth * first.angular_pitch)
        roll = self.pair.working_pressure_angle + first.base_half_angle - psi
        mate_roll = (self._tangent - first.base_radius * roll) / second.base_radius
        half = min(first.face_width, second.face_width) / 2 if self._reads_face(side) else 0.0
        open_by = np.zeros((len(teeth), 1)) if apart is None else apart[:, None]
        leans, stands = np.broadcast_to(lean[:, None], teeth.shape), np.broadcast_to(open_by, teeth.shape)
        found, pairs = np.zeros(teeth.shape), np.ones(teeth.shape, dtype=bool)
        for _ in range(LOOKS):  # a gear that has turned by what its pair takes stands at another roll
            rolls = [roll[pairs], mate_roll[pairs]]
            rolls[1] = rolls[1] - (found[pairs] if turns == "driven" else stands[pairs]) / second.base_radius
            if turns == "driver":
                rolls[0] = rolls[0] + (stands[pairs] - found[pairs]) / first.base_radius
            own = [each[pairs] for each in numbers]
            found[pairs] = self._out(own, (rolls[0], rolls[1]), half, leans[pairs])
            pairs[pairs] = self._changes(own, rolls[0], rolls[1])
            pairs &= found > found.max(axis=1, keepdims=True) - FAR
            if not pairs.any():
                break
        return np.asarray(found.max(axis=1))

    def _changes(self, numbers: Sequence[Array], roll: Array, mate_roll: Array) -> NDArray[np.bool_]:
        """Which pairs take another length at another roll: they slope, or touch at an edge."""
        edges = (roll > self.driver.gear.tip_roll) | (mate_roll > self.driven.gear.tip_roll)
        sloped = [(own[..., SLOPE] != 0.0) | (own[..., FORM] != 0.0) for own in numbers]
        return np.asarray(edges | sloped[0] | sloped[1])

    def _out(self, numbers: Sequence[Array], rolls: tuple[Array, Array], half: float, lean: Array) -> Array:
        """What each pair takes [mm] that touches at some rolls [rad], less what its edges have left their mates."""
        first, second = self.driver.gear, self.driven.gear
        (out, rising), (mate_out, mate_rising) = (
            flanks.along(own, at)
            for flanks, own, at in zip((self.driver, self.driven), numbers, self._touched(rolls), strict=True)
        )
        gone = _gone(first, second, rolls[0], self._tangent) + _gone(second, first, rolls[1], self._tangent)
        at_end = np.abs((rising + mate_rising) * half + lean) if half else 0.0
        return np.asarray(out + mate_out + at_end + self._aside(numbers, rolls) - gone)

    def _touched(self, rolls: tuple[Array, Array]) -> tuple[Array, Array]:
        """Rolls at which flanks touch [rad]: a tip edge that has passed its end by d meets its mate rho d further on.

        From roll t on an arc v of an involute ends at the roll sqrt(t^2 + 2 v/r_b).
        """
        gears = (self.driver.gear, self.driven.gear)
        passed = [np.maximum(at - gear.tip_roll, 0.0) for gear, at in zip(gears, rolls, strict=True)]
        arcs = [gear.base_radius * gear.tip_roll * own for gear, own in zip(gears, passed, strict=True)]
        on = [
            np.sqrt(np.maximum(at, 0.0) ** 2 + 2 * arc / gear.base_radius)
            for gear, at, arc in zip(gears, rolls, reversed(arcs), strict=True)
        ]
        return on[0], on[1]

    def _aside(self, numbers: Sequence[Array], rolls: tuple[Array, Array]) -> Array:
        """What pairs take more where they touch beside the line of action, for flanks that slope there [mm].

        As the driver's point rolls on by dt, the foot on the mate rolls back by rho_1/rho_2 dt, and both flanks curve
        away by b dt^2/2, b = rho_1^2 (1/rho_1 + 1/rho_2): of a slope g they touch g/b on and take g^2/(2 b) more, or
        less where a flank ends before.
        """
        if not any(own[..., [SLOPE, FORM]].any() for own in numbers):
            return np.zeros(rolls[0].shape)
        first, second = self.driver.gear, self.driven.gear
        inside = [np.clip(at, max(f.form_roll, 1e-3), f.tip_roll) for f, at in zip((first, second), rolls, strict=True)]
        rho, mate_rho = first.base_radius * inside[0], second.base_radius * inside[1]
        back, bend = rho / mate_rho, rho * (rho + mate_rho) / mate_rho
        steep = self.driver.slope(numbers[0], rolls[0]) - self.driven.slope(numbers[1], rolls[1]) * back
        # beyond the path of contact both edges have come from where they would have touched
        beyond = np.maximum(rolls[0] - first.tip_roll, 0.0) - np.maximum(rolls[1] - second.tip_roll, 0.0) / back
        steep = np.where(steep == 0.0, 0.0, steep + bend * beyond)
        low = np.maximum(first.form_roll - inside[0], (inside[1] - second.tip_roll) / back)
        high = np.minimum(first.tip_roll - inside[0], (inside[1] - second.form_roll) / back)
        on = np.clip(steep / bend, low, high)
        return np.asarray(steep * on - bend * on * on / 2)

    @property
    def _tangent(self) -> float:
        """Length [mm] of the tangent of both base circles."""
        bases = self.driver.gear.base_radius + self.driven.gear.base_radius
        return bases * math.tan(self.pair.working_pressure_angle)

    def _reads_face(self, side: int) -> bool:
        return (self.reading.contact if side == self.working_flank else self.reading.gap) == "face"

    def _teeth(self, side: int, driver_angle: Array) -> Integers:
        """Teeth of the driver (rows, teeth) that may touch, as the mesh counts."""
        gear, place = self.driver.gear, driver_angle / self.driver.gear.angular_pitch
        if self.reading.teeth == "driver":
            return -np.rint(place).astype(np.int64)[:, None]
        if self.reading.teeth == "driven":
            return (side == 1) - np.rint(place + 0.5).astype(np.int64)[:, None]
        working = self.pair.working_pressure_angle
        last_psi = working + gear.base_half_angle - self._start_roll + BEYOND * gear.angular_pitch
        length = gear.tip_roll - self._start_roll
        count = math.floor(length / gear.angular_pitch + 2 * BEYOND) + 1
        last = np.floor(last_psi / gear.angular_pitch - side * place).astype(np.int64)
        return side * (last[:, None] - np.arange(count))

    @property
    def _start_roll(self) -> float:
        """Roll of the driver where the driven gear's tip touches."""
        second = self.driven.gear
        return (self._tangent - second.base_radius * second.tip_roll) / self.driver.gear.base_radius


def _gone(gear: SpurGear, mate: SpurGear, roll: Array, tangent: float) -> Array:
    """By how much the tip edge of a gear has left its mate [mm] where its pair lies beyond the path of contact.

    The edge lies r_b (e(d) + t_tip n(d)) off its gear's axis, e the direction to where the tangent of both base circles
    touches the own one, n along that tangent, turned by d = t - t_tip. Its own tangent to the mate's base circle is L
    long and touches that th further on, so that the mate's flank is L - r_bm (t_m - th) away.
    """
    found, passed = np.zeros(roll.shape), roll > gear.tip_roll
    beyond = roll[passed] - gear.tip_roll
    own, other = gear.base_radius, mate.base_radius
    x = own + other - own * (np.cos(beyond) - gear.tip_roll * np.sin(beyond))
    y = tangent - own * (np.sin(beyond) + gear.tip_roll * np.cos(beyond))
    length = np.sqrt(np.maximum(x * x + y * y - other * other, 0.0))
    further = np.arctan2(y, x) - np.arctan2(length, other)
    found[passed] = length - (tangent - own * (gear.tip_roll + beyond)) + other * further
    return found


def tooth_pairs(model: Model, mesh: Mesh, reading: Reading) -> ToothPairs | None:
    """The pairs of flanks of a mesh; None where all flanks of each gear are alike."""
    acting = [
        (contributor, effect)
        for contributor in model.contributors
        for effect in contributor.effect.singles
        if isinstance(effect, FlankDeviation) and effect.acts_in(mesh)
    ]
    if not acting or not isinstance(mesh.pair, SpurPair):
        return None
    driver, driven = (_flanks(model, mesh, name, acting) for name in (mesh.driver, mesh.driven))
    return ToothPairs(mesh.pair, reading, mesh.resting_flank(reading.flank), driver, driven)


def teeth_deviate(model: Model, mesh: Mesh) -> bool:
    """Whether single flanks of a mesh's gears deviate."""
    gears = (mesh.driver, mesh.driven)
    return any(own.effect.deviates_teeth(gear) for own in model.contributors for gear in gears)


def pieces(trials: int, positions: int, components: int) -> Iterator[slice]:
    """Trials in pieces whose rows of deviations, repeated for each position, stay small."""
    size = max(1, NUMBERS_AT_ONCE // max(1, positions * components))
    for first in range(0, trials, size):
        yield slice(first, min(first + size, trials))


def _flanks(model: Model, mesh: Mesh, name: str, acting: Sequence[tuple[Contributor, FlankDeviation]]) -> ToothFlanks:
    gear, seat = mesh.gear(name), model.seats[model.seat_index[mesh.name, name]]
    if not isinstance(gear, SpurGear):
        raise TypeError(f"{name} is no spur gear")
    own = [(model.component_slices[one.name], effect) for one, effect in acting if effect.part == name]
    return ToothFlanks(gear, round(seat.ahead / gear.angular_pitch), own)


def _trials(deviations: Array) -> tuple[Array, Integers]:
    """Rows of deviations without those that repeat the row before, and which of them each row is."""
    new = np.ones(len(deviations), dtype=bool)
    new[1:] = (deviations[1:] != deviations[:-1]).any(axis=1)
    return deviations[new], np.cumsum(new) - 1
