"""Measuring strips of a cycloid disc, from the faces of its solid."""

from dataclasses import dataclass

import numpy as np

from tol3d.cycloid.shapes import CycloidDisc
from tol3d.solids import FaceStrip, face_strips

RIGHT_FLANK, LEFT_FLANK = "lobe 0 right flank", "lobe 0 left flank"


@dataclass(frozen=True, eq=False)
class LobeStrips:
    """Both flanks of lobe 0 in the disc's frame, clocking included; other lobes are the same, turned by lobe pitches.

    Args:
        right, left: strips; their parameter is the u of the profile that the disc is ground for.
        chord_error: of either [mm].
        flank_error: largest distance [mm] of their points from those of the profile at the same parameter.
    """

    right: FaceStrip
    left: FaceStrip
    chord_error: float
    flank_error: float


def lobe_strips(disc: CycloidDisc, steps: int) -> LobeStrips:
    """Strips with that many steps a flank; from the cache, or from the disc's solid, built for it."""
    right, left = face_strips(disc, (RIGHT_FLANK, LEFT_FLANK), steps)
    errors = (
        _off(disc, strip, turn * disc.profile.modification.rotation) for strip, turn in ((right, 1.0), (left, -1.0))
    )
    return LobeStrips(right, left, right.chord_error, max(errors))


def _off(disc: CycloidDisc, strip: FaceStrip, rotation: float) -> float:
    found = (strip.points[:, 0] + 1j * strip.points[:, 1]) * np.exp(-1j * (disc.clocking + rotation))
    x, y = disc.profile.ground.points(strip.parameter).T
    return float(np.abs(found - (x + 1j * y)).max())
