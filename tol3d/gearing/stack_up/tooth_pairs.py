"""Loss of each flank side of a pair by flanks that deviate one by one: the pair that stands out most touches.

On the tangent of both base circles, T = a sin(alpha_w) long, a pair of flanks touches r_b1 t_1 from its one end and
r_b2 t_2 = T - r_b1 t_1 from the other; t_1 falls by as much as the driver's tooth goes on. To first order each pair
loses the sum of both flank offsets there, with parallel axes at the end of the common face where the sum is larger.
Beyond the path of contact the tip edge of one gear may still touch first, where its pair stands out by
more than the edge has left the mate's flank.

Of helical gears that holds slice by slice, and a pair loses what the slice on its contact line loses that loses most.

Neglected: effects of the curvature of a deviation. Axes that move take the path of contact along, to first order.
"""

import importlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.effects import FORM, SHAPES, FlankDeviation
from tol3d.gearing.model import Contributor, Mesh, Model, Reading
from tol3d.gearing.model.flank_margin import margin_of
from tol3d.gearing.stack_up.term import Role
from tol3d.gears import InternalGear, InternalPair, SpurGear, SpurPair
from tol3d.gears.flank import RIGHT
from tol3d.gears.pair import CONTACT_MARGIN
from tol3d.numerics.arrays import Array

Integers = NDArray[np.int64]

NUMBERS_AT_ONCE: Final = 4_000_000
"""Deviations of rows that are held at once: 32 MB."""

KERNELS: Final = "tol3d.gearing.stack_up.tooth_kernels"
LINE_KERNELS: Final = "tol3d.gearing.stack_up.line_kernels"
"""Lazy imports: they load the compiler of kernels, which stack-ups of other gears do not need."""

WHO_TURNS: Final[Mapping[Role | None, int]] = {None: 0, "driven": 1, "driver": 2}
"""In the words of tooth_kernels."""


@dataclass(frozen=True, eq=False)
class ToothFlanks:
    """Deviations of the flanks of one gear, of which both sides of each tooth have SHAPES numbers.

    Args:
        gear: the gear.
        ahead: by how many teeth its tooth 0 stands ahead of the one that the mesh counts as such.
        acting: effects, each with the columns of its contributor in the deviations.
    """

    gear: SpurGear | InternalGear
    ahead: int
    acting: Sequence[tuple[slice, FlankDeviation]]

    def numbers(self, deviations: Array) -> Array:
        """Flank deviations of trials: (trials, teeth x 2 x SHAPES) [mm], right flanks of each tooth first.

        The input is (trials, components).

        No columns where no flank deviates.
        """
        found = np.zeros((len(deviations), 2 * SHAPES * self.gear.teeth if self.acting else 0))
        for columns, slots, factors in self._sums:
            found[:, slots] += factors * deviations[:, columns]
        return found

    @cached_property
    def _sums(self) -> Sequence[tuple[Integers, Integers, Array]]:
        """Columns of the deviations, each times a factor a summand of a slot of its own."""
        found = []
        for columns, effect in self.acting:
            summands: dict[int, list[tuple[int, int, float]]] = {}
            before: dict[int, int] = {}
            for component, place, shape, factor in effect.terms:
                slot = SHAPES * (2 * place.tooth + (place.flank != RIGHT)) + shape
                before[slot] = before.get(slot, -1) + 1
                summands.setdefault(before[slot], []).append((columns.start + component, slot, factor))
            for summand in summands.values():
                each = np.array(summand)
                found.append((each[:, 0].astype(np.int64), each[:, 1].astype(np.int64), each[:, 2]))
        return found

    @property
    def measures(self) -> tuple[float, ...]:
        """As tooth_kernels.GearTeeth has them."""
        sense = self.gear.iso_sign
        begin, end = sense * self.gear.form_roll, sense * self.gear.tip_roll
        waves, span = next(((own.waves, own.span) for _, own in self.acting if own.shape == FORM), (0.0, None))
        first, last = span or (begin, end)
        wave = 2 * math.pi * waves / (last - first), (first + last) / 2
        return self.gear.base_radius, begin, end, self.gear.face_width, *wave


@dataclass(frozen=True, eq=False)
class BuiltTeeth:
    """Flanks of a mesh in some trials.

    Args:
        driver, driven: as ToothFlanks.numbers has them.
        trial: that of each row, (rows,).
    """

    driver: Array
    driven: Array
    trial: Integers

    def in_section(self, cosine: float) -> tuple[Array, Array, Integers]:
        """The same along the line of action of a transverse section, of which `cosine` lies along the normals."""
        return self.driver / cosine, self.driven / cosine, self.trial


class Moved(NamedTuple):
    """Axes and flanks of a mesh that do not stand at their nominal places, (rows,) each.

    Args:
        apart: how much further apart the axes stand [mm].
        aside: how much further the driven one stands in the world's +y [mm].
        wider: half of the angle by which the driver's teeth are wider [rad].
        higher: how much higher the teeth of the driven one stand in the mesh, along the axes [mm].
    """

    apart: Array
    aside: Array
    wider: Array
    higher: Array


@dataclass(frozen=True, eq=False)
class ToothPairs:
    """The pairs of flanks of a mesh of spur or helical gears, at least one of which has flanks that deviate one by one.

    `beyond` is how far beyond the path of contact pairs are looked at [pitches].
    """

    pair: SpurPair | InternalPair
    reading: Reading
    working_flank: int
    driver: ToothFlanks
    driven: ToothFlanks
    beyond: float

    def built(self, deviations: Array, trial: Integers) -> BuiltTeeth:
        """The flanks of trials (trials, components), and the trial of each row (rows,)."""
        return BuiltTeeth(self.driver.numbers(deviations), self.driven.numbers(deviations), trial)

    def taken(
        self,
        side: int,
        built: BuiltTeeth,
        driver_angle: Array,
        lean: Array,
        moved: Moved | None,
        turns: Role | None = "driven",
        apart: Array | None = None,
    ) -> Array:
        """Loss of a flank side by its flanks [mm], (rows,): positive where it touches earlier.

        Args:
            side: 1 where the driver's right flanks touch, -1 where its left ones do.
            built: their trials.
            driver_angle: (rows,) [rad].
            lean: (trials, 1), loss by tilted axes at the upper end of the common face, signed [mm]; of helical gears
                (trials, 5): with the strain of the driven gear less that of the driver, the changes per height of a
                tooth's roll on the line of centres [rad/mm] and of the tangent, see _shifts, and the lean of the driven
                axis across the line of action, outwards from the driver's.
            moved: axes and flanks off their nominal places; None if none is.
            turns: the gear that turns until the side touches; None reads its gap as the gears stand.
            apart: by which the side stands open before [mm], (rows,), where anything but the driven gear turns.
        """
        first, second = self.driver.gear, self.driven.gear
        half = min(first.face_width, second.face_width) / 2 if self._reads_face(side) else 0.0
        start = first.iso_sign * self.pair.working_pressure_angle + first.base_half_angle
        teeth, count = self._teeth(side, driver_angle)
        places = (self.driver.ahead, self.driven.ahead, first.teeth, second.teeth)
        line: tuple[float, ...] = (self._tangent, start, first.angular_pitch, half)
        kernels, cosine = KERNELS, self.pair.base_helix_cosine
        if first.helix_angle:
            fall = first.hand * math.tan(first.base_helix_angle) / half
            up = first.hand * math.sin(first.base_helix_angle) * cosine
            at_pitch = first.iso_sign * math.tan(self.pair.working_pressure_angle)
            line = (*line, first.twist, fall, at_pitch, cosine**2, up)
            kernels = LINE_KERNELS
        found: Array = importlib.import_module(kernels).taken(
            (*self._measures, line),
            (side, WHO_TURNS[turns], count, *places),
            (built.driver, built.driven, built.trial) if cosine == 1.0 else built.in_section(cosine),
            (
                teeth,
                driver_angle,
                lean / np.array([cosine, 1.0, 1.0, 1.0, 1.0]) if first.helix_angle else lean,
                np.zeros(0) if apart is None else apart / cosine,
                self._shifts(side, moved),
            ),
        )
        return found * cosine

    @property
    def _measures(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """As tooth_kernels.GearTeeth, or TeethInRing, has those of driver and driven."""
        gears = (self.driver, self.driven)
        if isinstance(self.pair, SpurPair):
            return gears[0].measures, gears[1].measures
        first, second = ((*own.measures, float(own.gear.iso_sign)) for own in gears)
        return first, second

    def _shifts(self, side: int, moved: Moved | None) -> Array:
        """Change by moved axes and flanks of a tooth's roll on the line of centres [rad] and of the tangent [mm].

        (rows, 2), of helical gears (rows, 3) with the driven teeth's shift along the axes [mm]; flanks of wider teeth
        meet as much earlier as they stand further out.

        Axes that stand dx further apart touch at a pressure angle that is dx/(a tan alpha_w) larger, along a tangent
        that is dx/sin(alpha_w) longer; a line of centres that turns by dy/a takes the path of contact along.
        """
        if moved is None:
            return np.zeros((0, 2))
        apart, aside, wider, higher = moved
        alpha, distance = self.pair.working_pressure_angle, self.pair.centre_distance
        senses = self.driver.gear.iso_sign, self.driven.gear.iso_sign
        rolls = (senses[1] * apart / math.tan(alpha) + side * senses[0] * aside) / distance + wider
        shifts = [rolls, apart / math.sin(alpha), *([higher] if self.driver.gear.helix_angle else [])]
        return np.stack(shifts, axis=-1)

    @property
    def _tangent(self) -> float:
        """Length [mm] of the tangent of both base circles; of an internal pair negative."""
        return self.pair.base_radii * math.tan(self.pair.working_pressure_angle)

    def _reads_face(self, side: int) -> bool:
        return (self.reading.contact if side == self.working_flank else self.reading.gap) == "face"

    def _teeth(self, side: int, driver_angle: Array) -> tuple[Integers, int]:
        """The first of the driver's teeth (rows,) that may touch, as the mesh counts, and how many follow it.

        Each next one stands a tooth further back on the driver's right flanks, and further on on its left ones.
        """
        gear, place = self.driver.gear, driver_angle / self.driver.gear.angular_pitch
        if self.reading.teeth == "driver":
            return -np.rint(place).astype(np.int64), 1
        if self.reading.teeth == "driven":
            return (side == 1) - np.rint(place + 0.5).astype(np.int64), 1
        sense = gear.iso_sign
        working = sense * self.pair.working_pressure_angle
        leaning = abs(gear.twist) * self.pair.common_face / 2
        last_psi = working + gear.base_half_angle - self._start_roll + leaning + self.beyond * gear.angular_pitch
        length = sense * gear.tip_roll - self._start_roll + 2 * leaning
        count = math.floor(length / gear.angular_pitch + 2 * self.beyond) + 1
        return side * np.floor(last_psi / gear.angular_pitch - side * place).astype(np.int64), count

    @property
    def _start_roll(self) -> float:
        """Roll of the driver where the driven gear's tip touches; a ring's negative."""
        tip = self.driven.gear.iso_sign * self.driven.gear.tip_roll
        return (self._tangent - self.driven.gear.base_radius * tip) / self.driver.gear.base_radius


def tooth_pairs(model: Model, mesh: Mesh, reading: Reading) -> ToothPairs | None:
    """The pairs of flanks of a mesh; None where all flanks of each gear are alike."""
    acting = [
        (contributor, effect)
        for contributor in model.contributors
        for effect in contributor.effect.singles
        if isinstance(effect, FlankDeviation) and effect.acts_in(mesh)
    ]
    if not acting or not isinstance(mesh.pair, SpurPair | InternalPair):
        return None
    driver, driven = (_flanks(model, mesh, name, acting) for name in (mesh.driver, mesh.driven))
    beyond = CONTACT_MARGIN + margin_of(model, mesh)
    return ToothPairs(mesh.pair, reading, mesh.resting_flank(reading.flank), driver, driven, beyond)


def lines_alone(model: Model, mesh: Mesh, pair: SpurPair | InternalPair, reading: Reading) -> ToothPairs:
    """The pairs of flanks of a mesh of which none deviates: of gears that grow apart, or lean."""
    driver, driven = (_flanks(model, mesh, name, ()) for name in (mesh.driver, mesh.driven))
    return ToothPairs(pair, reading, mesh.resting_flank(reading.flank), driver, driven, CONTACT_MARGIN)


def teeth_deviate(model: Model, mesh: Mesh) -> bool:
    """True if single flanks of a mesh's gears deviate."""
    gears = (mesh.driver, mesh.driven)
    return any(contributor.effect.deviates_teeth(gear) for contributor in model.contributors for gear in gears)


def pieces(trials: int, positions: int, components: int) -> Iterator[slice]:
    """Trials in pieces whose rows of deviations, repeated for each position, stay small."""
    size = max(1, NUMBERS_AT_ONCE // max(1, positions * components))
    for first in range(0, trials, size):
        yield slice(first, min(first + size, trials))


def _flanks(model: Model, mesh: Mesh, name: str, acting: Sequence[tuple[Contributor, FlankDeviation]]) -> ToothFlanks:
    gear, seat = mesh.gear(name), model.seats[model.seat_index[mesh.name, name]]
    if not isinstance(gear, SpurGear | InternalGear):
        raise TypeError(f"{name} is no cylindrical gear")
    own = [(model.component_slices[one.name], effect) for one, effect in acting if effect.part == name]
    return ToothFlanks(gear, round(seat.ahead / gear.angular_pitch), own)


def distinct(deviations: Array) -> tuple[Array, Integers]:
    """Rows of deviations without repetitions of the row before, and the index of each row among them."""
    new = np.ones(len(deviations), dtype=bool)
    new[1:] = (deviations[1:] != deviations[:-1]).any(axis=1)
    return deviations[new], np.cumsum(new) - 1
