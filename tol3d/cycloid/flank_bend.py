"""What the analytic road of a cycloid stage neglects: the path of pin centres bends.

The road takes every gap along the normal of the place where the pin nominally is. Deviations, the turn and the
profile's shift put the pin D off that place along the path, whose curvature kappa then leaves kappa D^2/2 more.
Near roots of lobes the path bends sharply: with K = 0.77 and 40 pins its concave radius is half a millimetre where the
lever is 0.7 of the largest. Of D the shift's part stays while deviations shrink, so that products of it with deviations
are of first order in these.
"""

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.deviated import Deviated
from tol3d.cycloid.linear import LinearStage

Array = NDArray[np.float64]


def along_flank(
    stage: LinearStage, deviated: Deviated, phis: Array, places: NDArray[np.int64], turns: Array
) -> tuple[Array, Array, Array]:
    """How far pins stand along the path by deviations and turn, and by the shift [mm], and a factor [rad/mm^2].

    The factor times the square of the sum of both is what the bend adds to the turn; all are (trials,).

    Args:
        stage: the cycloid stage.
        deviated: of the trials.
        phis, places, turns: crank angle [rad], pin that touches and turn of each trial (trials,), see FirstTouches.
    """
    profile = stage.profile
    disc, pin = np.divmod(places, profile.pins)
    azimuths = 2 * np.pi * pin / profile.pins
    towards = np.exp(1j * (phis + 2 * np.pi * disc / stage.discs))
    u = azimuths + (phis + 2 * np.pi * disc / stage.discs) / profile.lobes
    normal = (profile.cos_normal(u) - 1j * profile.sin_normal(u)) * np.exp(1j * azimuths)
    moved, turned = stage.placed(deviated, disc, phis)
    rows, lobe = np.arange(len(phis)), np.floor(u / profile.lobe_pitch).astype(np.int64) % profile.lobes
    pins = (deviated.pins[rows, pin, 0] + 1j * deviated.pins[rows, pin, 1]) * np.exp(1j * azimuths)
    pitch = deviated.lobe_pitch[rows, disc, lobe] * profile.shortening / profile.pitch_radius
    arm = profile.pin_circle_radius * np.exp(1j * azimuths) - profile.eccentricity * towards
    rolled = turns * stage.rolling * profile.eccentricity * towards
    apart = pins - moved - 1j * (rolled + (turns + turned + pitch) * arm)
    bend = profile.path_curvature(u) / 2 / (-profile.lever(u) * (1 + stage.rolling / profile.lobes))
    return (np.conj(1j * normal) * apart).real, -profile.modification.shift * profile.sin_normal(u), bend
