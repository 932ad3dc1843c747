"""Builds of one mesh of a simulated scene: where a trial puts its gears, and where their flanks come to rest."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Literal

import numpy as np

from tol3d.errors import InputError
from tol3d.gearing.builds.build import Build, build
from tol3d.gearing.builds.flank_offsets import deviates
from tol3d.gearing.engines import OK, STATUS_TEXT, ReadingEngine
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.model import Model
from tol3d.gearing.model.measure import Reading
from tol3d.gearing.shafts import Mesh
from tol3d.gearing.system import GearSystem
from tol3d.numerics.arrays import Array
from tol3d.study.system.system import System
from tol3d.study.system.trials import Trials
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

POSITIONS_AT_ONCE: Final = 2**15  # of which each takes 100 bytes of readings
READING: Final = Reading()


@dataclass(frozen=True)
class Rests:
    """Rest positions of the driven gear on one side.

    Args:
        driven_angle: its turn about its own z [rad], (positions,).
        failures: reason by index of each position without one.
    """

    driven_angle: Array
    failures: Mapping[int, str]


@dataclass(frozen=True, eq=False)
class MeshBuild:
    """One build of a mesh.

    Args:
        model: of the scene's gears.
        mesh: which of them.
        deviations: of all of them, (1, components) [mm, rad, K].
    """

    model: Model
    mesh: Mesh
    deviations: Array

    @property
    def centre_distance(self) -> float:
        """Distance of the axes in the plane of the teeth [mm]."""
        origins = [self._placed.world_from_shaft[0, seat, :2, 3] for seat in self._seats]
        return float(np.hypot(*(origins[1] - origins[0])))

    @property
    def eccentricities(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Centres of driver and driven gear off their axes, each in its gear's frame [mm]."""
        (x1, y1), (x2, y2) = (self._placed.centre[0, seat] for seat in self._seats)
        return (x1, y1), (x2, y2)

    @property
    def thickening(self) -> float:
        """Sum over both gears by which a tooth is thicker along its normal than the nominal one [mm]."""
        gears = (self.mesh.pair.pinion, self.mesh.pair.wheel)
        return sum(
            2 * gear.section_arm * float(self._placed.flank_turn[0, seat])
            + 2 * float(self._placed.flank_offset[0, seat])
            for gear, seat in zip(gears, self._seats, strict=True)
        )

    def rests(self, driver_angle: Array, side: Literal["drive", "back"]) -> Rests:
        """Rest positions by the exact engine, with all that the scene's tolerances do.

        Args:
            driver_angle: turns of the driver about its z [rad], (positions,).
            side: flanks in contact.
        """
        count = range(0, len(driver_angle), POSITIONS_AT_ONCE)
        pieces = [driver_angle[first : first + POSITIONS_AT_ONCE] for first in count]
        read = [self._engine.rests(self._made, self.mesh, READING, piece)[side == "back"] for piece in pieces]
        status = np.concatenate([own.status.ravel() for own in read]) if read else np.zeros(0, np.int8)
        turned = np.concatenate([own.driven_angle.ravel() for own in read]) if read else np.zeros(0)
        return Rests(turned, {int(k): STATUS_TEXT[int(status[k])] for k in np.flatnonzero(status != OK)})

    @cached_property
    def _placed(self) -> Build:
        return build(self.model, self.deviations)

    @cached_property
    def _made(self) -> Build:
        return self._engine.build(self.deviations)

    @cached_property
    def _engine(self) -> ReadingEngine:
        return exact_engine(self.model)

    @property
    def _seats(self) -> tuple[int, int]:
        return (
            self.model.seat_index[self.mesh.name, self.mesh.driver],
            self.model.seat_index[self.mesh.name, self.mesh.driven],
        )


@dataclass(frozen=True, eq=False)
class MeshBuilds:
    """Builds of a mesh by the trials of its scene, in a housing or not.

    Args:
        simulation: of the scene.
        mesh: of those of `meshes_of`.
    """

    simulation: Simulation
    mesh: Mesh

    def build(self, trial: int | None = None) -> MeshBuild:
        """One build.

        Args:
            trial: of the scene's study, from 0 on; None for every contributor at its mean.

        Raises:
            InputError: its shafts' bores cannot be placed.
        """
        system: Any = self.simulation.system
        made = _mean(system) if trial is None else drawn(self.simulation, trial, 1)
        seen, held = system.seen_by_gears(made)
        for shaft in self._shafts:
            if shaft in held and held[shaft][0] != OK:
                text = system.statuses.by_code[held[shaft][0]]
                raise InputError(f"{self.mesh.name}: the bores of {shaft!r} cannot be placed in this build: {text}")
        return MeshBuild(self._model, self.mesh, np.asarray(seen.deviations))

    @cached_property
    def in_bores(self) -> tuple[str, ...]:
        """Shafts of the mesh that lie in the bores of a housing."""
        system: Any = self.simulation.system
        _, held = system.seen_by_gears(_mean(system))
        return tuple(shaft for shaft in self._shafts if shaft in held)

    @property
    def flanks_deviate(self) -> bool:
        """True if single flanks of its gears deviate."""
        return deviates(self._model, self.mesh)

    @property
    def _model(self) -> Model:
        return _gears_of(self.simulation.system)

    @property
    def _shafts(self) -> tuple[str, ...]:
        carrying = self._model.layout.carrying
        return tuple(carrying[gear][0] for gear in (self.mesh.driver, self.mesh.driven))


def meshes_of(system: System) -> Mapping[str, Mesh]:
    """Meshes of a system of gears by name, in a housing or not.

    Raises:
        InputError: the system is another one.
    """
    return {mesh.name: mesh for mesh in _gears_of(system).meshes}


def _gears_of(system: System) -> Model:
    found = getattr(system, "gears", system)
    if not isinstance(found, GearSystem) or not hasattr(system, "seen_by_gears"):
        raise InputError("expected a scene whose moves are meshes of gears, got one of another system")
    return found.model


def _mean(system: System) -> Trials:
    """One trial, every contributor at its mean; random directions have none."""
    return Trials(
        np.array([[mean for contributor in system.contributors for mean in contributor.draw.mean(turning=False)]]), {}
    )
