"""First contact of the discs of a cycloid stage among their pins, exact in finite geometry, without bearing play.

Complex numbers stand for points of the plane [mm]; the pin ring's axis is the origin, angles count counter-clockwise.
The carrier has turned by chi = -phi / Zc + delta; every crank by phi + rho delta in space, and its phase error. The
axis of crank i lies where the carrier's hole is, displaced with the carrier by its main bearing's inner ring:

    A_i = e^(i chi) (m + H_i),   H_i = R e^(2 pi i / cranks) + hole error,

its throw for disc d is turned with the crank: e^(i phi) E_id, E_id = e^(i beta_i) (a e^(i throw_d) + crank error). A
disc has its holes at h_id = R e^(2 pi i / cranks) + hole error - o_d in the frame of its profile's centre, with o_d
the profile's offset from the holes. So a crank's eccentricity goes round with phi, a disc's with its own turn psi_d,
the carrier's holes and its main bearing's inner ring with chi.

Three cranks without play hold a disc in six coordinates, three too many. The bearings are alike and give alike: the
disc lies where the squares of the distances between its holes' centres and the cranks' throws are least. That is exact
in finite geometry: with bars for means over the cranks,

    e^(i psi_d) = unit of sum_i (A_i + e^(i phi) E_id - mean) conj(h_id - mean)
                = unit of e^(i chi) S_d + e^(i phi) Q_d,
    centre_d = e^(i chi) (m + mean H) + e^(i phi) mean E_d - e^(i psi_d) mean h_d.

An eccentricity common to the cranks so moves the disc; differences turn it, by their mean tangential part over R.

The profile of disc d is turned against its holes by -throw_d / Zc so that its lobes mesh; its nominal turn is chi,
too. Pin j stands at the parameter 2 pi j / Zp + (phi + throw_d) / Zc of it, but for errors.

Errors of lobes: the pitch error p of lobe k turns the whole lobe about the disc's axis by p K / (a Zc),
counter-clockwise positive, so that its best flank moves p K along the normal. The profile error f moves its surface by
f along the normal, outwards positive. The disc's surface so is piecewise, with steps at the roots, where a pin has no
lever: as large as the difference of two profile errors there, and of second order in pitch errors. A pin touches the
lobe on which its foot lies. The rotation of a modified profile turns right and left flanks apart, with a corner at root
and tip.
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tol3d.gearing.cycloid.exact.contact_kernel import first_contacts
from tol3d.gearing.cycloid.exact.pin_contact import ContactShape
from tol3d.gearing.cycloid.model.profile import DiscProfile
from tol3d.gearing.cycloid.model.stage import CycloidStage, Deviated, Touching
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import evenly

CENTRE: Final = slice(0, 2)  # of the carrier's holes, in the carrier's frame
THROW: Final = slice(2, 4)  # mean of the cranks' throws, in the cranks' frame
HOLES: Final = slice(4, 6)  # mean of the disc's holes, in its profile's frame
CARRIER_TURN: Final = slice(6, 8)  # S
CRANK_TURN: Final = slice(8, 10)  # Q


@dataclass(frozen=True)
class Bearings:
    """Centres of the bearing seats [mm].

    Attributes:
        holes: of the carrier, in its frame, its main bearing's displacement in it (trials, cranks, 2).
        thrown: throws, in the crank's frame, its phase error in them (trials, cranks, discs, 2).
        bored: holes of the discs, in the frame of the profile's centre (trials, discs, cranks, 2).
    """

    holes: Array
    thrown: Array
    bored: Array


def bearings(
    eccentricity: float,
    crank_circle: float,
    disc_offsets: Array,
    disc_holes: Array,
    crank_errors: Array,
    crank_phases: Array,
    carrier_holes: Array,
    carrier_offsets: Array,
) -> Bearings:
    """Positions of the bearing seats, with their errors.

    Args:
        eccentricity: a [mm].
        crank_circle: radius R of the circle of the cranks' axes [mm].
        disc_offsets: of profiles from crank holes, in the disc's frame (trials, discs, 2) [mm].
        disc_holes: errors of the discs' holes in the same frame (trials, discs, cranks, 2) [mm].
        crank_errors: eccentricity errors in the crank's frame (trials, cranks, discs, 2) [mm].
        crank_phases: of the cranks (trials, cranks) [rad].
        carrier_holes: errors of the carrier's holes in its frame (trials, cranks, 2) [mm].
        carrier_offsets: by its main bearing, in its frame (trials, 2) [mm].
    """
    cranks, discs = crank_errors.shape[1:3]
    around = evenly(cranks)
    nominal = crank_circle * np.stack([np.cos(around), np.sin(around)], axis=-1)
    directions = evenly(discs)
    own = eccentricity * np.stack([np.cos(directions), np.sin(directions)], axis=-1) + crank_errors
    cos_b, sin_b = np.cos(crank_phases)[..., None], np.sin(crank_phases)[..., None]
    x, y = own[..., 0], own[..., 1]
    return Bearings(
        nominal + carrier_holes + carrier_offsets[:, None],
        np.stack([cos_b * x - sin_b * y, sin_b * x + cos_b * y], axis=-1),
        nominal + disc_holes - disc_offsets[:, :, None],
    )


def linkage(joined: Bearings) -> Array:
    """Terms of a disc's pose without bearing play, (trials, discs, 10) [mm, mm2]: see CENTRE, THROW..."""
    trials, _, discs = joined.thrown.shape[:3]
    middle = _mean(joined.holes)
    found = np.empty((trials, discs, 10))
    for disc in range(discs):
        thrown, bored = joined.thrown[:, :, disc], joined.bored[:, disc]
        middle_thrown, middle_bored = _mean(thrown), _mean(bored)
        across = bored - middle_bored[:, None]
        found[:, disc, CENTRE] = middle
        found[:, disc, THROW] = middle_thrown
        found[:, disc, HOLES] = middle_bored
        found[:, disc, CARRIER_TURN] = _turned(joined.holes - middle[:, None], across)
        found[:, disc, CRANK_TURN] = _turned(thrown - middle_thrown[:, None], across)
    return found


def _mean(points: Array) -> Array:
    """Mean over cranks, (trials, 2) of (trials, cranks, 2), in their order."""
    total = points[:, 0]
    for crank in range(1, points.shape[1]):
        total = total + points[:, crank]
    return np.asarray(total / points.shape[1])


def _turned(points: Array, others: Array) -> Array:
    """Sum over cranks of points times conjugates of others, (trials, 2) of (trials, cranks, 2)."""
    x, y, u, v = points[..., 0], points[..., 1], others[..., 0], others[..., 1]
    return np.asarray(_mean(np.stack([x * u + y * v, y * u - x * v], axis=-1)) * points.shape[1])


BOTH: Final = (1.0, -1.0)
"""Counter-clockwise, and back."""
NONE_COUNTED: Final = -1.0


@dataclass(frozen=True)
class AsMade:
    """Discs, cranks, carrier and pins as they are made.

    Attributes:
        linkage: of `linkage` (trials, discs, 10).
        pins: centres (trials, pins, 2) [mm].
        pin_radii: (trials, pins) [mm].
        lobe_pitch, lobe_profile: errors (trials, discs, lobes) [mm].
        leans: lean of the discs (trials, discs, 3): see `leaning`; None where they lie flat.
    """

    linkage: Array
    pins: Array
    pin_radii: Array
    lobe_pitch: Array
    lobe_profile: Array
    leans: Array | None = None


@dataclass(frozen=True)
class ContactStage(CycloidStage):
    """A cycloid stage as its exact first contacts need it."""

    def touches(
        self,
        deviated: Deviated,
        phis: Array,
        senses: tuple[float, ...] = BOTH,
        deflection: float | None = None,
        leans: Array | None = None,
    ) -> Touching:
        """Turns of the carrier at which the first working pin makes contact, counter-clockwise (+1) and back (-1).

        Lost motion is the first of `BOTH` turns less the second, negative where a build is tight: where the carrier has
        to turn back before pins of the other flanks are clear.

        Args:
            phis: crank angles (trials, positions), or (1, positions) that are those of every trial [rad].
            deflection: pins with at most this gap are counted then [mm]; None for no count.
            leans: of discs, see `leaning`; None where they lie flat.
        """
        shape = contact_shape(
            self.profile, self.window, self.rolling, NONE_COUNTED if deflection is None else deflection
        )
        positions = np.broadcast_to(phis, (len(deviated.pins), phis.shape[1]))
        return first_contact(shape, replace(self.as_made(deviated), leans=leans), positions, senses)

    def as_made(self, deviated: Deviated) -> AsMade:
        """Places and sizes of the deviated parts."""
        own = self.profile
        pins = pin_centres(own.pin_circle_radius, deviated.pins)
        radii = own.pin_radius + deviated.pin_radii
        return AsMade(linkage(self.joined(deviated)), pins, radii, deviated.lobe_pitch, deviated.lobe_profile)

    def joined(self, deviated: Deviated) -> Bearings:
        """Positions of the bearing seats, with the errors of the deviated parts."""
        return bearings(
            self.profile.eccentricity,
            self.crank_circle,
            deviated.disc_offsets,
            deviated.disc_holes,
            deviated.crank_errors,
            deviated.crank_phases,
            deviated.carrier_holes,
            deviated.carrier_offsets,
        )


def contact_shape(
    profile: DiscProfile, window: float, rolling: float, deflection: float = NONE_COUNTED
) -> ContactShape:
    """Kernel input of a nominal stage; see ContactShape."""
    ground = profile.ground
    k, pins = ground.shortening, ground.pins
    cosine = ((2 * pins - 1) * k**2 - (pins - 2)) / ((pins + 1) * k)
    return ContactShape(
        pins=float(profile.pins),
        lobes=float(profile.lobes),
        eccentricity=profile.eccentricity,
        ground_circle=ground.pin_circle_radius,
        ground_radius=ground.pin_radius,
        pin_circle=profile.pin_circle_radius,
        pin_radius=profile.pin_radius,
        rotation=profile.modification.rotation,
        window=window,
        rolling=rolling,
        sharpest=1 / profile.smallest_convex_radius,
        sharpest_cosine=max(cosine, -1.0),
        deflection=deflection,
    )


def first_contact(shape: ContactShape, made: AsMade, phis: Array, senses: tuple[float, ...] = BOTH) -> Touching:
    """Turn the carrier until the first working pin touches a disc, with cranks at phi (trials, positions) [rad].

    All turns are exact for rigid parts: any working pin of any disc may be first. Results do not depend on which trials
    and positions are asked for together. A turn of the discs leaves all as it was; whole ones are taken off the crank
    angles, whose last digit would otherwise be more than Newton's method asks for.
    """
    trials, positions = phis.shape
    turns = np.empty((trials, positions, len(senses)))
    places = np.empty(turns.shape, dtype=np.int64)
    counted = shape.deflection >= 0
    near = np.empty(turns.shape if counted else (0, 0, 0), dtype=np.int64)
    first_contacts(
        shape,
        evenly(made.linkage.shape[1]),
        pin_directions(int(shape.pins)),
        *(
            np.require(each, dtype=np.float64, requirements=["C", "W"])
            for each in (
                made.linkage, made.pins, made.pin_radii, made.lobe_pitch, made.lobe_profile,
                np.zeros((*made.linkage.shape[:2], 3)) if made.leans is None else made.leans,
                np.mod(phis, 2 * math.pi * shape.lobes),
            )
        ),
        np.array(senses),
        turns,
        places,
        near,
    )  # fmt: skip
    return Touching(turns, places, near if counted else None)


def pin_directions(pins: int) -> Array:
    """Cosine and sine of the pins' azimuths (pins, 2)."""
    azimuths = evenly(pins)
    return np.stack([np.cos(azimuths), np.sin(azimuths)], axis=-1)


def pin_centres(circle: float, errors: Array) -> Array:
    """Centres of pins (trials, pins, 2) [mm] that lie off a circle outwards and counter-clockwise (trials, pins, 2)."""
    along = pin_directions(errors.shape[1])
    across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
    return np.asarray((circle + errors[..., :1]) * along + errors[..., 1:] * across)


def leaning(tilts: Array, width: float) -> Array:
    """Lean of discs tilted about axes in their plane (trials, discs, 3): slopes, and half their width [mm].

    Args:
        tilts: about x and y of the frame of a disc's holes, through the middle of its width (trials, discs, 2) [rad]:
            one rotation about the axis that both make, by the root of their squares.
        width: of the discs' faces [mm].
    """
    angle = np.sqrt(tilts[..., 0] ** 2 + tilts[..., 1] ** 2)
    ratio = np.where(angle > 0, np.tan(angle) / np.where(angle > 0, angle, 1.0), 1.0)
    half = np.full(tilts.shape[:-1], width / 2)
    return np.stack([-tilts[..., 1] * ratio, tilts[..., 0] * ratio, half], axis=-1)
