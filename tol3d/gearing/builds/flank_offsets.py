"""Offsets of single flanks of gears: one row a build, shared by all positions at which the build is read.

Coefficients of a flank are consecutive: its constant offset [mm], and those along profile, form and face, see
FlankDeviation in effects.py. A gear without deviations of single flanks has none.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.builds.displacements import FlankOffsets, displacements
from tol3d.gearing.effects import FORM, SHAPES, SLOPE, UNIFORM, FlankDeviation
from tol3d.gearing.model import Mesh, Model
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.flank import RIGHT, Flank
from tol3d.numerics.arrays import Array

Integers = NDArray[np.int64]


def deviates(model: Model, mesh: Mesh) -> bool:
    """True if single flanks of a mesh's gears deviate."""
    effects = (effect for contributor in model.contributors for effect in contributor.effect.singles)
    return any(isinstance(effect, FlankDeviation) and effect.acts_in(mesh) for effect in effects)


def flank_slot(teeth: int, tooth: Integers | int, flank: Flank) -> Any:
    """Index of the first coefficient of a flank among those of its gear; teeth count round the gear."""
    return SHAPES * (2 * np.mod(tooth, teeth) + (flank != RIGHT))


@dataclass(frozen=True, eq=False)
class FlankPlaces:
    """Indices of flank coefficients, and their dependence on deviations.

    Args:
        starts: of each gear that has any, by name.
        waves: of the form of its flanks, by name; see FlankDeviation.
        spans: rolls between which u goes from -1/2 to 1/2 [rad], by name: of its waves, or of the whole involute.
        components, slots, factors: (terms,), each adds a factor times a component of the deviations to a slot.
        count: of all coefficients.
    """

    starts: Mapping[str, int]
    waves: Mapping[str, float]
    spans: Mapping[str, tuple[float, float]]
    components: Integers
    slots: Integers
    factors: Array
    count: int

    @classmethod
    def of(cls, model: Model) -> "FlankPlaces":
        """Those of a model."""
        acting = [
            (model.component_slices[contributor.name].start, term.effect)
            for contributor in model.contributors
            for effect in contributor.effect.singles
            for term in displacements(effect, model, len(contributor.draw.components))
            if isinstance(term, FlankOffsets)
        ]
        starts: dict[str, int] = {}
        waves: dict[str, float] = {}
        spans: dict[str, tuple[float, float]] = {}
        count = 0
        for _, effect in acting:
            gear = _cylindrical_gear(model, effect.part)
            if effect.part not in starts:
                starts[effect.part], waves[effect.part] = count, 0.0
                spans[effect.part] = gear.form_roll, gear.tip_roll
                count += 2 * SHAPES * gear.teeth
            if effect.shape == FORM:
                waves[effect.part] = effect.waves
                spans[effect.part] = effect.span or spans[effect.part]
        terms: list[tuple[int, int]] = []
        factors: list[float] = []
        for first, effect in acting:
            gear, start = _cylindrical_gear(model, effect.part), starts[effect.part]
            for component, place, shape, factor in effect.terms:
                slot = start + int(flank_slot(gear.teeth, place.tooth, place.flank))
                for own, share in _over(spans[effect.part], gear, shape):
                    terms.append((first + component, slot + own))
                    factors.append(factor * share)
        each = np.array(terms, dtype=np.int64).reshape(-1, 2)
        return cls(starts, waves, spans, each[:, 0], each[:, 1], np.array(factors, dtype=float), count)

    def made(self, deviations: Array) -> "FlankDeviations | None":
        """The offsets of builds with these deviations (trials, components); None where no gear has any."""
        if not self.count:
            return None
        values = np.zeros((len(deviations), self.count))
        for terms in self._one_a_slot:
            values[:, self.slots[terms]] += self.factors[terms] * deviations[:, self.components[terms]]
        return FlankDeviations(values, np.arange(len(deviations)))

    @cached_property
    def _one_a_slot(self) -> Sequence[Integers]:
        """All terms in parts, in none of which two add to one slot; each slot has them in their order."""
        before = np.zeros(self.count, dtype=np.int64)
        part = np.empty(len(self.slots), dtype=np.int64)
        for term, slot in enumerate(self.slots):
            part[term] = before[slot]
            before[slot] += 1
        return [np.flatnonzero(part == own) for own in range(before.max(initial=0))]

    def rates(self, model: Model, seat: int, flank: Flank, teeth: Integers, place: tuple[Array, Array]) -> Array:
        """Outward motion of points of flanks along the normal per component, (rows, components).

        Args:
            model, seat: whose flanks.
            flank, teeth: which side, and which teeth (rows,) as the mesh counts.
            place: roll [rad] and height over the middle of the face [mm], (rows,) each, of the gear not grown.
        """
        own = model.seats[seat]
        gear = model.gear(own.gear).gear
        matrix = np.zeros((self.count, model.component_count))
        np.add.at(matrix, (self.slots, self.components), self.factors)
        if own.gear not in self.starts or not isinstance(gear, CylindricalGear):
            return np.zeros((len(teeth), model.component_count))
        roll, height = place
        begin, end = self.spans[own.gear]
        u = (roll - (begin + end) / 2) / (end - begin)
        waves = self.waves[own.gear]
        form = np.cos(2 * math.pi * waves * u) / 2 if waves else 1 / 3 - 4 * u * u
        shapes = np.stack([np.ones_like(u), u, form, height / gear.face_width], axis=-1)
        ahead = round(own.ahead / gear.angular_pitch)
        first = self.starts[own.gear] + flank_slot(gear.teeth, teeth - ahead, flank)
        return np.asarray((shapes[:, :, None] * matrix[first[:, None] + np.arange(SHAPES)]).sum(axis=1))

    def acts_in(self, *gears: str) -> bool:
        """True if any of the gears has coefficients."""
        return any(gear in self.starts for gear in gears)

    def reach(self, made: "FlankDeviations", model: Model, *gears: str) -> Array:
        """Largest excess of a pair of flanks of some gears over its neighbours, (builds,) [mm]."""
        total = np.zeros((len(made.values), 2))  # of right and left flanks
        for gear in gears:
            if gear in self.starts:
                teeth = _cylindrical_gear(model, gear).teeth
                own = made.values[:, self.starts[gear] :][:, : 2 * SHAPES * teeth].reshape(-1, teeth, 2, SHAPES)
                least, most = self._extremes(_cylindrical_gear(model, gear), gear, own)
                total += np.maximum(*((most - np.roll(least, by, axis=1)).max(axis=1) for by in (1, -1)))
        return np.asarray(total.max(axis=1))

    def _extremes(self, gear: CylindricalGear, name: str, own: Array) -> tuple[Array, Array]:
        """Bounds of the least and largest offset of flanks (…, SHAPES) anywhere [mm]."""
        begin, end = self.spans[name]
        ends = [(roll - (begin + end) / 2) / (end - begin) for roll in (gear.form_roll, gear.tip_roll)]
        level, slope, form, helix = np.moveaxis(own, -1, 0)
        rows, beside = [level + slope * u for u in ends], np.abs(helix) / 2
        if self.waves[name]:
            beside = beside + np.abs(form) / 2
        elif form.any():
            found = np.divide(slope, 8 * form, out=np.zeros_like(form), where=form != 0.0)
            vertex = np.clip(found, ends[0], ends[1])
            rows = [level + slope * u + form * (1 / 3 - 4 * u * u) for u in (*ends, vertex)]
        return np.minimum.reduce(rows) - beside, np.maximum.reduce(rows) + beside


def _cylindrical_gear(model: Model, name: str) -> CylindricalGear:
    gear = model.gear(name).gear
    if not isinstance(gear, CylindricalGear):
        raise TypeError(f"{name} is no cylindrical gear")
    return gear


def _over(span: tuple[float, float], gear: CylindricalGear, shape: int) -> Iterator[tuple[int, float]]:
    """A shape over the whole involute by those over a span of it: u of one is a share of the other's, and a level."""
    whole, begin, end = gear.tip_roll - gear.form_roll, *span
    yield shape, (end - begin) / whole if shape == SLOPE else 1.0
    off = (begin - gear.form_roll + end - gear.tip_roll) / 2
    if shape == SLOPE and off:
        yield UNIFORM, off / whole


@dataclass(frozen=True, eq=False)
class FlankDeviations:
    """Offsets of single flanks of some builds.

    Args:
        values: (builds, coefficients) [mm].
        row: (rows,), the build of each row.
    """

    values: Array
    row: Integers

    def __getitem__(self, rows: Any) -> "FlankDeviations":
        """Those of some rows."""
        return FlankDeviations(self.values, self.row[rows])
