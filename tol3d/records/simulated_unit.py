"""One unit of a scene on a rig, by the exact engine: where its driven gear rests at every angle of the driver.

All that the scene's tolerances do acts: teeth that deviate one by one, leaning axes, temperatures, the bores of a
housing. The closed form of exact_play.py shares no formula with it; where only eccentricities, tooth thickness and the
distance of the axes act, both agree to 1e-9 rad.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from tol3d.errors import InputError
from tol3d.gearing.engines import OK, STATUS_TEXT
from tol3d.gearing.model.measure import Reading
from tol3d.numerics.arrays import Array
from tol3d.records.exact_play import Side
from tol3d.records.pair import RigPair, Specimen

if TYPE_CHECKING:
    from tol3d.gearing.builds.build import Build
    from tol3d.gearing.engines import ReadingEngine
    from tol3d.gearing.model import Mesh


POSITIONS_AT_ONCE: Final = 2**15  # of which each takes 100 bytes of readings
READING: Final = Reading()


@dataclass(frozen=True, eq=False)
class SimulatedUnit:
    """A build of two gears; implements Unit.

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
        """By how much the driven gear is ahead of its nominal angle, in the sense in which it is driven [rad]."""
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
