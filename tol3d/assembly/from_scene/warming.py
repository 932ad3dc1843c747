"""Parts that are warmer: every length of them grows by their coefficient of expansion.

A part grows about the origin of its frame, so that a feature at p is displaced by growth times p. Of that the datum
frame in which the feature lies has its share already, a shift: a part that grows evenly keeps its angles.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.from_scene.contributors import Effects
from tol3d.assembly.from_scene.datums import DatumFrames
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.model import Axis, Contribution, DatumFrame, Plane, Point, RoundPlane
from tol3d.system.plain import PlainContributor

Array = NDArray[np.float64]

HELD = 1e-9
"""Length of what earlier datums leave of a direction that they hold already."""


@dataclass(frozen=True)
class Warming:
    """A temperature of some parts above the reference.

    Args:
        contributor: of one component [K].
        expansions: coefficient of expansion [1/K] by part.
    """

    contributor: PlainContributor
    expansions: Mapping[str, float]


def warmed(effects: Effects, drawing: Drawing, frames: DatumFrames, warmings: Sequence[Warming]) -> None:
    """Add what temperatures do to features."""
    for own in warmings:
        columns = effects.added(own.contributor)
        for name, datums in drawing.parents():
            expansion = own.expansions.get(part_of(name), 0.0)
            if expansion == 0.0:
                continue
            frame = frames.named(part_of(name), datums)
            shift = _shift(frames.made[frame], drawing) if frame else np.zeros(3)
            matrix, size = _growth(drawing.kind(name), shift)
            contribution = Contribution(own.contributor.name, columns, expansion * matrix[:, None])
            effects.moved_by.setdefault(name, []).append(contribution)
            if size:
                larger = Contribution(own.contributor.name, columns, np.array([[expansion * size]]))
                effects.size_by.setdefault(name, []).append(larger)


def _growth(feature: FeatureUnion, shift: Array) -> tuple[Array, float]:
    """Displacement of a feature's components by a growth of 1, its datum frame shifted (3,); and of its size [mm]."""
    shape, frame = feature.shape, feature.frame
    turned = frame[:3, :3].T
    aside = turned @ (frame[:3, 3] - shift)
    match shape:
        case Point():
            return aside, 0.0
        case Plane() | RoundPlane():
            return np.array([aside[2], 0.0, 0.0]), 0.0
        case Axis():
            return np.array([aside[0], aside[1], aside[0], aside[1]]), shape.diameter or 0.0
    raise TypeError(f"{type(shape).__name__} does not say how it grows")


def _shift(frame: DatumFrame, drawing: Drawing) -> Array:
    """By what a datum frame is shifted (3,) by a growth of 1: each datum in the directions that earlier ones left."""
    shift, free = np.zeros(3), np.eye(3)
    for datum in frame.datums:
        for name in datum.features[:1]:
            own = drawing.kind(name)
            for direction in _held(own, datum.features, drawing):
                left = free @ direction
                if np.linalg.norm(left) > HELD:
                    shift = shift + left * (direction @ own.frame[:3, 3] - direction @ shift) / (left @ left)
                    free = free - np.outer(left, left) / (left @ left)
    return shift


def _held(feature: FeatureUnion, names: Sequence[str], drawing: Drawing) -> Iterator[Array]:
    """Directions (3,) in which a datum holds the place of what is toleranced to it."""
    shape, frame = feature.shape, feature.frame
    if isinstance(shape, Plane | RoundPlane):
        yield frame[:3, 2]
    elif isinstance(shape, Point):
        yield from frame[:3, :3].T
    elif len(names) == 1:
        yield from frame[:3, :2].T
    else:
        line = drawing.kind(names[1]).frame[:3, 3] - frame[:3, 3]
        yield from np.linalg.svd(line[None])[2][1:]
