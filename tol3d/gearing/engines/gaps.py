"""Interface of an engine: signed gaps of candidate tooth pairs, with contact points and normals."""

import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids import FlankStrips
from tol3d.gearing.builds.build import Build
from tol3d.gearing.engines.status import INTERFERES, STATUS_TEXT
from tol3d.gearing.model import Mesh, Model, Reading
from tol3d.gears import Flank
from tol3d.numerics.arrays import Array
from tol3d.study.system.outcome import Statuses

Teeth = NDArray[np.int64]


@dataclass(frozen=True)
class Gaps:
    """Gaps between one flank side of two gears, for each trial and candidate tooth pair.

    Args:
        value: (trials, pairs) [mm], shortest distance, negative where the flanks overlap;
            NaN where the pair was not asked for or overlaps deeper than the engine can measure.
        deep: (trials, pairs), True in that last case.
        at_end: (trials, pairs), whether either flank ends at its nearest point: at its tip edge, or where it begins.
        driver_point, driven_point: (trials, pairs, 3) [mm], the nearest points on the flanks, world.
        normal: (trials, pairs, 3), unit vector from the driver's flank to the driven's.
        driver_teeth: (trials, pairs), which tooth of the driver each pair is.
    """

    value: Array
    deep: NDArray[np.bool_]
    at_end: NDArray[np.bool_]
    driver_point: Array
    driven_point: Array
    normal: Array
    driver_teeth: Teeth

    def rows(self, rows: NDArray[np.intp]) -> "Gaps":
        """The gaps of some trials."""
        return Gaps(
            value=self.value[rows],
            deep=self.deep[rows],
            at_end=self.at_end[rows],
            driver_point=self.driver_point[rows],
            driven_point=self.driven_point[rows],
            normal=self.normal[rows],
            driver_teeth=self.driver_teeth[rows],
        )

    def per_turn(self, axis_point: Array, axis: Array, *, of_driver: bool) -> Array:
        """Derivative of the gaps by the turn of one gear [mm/rad], (trials, pairs).

        Args:
            axis_point, axis: the gear's rotation axis, each (trials, 3).
            of_driver: the driver turns (its flank is behind the normal), else the driven.
        """
        point = self.driver_point if of_driver else self.driven_point
        moved = np.cross(axis[:, None], point - axis_point[:, None])
        rate = np.asarray((moved * self.normal).sum(axis=-1))
        return -rate if of_driver else rate

    def smallest(self) -> Array:
        """Smallest gap of each trial [mm], (trials,); NaN where any pair is too deep to measure."""
        least = np.min(np.where(np.isnan(self.value), np.inf, self.value), axis=1)
        return np.where(self.deep.any(axis=1) | np.isinf(least), np.nan, least)


class Engine(Protocol):
    """Anything that measures gaps."""

    def depth(self, mesh: Mesh) -> float:
        """Deepest overlap of a mesh's flanks that the engine can measure [mm]."""

    def last_step(self, mesh: Mesh) -> float:
        """A turn that moves flanks by no more [mm] may be the last: gaps are linear over it, as known."""

    @property
    def chord_error(self) -> float:
        """Largest distance [mm] between its flanks and the mathematical ones."""

    def gaps(
        self,
        build: Build,
        mesh: Mesh,
        flank: Flank,
        angles: tuple[Array, Array],
        driver_teeth: Teeth,
        wanted: NDArray[np.bool_],
        *,
        section: bool = False,
    ) -> Gaps:
        """Gaps of one flank side.

        Args:
            build: virtual builds, one per row.
            mesh: which gears.
            flank: the driver's flank; the driven's mating one follows from the pair.
            angles: turn of driver and driven [rad], each (trials,).
            driver_teeth: (trials, pairs) candidate teeth of the driver.
            wanted: (trials, pairs); the others stay nan.
            section: of the driver's flank take the section in the middle of the common face, not the whole.
        """


@dataclass(frozen=True)
class MeshReading:
    """A mesh brought to contact and read, one row a build and position; of rests all rows are (trials, positions).

    Args:
        driver_angle, driven_angle: turns of the gears at rest [rad], (rows,).
        gap: smallest gap of the non-working flanks [mm], (rows,).
        driven_turn, driver_turn: free turn of one gear, the other held at rest [rad], (rows,); below 0 where the
            non-working flanks overlap; NaN where not wanted.
        contact: point on the driver [mm], (rows, 3), world.
        tooth: the driver's tooth that touches, (rows,).
        status: (rows,), as the mesh move has it.
    """

    driver_angle: Array
    driven_angle: Array
    gap: Array
    driven_turn: Array
    driver_turn: Array
    contact: Array
    tooth: Teeth
    status: NDArray[np.int8]


@runtime_checkable
class ReadingEngine(Engine, Protocol):
    """An engine that builds, seats and reads meshes itself, faster than by its gaps and to the same result."""

    def build(self, deviations: Array) -> Build:
        """Builds of the trials with these deviations (trials, components), as build.build makes them."""

    def reversed_build(self, deviations: Array) -> Build:
        """Builds of the reversed model: shafts lie where the load on the other flanks pushes them."""

    def read(
        self, build: Build, mesh: Mesh, reading: Reading, driver_angle: Array, turning: frozenset[str] = frozenset()
    ) -> MeshReading:
        """Hold the driver, turn the driven gear onto the working flank, read the others.

        Args:
            build: virtual builds, one per row.
            mesh, reading: which gears, and where on them.
            driver_angle: (rows,) [rad].
            turning: names of the gears whose free turn is wanted.
        """

    def rests(self, build: Build, mesh: Mesh, reading: Reading, driver_angle: Array) -> tuple[MeshReading, MeshReading]:
        """Rest positions of the driven gear on the drive and on the back side, one contact each; gap and turns are nan.

        Args:
            build: virtual builds, one per trial.
            mesh, reading: the gears, and places on them; the reading's flank does not matter.
            driver_angle: (positions,) [rad], the same of every trial; contacts are those of the first.
        """


EXACT = "tol3d.gearing.engines.exact"
FCL = "tol3d.gearing.engines.fcl"


def exact_engine(model: Model) -> ReadingEngine:
    """The exact engine of a model."""
    engine: ReadingEngine = importlib.import_module(EXACT).ExactEngine(model)
    return engine


def exact_is_compiled(model: Model) -> bool:
    """True if the exact engine's kernels for a model are already compiled on this machine."""
    return bool(importlib.import_module(EXACT).ExactEngine(model).kept)


def fcl_engine(model: Model, strips: Mapping[str, FlankStrips]) -> Engine:
    """FCL on the measuring strips of every gear, by its name."""
    engine: Engine = importlib.import_module(FCL).FclEngine(model, strips)
    return engine


STATUSES: Final = Statuses(
    texts=tuple(STATUS_TEXT[code] for code in range(len(STATUS_TEXT))),
    lacking=frozenset((STATUS_TEXT[INTERFERES],)),
    words={"interferes": "jam", "no contact": "find no contact", "out of range": "are out of range"},
    states={"interferes": "jammed", "no contact": "without contact"},
)
