"""The analytic method of a cycloid stage with play: where a torque takes it, all gaps of first order about the nominal.

Bodies are the carrier, discs and cranks, each free in the plane; in the carrier's frame, lengths and turns at the crank
circle's radius R, a disc is displaced by D and turned by tau, a crank displaced by C and turned by beta, the carrier
turned by delta. With rho turns of the cranks a turn of the carrier, psi = phi + phi / Zc and the throw's direction
theta, and with deviations in small letters,

    pin:      gap - n . D - L tau >= 0,
    disc:     |D + i tau h + hole - offset - C - e^(i psi) throw'| <= c / 2,
              throw' = throw + i a e^(i theta) (rho delta + beta + phase),
    carrier:  |C - i delta h - hole - main bearing| <= c / 2,
    planet:   least <= beta - (cos(alpha) d_t -+ sin(alpha) d_r) / r_b <= most, d what the last bearing lets the crank.

The carrier's turn is made largest, see tol3d.numerics.cone_programme: as a problem with round gaps, not by tangents,
and by another method than the kernel's. Of a build that does not fit all parts give alike, by as little as lets it.
Neglected: products of deviations, of play and of turns; pins are met on the normal of their nominal place. Nothing here
sees a pose.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.gearing.cycloid.first_order.linear import LinearStage, Sense
from tol3d.gearing.cycloid.model.stage import Deviated, Play
from tol3d.numerics.arrays import Array, Complex, Places
from tol3d.numerics.cone_programme import ConeProgramme, Solved, solve_cone_programme
from tol3d.numerics.plane import as_complex

LEAST_PLAY: Final = 1e-6  # mm on the radius; of a bearing without, so that logarithms have room
FAR: Final = 1.0  # mm, the gap of a pin that does not work


@dataclass(frozen=True)
class Forces:
    """Turns of rests, and their change as gaps open (rests, ...), by their forces; a sense is in them.

    Args:
        turns: of the carrier (rests,) [rad].
        pins: of each pin's gap at each disc (rests, discs, pins) [rad/mm].
        discs: of a hole against its throw, in the carrier's frame (rests, cranks, discs, 2) [rad/mm].
        carrier: of a crank against the carrier's hole, in that frame (rests, cranks, 2) [rad/mm].
        disc_play, carrier_play: of diametral clearances (rests, cranks, discs) and (rests, cranks) [rad/mm].
        planets: of the least and most turn of each crank (rests, cranks, 2).
        gaps: of working pins there, others far off (rests, rows) [mm].
        gives: deformation of all parts that the build would need to fit (rests,) [mm].
    """

    turns: Array
    pins: Array
    discs: Array
    carrier: Array
    disc_play: Array
    carrier_play: Array
    planets: Array
    gaps: Array
    gives: Array


@dataclass(frozen=True)
class LinearRest(LinearStage):
    """A cycloid stage with play, to first order."""

    def rests(self, deviated: Deviated, phis: Array, play: Play, sense: Sense, aside: Array | None = None) -> Forces:
        """Turn the carrier by a torque, counter-clockwise (1) or back (-1), until contacts hold it.

        Args:
            phis: crank angles (trials,) [rad].
            play: of the trials, its turns of cranks (trials, cranks, 2).
            aside: tilts of discs, see LinearStage.touches.
        """
        sizes = len(phis), self.cranks, self.discs
        pins, held, pin_places = self._pins(deviated, phis, sense, aside)
        cones, off = self._bearings(deviated, phis)
        radial = np.concatenate(
            [np.broadcast_to(play.disc, sizes).reshape(len(phis), -1), np.broadcast_to(play.carrier, sizes[:2])], axis=1
        )
        planets, turns = self._planets(cones[:, -self.cranks :], off[:, -self.cranks :], play)
        given = ConeProgramme(
            np.concatenate([pins, planets], axis=1),
            np.concatenate([held, turns], axis=1),
            np.stack([cones.real, cones.imag], axis=2),
            np.stack([off.real, off.imag], axis=2),
            np.maximum(radial / 2, LEAST_PLAY),
        )
        solved = solve_cone_programme(given, sense)
        return self._forces(solved, pin_places, sense)

    def _pins(self, deviated: Deviated, phis: Array, sense: Sense, aside: Array | None) -> tuple[Array, Array, Places]:
        """Rows and gaps of the pins that work, and their places: disc times pins + pin (trials, rows).

        All trials have as many rows as can work at any crank angle; pins that do not work are far off.
        """
        profile = self.profile
        found = [self.nominal_gaps(deviated, disc, phis, aside) for disc in range(self.discs)]
        gaps, levers = (np.concatenate([own[k] for own in found], axis=1) for k in (0, 1))
        normals = np.concatenate([own[2] for own in found], axis=1) * np.exp(1j * phis / profile.lobes)[:, None]
        works = sense * levers > self.window * profile.pitch_radius
        places = np.argsort(~works, axis=1, kind="stable")[:, : self._most_working(sense)]
        rows, trial = np.zeros((*places.shape, self._unknowns)), np.arange(len(phis))[:, None]
        at, number = 1 + 3 * (places // profile.pins), np.arange(places.shape[1])
        normal, lever = np.take_along_axis(normals, places, axis=1), np.take_along_axis(levers, places, axis=1)
        rows[trial, number, at], rows[trial, number, at + 1] = -normal.real, -normal.imag
        rows[trial, number, at + 2] = -lever / self.crank_circle
        idle = ~np.take_along_axis(works, places, axis=1)
        rows[idle] = 0.0
        return rows, np.where(idle, FAR, np.take_along_axis(gaps, places, axis=1)), places

    def _most_working(self, sense: Sense) -> int:
        """Pins that work at once, of all discs, at most: evenly spread phases lie in an arc as often or once more."""
        levers = [-self.profile.lever(self._parameters(np.array([throw]))) for throw in self.throws]
        counts = (int(np.count_nonzero(sense * own > self.window * self.profile.pitch_radius)) for own in levers)
        return sum(min(count + 1, self.profile.pins) for count in counts)

    def _bearings(self, deviated: Deviated, phis: Array) -> tuple[Complex, Complex]:
        """Displacements in bearings, in the carrier's frame: slopes (trials, bearings, unknowns), and where y = 0."""
        discs = self.discs
        holes, eccentricity = self.crank_directions, self.profile.eccentricity
        ahead = np.exp(1j * phis * (1 + 1 / self.profile.lobes))
        slopes = np.zeros((len(phis), self.cranks * (discs + 1), self._unknowns), dtype=np.complex128)
        off = np.empty(slopes.shape[:2], dtype=np.complex128)
        for crank in range(self.cranks):
            own, hole = 1 + 3 * discs + 3 * crank, 1j * holes[crank]
            for disc in range(discs):
                row, at = crank * discs + disc, 1 + 3 * disc
                swung = 1j * eccentricity * ahead * np.exp(1j * self.throws[disc])
                slopes[:, row, at : at + 3] = 1.0, 1j, hole
                slopes[:, row, own : own + 2] = -1.0, -1j
                slopes[:, row, own + 2] = -swung / self.crank_circle
                slopes[:, row, 0] = -self.rolling * swung / self.crank_circle
                thrown = ahead * as_complex(deviated.crank_errors[:, crank, disc])
                bored = as_complex(deviated.disc_holes[:, disc, crank]) - as_complex(deviated.disc_offsets[:, disc])
                off[:, row] = bored - thrown - swung * deviated.crank_phases[:, crank]
            row = self.cranks * discs + crank
            slopes[:, row, own : own + 2] = 1.0, 1j
            slopes[:, row, 0] = -hole
            off[:, row] = -as_complex(deviated.carrier_holes[:, crank]) - as_complex(deviated.carrier_offsets)
        return slopes, off

    def _planets(self, slopes: Complex, off: Complex, play: Play) -> tuple[Array, Array]:
        """Rows and gaps of planets' flanks, those that hold cranks back first; given displacements in the carrier."""
        radius = self.crank_circle
        around, outwards = play.leaving
        turned = slopes * np.conj(self.crank_directions)[:, None]
        lies = off * np.conj(self.crank_directions)
        cranks = np.zeros(turned.shape)
        for crank in range(self.cranks):
            cranks[:, crank, 3 * (self.discs + 1 + crank)] = 1.0
        free = radius * np.broadcast_to(play.crank, (len(off), self.cranks, 2))
        back = cranks - radius * (around * turned.imag - outwards * turned.real)
        ahead = -cranks + radius * (around * turned.imag + outwards * turned.real)
        gaps = np.concatenate(
            [
                -free[..., 0] - radius * (around * lies.imag - outwards * lies.real),
                free[..., 1] + radius * (around * lies.imag + outwards * lies.real),
            ],
            axis=1,
        )
        return np.concatenate([back, ahead], axis=1), gaps

    def _forces(self, solved: Solved, places: Places, sense: Sense) -> Forces:
        trials = len(places)
        cranks, discs, pins = self.cranks, self.discs, self.profile.pins
        straight, turned = sense * solved.straight / self.crank_circle, sense * solved.round / self.crank_circle
        on_pins = np.zeros((trials, discs * pins))
        np.put_along_axis(on_pins, places, straight[:, : places.shape[1]], axis=1)
        of_bearings = np.sqrt((turned * turned).sum(axis=-1))
        split = cranks * discs
        return Forces(
            turns=solved.y[:, 0] / self.crank_circle,
            pins=on_pins.reshape(trials, discs, pins),
            discs=-turned[:, :split].reshape(trials, cranks, discs, 2),
            carrier=-turned[:, split:],
            disc_play=sense * of_bearings[:, :split].reshape(trials, cranks, discs) / 2,
            carrier_play=sense * of_bearings[:, split:] / 2,
            planets=np.stack(np.split(straight[:, places.shape[1] :], 2, axis=1), axis=-1)
            * self.crank_circle
            * np.array([-1.0, 1.0]),
            gaps=solved.gaps[:, : places.shape[1]],
            gives=solved.y[:, -1],
        )

    @property
    def _unknowns(self) -> int:
        """The carrier's turn, places and turns of discs and cranks, and the deformation of all parts."""
        return 2 + 3 * (self.discs + self.cranks)
