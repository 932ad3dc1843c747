"""Interface of every gear and every pair of gears to builds, moves and engines, whatever the teeth.

One tooth in its space: both of its flanks are looked at, and no other tooth's.

A flank is in action between the start and the end of the path of contact, where the mate's tip and its own end it (ISO
21771, active flank). Beyond, a neighbour carries, and the tip edge that is nearest there gives no backlash.
"""

import math
from dataclasses import dataclass
from typing import Final, Literal, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import GeometryError
from tol3d.gears.flank import LEFT, RIGHT, Flank
from tol3d.gears.toothed_gear import ToothedGear
from tol3d.numerics.arrays import Array

Teeth = NDArray[np.int64]


class Gear(Protocol):
    """One gear, in its own frame: z its axis, x through the middle of tooth 0."""

    def __hash__(self) -> int: ...

    @property
    def teeth(self) -> int:
        """Number of teeth."""

    @property
    def module(self) -> float:
        """m [mm]; of a bevel gear at the outer end."""

    @property
    def pressure_angle(self) -> float:
        """alpha [rad] at the reference circle or on the pitch cone."""

    @property
    def face_width(self) -> float:
        """b [mm]."""

    @property
    def bore(self) -> float:
        """Diameter [mm] of the hole for the shaft; 0 means none."""

    @property
    def angular_pitch(self) -> float:
        """2 pi / z [rad]."""

    @property
    def base_radius(self) -> float:
        """Largest arm [mm] with which a turn about the axis moves a flank along its normal."""

    @property
    def section_arm(self) -> float:
        """Lever arm [mm] in the section in which the gear is measured: the middle of its face."""

    @property
    def thickness_radius(self) -> float:
        """Radius [mm] at which the tooth thickness is an arc, in that section."""

    @property
    def section_thickness(self) -> float:
        """Arc [mm] of a tooth at that radius."""

    @property
    def section_tip(self) -> float:
        """Arc [mm] at that radius by which a tooth may be thinner before its flanks meet at its tip."""

    @property
    def pitch_angle(self) -> float:
        """delta [rad] of the pitch cone, 0 for a cylinder."""

    @property
    def twist(self) -> float:
        """kappa [rad/mm], by which a transverse section is turned per height; 0 but for helical gears."""

    @property
    def base_pitch(self) -> float:
        """Distance [mm] of neighbouring flanks along their normal, in that section."""

    def perturbed(self, flank_turn: float, scale: float) -> Self:
        """The gear with its flanks turned out of their teeth [rad], and grown.

        Raises:
            GeometryError: such a gear cannot be made.
        """


CONTACT_MARGIN = 0.15  # pitches beyond the path of contact, whose ends move by 1/sin(alpha_w) of a shift of the axes


@dataclass(frozen=True)
class Displaced:
    """Positions of the gears of a pair in virtual builds; axis 1 is pinion, wheel.

    Args:
        origin: (rows, 2, 3) [mm], origins of both gears' frames in the world of the mesh.
        turn: (rows, 2, 3) [rad], rotation vectors in the world by which the axes left their rest.
        flank_turn: (rows, 2) [rad], by which flanks are turned out of their tooth; positive is thicker.
    """

    origin: Array
    turn: Array
    flank_turn: Array


class GearPair(Protocol):
    """A pinion (driver) and a wheel (driven) in the world of their mesh, where the driver's axis is z."""

    @property
    def pinion(self) -> Gear:
        """The driver."""

    @property
    def wheel(self) -> Gear:
        """The driven gear."""

    @property
    def long_period_turns(self) -> int:
        """Turns of the pinion until the same teeth meet again in the same places: z2 / gcd(z1, z2)."""

    @property
    def working_pressure_angle(self) -> float:
        """alpha_w [rad], of helical gears alpha_wt in the transverse section."""

    @property
    def base_helix_cosine(self) -> float:
        """cos beta_b: of a length along the line of action of a transverse section the part along the normal."""

    @property
    def working_radii(self) -> tuple[float, float]:
        """Radii [mm] of the rolling circles of pinion and wheel, in the middle of the face."""

    @property
    def normal_backlash(self) -> float:
        """j_bn [mm] of the nominal pair, in the middle of the face; negative: the teeth interfere."""

    @property
    def world_from_wheel(self) -> Array:
        """Rotation (3, 3) of the wheel's frame at rest in the world."""

    @property
    def wheel_origin(self) -> Array:
        """Origin (3,) [mm] of that frame; a housing that grows scales it."""

    @property
    def mesh_azimuths(self) -> tuple[float, float]:
        """Azimuth [rad] of the mesh in the frame at rest of pinion and wheel."""

    @property
    def opening_off_mesh(self) -> tuple[float, float]:
        """Azimuth off the mesh [rad] in which a shift of the axis opens: pi, away from the mate; of a ring 0."""

    @property
    def pinion_section(self) -> float:
        """Position of the middle of the common face on the pinion's face, from 0 to 1 along its z."""

    @property
    def arm_spread(self) -> float:
        """Relative variation of the lever arm of a turn about the axis over the face: 0 on a cylinder."""

    @property
    def view_from_world(self) -> Array:
        """Rotation (3, 3) to the view of the heel of the teeth in mesh, the wheel on the right."""

    def tip_clearance(self, origins: Array, scale: tuple[float, float]) -> float:
        """Smaller free distance [mm] between a tip and the mate's root.

        Args:
            origins: (2, 3) [mm], where the frames of pinion and wheel lie in the world.
            scale: growth of both.
        """

    @property
    def remedy(self) -> str:
        """Remedy for teeth that interfere, with the numbers."""

    def refuse_interference(self) -> None:
        """Raise a GeometryError unless tips clear roots and contact stays on both flanks."""

    def driven_angle(self, driver_angle: Array) -> Array:
        """Wheel's turn [rad] with its space centred on the pinion's tooth."""

    def touching_angle(self, driver_angle: Array, flank: Flank, displaced: Displaced) -> Array:
        """Wheel's turn [rad], (rows,), at which the flanks of that side of the pinion touch, nearly."""

    @property
    def active_azimuths(self) -> tuple[float, float]:
        """Azimuths [rad] of a pinion's tooth, times sigma, between which it is on the path of contact."""

    @property
    def touching_azimuths(self) -> tuple[float, float]:
        """Azimuths [rad] of a pinion's tooth, times sigma, between which it may touch: its path and a margin."""

    def candidate_teeth(self, driver_angle: Array, flank: Flank) -> tuple[Teeth, NDArray[np.bool_]]:
        """Pinion teeth (rows, pairs) that may touch on that flank, and whether each may."""

    def mating_teeth(self, driver_teeth: Teeth, flank: Flank) -> Teeth:
        """The wheel's tooth that each of those pinion flanks meets."""

    def mating_flank(self, flank: Flank) -> Flank:
        """Flank of the wheel that meets that side of the pinion.

        A gear leaves its mate on its own right flanks by a turn in the positive sense, on its left ones by one back.
        """


SAME_LENGTH: Final = 1e-9  # relative; two modules written alike are equal in this sense


@dataclass(frozen=True)
class RollingPair:
    """Common base of pairs with any teeth: module, pressure angle, numbers of teeth, and teeth that may touch."""

    pinion: ToothedGear
    wheel: ToothedGear

    def _refuse_unlike(self) -> None:
        for name, unit in (("module", "mm"), ("pressure_angle", "rad")):
            first, second = getattr(self.pinion, name), getattr(self.wheel, name)
            if not math.isclose(first, second, rel_tol=SAME_LENGTH):
                raise GeometryError(
                    f"the gears of a pair need the same {name}, got {first:g} {unit} and {second:g} {unit}"
                )

    @property
    def ratio(self) -> float:
        """z2 / z1."""
        return self.wheel.teeth / self.pinion.teeth

    @property
    def long_period_turns(self) -> int:
        """Turns of the pinion until the same teeth meet again in the same places: z2 / gcd(z1, z2)."""
        return self.wheel.teeth // math.gcd(self.pinion.teeth, self.wheel.teeth)

    @property
    def touching_azimuths(self) -> tuple[float, float]:
        """See GearPair."""
        raise NotImplementedError

    def candidate_teeth(self, driver_angle: Array, flank: Flank) -> tuple[Teeth, NDArray[np.bool_]]:
        """Pinion teeth that may touch on that flank."""
        return candidate_teeth(self.touching_azimuths, self.pinion.angular_pitch, driver_angle, flank)


def candidate_teeth(
    window: tuple[float, float], pitch: float, driver_angle: Array, flank: Flank
) -> tuple[Teeth, NDArray[np.bool_]]:
    """Pinion teeth that stand within a window of azimuths.

    Args:
        window: lowest and highest azimuth [rad], times sigma.
        pitch: of the pinion [rad].
        driver_angle: pinion's turn [rad], shape (rows,).
        flank: the pinion's flank.

    Returns:
        (rows, pairs) tooth numbers (any integer; tooth k is turned by 2 pi k/z), consecutive, and (rows, pairs)
        whether each stands there.
    """
    lowest, highest = ((end - flank * driver_angle) / pitch for end in window)
    pairs = math.floor((window[1] - window[0]) / pitch) + 1
    steps = np.ceil(lowest).astype(np.int64)[:, None] + np.arange(pairs)
    return np.asarray(flank * steps), steps <= highest[:, None]


Owner = Literal["driver", "driven"]

ROUNDING = 1e-9  # pitches; a flank that so nearly ends where it is looked at does not end there


def driver_teeth_at_one_tooth(
    driver_angle: Array, angular_pitch: float, flank: Flank, owner: Owner
) -> NDArray[np.int64]:
    """The driver's tooth that touches, with that flank, the one tooth (or is it), (rows, 1).

    The one tooth is the owner's nearest to the line of centres, which the driver sees at azimuth 0. A driven
    tooth stands in a space of the driver: the space's right wall is the right flank of the tooth above it.

    >>> driver_teeth_at_one_tooth(np.array([0.1]), 1.0, RIGHT, "driver").tolist()
    [[0]]
    >>> [driver_teeth_at_one_tooth(np.array([0.1]), 1.0, flank, "driven").tolist() for flank in (1, -1)]
    [[[0]], [[-1]]]
    """
    place = driver_angle / angular_pitch
    above = 1 if flank == RIGHT else 0
    tooth = -np.round(place) if owner == "driver" else above - np.round(place + 0.5)
    return np.asarray(tooth.astype(np.int64)[:, None])


def one_tooth_acts(pair: GearPair, driver_angle: Array, owner: Owner) -> NDArray[np.bool_]:
    """True where both flanks of the one tooth are on the nominal path of contact, (rows,), at driver angles [rad]."""
    pitch = pair.pinion.angular_pitch
    lowest, highest = pair.active_azimuths
    acts = np.ones(len(driver_angle), dtype=bool)
    for flank in (RIGHT, LEFT):
        teeth = driver_teeth_at_one_tooth(driver_angle, pitch, flank, owner)[:, 0]
        azimuth = flank * (driver_angle + pitch * teeth)
        acts &= (lowest - ROUNDING * pitch <= azimuth) & (azimuth <= highest + ROUNDING * pitch)
    return acts


def one_tooth_share(pair: GearPair, owner: Owner) -> float:
    """Share of all positions, 0 to 1, at which they are.

    As the driver turns by a pitch, the flanks of its own tooth next to the line of centres stand at azimuths, times
    sigma, of f and -f, f from -1/2 to 1/2 of a pitch; those of the driven tooth are met at f and 1 - f, f from 0 to 1.
    """
    lowest, highest = (azimuth / pair.pinion.angular_pitch for azimuth in pair.active_azimuths)
    together, first, last = (0.0, -0.5, 0.5) if owner == "driver" else (1.0, 0.0, 1.0)
    begin, end = max(first, lowest, together - highest), min(last, highest, together - lowest)
    return min(1.0, max(0.0, end - begin + ROUNDING))
