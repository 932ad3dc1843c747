"""Cycloid stages at rest under a torque, with play in the bearings of their cranks."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.cycloid.exact.contact import NONE_COUNTED, ContactStage, contact_shape
from tol3d.gearing.cycloid.exact.rest_kernel import rests, work_arrays
from tol3d.gearing.cycloid.model.stage import Deviated, Play
from tol3d.numerics.arrays import Array, Places


@dataclass(frozen=True)
class Resting:
    """Rest positions of stages.

    Attributes:
        turns: of the carrier beyond -phi / Zc (trials, positions) [rad]; NaN where it does not rest.
        loads: force on each pin per torque on the carrier (trials, positions, discs pins) [1/mm]; 0 where it carries
            nothing. As many carry as bearings without stiffness can share loads among, no more.
        near: working pins that have a gap of at most the stated deflection then (trials, positions).
        status: 0 where it rests; else see tol3d.numerics.programme, and NOT_HELD.
    """

    turns: Array
    loads: Array
    near: Places
    status: NDArray[np.int8]


@dataclass(frozen=True)
class RestStage(ContactStage):
    """A cycloid stage with discs and cranks as bodies that move and turn in the plane, all of them rigid.

    Pins stop discs by the flanks that the torque presses, as in `ContactStage`; those of the other flanks, which a
    tight build has in the discs, stop nothing. Without play this is first contact, as long as the errors of holes and
    throws let all cranks fit; where they do not, no place is found for the discs, as no bearing gives.
    """

    def rests(
        self,
        deviated: Deviated,
        phis: Array,
        play: Play,
        sense: float,
        deflection: float | None = None,
        leans: Array | None = None,
    ) -> Resting:
        """Turn the carrier by a torque, counter-clockwise (+1) or back (-1), until contacts hold it.

        Args:
            phis: crank angles (trials, positions), or (1, positions) that are those of every trial [rad].
            deflection, leans: see ContactStage.touches.
        """
        trials, positions = len(deviated.pins), phis.shape[1]
        made, joined = self.as_made(deviated), self.joined(deviated)
        radial = np.empty((trials, self.cranks * (self.discs + 1)))
        discs = np.broadcast_to(play.disc, (trials, self.cranks, self.discs))
        radial[:, : self.cranks * self.discs] = discs.reshape(trials, -1) / 2
        radial[:, self.cranks * self.discs :] = np.broadcast_to(play.carrier, (trials, self.cranks)) / 2
        found = Resting(
            np.empty((trials, positions)),
            np.empty((trials, positions, self.discs * self.profile.pins)),
            np.empty((trials, positions), dtype=np.int64),
            np.empty((trials, positions), dtype=np.int8),
        )
        phis = np.broadcast_to(phis, (trials, positions))
        free = np.broadcast_to(play.crank, (trials, positions, self.cranks, 2))
        leans = np.zeros((trials, self.discs, 3)) if leans is None else leans
        bodies = made.linkage, joined.holes, joined.thrown, joined.bored
        given = (
            *(*bodies, made.pins, made.pin_radii, made.lobe_pitch, made.lobe_profile),
            *(leans, radial, free, np.array(play.leaving), phis),
        )
        like = as_before(phis[..., None], free) & as_before(*(own[:, None] for own in (*bodies, leans, radial)))
        rests(
            contact_shape(self.profile, self.window, self.rolling, NONE_COUNTED if deflection is None else deflection),
            self.throws,
            *(np.require(each, dtype=np.float64, requirements=["C", "W"]) for each in given),
            like,
            sense,
            found.turns,
            found.loads,
            found.near,
            found.status,
            *work_arrays(self.discs, self.cranks, self.profile.pins),
        )
        return found


def as_before(*given: Array) -> NDArray[np.bool_]:
    """True where trials (trials, positions, ...) have the numbers of the one before them (trials, positions)."""
    same = [(own[1:] == own[:-1]).all(axis=tuple(range(2, own.ndim))) for own in given]
    found = np.zeros(given[0].shape[:2], dtype=np.bool_)
    found[1:] = np.logical_and.reduce(same)
    return found
