"""Thermal growth of parts: every length grows by the coefficient of expansion.

A part grows about the origin of its frame, so that a feature at p is displaced by growth times p. The shift of the
feature's datum frame is part of it: a part that grows evenly keeps its angles.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from tol3d.assembly.from_scene.datums import DatumFrames, frame_name
from tol3d.assembly.from_scene.effects import Drawn, Effect
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model import Datum, DatumFrame, Shape
from tol3d.numerics.arrays import Array
from tol3d.scene.temperature import TemperatureSpec
from tol3d.study.system.draw import Scalar
from tol3d.study.system.plain import UNITS, PlainContributor

SEEN = 1e-6
"""Change of what a datum asks by a motion of length 1 that is none."""
HELD = 1e-9
"""Length of the free part of a direction that earlier datums hold."""


def growth(drawing: Drawing, frames: DatumFrames) -> Iterator[Drawn]:
    """Part temperatures, with their effects on features.

    Raises:
        SceneError: datums that turn as their part grows.
    """
    scene, solids = drawing.scene, drawing.scene.of(SolidSpec)
    for entry, spec in scene.of(TemperatureSpec).items():
        grown = {part: solids[part].expansion for part in spec.of if part in solids}
        expansions = {part: own.internal for part, own in grown.items() if own is not None}
        if not expansions:
            continue
        draw = Scalar(spec.distribution.resolve(scene.files))
        effects = list[Effect]()
        for name, datums in drawing.parents():
            expansion = expansions.get(part_of(name), 0.0)
            if expansion == 0.0:
                continue
            frame = frame_name(part_of(name), datums)
            if frame and np.linalg.norm(_turn(frames.made[frame], drawing)) > HELD:
                own = " | ".join("-".join(datum.features) for datum in datums)
                words = f"expected datums that a part which grows evenly keeps upright, got {own} of {name!r}"
                advice = "a pattern at several depths leans as it grows, a slot that misses its hole turns"
                raise scene.refuse(
                    ("tolerances", entry, "of"), f"{words}: {advice}; name a plane or another datum first"
                )
            shift = _shift(frames.made[frame], drawing) if frame else np.zeros(3)
            turn = drawing.kind(name).frame[:3, :3]
            matrix = expansion * turn.T @ (_grown(drawing.kind(name)) - shift)
            effects.append(Effect("grown_by", name, matrix[:, None]))
            if size := drawing.kind(name).shape.nominal_size:
                effects.append(Effect("size_by", name, np.array([[expansion * size]])))
        contributor = PlainContributor(entry, spec.kind, draw, *UNITS["temperature"], spec.description, nominal="")
        yield Drawn(contributor, tuple(effects))


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
        parts = np.split(across.T[taken], np.cumsum([len(row) for row in rows])[:-1], axis=1)
        off = (part @ own @ (_grown(f) - shift) for part, own, f in zip(parts, rows, features, strict=False))
        missing = sum(off, start=np.zeros(len(taken)))
        shift = shift + along[taken].T @ (missing / lengths[taken])
        free = free - along[taken].T @ along[taken]
    return shift


def _grown(feature: FeatureUnion) -> Array:
    """The point (3,) by whose growth a feature moves [mm]: its middle, of a cone its apex."""
    return np.asarray(feature.frame[:3, 3] + feature.shape.growth_centre * feature.frame[:3, 2])


def _turn(frame: DatumFrame, drawing: Drawing) -> Array:
    """Turn of a datum frame (3,) per growth of 1: what its datums ask in order, by least squares of what is left."""
    features = [[drawing.kind(name) for name in datum.features] for datum in frame.datums]
    reach = max(1.0, *(float(np.linalg.norm(own.frame[:3, 3])) for some in features for own in some))
    left, found = np.eye(6), np.zeros(6)  # shift of the origin, turn times reach
    for datum, some in zip(frame.datums, features, strict=True):
        for rows, values in _asked(datum, some, reach, left):
            across, lengths, along = np.linalg.svd(rows @ left)
            count = int(np.sum(lengths > SEEN))
            missing = across[:, :count].T @ (values - rows @ found) / lengths[:count]
            found, left = found + left @ along[:count].T @ missing, left @ along[count:].T
    free = left[3:] @ left[3:].T  # what no datum holds turns least
    return np.asarray((found[3:] - free @ np.linalg.pinv(free, SEEN) @ found[3:]) / reach)


def _asked(datum: Datum, features: Sequence[FeatureUnion], reach: float, left: Array) -> Iterator[tuple[Array, Array]]:
    """Equations that a datum asks (equations, 6), and their values, of a part that grows by 1."""

    def rows(place: Array, ways: Array) -> Array:
        return np.hstack([ways, np.cross(place, ways) / reach])

    def turns(ways: Array) -> tuple[Array, Array]:
        return np.hstack([np.zeros((2, 3)), ways]), np.zeros(2)

    own, frame = features[0], features[0].frame
    place, sides = frame[:3, 3], frame[:3, :2].T
    if datum.simulator == "pattern":
        ways = [feature.frame[:3, feature.shape.located].T for feature in features]
        ends = [[feature.frame[:3, :3] @ end for end in feature.shape.ends] for feature in features]
        places = [(each.frame[:3, 3], way, some) for each, way, some in zip(features, ways, ends, strict=True)]
        every = [rows(at + end, way) for at, way, some in places for end in some]
        yield np.concatenate(every), np.concatenate([way @ at for at, way, some in places for _ in some])
    elif len(features) > 1:
        place = np.mean([feature.frame[:3, 3] for feature in features], axis=0)
        sides = np.linalg.svd((features[-1].frame[:3, 3] - frame[:3, 3])[None])[2][1:]
        yield rows(place, sides), sides @ place
        yield turns(sides)
    elif datum.targets is not None:
        for target in datum.targets:
            yield rows(frame[:3, :3] @ target + place, frame[:3, 2:3].T), frame[:3, 2:3].T @ place
    else:
        held, turning = own.shape.asks
        asked = [(rows(place, _sides(own)), _sides(own) @ _grown(own)), turns(sides)][: 1 if turning == "none" else 2]
        by_place = held != "along" or _by_place(np.concatenate([asked[0][0], asked[1][0] / reach]) @ left, own.shape)
        yield from asked if by_place else asked[::-1]


def _by_place(moved: Array, shape: Shape) -> bool:
    """True of a slot or tab if one motion is left, which moves its middle more than its ends over that."""
    if shape.nominal_size is None:
        return False
    away, about_x, about_y = np.abs(moved).max(axis=1, initial=0.0)
    alone = np.linalg.matrix_rank(moved, tol=SEEN) == 1
    return bool(alone and away > shape.reach[1] * about_x + shape.reach[0] * about_y - SEEN)


def _held(feature: FeatureUnion, names: Sequence[str], drawing: Drawing) -> Array:
    """Directions (directions, 3) in which a datum holds the place of what is toleranced to it."""
    frame = feature.frame
    if len(names) == 2:
        line = drawing.kind(names[1]).frame[:3, 3] - frame[:3, 3]
        return np.asarray(np.linalg.svd(line[None])[2][1:])
    return _sides(feature)


def _sides(feature: FeatureUnion) -> Array:
    """Directions (directions, 3) in which a feature's own place is held."""
    return feature.frame[:3, feature.shape.held].T
