"""What is ground off the profile of a cycloid disc so that its lobes run among the pins with clearance."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Modification:
    """By how much the grinding departs from the profile that touches every pin.

    First-order clearance between a flank and its pin, along the normal, at the phase t of the pin:
    offset - shift cos(alpha) + rotation |lever|, where cos(alpha) = (1 - K cos t) / sqrt(1 + K^2 - 2 K cos t) is that
    of the angle between the normal and the radius to the pin. Shift and offset of one sign work against each other;
    offset = shift sqrt(1 - K^2) < 0 leaves no clearance at cos t = K, where the lever is largest, and some elsewhere.

    Args:
        shift: added to the radius of the pin circle that the profile is ground for [mm]; negative takes material off.
        offset: added to the radius of the pins that it is ground for [mm]; positive takes material off.
        rotation: of either flank about the disc's axis, towards the middle of its lobe [rad]; positive takes material
            off. The lobe's tip and the root between two lobes become corners.
    """

    shift: float = 0.0
    offset: float = 0.0
    rotation: float = 0.0


UNMODIFIED: Final = Modification()
