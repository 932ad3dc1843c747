"""Projected zones: an axis is judged where what is screwed into its hole stands out, not in the hole.

The projected part of an axis begins at its end along +z, and is as long as the zone says. ISO 10578, ASME Y14.5.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Axis, Contribution, Feature

Array = NDArray[np.float64]


def projected_name(feature: str, length: float) -> str:
    """The name of the projected part of an axis; scenes cannot name one so."""
    return f"{feature}..{length:.9g} mm beyond"


def projected(feature: Feature, length: float) -> Feature:
    """The projected part of an axis, of some length [mm], as a feature of its own."""
    assert isinstance(feature.shape, Axis)
    frame = feature.frame.copy()
    frame[:3, 3] += (feature.shape.length + length) / 2 * frame[:3, 2]
    share = length / feature.shape.length
    ends = _at_ends(0.0, 1.0, -share, 1.0 + share)
    moved_by = tuple(Contribution(own.contributor, own.columns, ends @ own.matrix) for own in feature.moved_by)
    name, shape = projected_name(feature.name, length), replace(feature.shape, length=length)
    return replace(feature, name=name, shape=shape, frame=frame, moved_by=moved_by, is_named=False)


def seen_from_projected(own_length: float, length: float) -> Array:
    """(4, 4): components of the projected part of an axis -> those of the axis itself, both lengths in mm."""
    share = own_length / length
    return _at_ends(1.0 + share, -share, 1.0, 0.0)


def _at_ends(start_by_start: float, start_by_end: float, end_by_start: float, end_by_end: float) -> Array:
    """Ends of one piece of a straight line by those of another, x and y alike."""
    return np.kron(np.array([[start_by_start, start_by_end], [end_by_start, end_by_end]]), np.eye(2))
