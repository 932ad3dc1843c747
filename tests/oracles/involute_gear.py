"""An involute spur gear in polar form: half the angle of a tooth as a function of the radius.

Lengths in mm, angles in rad. Gear frame: z the axis, x through the middle of tooth 0. The sign sigma is +1
for the flank on the low-azimuth side of its tooth, -1 for the other.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from tol3d.gears.flank import Flank

BELOW_BASE = 0.0  # mm of string: the flank is followed down to its base circle, where no mate ever reaches

Number = TypeVar("Number", float, np.ndarray)


@dataclass(frozen=True)
class InvoluteGear:
    """Plain numbers of one gear; `thickness_deviation` [mm] is an arc at the reference circle."""

    teeth: int
    module: float
    pressure_angle: float
    face_width: float
    profile_shift: float = 0.0
    addendum: float = 1.0
    thickness_deviation: Any = 0.0  # or an array that broadcasts

    def grown(self, factor: Any) -> "InvoluteGear":
        """The same gear, every length times a factor, or an array of them."""
        return replace(
            self,
            module=self.module * factor,
            face_width=self.face_width * factor,
            thickness_deviation=self.thickness_deviation * factor,
        )

    @property
    def reference_radius(self) -> float:
        return self.module * self.teeth / 2

    @property
    def base_radius(self) -> float:
        return self.reference_radius * math.cos(self.pressure_angle)

    @property
    def tip_radius(self) -> float:
        return self.reference_radius + (self.addendum + self.profile_shift) * self.module

    @property
    def pitch(self) -> float:
        """Angle from tooth to tooth [rad]."""
        return 2 * math.pi / self.teeth

    @property
    def tip_string(self) -> float:
        """Length [mm] of the string that draws the flank, at the tip."""
        return math.sqrt(self.tip_radius**2 - self.base_radius**2)

    def half_angle(self, radius: Number) -> Number:
        """Half the angle [rad] of a tooth at a radius of at least the base radius.

        A rack of pitch pi m rolls on the reference circle; shifted out by x m its space there is
        pi m/2 + 2 x m tan(alpha) wide, and so is the tooth. From there to another radius both flanks
        lean in by the difference of tan(alpha_y) - alpha_y.
        """
        alpha = self.pressure_angle
        thickness = self.module * (math.pi / 2 + 2 * self.profile_shift * math.tan(alpha)) + self.thickness_deviation
        at = np.arccos(np.minimum(1.0, self.base_radius / radius))
        return thickness / (2 * self.reference_radius) + (math.tan(alpha) - alpha) - (np.tan(at) - at)

    def thickness(self, radius: Number) -> Number:
        """Tooth thickness [mm] as an arc at a radius."""
        return 2 * radius * self.half_angle(radius)

    def flank_points(self, string: np.ndarray, z: np.ndarray, tooth: np.ndarray, flank: Flank) -> np.ndarray:
        """Points (..., 3) on a flank; `string` [mm] = sqrt(r^2 - r_b^2), all arguments broadcast."""
        string, z, tooth = np.broadcast_arrays(string, z, tooth)
        radius = np.hypot(self.base_radius, string)
        azimuth = self.pitch * tooth - flank * self.half_angle(radius)
        return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)

    def signed_distance(self, points: np.ndarray, tooth: np.ndarray, flank: Flank) -> np.ndarray:
        """Shortest distance [mm] of points (..., 3) in the gear's frame to one flank, negative inside the tooth.

        The flank ends at tip circle, base circle and faces; a point beyond an end is measured to that edge.
        A point off the flank by the angle delta lies on the same involute turned by delta; along the common
        normal, tangent to the base circle, that is r_b delta, and the string is longer by as much.
        """
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        radius = np.maximum(np.hypot(x, y), self.base_radius)
        azimuth = np.arctan2(y, x) - self.pitch * tooth
        azimuth -= 2 * math.pi * np.round(azimuth / (2 * math.pi))
        outside = self.base_radius * (-flank * azimuth - self.half_angle(radius))
        string = np.sqrt(radius**2 - self.base_radius**2) - outside
        foot_string = np.clip(string, BELOW_BASE, self.tip_string)
        foot_z = np.clip(z, -self.face_width / 2, self.face_width / 2)
        on_flank = (foot_string == string) & (foot_z == z)
        within = (outside < 0.0) & (np.hypot(x, y) < self.tip_radius) & (foot_z == z)
        to_edge = np.linalg.norm(points - self.flank_points(foot_string, foot_z, tooth, flank), axis=-1)
        return np.where(on_flank | within, outside, to_edge)
