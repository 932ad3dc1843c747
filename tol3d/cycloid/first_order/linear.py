"""The analytic method of a cycloid stage: turns of its carrier to first order, by levers and gaps at nominal pins.

With crank phi, disc d has its centre at a e^(i phi_d), phi_d = phi + 2 pi d / discs, and has turned with the carrier
by chi = -phi / Zc. A pin at azimuth alpha stands at phase s = alpha - phi_d; its normal, out of the disc, comes from
the pitch point a Zp e^(i phi_d): n = e^(i alpha) (1 - K e^(-is)) / w, w = sqrt(1 + K^2 - 2 K cos s). The disc closes
its gap by the lever L = rc' sin s / w per radian. To first order the gap there is

    c + n . (pin - disc) - pin radius - profile - L (turn + K pitch / rc'),

c the clearance of the modification, "pin" and "disc" displacements. Three cranks without play that give way alike place
the disc: it is displaced by the means of carrier holes, throws and disc holes and turned by their mean moments over the
crank circle. While the carrier turns by delta the cranks turn by rho delta, which moves the disc against every pin as
far as a turn by rho delta / Zc more. So each pin of lever L allows the turn gap / (L (1 + rho / Zc)), forwards where
L > 0; the smallest of all working pins of all discs is the carrier's. Neglected: every product of two deviations, the
modification among them: pins touch where they would nominally, on the normal of that place. Nothing here sees a pose.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from tol3d.cycloid.model.stage import CycloidStage, Deviated, Touching
from tol3d.numerics.arrays import Array, Complex, Places
from tol3d.numerics.plane import as_complex, as_points, evenly

Sense = Literal[1, -1]


@dataclass(frozen=True)
class LinearStage(CycloidStage):
    """A cycloid stage as its first-order turns need it."""

    def touches(
        self,
        deviated: Deviated,
        phis: Array,
        sense: Sense = 1,
        aside: Array | None = None,
        deflection: float | None = None,
    ) -> Touching:
        """Turns of the carrier at which the first working pin makes contact, counter-clockwise (1) or back (-1).

        Args:
            phis: crank angles (trials, positions), or (1, positions) that are those of every trial [rad].
            aside: tilts of discs about x and y of their frames, times half their width (trials, discs, 2) [mm]: a pin
                sees the faces offset by that to either side, and the nearer one closes its gap; None for no tilts.
            deflection: pins with at most this gap are counted then [mm]; None for no count.
        """
        trials, positions, rows = len(deviated.pins), phis.shape[1], np.arange(len(deviated.pins))
        turns = np.empty((trials, positions))
        places = np.empty((trials, positions), dtype=np.int64)
        near = None if deflection is None else np.empty_like(places)
        placed = [PlacedDisc.of(self, deviated, disc) for disc in range(self.discs)]
        shared = [self.nominal_pins(disc, phis[0]) for disc in range(self.discs)] if len(phis) == 1 else None
        for position in range(positions):
            at = phis[:, position]
            nominal = (
                [self.nominal_pins(disc, at) for disc in range(self.discs)]
                if shared is None
                else [own.row(position) for own in shared]
            )
            found = [
                self._allowed(deviated, disc, placed[disc], at, nominal[disc], sense, aside)
                for disc in range(self.discs)
            ]
            firsts = np.stack([np.argmin(sense * own, axis=1) for own, _ in found])
            allowed = np.stack([own[rows, first] for (own, _), first in zip(found, firsts, strict=True)])
            pins = np.stack([own[first] for (_, own), first in zip(found, firsts, strict=True)])
            first = np.argmin(sense * allowed, axis=0)
            turns[:, position] = allowed[first, rows]
            places[:, position] = pins[first, rows] + first * self.profile.pins
            if near is not None and deflection is not None:
                near[:, position] = self._within(turns[:, position], at, found, deflection)
        return Touching(turns, places, near)

    def rates(self, phis: Array, places: Places) -> Deviated:
        """Derivatives of the turn (rows,) [rad] by each deviation while a pin touches, in the form of the deviations.

        Args:
            phis: crank angles (rows,) [rad].
            places: the pins that touch (rows,), see Touching.
        """
        profile, rows = self.profile, np.arange(len(phis))
        disc, pin = np.divmod(places, profile.pins)
        found = Deviated.nothing(len(phis), profile.pins, self.discs, self.cranks)
        phases = phis + self.throws[disc]
        u = self._parameters(phases)[rows, pin]
        normal, lever = self._normals(u, self._azimuths[pin]), -profile.lever(u)
        reach = lever * self._giving
        at_pin = normal * np.exp(-1j * self._azimuths[pin]) / reach
        found.pins[rows, pin] = as_points(at_pin)
        found.pin_radii[rows, pin] = -1.0 / reach
        lobe = self._lobes(u)
        found.lobe_profile[rows, disc, lobe] = -1.0 / reach
        found.lobe_pitch[rows, disc, lobe] = -profile.shortening / profile.pitch_radius / self._giving
        self._of_linkage(found, phis, disc, -normal / reach)
        return found

    # one disc -------------------------------------------------------------------------------------------

    def gaps(self, phis: Array, disc: int, pins: Places, further: Array) -> Array:
        """Closing of the gaps of a disc's pins [mm] by further carrier turns (trials, pins), at phis (trials,)."""
        lever = self.profile.lever(self._parameters(phis + self.throws[disc])[:, pins])
        return np.abs(further * lever * self._giving)

    def _within(self, turns: Array, phis: Array, found: Sequence[tuple[Array, Places]], deflection: float) -> Places:
        """Number of pins of all discs with a gap of at most a deflection at turns (trials,)."""
        count = np.zeros(len(turns), dtype=np.int64)
        for disc, (allowed, pins) in enumerate(found):
            works = np.isfinite(allowed)
            gaps = self.gaps(phis, disc, pins, np.where(works, allowed, 0.0) - turns[:, None])
            count += (works & (gaps <= deflection)).sum(axis=1)
        return count

    def _allowed(
        self,
        deviated: Deviated,
        disc: int,
        placed: "PlacedDisc",
        phis: Array,
        nominal: "NominalPins",
        sense: Sense,
        aside: Array | None,
    ) -> tuple[Array, Places]:
        """Turn of the carrier that each working pin of one disc allows, at phis (trials,), or (1,) of every trial.

        Returns:
            Turns (trials, pins) [rad], infinite where a pin does not work in a trial, and which pins (pins,).
        """
        profile = self.profile
        pins = np.flatnonzero((sense * nominal.levers > self.window * profile.pitch_radius).any(axis=0))
        moved, turned = placed.at(phis, profile.lobes)
        own = nominal.some(pins)
        gap = self._gaps(deviated, disc, phis, aside, (moved, pins, own))
        works = sense * own.levers > self.window * profile.pitch_radius
        turn = gap / np.where(works, own.levers, 1.0) - turned[:, None]
        turn -= profile.shortening / profile.pitch_radius * picked(deviated.lobe_pitch[:, disc], own.lobes)
        return np.where(works, turn / self._giving, sense * np.inf), pins

    def nominal_gaps(
        self, deviated: Deviated, disc: int, phis: Array, aside: Array | None
    ) -> tuple[Array, Array, Complex]:
        """Gaps of all pins at a disc in its nominal place [mm], levers, and normals in the world (trials, pins).

        Args: see touches; phis (trials,).
        """
        pins, own = np.arange(self.profile.pins), self.nominal_pins(disc, phis)
        gap = self._gaps(deviated, disc, phis, aside, (np.zeros(len(phis), dtype=np.complex128), pins, own))
        errors = picked(deviated.lobe_pitch[:, disc], own.lobes)
        pitch = self.profile.shortening / self.profile.pitch_radius * errors
        return gap - own.levers * pitch, own.levers, own.normals

    def lobes_at(self, disc: int, phis: Array) -> Places:
        """The lobe of a disc at each pin (trials, pins)."""
        return self._lobes(self._parameters(phis + self.throws[disc]))

    def nominal_pins(self, disc: int, phis: Array) -> "NominalPins":
        """Nominal places of the pins about a disc, at phis (rows,)."""
        profile, azimuths = self.profile, self._azimuths
        u = self._parameters(phis + self.throws[disc])
        normals = self._normals(u, azimuths)
        return NominalPins(
            self._lobes(u), -profile.lever(u), normals, normals * np.exp(-1j * azimuths), profile.clearance(u)
        )

    def _gaps(
        self,
        deviated: Deviated,
        disc: int,
        phis: Array,
        aside: Array | None,
        at: "tuple[Complex, Places, NominalPins]",
    ) -> Array:
        """Gaps (trials, pins) of some pins at a disc that is displaced (trials,), without errors of pitch."""
        moved, pins, own = at
        normal, outwards = own.normals, own.outwards
        gap = own.clearance + outwards.real * deviated.pins[:, pins, 0] + outwards.imag * deviated.pins[:, pins, 1]
        gap -= deviated.pin_radii[:, pins] + picked(deviated.lobe_profile[:, disc], own.lobes)
        gap -= normal.real * moved.real[:, None] + normal.imag * moved.imag[:, None]
        if aside is not None:
            faces = 1j * as_complex(aside[:, disc]) * np.exp(-1j * phis / self.profile.lobes)
            gap -= np.abs(normal.real * faces.real[:, None] + normal.imag * faces.imag[:, None])
        return np.asarray(gap)

    def _of_linkage(self, found: Deviated, phis: Array, disc: Places, push: Complex) -> None:
        """Write the rates of a disc's placement: `push` is that of its displacement (rows,) in the world."""
        rows, profile = np.arange(len(phis)), self.profile
        carrier, throw = np.exp(-1j * phis / profile.lobes), np.exp(1j * phis)
        moment = 1j * self.crank_directions / (self.crank_circle * self.cranks) / self._giving
        carried = push * np.conj(carrier)
        holes = carried[:, None] / self.cranks - moment
        found.carrier_offsets[...] = as_points(carried)
        found.disc_offsets[rows, disc] = as_points(carried)
        found.carrier_holes[...] = as_points(holes)
        found.disc_holes[rows, disc] = -as_points(holes)
        thrown = (push * np.conj(throw))[:, None] / self.cranks - moment * (carrier * np.conj(throw))[:, None]
        found.crank_errors[rows, :, disc] = as_points(thrown)
        tangential = 1j * profile.eccentricity * np.exp(1j * self.throws[disc])
        found.crank_phases[...] = (np.conj(thrown) * tangential[:, None]).real

    # numbers --------------------------------------------------------------------------------------------

    @property
    def _giving(self) -> float:
        """1 + rho / Zc: factor by which a gap closes more as the cranks turn with the carrier."""
        return 1.0 + self.rolling / self.profile.lobes

    @property
    def crank_directions(self) -> Complex:
        """Unit vectors to the cranks' axes (cranks,)."""
        return np.asarray(np.exp(2j * np.pi * np.arange(self.cranks) / self.cranks))

    @property
    def _azimuths(self) -> Array:
        return evenly(self.profile.pins)

    def _parameters(self, phases: Array) -> Array:
        """Places of all pins on the profile of a disc whose eccentricity points at phases (rows,): (rows, pins)."""
        return np.asarray(self._azimuths + phases[:, None] / self.profile.lobes)

    def _normals(self, u: Array, azimuths: Array) -> Complex:
        """Normals out of the disc, in the world."""
        return np.asarray((self.profile.cos_normal(u) - 1j * self.profile.sin_normal(u)) * np.exp(1j * azimuths))

    def _lobes(self, u: Array) -> Places:
        """Lobe at each place of the profile."""
        return np.floor(u / self.profile.lobe_pitch).astype(np.int64) % self.profile.lobes


@dataclass(frozen=True)
class NominalPins:
    """Pins where they stand nominally at a disc (rows, pins); rows are crank angles, of a trial each or shared by all.

    Args:
        lobes: that they stand at.
        levers: by which a turn of the carrier closes their gaps [mm].
        normals: out of the disc, in the world.
        outwards: the same, seen from the pins: their real parts point off the ring's axis.
        clearance: that the modification leaves [mm].
    """

    lobes: Places
    levers: Array
    normals: Complex
    outwards: Complex
    clearance: Array

    def row(self, own: int) -> "NominalPins":
        """One row, as one of one."""
        return NominalPins(*(each[own : own + 1] for each in vars(self).values()))

    def some(self, pins: Places) -> "NominalPins":
        """Some of the pins."""
        return NominalPins(*(each[:, pins] for each in vars(self).values()))


@dataclass(frozen=True)
class PlacedDisc:
    """Displacement and turn of one disc (trials,), before any turn of the crank.

    Args:
        carried: displacement that goes round with the carrier, complex [mm].
        thrown: the same with the crank.
        turned: its turn on the carrier [rad].
        rocked: the same that goes round with crank against carrier, as a complex number whose imaginary part counts.
    """

    carried: Complex
    thrown: Complex
    turned: Array
    rocked: Complex

    @classmethod
    def of(cls, stage: LinearStage, deviated: Deviated, disc: int) -> "PlacedDisc":
        """One of a stage's discs."""
        holes = as_complex(deviated.carrier_holes) - as_complex(deviated.disc_holes[:, disc])
        tangential = 1j * stage.profile.eccentricity * np.exp(1j * stage.throws[disc])
        throws = as_complex(deviated.crank_errors[:, :, disc]) + tangential * deviated.crank_phases
        across = np.conj(stage.crank_directions) / (stage.crank_circle * stage.cranks)
        offsets = as_complex(deviated.carrier_offsets) + as_complex(deviated.disc_offsets[:, disc])
        return cls(holes.mean(axis=1) + offsets, throws.mean(axis=1), (holes @ across).imag, throws @ across)

    def at(self, phis: Array, lobes: int) -> tuple[Complex, Array]:
        """Displacement in the world and turn (trials,)."""
        carrier, throw = np.exp(-1j * phis / lobes), np.exp(1j * phis)
        return carrier * self.carried + throw * self.thrown, self.turned + (throw * np.conj(carrier) * self.rocked).imag


def picked(own: Array, lobes: Places) -> Array:
    """Values of lobes (trials, lobes) at (trials, pins) or (1, pins)."""
    return own[:, lobes[0]] if len(lobes) == 1 else np.take_along_axis(own, lobes, axis=1)
