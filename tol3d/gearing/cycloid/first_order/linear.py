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

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from tol3d.gearing.cycloid.first_order.turns_kernel import NONE_COUNTED, LinearShape, first_order_turns
from tol3d.gearing.cycloid.model.stage import CycloidStage, Deviated, Touching
from tol3d.numerics.arrays import Array, Complex, Places
from tol3d.numerics.plane import as_complex, as_points, evenly

Sense = Literal[1, -1]


@dataclass(frozen=True)
class LinearStage(CycloidStage):
    """A cycloid stage as its first-order turns need it."""

    bends: ClassVar[bool] = False
    """True where turns have the bend of the path of each pin besides."""

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
        trials, positions = len(deviated.pins), phis.shape[1]
        turns, places = np.empty((trials, positions)), np.empty((trials, positions), dtype=np.int64)
        near = None if deflection is None else np.empty_like(places)
        profile, own = self.profile, self.profile.modification
        first_order_turns(
            LinearShape(
                pins=float(profile.pins),
                lobes=float(profile.lobes),
                eccentricity=profile.eccentricity,
                pin_circle=profile.pin_circle_radius,
                shift=own.shift,
                offset=own.offset,
                rotation=own.rotation,
                least=self.window * profile.pitch_radius,
                rolling=self.rolling,
                deflection=NONE_COUNTED if deflection is None else deflection,
                bends=float(self.bends),
            ),
            self.throws,
            np.stack([np.cos(self._azimuths), np.sin(self._azimuths)], axis=-1),
            *(
                np.require(each, dtype=np.float64, requirements=["C", "W"])
                for each in (
                    self.placed(deviated), deviated.pins, deviated.pin_radii, deviated.lobe_pitch,
                    deviated.lobe_profile, np.zeros((trials, self.discs, 2)) if aside is None else aside, phis,
                )
            ),
            float(sense),
            turns,
            places,
            np.empty((0, 0), dtype=np.int64) if near is None else near,
        )  # fmt: skip
        return Touching(turns, places, near)

    def placed(self, deviated: Deviated) -> Array:
        """Displacement and turn of the discs before any turn of the crank, (trials, discs, 7) [mm, rad].

        Displacement that goes round with the carrier, and with the crank (x, y of each); turn on the carrier, and that
        which goes round with crank against carrier, as a complex number whose imaginary part counts.
        """
        found, across = [], np.conj(self.crank_directions) / (self.crank_circle * self.cranks)
        for disc, throw in enumerate(self.throws):
            holes = as_complex(deviated.carrier_holes) - as_complex(deviated.disc_holes[:, disc])
            tangential = 1j * self.profile.eccentricity * np.exp(1j * throw)
            throws = as_complex(deviated.crank_errors[:, :, disc]) + tangential * deviated.crank_phases
            offsets = as_complex(deviated.carrier_offsets) + as_complex(deviated.disc_offsets[:, disc])
            carried, rocked = holes.mean(axis=1) + offsets, (throws * across).sum(axis=1)
            moved = np.hstack([as_points(carried), as_points(throws.mean(axis=1))])
            found.append(np.column_stack([moved, (holes * across).sum(axis=1).imag, as_points(rocked)]))
        return np.stack(found, axis=1)

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

    def nominal_gaps(
        self, deviated: Deviated, disc: int, phis: Array, aside: Array | None
    ) -> tuple[Array, Array, Complex]:
        """Gaps of all pins at a disc in its nominal place [mm], levers, and normals in the world (trials, pins).

        Args: see touches; phis (trials,).
        """
        profile, azimuths = self.profile, self._azimuths
        u = self._parameters(phis + self.throws[disc])
        normals, lobes, levers = self._normals(u, azimuths), self._lobes(u), -profile.lever(u)
        outwards = normals * np.exp(-1j * azimuths)
        gap = profile.clearance(u) + outwards.real * deviated.pins[..., 0] + outwards.imag * deviated.pins[..., 1]
        gap -= deviated.pin_radii + picked(deviated.lobe_profile[:, disc], lobes)
        if aside is not None:
            faces = 1j * as_complex(aside[:, disc]) * np.exp(-1j * phis / profile.lobes)
            gap -= np.abs(normals.real * faces.real[:, None] + normals.imag * faces.imag[:, None])
        pitch = profile.shortening / profile.pitch_radius * picked(deviated.lobe_pitch[:, disc], lobes)
        return gap - levers * pitch, levers, normals

    def lobes_at(self, disc: int, phis: Array) -> Places:
        """The lobe of a disc at each pin (trials, pins)."""
        return self._lobes(self._parameters(phis + self.throws[disc]))

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


def picked(own: Array, lobes: Places) -> Array:
    """Values of lobes (trials, lobes) at (trials, pins) or (1, pins)."""
    return own[:, lobes[0]] if len(lobes) == 1 else np.take_along_axis(own, lobes, axis=1)
