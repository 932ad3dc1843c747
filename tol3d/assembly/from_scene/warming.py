"""Thermal growth of parts: every length grows by the coefficient of expansion.

A part grows about the origin of its frame, so that a feature at p is displaced by growth times p. The shift of the
feature's datum frame is part of it: a part that grows evenly keeps its angles.
"""

from collections.abc import Sequence

import numpy as np

from tol3d.assembly.from_scene.contributors import Effects
from tol3d.assembly.from_scene.datums import DatumFrames
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model import Axis, Cone, Contribution, DatumFrame, Point
from tol3d.assembly.model.feature import nominal_size
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.scene.temperature import TemperatureSpec
from tol3d.system.draw import Scalar
from tol3d.system.plain import UNITS, PlainContributor

HELD = 1e-9
"""Length of the free part of a direction that earlier datums hold."""


def warmed(effects: Effects, scene: Scene, drawing: Drawing, frames: DatumFrames) -> None:
    """Add the effect of part temperatures on their features."""
    solids = scene.of(SolidSpec)
    for entry, spec in scene.of(TemperatureSpec).items():
        grown = {part: solids[part].expansion for part in spec.of if part in solids}
        expansions = {part: own.internal for part, own in grown.items() if own is not None}
        if not expansions:
            continue
        draw = Scalar(spec.distribution.resolve(scene.files))
        columns = effects.added(PlainContributor(entry, spec.kind, draw, *UNITS["temperature"], spec.description))
        for name, datums in drawing.parents():
            expansion = expansions.get(part_of(name), 0.0)
            if expansion == 0.0:
                continue
            frame = frames.named(part_of(name), datums)
            shift = _shift(frames.made[frame], drawing) if frame else np.zeros(3)
            turn = drawing.kind(name).frame[:3, :3]
            matrix = expansion * turn.T @ (_grown(drawing.kind(name)) - shift)
            effects.grown_by.setdefault(name, []).append(Contribution(entry, columns, matrix[:, None]))
            if size := nominal_size(drawing.kind(name).shape):
                larger = Contribution(entry, columns, np.array([[expansion * size]]))
                effects.size_by.setdefault(name, []).append(larger)


def _shift(frame: DatumFrame, drawing: Drawing) -> Array:
    """Shift of a datum frame (3,) per growth of 1: each datum in the directions that earlier ones left."""
    shift, free = np.zeros(3), np.eye(3)
    for datum in frame.datums:
        features = [drawing.kind(name) for name in datum.features]
        if datum.simulator == "pattern":
            rows = [_held(own, (name,), drawing) for own, name in zip(features, datum.features, strict=True)]
        else:
            rows = [_held(features[0], datum.features, drawing)]
        held = np.concatenate(rows)
        across, lengths, along = np.linalg.svd(held @ free)
        taken = np.flatnonzero(lengths > HELD)
        parts = np.split(across.T[taken], np.cumsum([len(own) for own in rows])[:-1], axis=1)
        off = (part @ own @ (_grown(f) - shift) for part, own, f in zip(parts, rows, features, strict=False))
        missing = sum(off, start=np.zeros(len(taken)))
        shift = shift + along[taken].T @ (missing / lengths[taken])
        free = free - along[taken].T @ along[taken]
    return shift


def _grown(feature: FeatureUnion) -> Array:
    """The point (3,) by whose growth a feature moves [mm]: its middle, of a cone its apex."""
    shape, frame = feature.shape, feature.frame
    return np.asarray(frame[:3, 3] + (shape.apex if isinstance(shape, Cone) else 0.0) * frame[:3, 2])


def _held(feature: FeatureUnion, names: Sequence[str], drawing: Drawing) -> Array:
    """Directions (directions, 3) in which a datum holds the place of what is toleranced to it."""
    shape, frame = feature.shape, feature.frame
    if len(names) == 2:
        line = drawing.kind(names[1]).frame[:3, 3] - frame[:3, 3]
        return np.asarray(np.linalg.svd(line[None])[2][1:])
    if isinstance(shape, Point | Cone):
        return frame[:3, :3].T
    return frame[:3, :2].T if isinstance(shape, Axis) else frame[:3, 2:3].T
