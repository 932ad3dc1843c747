"""What the stack-up of a bevel pair has of its own: shaft angle and offset of the axes.

The pair is replaced by the imaginary spur pair of its back cones, read in the middle of the face.
Source: Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, 1533-1542, section 3.1, for equal gears at 90 deg;
here for any cones. Neglected: the position within a pitch (an axial or radial shift acts on the pairs of one mesh by
up to 10 % more or less, and differs by that between the gear with the tooth and the one with the space), and the
face: where contact or gap are read over the whole of it, they differ by several per cent.
"""

import math

from tol3d.analytic.stack import Role, Stack, Term
from tol3d.gears import BevelPair
from tol3d.model import AxisTilt, Contributor


class BevelStack(Stack[BevelPair]):
    """The stack-up of a bevel pair in the middle of its face."""

    def tilt(self, effect: AxisTilt, contributor: Contributor, role: Role) -> Term | None:
        """Shaft angle: 2 R_m sin(alpha) about the apex.

        About a point of the gear's axis at the distance h from the apex 2 h sin(alpha) cos(delta) less, which is
        what the shift of the apex towards the mesh takes. A turn out of the plane of the axes changes nothing.
        """
        lever = self.pair.mean_cone_distance - effect.pivot * math.cos(self.gear(role).pitch_angle)
        _, y = self.turns_of(effect, contributor, role)
        per_turn = -2 * self.sin * lever
        if len(y) == 1:
            return Term(contributor, per_turn * float(y[0]))
        return Term(contributor, per_turn * math.hypot(*y), along=math.atan2(y[1], y[0]))

    def axes_offset(self, contributor: Contributor, role: Role) -> Term | None:
        """2 sin(alpha) sin(delta) of the driven gear, as the source has it for its "axial distance".

        That is what a shift along the axis does. Of an offset across both axes the geometry sees nothing in the
        middle of the face, to first order: the 3D simulation tells.
        """
        return Term(contributor, 2 * self.sin * math.sin(self.gear(role).pitch_angle))
