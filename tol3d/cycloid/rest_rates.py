"""What the turn of a rest changes by per deviation, by the forces that hold it: the rates of the analytic road."""

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.deviated import Deviated
from tol3d.cycloid.first_stage import add_rates
from tol3d.cycloid.linear_rest import Forces
from tol3d.cycloid.rv_deviated import RVDeviated
from tol3d.cycloid.rv_set import RVSet
from tol3d.gears import LEFT, RIGHT

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def rest_rates(own: RVSet, deviated: RVDeviated, turns: Array, phis: Array, forces: Forces) -> RVDeviated:
    """Rates of trials, in the form of their deviations [rad/mm or rad/rad].

    A tilt closes gaps whatever its sign: its rates are those on its side.

    Args:
        own: the reducer.
        deviated: of the trials.
        turns: of the output (trials,).
        phis: crank angles (trials,) [rad].
        forces: of the trials.
    """
    found = RVDeviated.nothing(own, len(turns))
    _of_planets(own, found, turns, forces)
    _of_pins(own, found, deviated.disc_tilts, phis, forces)
    _of_bearings(own, found.stage, phis, forces)
    found.disc_play[...] = np.swapaxes(forces.disc_play, 1, 2)
    found.carrier_play[...] = forces.carrier_play
    return found


def _of_planets(own: RVSet, found: RVDeviated, turns: Array, forces: Forces) -> None:
    """Of teeth; where planets lie is that of the cranks, whose bearings hold them."""
    for crank in range(own.cranks):
        planets = np.full(len(turns), crank)
        for side, flank in enumerate((RIGHT, LEFT)):
            add_rates(own, found, turns, planets, flank, forces.planets[:, crank, side])
    found.stage.carrier_holes[...] = 0.0
    found.stage.carrier_offsets[...] = 0.0


def _of_pins(own: RVSet, found: RVDeviated, tilts: Array, phis: Array, forces: Forces) -> None:
    profile, stage, rows = own.profile, own.linear, np.arange(len(phis))[:, None]
    nothing, azimuths = Deviated.nothing(1, profile.pins, own.discs, own.cranks), 2 * np.pi * np.arange(profile.pins)
    azimuths = azimuths / profile.pins
    for disc in range(own.discs):
        force = forces.pins[:, disc]
        _, lever, normal = stage.nominal_gaps(nothing, disc, phis, None)
        lobes = stage.lobes_at(disc, phis)
        found.stage.pins[...] += _plane(force * normal * np.exp(-1j * azimuths))
        found.stage.pin_radii[...] -= force
        np.add.at(found.stage.lobe_profile[:, disc], (rows, lobes), -force)
        pitch = lever * profile.shortening / profile.pitch_radius
        np.add.at(found.stage.lobe_pitch[:, disc], (rows, lobes), -force * pitch)
        if own.width is not None:
            across = -1j * normal * np.exp(1j * phis / profile.lobes)[:, None]
            side = np.sign((np.conj(across) * _complex(tilts[:, disc])[:, None]).real)
            found.disc_tilts[:, disc] = _plane(-own.width / 2 * (force * side * across).sum(axis=1))


def _of_bearings(own: RVSet, found: Deviated, phis: Array, forces: Forces) -> None:
    ahead = np.exp(1j * phis * (1 + 1 / own.profile.lobes))
    discs, carrier = _complex(forces.discs), -_complex(forces.carrier)
    swung = 1j * own.profile.eccentricity * np.exp(1j * own.linear.throws)
    thrown = -discs * np.conj(ahead)[:, None, None]
    found.disc_holes[...] = np.swapaxes(forces.discs, 1, 2)
    found.disc_offsets[...] = -_plane(discs.sum(axis=1))
    found.crank_errors[...] = _plane(thrown)
    if own.first is None:  # else those of planets
        found.crank_phases[...] = (np.conj(thrown) * swung).real.sum(axis=2)
    found.carrier_holes[...] = _plane(carrier)
    found.carrier_offsets[...] = _plane(carrier.sum(axis=1))


def _complex(points: Array) -> Complex:
    return np.asarray(points[..., 0] + 1j * points[..., 1])


def _plane(values: Complex) -> Array:
    return np.stack([values.real, values.imag], axis=-1)
