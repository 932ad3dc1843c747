"""The mesh move: the driven gear turns until the working flanks touch."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.builds.build import Build
from tol3d.gearing.builds.flank_offsets import deviates
from tol3d.gearing.engines import INTERFERES, NO_CONTACT, OK, OUT_OF_RANGE, Engine, Gaps
from tol3d.gearing.model import Mesh, Model, Reading
from tol3d.gearing.model.flank_margin import margin_of
from tol3d.gears import Displaced, Flank, driver_teeth_at_one_tooth
from tol3d.gears.flank import opposite
from tol3d.gears.pair import candidate_teeth
from tol3d.numerics.arrays import Array

Status = NDArray[np.int8]

LAST_ERROR = 0.8e-6  # modules; error of the last step where contact jumps along a face of varying arm
TURN_STEPS = 40  # steps; Newton takes two or three, backing out of an overlap one for each engine depth
TIE = 0.8e-3  # modules; a pair that has this much further to go than the first one is not asked again,
TIE_SHARE = 0.02  # of the step itself, for the gaps' curvature: (0.4 mm)^2/(2 x 20 mm) is 1 % of 0.4 mm
ROOT_FINDING_NOISE = 1e-6  # mm; a free play above minus this is called free


@dataclass(frozen=True)
class MeshSeat:
    """Rest positions of a mesh: one row per trial and position.

    Args:
        driver_angle, driven_angle: turns [rad], (rows,).
        working: gaps of the working flanks at rest; the touching pair's is 0.
        non_working: gaps of the other flanks of the driver's teeth in their spaces.
        status: (rows,), OK, INTERFERES (the non-working flanks overlap), NO_CONTACT, or OUT_OF_RANGE (of one tooth, a
            flank is out of action).
    """

    driver_angle: Array
    driven_angle: Array
    working: Gaps
    non_working: Gaps
    status: Status

    @property
    def contact(self) -> tuple[Array, NDArray[np.int64]]:
        """Point on the driver [mm] (rows, 3), world, and the driver's tooth (rows,) that touches first."""
        gaps = np.where(np.isnan(self.working.value), np.inf, self.working.value)
        first = np.argmin(gaps, axis=1)
        rows = np.arange(len(first))
        return self.working.driver_point[rows, first], self.working.driver_teeth[rows, first]


@dataclass(frozen=True)
class Meshing:
    """The builds of a mesh, with an engine for gaps: the data that stay while gears turn.

    Args:
        engine: measures gaps.
        model, mesh, build: the builds; one row per position.
        reading: place on the face, and teeth, at which flanks are evaluated.
        reversed_build: builds in which the load is on the other flanks, if shafts lie elsewhere then.
    """

    engine: Engine
    model: Model
    mesh: Mesh
    build: Build
    reading: Reading
    reversed_build: Build | None = None

    @property
    def flank(self) -> Flank:
        """The driver's flank that touches."""
        return self.mesh.resting_flank(self.reading.flank)

    def seat(self, driver_angle: Array) -> MeshSeat:
        """Hold the driver at its angles [rad] (rows,), turn the driven gear into contact on the reading's flank."""
        flank = self.flank
        start = self.mesh.pair.touching_angle(driver_angle, flank, self._displaced(driver_angle))
        angles, working, touched = self.turn_to_contact(flank, (driver_angle, start), turn_driver=False)
        non_working = self.gaps_of(opposite(flank), angles, self.reading.gap == "section", touched)
        play = non_working.smallest()
        deep = non_working.deep.any(axis=1)
        overlap = deep | (play < -ROOT_FINDING_NOISE)
        nowhere = ~touched | (np.isnan(play) & ~deep)
        idle = self._idle(working) | self._idle(non_working)
        status = np.select([idle, nowhere, overlap], [OUT_OF_RANGE, NO_CONTACT, INTERFERES], OK).astype(np.int8)
        return MeshSeat(driver_angle, angles[1], working, non_working, status)

    def _idle(self, gaps: Gaps) -> NDArray[np.bool_]:
        """Rows (rows,) in which the one tooth that is looked at has left the path of contact."""
        if self.reading.teeth == "all":
            return np.zeros(len(gaps.value), dtype=bool)
        return np.asarray(gaps.at_end[:, 0])

    def rows(self, rows: NDArray[np.intp]) -> "Meshing":
        """The same for some builds."""
        other = None if self.reversed_build is None else self.reversed_build.rows(rows)
        return replace(self, build=self.build.rows(rows), reversed_build=other)

    @property
    def reversed(self) -> "Meshing | None":
        """The same while the other flanks carry the load; None if no shaft lies elsewhere then."""
        if self.reversed_build is None:
            return None
        return replace(self, build=self.reversed_build, reversed_build=None)

    def gaps_of(self, flank: Flank, angles: tuple[Array, Array], section: bool, wanted: NDArray[np.bool_]) -> Gaps:
        """Gaps of one flank side of the driver, for the builds (rows,) that are wanted."""
        teeth, near = self._teeth(angles[0], flank)
        return self.engine.gaps(self.build, self.mesh, flank, angles, teeth, near & wanted[:, None], section=section)

    def _teeth(self, driver_angle: Array, flank: Flank) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        pitch = self.mesh.pair.pinion.angular_pitch
        if self.reading.teeth == "all" and deviates(self.model, self.mesh):
            lowest, highest = self.mesh.pair.touching_azimuths
            beyond = margin_of(self.model, self.mesh) * pitch
            return candidate_teeth((lowest - beyond, highest + beyond), pitch, driver_angle, flank)
        if self.reading.teeth == "all":
            return self.mesh.pair.candidate_teeth(driver_angle, flank)
        teeth = driver_teeth_at_one_tooth(driver_angle, pitch, flank, self.reading.teeth)
        return teeth, np.ones(teeth.shape, dtype=bool)

    def _displaced(self, driver_angle: Array) -> Displaced:
        seats = [self.model.seat_index[self.mesh.name, name] for name in (self.mesh.driver, self.mesh.driven)]
        angles = (driver_angle, self.mesh.pair.driven_angle(driver_angle))
        sections = np.array([gear.section_arm for gear in (self.mesh.pair.pinion, self.mesh.pair.wheel)])
        return Displaced(
            origin=np.stack([self.build.centre_of(s, a) for s, a in zip(seats, angles, strict=True)], axis=1),
            turn=self.build.axis_turn[:, seats],
            flank_turn=self.build.flank_turn[:, seats] + self.build.flank_offset[:, seats] / sections,
        )

    def turn_to_contact(
        self, flank: Flank, angles: tuple[Array, Array], *, turn_driver: bool, known: Gaps | None = None
    ) -> tuple[tuple[Array, Array], Gaps, NDArray[np.bool_]]:
        """Turn one gear until a flank side touches at its first pair.

        Newton on the smallest gap: each pair's gap and its derivative by the turn come from the engine, so
        the step is the one after which the first pair touches. From an overlap too deep to measure, back out
        by the engine's depth.

        Args:
            flank: the driver's flank that shall touch.
            angles: where to start, driver and driven [rad], each (rows,).
            turn_driver: the driver turns and the driven is held, or the other way round.
            known: the gaps at the start where they have been measured already.

        Returns:
            angles of both gears at contact, the gaps there, and which rows reached contact, in action.
        """
        pair = self.mesh.pair
        mover_name = self.mesh.driver if turn_driver else self.mesh.driven
        seat = self.model.seat_index[self.mesh.name, mover_name]
        base_radius = self.mesh.gear(mover_name).base_radius
        depth, last_step = self.engine.depth(self.mesh), self.engine.last_step(self.mesh)
        if pair.arm_spread:
            last_step = min(last_step, LAST_ERROR * pair.pinion.module / pair.arm_spread)
        axis_point, axis = self.build.axis(seat)
        opening = float(flank if turn_driver else pair.mating_flank(flank))
        section = self.reading.contact == "section"
        teeth, wanted = self._teeth(angles[0], flank)
        turned = [angles[0].copy(), angles[1].copy()]
        mover = turned[0 if turn_driver else 1]
        at_rest = _AtRest(teeth)
        touched = np.zeros(len(mover), dtype=bool)
        rows = np.arange(len(mover))
        for _ in range(TURN_STEPS):
            at = (turned[0][rows], turned[1][rows])
            gaps = known or self.engine.gaps(
                self.build.rows(rows), self.mesh, flank, at, teeth[rows], wanted[rows], section=section
            )
            known = None
            rate = np.abs(gaps.per_turn(axis_point[rows], axis[rows], of_driver=turn_driver))
            reach = np.where(np.isnan(gaps.value), np.inf, gaps.value / rate)
            deep = np.asarray(gaps.deep.any(axis=1))
            least = reach.min(axis=1)
            lost = ~deep & np.isinf(least)  # no faces overlap
            step = np.where(deep, -depth / base_radius, np.where(lost, 0.0, least))
            mover[rows] -= opening * step
            resting = ~deep & ~lost & (np.abs(step) * base_radius < last_step)
            at_rest.keep(rows[resting], gaps, resting, rate * step[:, None])
            tie = TIE * pair.pinion.module / base_radius + (TIE_SHARE + pair.arm_spread) * np.abs(step)
            tied = reach <= (step + tie)[:, None]
            wanted[rows] &= deep[:, None] | tied
            touched[rows[resting]] = True
            rows = rows[~(resting | lost)]
            if not len(rows):
                break
        ends = at_rest.gaps()
        return (turned[0], turned[1]), ends, touched & ~self._idle(ends)


class _AtRest:
    """Collects the gaps of each row in the round in which it comes to rest."""

    def __init__(self, teeth: NDArray[np.int64]) -> None:
        self._teeth = teeth
        self._value = np.full(teeth.shape, np.nan)
        self._deep = np.zeros(teeth.shape, dtype=bool)
        self._at_end = np.zeros(teeth.shape, dtype=bool)
        self._vectors = np.full((3, *teeth.shape, 3), np.nan)

    def keep(self, rows: NDArray[np.intp], gaps: Gaps, chosen: NDArray[np.bool_], closed: Array) -> None:
        """Keep the chosen rows; `closed` [mm] is the reduction of each gap by the last step."""
        self._value[rows] = (gaps.value - closed)[chosen]
        self._at_end[rows] = gaps.at_end[chosen]
        for kept, vectors in zip(self._vectors, (gaps.driver_point, gaps.driven_point, gaps.normal), strict=True):
            kept[rows] = vectors[chosen]

    def gaps(self) -> Gaps:
        """The gaps at rest; nan for pairs that could not touch first and for rows that found no rest."""
        driver_point, driven_point, normal = self._vectors
        return Gaps(self._value, self._deep, self._at_end, driver_point, driven_point, normal, self._teeth)
