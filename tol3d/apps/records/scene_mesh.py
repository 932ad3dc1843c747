"""A mesh of a scene that is on a rig: its builds, by closed form and by the exact engine."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tol3d.apps.records.from_scene import mesh_of, specimen_of
from tol3d.apps.records.pair import RigPair, Side, Specimen
from tol3d.errors import InputError
from tol3d.gearing import Mesh, MeshBuild, MeshBuilds, meshes_of
from tol3d.numerics.arrays import Array

if TYPE_CHECKING:
    from tol3d.study import Simulation


@dataclass(frozen=True, eq=False)
class SimulatedUnit:
    """A build of two gears, by the exact engine; implements Unit.

    All that the scene's tolerances do acts: teeth that deviate one by one, leaning axes, temperatures, the bores of a
    housing. The closed form of pair.py shares no formula with it; where only eccentricities, tooth thickness and the
    distance of the axes act, both agree to 1e-9 rad.

    Args:
        specimen: the same by closed form, as far as that goes.
        build: its gears.
    """

    specimen: Specimen
    build: MeshBuild

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
        return (self.pair.rate * flat + self._beside(flat, side) + self.specimen.constant_part / 2).reshape(phi1.shape)

    def _beside(self, phi1: Array, side: Side) -> Array:
        """Angle of the driven gear ahead of its nominal one, in the sense in which it is driven [rad]."""
        mesh = self.build.mesh
        sense = float(mesh.working_flank)
        angles = -sense * phi1
        own = self.build.rests(angles, side)
        if own.failures:
            at, why = next(iter(own.failures.items()))
            raise InputError(
                f"{mesh.name}: this build cannot be turned: {why} at phi1 = {np.degrees(phi1[at]):.2f} deg; take "
                "another --trial, or give the gears more play"
            )
        return np.asarray(sense * (own.driven_angle - mesh.pair.driven_angle(angles)))


@dataclass(frozen=True, eq=False)
class SceneMesh:
    """Two spur gears of a scene, in a housing or not.

    Args:
        builds: of the scene's trials.
    """

    builds: MeshBuilds

    @classmethod
    def of(cls, simulation: "Simulation", name: str | None) -> "SceneMesh":
        """The mesh of that name, or the only one of two spur gears.

        Raises:
            InputError: there is none, or several and no name.
        """
        return cls(MeshBuilds(simulation, mesh_of(meshes_of(simulation.system), simulation.system.name, name)))

    @property
    def scene(self) -> str:
        """Name of the scene."""
        return self.builds.simulation.system.name

    @property
    def mesh(self) -> Mesh:
        """The gears."""
        return self.builds.mesh

    def specimen(self, trial: int | None = None) -> Specimen:
        """A build by closed form: eccentricities, tooth thickness and the distance of the axes.

        Args:
            trial: of the scene's study, from 0 on; None for the build with every contributor at its mean.

        Raises:
            InputError: there is no such trial, or its shafts' bores cannot be placed.
        """
        return specimen_of(self._build(trial))

    def unit(self, trial: int | None = None) -> SimulatedUnit:
        """The same build by the exact engine, with all that the scene's tolerances do.

        Raises:
            InputError: see specimen.
        """
        build = self._build(trial)
        return SimulatedUnit(specimen_of(build), build)

    def _build(self, trial: int | None) -> MeshBuild:
        trials = self.builds.simulation.study.trials
        if trial is not None and not 0 <= trial < trials:
            raise InputError(f"--trial: expected 0 … {trials - 1}, which the scene's study has, got {trial}")
        return self.builds.build(trial)
