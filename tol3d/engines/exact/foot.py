"""What a kind of gear has to tell the kernels: the foot of a point of one flank on the other, and how gears grow."""

from typing import Any

from tol3d.engines.exact.numbers import Foot


def foot(
    own: Any,
    mate: Any,
    pose: Any,
    own_azimuth: float,
    mate_azimuth: float,
    sigma: float,
    offset: float,
    profile: float,
    face: float,
) -> Foot:
    """The foot on the mate's endless flank of a point of own flank; one variant a kind of gears.

    Args:
        own, mate: the gears' teeth.
        pose: mate from own.
        own_azimuth, mate_azimuth: of the middle of the teeth [rad], their flanks' turns included.
        sigma: side of the flanks, the same for both.
        offset: of both flanks along their normals, together [mm].
        profile, face: the point's parameters.
    """
    raise NotImplementedError


def grown(tooth: Any, scale: float) -> Any:
    """The teeth of a gear that has grown about its origin; one variant a kind."""
    raise NotImplementedError


def section(tooth: Any, share: float) -> Any:
    """The teeth with no more of the face than one section, at a share of it; one variant a kind."""
    raise NotImplementedError
