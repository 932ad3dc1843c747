"""Common base of spur and bevel gears: refused sizes, reference circle, flanks that deviate."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Final, Self

from tol3d.errors import GeometryError

PRESSURE_ANGLES: Final = (5, 45)  # deg


@dataclass(frozen=True)
class ToothedGear:
    """A gear, whatever its teeth; arguments as in its kinds. Lengths in mm, angles in rad."""

    teeth: int
    module: float
    pressure_angle: float
    face_width: float

    lengths: ClassVar[tuple[str, ...]] = ("module", "face_width")
    """Lengths that grow with the gear, apart from thickness deviations."""

    @property
    def tooth_thickness_deviation(self) -> float:
        """Added to the nominal arc at the reference circle [mm]."""
        raise NotImplementedError

    def _refuse_sizes(self, angles: Mapping[str, tuple[float, float]]) -> None:
        """Refuse too few teeth, sizes not above 0, and angles out of their limits [deg]."""
        if self.teeth < 3:
            raise GeometryError(f"teeth: expected at least 3, got {self.teeth}")
        for name in ("module", "face_width"):
            if not getattr(self, name) > 0.0:
                raise GeometryError(f"{name}: expected more than 0 mm, got {getattr(self, name):g} mm")
        for name, (low, high) in angles.items():
            degrees = math.degrees(getattr(self, name))
            if not low <= degrees <= high:
                raise GeometryError(f"{name}: expected {low} to {high} deg, got {degrees:g} deg")

    @property
    def reference_radius(self) -> float:
        """r = m z/2 [mm]; of a bevel gear on the pitch cone at the outer end."""
        return self.module * self.teeth / 2

    @property
    def reference_diameter(self) -> float:
        """d = m z [mm]; of a bevel gear on the pitch cone at the outer end."""
        return self.module * self.teeth

    @property
    def angular_pitch(self) -> float:
        """2 pi/z [rad], about the axis."""
        return 2 * math.pi / self.teeth

    @property
    def deviation_radius(self) -> float:
        """Radius [mm] at which `tooth_thickness_deviation` is an arc: the reference circle."""
        return self.reference_radius

    def perturbed(self, flank_turn: float, scale: float) -> Self:
        """The gear with its flanks turned out of their teeth [rad], and grown; a bevel gear grows about its apex.

        Raises:
            GeometryError: such a gear cannot be made.
        """
        thicker = self.tooth_thickness_deviation + 2 * self.deviation_radius * flank_turn
        lengths = {name: getattr(self, name) for name in self.lengths}
        grown = {name: length * scale for name, length in lengths.items() if length is not None}
        return replace(self, **grown | {"tooth_thickness_deviation": thicker * scale})
