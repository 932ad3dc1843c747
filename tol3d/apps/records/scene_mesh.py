"""A mesh of a scene that is on a rig: its builds, by closed form and by the exact engine."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from tol3d.apps.records.from_scene import gears_of, mean_row, mesh_of, specimen_of_build
from tol3d.apps.records.pair import RigPair, Side, Specimen
from tol3d.errors import InputError
from tol3d.gearing.builds.flank_offsets import deviates
from tol3d.gearing.engines import OK, STATUS_TEXT
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.model.measure import Reading
from tol3d.numerics.arrays import Array
from tol3d.study import drawn
from tol3d.system import Trials

if TYPE_CHECKING:
    from tol3d.gearing.builds.build import Build
    from tol3d.gearing.engines import ReadingEngine
    from tol3d.gearing.model import Mesh, Model
    from tol3d.study import Simulation

POSITIONS_AT_ONCE: Final = 2**15  # of which each takes 100 bytes of readings
READING: Final = Reading()


@dataclass(frozen=True, eq=False)
class SimulatedUnit:
    """A build of two gears, by the exact engine; implements Unit.

    All that the scene's tolerances do acts: teeth that deviate one by one, leaning axes, temperatures, the bores of a
    housing. The closed form of pair.py shares no formula with it; where only eccentricities, tooth thickness and the
    distance of the axes act, both agree to 1e-9 rad.

    Args:
        specimen: the same by closed form, as far as that goes.
        mesh: its gears.
        build: one build.
        engine: the exact one.
    """

    specimen: Specimen
    mesh: "Mesh"
    build: "Build"
    engine: "ReadingEngine"

    @property
    def pair(self) -> RigPair:
        """See Unit."""
        return self.specimen.pair

    def driven_angle(self, phi1: Array, side: Side) -> Array:
        """See Unit; encoder 2 stands at 0 where the driven gear is half the constant part j_c beside its nominal place.

        So it counts as the closed form does, where the drive flank of gears without eccentricities rests at
        phi2 = phi1 z1/z2, and the directions of tolerances become phases as from_scene.py has it.

        Raises:
            InputError: the build jams, or its flanks are not found.
        """
        flat = phi1.ravel()
        pieces = [flat[first : first + POSITIONS_AT_ONCE] for first in range(0, len(flat), POSITIONS_AT_ONCE)]
        turned = np.concatenate([self._beside(own, side) for own in pieces]) if pieces else flat
        return (self.pair.rate * flat + turned + self.specimen.constant_part / 2).reshape(phi1.shape)

    def _beside(self, phi1: Array, side: Side) -> Array:
        """Angle of the driven gear ahead of its nominal one, in the sense in which it is driven [rad]."""
        sense = float(self.mesh.working_flank)
        angles = -sense * phi1
        both = self.engine.rests(self.build, self.mesh, READING, angles)
        own = both[0 if side == "drive" else 1]
        if (own.status != OK).any():
            at = int(np.flatnonzero(own.status.ravel() != OK)[0])
            raise InputError(
                f"{self.mesh.name}: this build cannot be turned: {STATUS_TEXT[int(own.status.ravel()[at])]} at phi1 = "
                f"{np.degrees(phi1[at]):.2f} deg; take another --trial, or give the gears more play"
            )
        return np.asarray(sense * (own.driven_angle.ravel() - self.mesh.pair.driven_angle(angles)))


@dataclass(frozen=True, eq=False)
class SceneMesh:
    """Two spur gears of a scene, in a housing or not.

    Args:
        simulation: of the scene.
        model: its gears.
        mesh: which of them.
    """

    simulation: "Simulation"
    model: "Model"
    mesh: "Mesh"

    @classmethod
    def of(cls, simulation: "Simulation", name: str | None) -> "SceneMesh":
        """The mesh of that name, or the only one of two spur gears.

        Raises:
            InputError: there is none, or several and no name.
        """
        model = gears_of(simulation.system)
        return cls(simulation, model, mesh_of(model, name))

    @cached_property
    def in_bores(self) -> tuple[str, ...]:
        """Its shafts that lie in the bores of a housing."""
        holding: Any = self.simulation.system
        _, held = holding.seen_by_gears(Trials(mean_row(self.simulation.system), {}))
        return tuple(shaft for shaft in self._shafts if shaft in held)

    @property
    def teeth_deviate(self) -> bool:
        """True if single flanks of its gears deviate, which the closed form does not know."""
        return deviates(self.model, self.mesh)

    @property
    def _shafts(self) -> tuple[str, ...]:
        carrying = self.model.layout.carrying
        return tuple(carrying[gear][0] for gear in (self.mesh.driver, self.mesh.driven))

    def specimen(self, trial: int | None = None) -> Specimen:
        """A build by closed form: eccentricities, tooth thickness and the distance of the axes.

        Args:
            trial: of the scene's study, from 0 on; None for the build with every contributor at its mean.

        Raises:
            InputError: there is no such trial, or its shafts' bores cannot be placed.
        """
        return specimen_of_build(self.model, self.mesh, self._deviations(trial))

    def unit(self, trial: int | None = None) -> SimulatedUnit:
        """The same build by the exact engine, with all that the scene's tolerances do.

        Raises:
            InputError: see specimen.
        """
        deviations, engine = self._deviations(trial), exact_engine(self.model)
        specimen = specimen_of_build(self.model, self.mesh, deviations)
        return SimulatedUnit(specimen, self.mesh, engine.build(deviations), engine)

    def _deviations(self, trial: int | None) -> Array:
        """Deviations of the gears (1, components) [mm, rad, K]."""
        system, trials = self.simulation.system, self.simulation.study.trials
        if trial is not None and not 0 <= trial < trials:
            raise InputError(f"--trial: expected 0 … {trials - 1}, which the scene's study has, got {trial}")
        made = Trials(mean_row(system), {}) if trial is None else drawn(self.simulation, trial, 1)
        holding: Any = system
        seen, held = holding.seen_by_gears(made)
        for shaft in self._shafts:
            if shaft in held and held[shaft][0] != OK:
                text = system.statuses.by_code[held[shaft][0]]
                raise InputError(f"{self.mesh.name}: the bores of {shaft!r} cannot be placed in this build: {text}")
        return np.asarray(seen.deviations)
