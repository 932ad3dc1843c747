"""Evaluation ranges: limits on a flank between which slopes and forms count.

ISO 1328-1:2013 finds the mean line of a trace in an evaluation range, and takes the slope deviation from it between the
ends of the flank, to which it is extrapolated: f_Halpha from the profile control diameter to the tip diameter, f_Hbeta
over the whole face width. The form deviation counts within the evaluation range. The profile's is the first 95 % of the
length of roll from the control diameter, which is where the active profile begins if no drawing says otherwise, to the
tip; older editions have 92 %, for slopes too. The standard itself was not available.
"""

from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.errors import GeometryError
from tol3d.gears import SpurGear
from tol3d.scene.listed import listed
from tol3d.units import Of, Quantity

FORM_SHARE: Final = 0.95
"""Fraction of the length of roll from control to tip diameter in which the form of a profile counts."""

AT_END: Final = 1e-6  # mm; of a diameter or a height that is written with some digits: so far beyond is at the end

Range = Annotated[tuple[Annotated[Quantity, Of("length")], ...], listed("lengths", 2, 2)]


@dataclass(frozen=True)
class Part:
    """A part of a flank, along the profile or along the face.

    Args:
        begin, end: of it [rad of roll, or mm].
        least, most: of the whole flank.
    """

    begin: float
    end: float
    least: float
    most: float

    @property
    def slope(self) -> tuple[float, float]:
        """Coefficients of 1 and u over the whole flank that give u over this part, -1/2 and 1/2 at its ends."""
        length = self.end - self.begin
        return (self.least + self.most - self.begin - self.end) / (2 * length), (self.most - self.least) / length

    @property
    def barrel(self) -> tuple[float, float, float]:
        """Coefficients of 1, u and 1/3 - 4 u^2 over the whole flank that give 1/3 - 4 u^2 over this part."""
        level, times = self.slope
        return (1 - times**2) / 3 - 4 * level**2, -8 * times * level, times**2


def profile_part(diameters: Range | None, gear: SpurGear, active_roll: float, share: float) -> Part:
    """The part of a profile between two diameters; or a share of that from the active profile's begin to the tip.

    Raises:
        GeometryError: the diameters do not lie on the involute, the first below the second.
    """
    least, most = gear.form_roll, gear.tip_roll
    if diameters is None:
        return Part(active_roll, active_roll + share * (most - active_roll), least, most)
    inner, outer = (diameter.internal for diameter in diameters)
    ends = 2 * gear.form_radius, 2 * gear.tip_radius
    if not ends[0] - AT_END <= inner < outer <= ends[1] + AT_END:
        raise GeometryError(
            f"range: expected two diameters from {ends[0]:.4f} mm, where the involute begins, to {ends[1]:.4f} mm, its "
            f"tip, got {inner:g} mm and {outer:g} mm"
        )
    begin, end = (gear.roll_at(min(max(own, ends[0]), ends[1]) / 2) for own in (inner, outer))
    return Part(begin, end, least, most)


def face_part(heights: Range | None, gear: SpurGear) -> Part:
    """The part of a face between two heights over its lower end, or the whole face [mm].

    Raises:
        GeometryError: the heights do not lie on the face, the first below the second.
    """
    half = gear.face_width / 2
    if heights is None:
        return Part(-half, half, -half, half)
    lower, upper = (height.internal for height in heights)
    if not -AT_END <= lower < upper <= 2 * half + AT_END:
        raise GeometryError(
            f"range: expected two heights from 0 mm, the lower end of the face, to {2 * half:g} mm, its upper end, got "
            f"{lower:g} mm and {upper:g} mm"
        )
    return Part(lower - half, upper - half, -half, half)
