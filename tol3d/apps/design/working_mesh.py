"""One mesh of a set at its centre distance: working pressure angle, path of contact, losses, margins of its teeth.

Lengths in mm, angles in rad; profile shifts in modules, positive ones thicken the tooth, of a ring too (ISO 21771;
books that write inv alpha_w with (x_2 - x_1)/(z_2 - z_1) have the other sign of a ring's shift). `s` is +1 of an
external mesh, -1 of an internal one.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from tol3d.errors import GeometryError
from tol3d.gearing.planetary import CentralMesh, Sharing, shared_sliding_factor, sliding_factor
from tol3d.gears import involute

ISO53_ADDENDUM: Final = 1.0
ISO53_DEDENDUM: Final = 1.25


@dataclass(frozen=True)
class BasicRack:
    """Module m [mm], pressure angle alpha [rad], addendum and dedendum factors h_a*, h_f*.

    Raises:
        GeometryError: a module of 0 or less, an angle beyond 5 to 45 deg, a dedendum below the addendum.
    """

    module: float = 1.0
    pressure_angle: float = math.radians(20)
    addendum: float = ISO53_ADDENDUM
    dedendum: float = ISO53_DEDENDUM

    def __post_init__(self) -> None:
        if not self.module > 0.0:
            raise GeometryError(f"module: expected more than 0 mm, got {self.module:g} mm")
        if not math.radians(5) <= self.pressure_angle <= math.radians(45):
            raise GeometryError(f"pressure angle: expected 5 to 45 deg, got {math.degrees(self.pressure_angle):g} deg")
        if not self.dedendum > self.addendum > 0.0:
            raise GeometryError(
                f"expected a dedendum above the addendum, and that above 0, got {self.dedendum:g} and {self.addendum:g}"
            )


ROOT_FILLET = 0.38  # of the module, as gears have it unless a scene says otherwise: ISO 53:1998, profile A


def working_pressure_angle(mesh: CentralMesh, rack: BasicRack, centre_distance: float) -> float:
    """alpha_w [rad] with a cos alpha_w = m (z + s z_p)/2 cos alpha.

    Raises:
        GeometryError: the centre distance is below that at which the base circles touch.
    """
    base = rack.module * mesh.tooth_sum / 2 * math.cos(rack.pressure_angle)
    if not centre_distance > base:
        raise GeometryError(
            f"centre distance {centre_distance:g} mm: the mesh of {mesh.central} needs more than {base:.4f} mm"
        )
    return math.acos(base / centre_distance)


def shift_sum(mesh: CentralMesh, rack: BasicRack, centre_distance: float) -> float:
    """x + x_p without backlash at a centre distance [mm]: s (z + s z_p)(inv alpha_w - inv alpha)/(2 tan alpha).

    Source: ISO 21771-1:2024, 5.3, with a ring's teeth counted negative there.
    """
    working = working_pressure_angle(mesh, rack, centre_distance)
    more = involute(working) - involute(rack.pressure_angle)
    return _sign(mesh) * mesh.tooth_sum * more / (2 * math.tan(rack.pressure_angle))


def _sign(mesh: CentralMesh) -> int:
    return -1 if mesh.internal else 1


@dataclass(frozen=True)
class WorkingMesh:
    """A central gear and a planet in mesh without backlash.

    Args:
        centre_distance: a [mm].
        central_shift, planet_shift: x of both; their sum is `shift_sum`.
    """

    mesh: CentralMesh
    rack: BasicRack
    centre_distance: float
    central_shift: float
    planet_shift: float

    @property
    def sign(self) -> int:
        """s: +1 external, -1 internal."""
        return _sign(self.mesh)

    @cached_property
    def working_angle(self) -> float:
        """alpha_w [rad]."""
        return working_pressure_angle(self.mesh, self.rack, self.centre_distance)

    # circles [mm] ---------------------------------------------------------------------------------

    def _reference(self, teeth: int) -> float:
        return self.rack.module * teeth / 2

    @property
    def base_radii(self) -> tuple[float, float]:
        """Base radii of central gear and planet."""
        cos = math.cos(self.rack.pressure_angle)
        return self._reference(self.mesh.teeth) * cos, self._reference(self.mesh.planet_teeth) * cos

    @property
    def tip_radii(self) -> tuple[float, float]:
        """Tip radii of central gear and planet: m (z/2 + h_a* + x), of a ring m (z/2 - h_a* - x)."""
        m, high = self.rack.module, self.rack.addendum
        central = self._reference(self.mesh.teeth) + self.sign * m * (high + self.central_shift)
        return central, self._reference(self.mesh.planet_teeth) + m * (high + self.planet_shift)

    @property
    def root_radii(self) -> tuple[float, float]:
        """Root radii of central gear and planet: m (z/2 - h_f* + x), of a ring m (z/2 + h_f* - x)."""
        m, low = self.rack.module, self.rack.dedendum
        central = self._reference(self.mesh.teeth) - self.sign * m * (low - self.central_shift)
        return central, self._reference(self.mesh.planet_teeth) - m * (low - self.planet_shift)

    @cached_property
    def tip_angles(self) -> tuple[float, float]:
        """Pressure angles [rad] at the tip circles of central gear and planet; 0 inside the base circle."""
        central, planet = (
            math.acos(min(1.0, base / tip)) for base, tip in zip(self.base_radii, self.tip_radii, strict=True)
        )
        return central, planet

    # path of contact ------------------------------------------------------------------------------

    @cached_property
    def contact_ratios(self) -> tuple[float, float]:
        """Parts of the path of contact on either side of the pitch point [base pitches].

        epsilon_1 = s z/(2 pi)(tan alpha_a - tan alpha_w) to the central gear's tip, epsilon_2 = z_p/(2 pi)(...) to the
        planet's.
        """
        at_pitch = math.tan(self.working_angle)
        central, planet = (math.tan(angle) - at_pitch for angle in self.tip_angles)
        turn = 2 * math.pi
        return self.sign * self.mesh.teeth * central / turn, self.mesh.planet_teeth * planet / turn

    @property
    def contact_ratio(self) -> float:
        """epsilon_alpha."""
        return sum(self.contact_ratios)

    # margins, negative where the teeth fail -------------------------------------------------------

    @property
    def tip_clearances(self) -> tuple[float, float]:
        """Free distance [mm] between central gear's tip and planet's root, planet's tip and central gear's root."""
        (tip, planet_tip), (root, planet_root) = self.tip_radii, self.root_radii
        if self.mesh.internal:
            return tip - self.centre_distance - planet_root, root - self.centre_distance - planet_tip
        return self.centre_distance - tip - planet_root, self.centre_distance - planet_tip - root

    @property
    def tip_thicknesses(self) -> tuple[float, float]:
        """Arcs [mm] at the tip circles of central gear and planet."""
        alpha, (first, second) = self.rack.pressure_angle, self.tip_angles
        central = self._half_angle(self.mesh.teeth, self.central_shift) + self.sign * (
            involute(alpha) - involute(first)
        )
        planet = self._half_angle(self.mesh.planet_teeth, self.planet_shift) + involute(alpha) - involute(second)
        return 2 * self.tip_radii[0] * central, 2 * self.tip_radii[1] * planet

    def _half_angle(self, teeth: int, shift: float) -> float:
        """Half of a tooth at the reference circle [rad]."""
        return (math.pi / 2 + 2 * shift * math.tan(self.rack.pressure_angle)) / teeth

    @property
    def involute_margins(self) -> tuple[float, float]:
        """Distance [mm along the line of action] of contact from the fillets of central gear and planet.

        A fillet is taken as the arc of 0.38 m between root circle and involute.
        """
        (base, planet_base), (root, planet_root) = self.base_radii, self.root_radii
        along = self.centre_distance * math.sin(self.working_angle)
        reach, planet_reach = (
            one * math.tan(angle) for one, angle in zip(self.base_radii, self.tip_angles, strict=True)
        )
        fillet = ROOT_FILLET * self.rack.module
        planet_form = _form(planet_root + fillet, planet_base, -fillet)
        if self.mesh.internal:
            return _form(root - fillet, base, fillet) - (along + planet_reach), reach - along - planet_form
        return along - planet_reach - _form(root + fillet, base, -fillet), along - reach - planet_form

    @property
    def tip_interference_margin(self) -> float:
        """Angle [rad of the ring] between passing tip corners as a planet's tooth leaves its space; inf outside.

        Where the tip circles cross, at the azimuths delta_p, delta of planet and ring off the line of centres:
        [z_p (inv alpha_ap + delta_p) - z (inv alpha_a + delta) + (z - z_p) inv alpha_w] / z. Negative: trimming
        interference.
        """
        if not self.mesh.internal:
            return math.inf
        (tip, planet_tip), a = self.tip_radii, self.centre_distance
        outwards = (tip**2 - planet_tip**2 - a**2) / (2 * a * planet_tip)
        if abs(outwards) >= 1.0:
            return math.inf
        delta_p = math.acos(outwards)
        delta = math.acos((tip**2 - planet_tip**2 + a**2) / (2 * a * tip))
        central, planet = (involute(angle) for angle in self.tip_angles)
        z, z_p = self.mesh.teeth, self.mesh.planet_teeth
        return (z_p * (planet + delta_p) - z * (central + delta) + (z - z_p) * involute(self.working_angle)) / z


def _form(centre: float, base: float, fillet: float) -> float:
    """Length of the tangent [mm] from the base circle to where an arc with its centre on that radius ends the flank."""
    beyond = centre**2 - base**2
    return max(0.0, (math.sqrt(beyond) if beyond > 0.0 else 0.0) + fillet)


def mesh_efficiency(mesh: WorkingMesh, friction: float, sharing: Sharing = "formula") -> float:
    """1 - mu pi (1/z_p + s/z) E.

    Args:
        mesh: at its centre distance.
        friction: mu, the same all along the path.
        sharing: E by the formula, or by equal shares of the pairs in contact.
    """
    factor = sliding_factor if sharing == "formula" else shared_sliding_factor
    slow = 1 / mesh.mesh.planet_teeth + mesh.sign / mesh.mesh.teeth
    return 1 - friction * math.pi * slow * factor(*mesh.contact_ratios)
