"""Normal backlash of a pair of gears: the nominal one plus the first-order change by each deviation.

The terms of each effect are in terms.py; here they are added up. Neglected terms are in backlash.py, by kind of pair.
Source: Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, 1533-1542, sections 2.1 and 3.1, where alpha_w = alpha
and delta = 45 deg.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.effects import ToothThickness
from tol3d.gearing.model import Contributor, Mesh, Model, Reading
from tol3d.gearing.stack_up.term import Neglect, NominalMesh, Pair, Role, Term
from tol3d.gearing.stack_up.terms import Contribution, contribution, of_both_loads
from tol3d.gearing.stack_up.tooth_pairs import Moved, ToothPairs, distinct, tooth_pairs
from tol3d.numerics.arrays import Array


class Shifts(NamedTuple):
    """Terms of axes and flanks that move."""

    apart: Sequence[Term]
    """Openings by shifts of axes and by parts that grow."""
    aside: Sequence[Term]
    screwed: Sequence[Term]
    """The part of those aside by teeth that move along the axis."""


class Stack(NominalMesh[Pair]):
    """The stack-up of one mesh of a model, for one of its readings."""

    def __init__(self, model: Model, mesh: Mesh, pair: Pair, reading: Reading) -> None:
        super().__init__(model, mesh, pair, reading)
        self.contributions = tuple(
            own for contributor in model.contributors for own in self._contributions(contributor)
        )
        self.terms = tuple(own.opening for own in self.contributions if own.opening)
        self.teeth = tooth_pairs(model, mesh, reading)
        self.sideways = tuple(own.aside for own in self.contributions if own.aside)
        self._widens = tuple(
            (contributor.name, effect.turn)
            for contributor in model.contributors
            for effect in contributor.effect.singles
            if isinstance(effect, ToothThickness) and effect.part == mesh.driver
        )  # half an angle of the driver's teeth [rad/mm]

    def _contributions(self, contributor: Contributor) -> Iterator[Contribution]:
        """Contributions of a contributor's effects; to a free turn between both loads where the reading is of that."""
        singles, others = contributor.effect.singles, contributor.effect.reversed.singles
        for effect, other in zip(singles, others, strict=True):
            own = contribution(effect, self, contributor)
            if self.reading.reversing and other != effect:
                yield from of_both_loads(own, contribution(other, self, contributor), self)
            else:
                yield own

    @cached_property
    def _shifting(self) -> Mapping[int, Shifts]:
        """Shifts of axes, by side of the driver's flanks that carry the load."""
        work = self.mesh.resting_flank(self.reading.flank)
        if not self.reading.reversing:
            return dict.fromkeys((work, -work), _shifts(self.contributions))
        return {
            side: _shifts(
                [
                    contribution(effect, self, contributor)
                    for contributor in model.contributors
                    for effect in contributor.effect.singles
                ]
            )
            for side, model in ((work, self.model), (-work, self.model.reversed))
        }

    @property
    def nominal(self) -> float:
        """j_bn of the nominal pair [mm], exact."""
        return self.pair.normal_backlash

    def normal_backlash(self, deviations: Array, driver_angle: Array, turns: Role | None = None) -> Array:
        """j_bn [mm], (rows,), of deviations (rows, components) at the driver's turns [rad] (rows,).

        If single flanks deviate, the gap of gears at rest and the turn of a gear give different values.
        """
        angles = (driver_angle, self.pair.driven_angle(driver_angle))
        total = np.full(len(deviations), self.nominal)
        for term in (term for term in self.terms if term.tilts is None):
            total = total + term.change(deviations[:, self.model.component_slices[term.contributor.name]], angles)
        if self.teeth:
            return total - self._lost_by_teeth(self.teeth, deviations, driver_angle, total, turns)
        return total - self.lost(*self._lost_by_tilts(deviations), driver_angle)

    @property
    def both_sides_alike(self) -> bool:
        """True if both flank sides are read at the same place of the face; else tilts count on the working one only."""
        return self.reading.contact == self.reading.gap

    def lost(self, in_plane: Array, across: Array, driver_angle: Array | None = None) -> Array:
        """Loss of normal backlash by tilts [mm], (rows,), from their parts in the plane of the axes and across it.

        The driver's turns [rad] (rows,) do not matter here; of helical gears they do.

        Half a face times |a + b| on the side of the driver's right flanks, |a - b| on the other: 2 max(|a|, |b|) of
        both together.
        """
        if self.both_sides_alike:
            return np.maximum(np.abs(in_plane), np.abs(across))
        return np.abs(in_plane + self.mesh.working_flank * across)

    def _lost_by_tilts(self, deviations: Array) -> tuple[Array, Array]:
        """Loss of the flank sides read over the face by tilts in the plane of the axes and across it.

        Signed [mm], (rows,).

        The ends of the face at which the two count are the same on one flank side and opposite on the other.
        """
        in_plane, across = np.zeros(len(deviations)), np.zeros(len(deviations))
        for term in self.terms:
            if term.tilts is not None:
                own = deviations[:, self.model.component_slices[term.contributor.name]]
                for column, (by_plane, by_across) in zip(own.T, zip(*term.tilts, strict=True), strict=True):
                    in_plane = in_plane + by_plane * column
                    across = across + by_across * column
        return in_plane, across

    def _lost_by_teeth(
        self, teeth: ToothPairs, deviations: Array, driver_angle: Array, whole: Array, turns: Role | None
    ) -> Array:
        """Loss of a normal backlash `whole` by single flanks and tilts together [mm], (rows,)."""
        builds, trial = distinct(deviations)
        leans, built = self._leans(builds), teeth.built(builds, trial)
        work = self.mesh.resting_flank(self.reading.flank)
        moved = self._moved(deviations, driver_angle)
        working = teeth.taken(work, built, driver_angle, leans[work], moved[work])
        apart = np.maximum(whole - working, 0.0)
        return working + teeth.taken(-work, built, driver_angle, leans[-work], moved[-work], turns, apart)

    @property
    def turning_teeth(self) -> ToothPairs | None:
        """Pairs that turn the driven gear from position to position, as others come into contact; None if none do."""
        return self.teeth

    def turned_by_teeth(self, side: int, deviations: Array, driver_angle: Array) -> Array:
        """Turn of the driven gear about its z [mm at its arm] by its turning teeth where a side touches.

        Args:
            side: 1 where the driver's right flanks touch, -1 where its left ones do.
            deviations: (trials, components).
            driver_angle: (positions,) [rad].

        Returns:
            (trials, positions).
        """
        count, positions, teeth = len(deviations), len(driver_angle), self.turning_teeth
        if teeth is None:
            return np.zeros((count, positions))
        trial, angles = np.repeat(np.arange(count), positions), np.tile(driver_angle, count)
        built, moved = teeth.built(deviations, trial), self._moved(deviations, angles, trial)
        taken = teeth.taken(side, built, angles, self._leans(deviations)[side], moved[side])
        return np.asarray(self.sense * side * taken.reshape(count, positions))

    def _moved(
        self, deviations: Array, driver_angle: Array, trial: NDArray[np.int64] | None = None
    ) -> Mapping[int, Moved | None]:
        """Axes and flanks that do not stand at their nominal places, by side of the driver's touching flanks.

        None where all do.

        Args:
            deviations: (rows, components), or (trials, components) where `trial` says which of them each row is.
            driver_angle: (rows,) [rad].
            trial: (rows,).
        """
        work = self.mesh.resting_flank(self.reading.flank)
        moved = self._moved_by(self._shifting[work], deviations, driver_angle, trial)
        if not self.reading.reversing:
            return {work: moved, -work: moved}
        return {work: moved, -work: self._moved_by(self._shifting[-work], deviations, driver_angle, trial)}

    def _moved_by(
        self, shifts: Shifts, deviations: Array, driver_angle: Array, trial: NDArray[np.int64] | None
    ) -> Moved | None:
        if not (any(shifts) or self._widens):
            return None
        angles = (driver_angle, self.pair.driven_angle(driver_angle))
        apart, aside = np.zeros(len(driver_angle)), np.zeros(len(driver_angle))
        for total, terms, by in ((apart, shifts.apart, 2 * self.sin), (aside, shifts.aside, self.cos)):
            for term in terms:
                own = deviations[:, self.model.component_slices[term.contributor.name]]
                total += term.change(own if trial is None else own[trial], angles) / by
        wider, higher = np.zeros(len(driver_angle)), np.zeros(len(driver_angle))
        for term in shifts.screwed:
            own = deviations[:, self.model.component_slices[term.contributor.name]]
            turned = term.change(own if trial is None else own[trial], angles)
            aside -= turned / self.cos
            higher += turned / self.screwed("driven")
        for name, factor in self._widens:
            own = deviations[:, self.model.component_slices[name]][:, 0]
            wider += factor * (own if trial is None else own[trial])
        return Moved(apart, aside, wider, higher)

    def _leans(self, deviations: Array) -> Mapping[int, Array]:
        """Loss by tilts at the upper end of the face, by side of the driver's touching flanks [mm], (rows, 1)."""
        in_plane, across = self._lost_by_tilts(deviations)
        half = 2.0 if self.both_sides_alike else 1.0  # tilts count both flank sides, or the one that reads the face
        return {side: -(in_plane + side * across)[:, np.newaxis] / half for side in (1, -1)}

    def aside(self, deviations: Array, driver_angle: Array) -> Array:
        """Shift [mm], (rows,), of the middle of the driven gear's play, along the flanks' normals.

        A driver that shifts along the teeth's path at the mesh turns its mate, a driven gear that does is turned back:
        by cos(alpha_w) of the shift. A gear that leans both in the plane of the axes and across it loses more on one
        flank side, half a face times |a + b|, than on the other, |a - b|. Positive turns the driven gear in the
        positive sense about its z.
        """
        angles = (driver_angle, self.pair.driven_angle(driver_angle))
        in_plane, across = self._lost_by_tilts(deviations)
        if self.teeth:
            builds, trial = distinct(deviations)
            leans, built = self._leans(builds), self.teeth.built(builds, trial)
            moved = self._moved(deviations, driver_angle)
            right, left = (self.teeth.taken(side, built, driver_angle, leans[side], moved[side]) for side in (1, -1))
            total = self.sense * (right - left) / 2
        else:
            total = self._aside_by_tilts(in_plane, across, driver_angle)
        for term in self.sideways:
            total = total + term.change(deviations[:, self.model.component_slices[term.contributor.name]], angles)
        return total

    def _aside_by_tilts(self, in_plane: Array, across: Array, driver_angle: Array) -> Array:
        """Part of `aside` by tilts [mm], (rows,): half of the difference of both sides' losses."""
        if self.both_sides_alike:
            return np.asarray(self.sense * (np.abs(in_plane + across) - np.abs(in_plane - across)) / 4)
        return np.asarray(self.mesh.driven_flank * self.lost(in_plane, across) / 2)

    @property
    def neglects(self) -> tuple[Neglect, ...]:
        """Neglected first-order terms, each with its size; nothing else may differ to first order."""
        return ()


def _shifts(contributions: Sequence[Contribution]) -> Shifts:
    return Shifts(
        [own.opening for own in contributions if own.opening and (own.along_line or own.strains)],
        [own.aside for own in contributions if own.aside],
        [own.screwed for own in contributions if own.screwed],
    )
