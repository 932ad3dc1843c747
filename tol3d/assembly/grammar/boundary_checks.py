"""Checks of datums at their material boundaries: orientation of the gauge, and a size."""

from collections.abc import Iterator, Sequence

import numpy as np

from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features.feature_spec import AXES, SIZED
from tol3d.assembly.grammar.measures.assembly_measure import FeatureMeasureSpec
from tol3d.assembly.grammar.measures.inspected import (
    InspectedPatternSpec,
    InspectedPositionSpec,
    InspectedSetSpec,
    InspectedTogetherSpec,
)
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance, Modified
from tol3d.assembly.grammar.tolerances.location import Composite, LocationSpec, OrientationSpec
from tol3d.assembly.grammar.tolerances.plus_minus import PlusMinusSpec, SizeSpec
from tol3d.assembly.grammar.zone import are_alike
from tol3d.assembly.model.datum_frame import Modifier
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]

SQUARE = 1e-6  # sine of the angle of the axis to the normal


def unfit_boundaries(scene: Scene) -> Iterator[Problem]:
    """Datums at their boundary without orientation or size, or in the frame of a measure."""
    drawing = Drawing(scene)
    for name, spec in scene.tolerances.items():
        if isinstance(spec, FeatureTolerance):
            for k, datum in enumerate(spec.named_datums):
                if datum.gauge is not None:
                    place: KeyPath = ("tolerances", name, "datums")
                    yield from _unfit(drawing, part_of(spec.of), spec.named_datums, k, place)
                    if datum.gauge == "least":
                        key = datum.key
                        yield place, f"expected {key}: random or {key}: centred, for least is of what is inspected"
    for name, measure in scene.measures.items():
        if isinstance(measure, FeatureMeasureSpec):
            yield from _of_measure(drawing, name, measure)


def _of_measure(drawing: Drawing, name: str, spec: FeatureMeasureSpec) -> Iterator[Problem]:
    place: KeyPath = ("measures", name, "datums")
    for k, datum in enumerate(spec.named_datums):
        if datum.gauge is None:
            continue
        if not isinstance(spec, InspectedPositionSpec | InspectedTogetherSpec) or datum.gauge != "least":
            yield place, f"expected datums without {datum.key}, or {datum.key}: least of what is inspected"
            continue
        yield from _unfit(drawing, part_of(spec.of_what[0]), spec.named_datums, k, place)
        across = isinstance(spec, InspectedPositionSpec) and spec.across is not None
        for path, own, _ in spec.named():
            if own in drawing.names and (wrong := _unread(drawing, own, across)):
                yield ("measures", name, *path), wrong


def _unread(drawing: Drawing, of: str, across: bool) -> str | None:
    """A feature that a position over places of gauges cannot be of, in words; of a point it is `across` a direction."""
    kind = drawing.kind(of)
    flat = kind.kind == "plane" and kind.extent is not None
    if kind.kind in (*AXES, "slot") or flat or (kind.kind == "point" and across):
        return None
    return f"expected a hole, pin, axis, cone, slot, flat rectangle or a point with `across`, got {of!r}"


def is_square(normal: Array, axis: Array) -> bool:
    """True if an axis is perpendicular to a plane."""
    return float(np.linalg.norm(np.cross(normal, axis))) < SQUARE


def shifts_alone(drawing: Drawing, part: str, datums: Sequence[DatumSpec]) -> bool:
    """True if the gauge of the last datum only shifts: its hole or pin is perpendicular to the orienting plane."""
    known = drawing.features[part]
    gauged = [datum.gauge is not None for datum in datums]
    if gauged != [False, True] or any(datum.is_several for datum in datums):
        return False
    if not _has_place(drawing, f"{part}.{datums[1].features[0]}"):
        return False  # nothing orients it to the plane
    plane, hole = (known.get(datum.features[0]) for datum in datums)
    if plane is None or hole is None or (plane.kind, hole.kind) != ("plane", "cylinder"):
        return False
    return is_square(plane.frame[:3, 2], hole.frame[:3, 2])


def earlier_zone(
    drawing: Drawing, feature: str, datums: Sequence[DatumSpec], k: int
) -> tuple[float, Modifier | None] | None:
    """Width of the zone of a feature of a datum at its precedence [mm], and what widens it.

    It is 0 without any tolerance of the place, None with others alone.

    It is its location zone to just the datums before it, whatever their modifiers; if these only orient it, as a plane
    perpendicular to it does, its orientation zone to them. One of several features has its location zone, to whatever
    datums, or the lower segment of that to just the datums before it: these hold the features to each other.

    Args:
        drawing: of the scene.
        feature: with its part.
        datums: of the frame.
        k: the number of the datum.
    """
    located = [own.spec for own in drawing.of(feature, LocationSpec) if isinstance(own.spec, LocationSpec)]
    earlier = datums[:k]
    if not _has_place(drawing, feature) or (k == 0 and not datums[k].is_several):
        return 0.0, None
    if datums[k].is_several and located:
        lower = located[0].lower_segment if isinstance(located[0], Composite) else None
        to_these = lower is not None and _names(lower.datums or ()) == _names(earlier)
        zone = lower.zone if lower is not None and to_these else located[0].zone
        return zone.size, _modifier(located[0])
    names = _names(earlier)
    location: tuple[type[FeatureTolerance], ...] = (LocationSpec,)
    orientation: tuple[type[FeatureTolerance], ...] = (OrientationSpec,)
    kinds = orientation + location if _orients_only(drawing, feature, earlier) else location
    for kind in kinds:
        for own in drawing.of(feature, kind):
            spec = own.spec
            if isinstance(spec, OrientationSpec | LocationSpec) and _names(spec.named_datums) == names:
                holding = spec if holds_all(drawing, own) else located[0]
                return holding.zone.size, _modifier(holding)
    return None


def holds_all(drawing: Drawing, own: Stated) -> bool:
    """True unless a zone of orientation limits other leans than the location zone of the same feature."""
    if not isinstance(own.spec, OrientationSpec):
        return True
    located = (other.spec for other in drawing.of(own.feature, LocationSpec))
    return all(are_alike(spec.zone, own.spec.zone) for spec in located if isinstance(spec, LocationSpec))


def _modifier(spec: FeatureTolerance) -> Modifier | None:
    return spec.modifier if isinstance(spec, Modified) else None


def _has_place(drawing: Drawing, feature: str) -> bool:
    """True if a tolerance other than of its size is of a feature: without one its gauge is of its MMC size."""
    kinds: tuple[type[FeatureTolerance], ...] = (LocationSpec, OrientationSpec, PlusMinusSpec)
    return any(drawing.of(feature, kind) for kind in kinds)


def _names(datums: Sequence[DatumSpec]) -> list[tuple[str, ...]]:
    return [datum.features for datum in datums]


def _orients_only(drawing: Drawing, feature: str, earlier: Sequence[DatumSpec]) -> bool:
    """True if datums leave a feature free across itself: they are one plane perpendicular to it."""
    plane = drawing.features[part_of(feature)].get(earlier[0].features[0]) if earlier else None
    own = drawing.kind(feature)
    if len(earlier) != 1 or plane is None or plane.kind != "plane":
        return False
    normal, z = plane.frame[:3, 2], own.frame[:3, 2]
    return is_square(normal, z) if own.kind == "cylinder" else abs(float(normal @ z)) < SQUARE


def _unfit(drawing: Drawing, part: str, datums: tuple[DatumSpec, ...], k: int, place: KeyPath) -> Iterator[Problem]:
    for feature in datums[k].features:
        yield from _unfit_feature(drawing, f"{part}.{feature}", datums, k, place)


def _unfit_feature(
    drawing: Drawing, own: str, datums: tuple[DatumSpec, ...], k: int, place: KeyPath
) -> Iterator[Problem]:
    part = part_of(own)
    if own not in drawing.names or drawing.kind(own).kind not in ("cylinder", "slot"):
        return  # reported already
    between = [
        own for own, after in zip(datums[k + 1 :], datums[k + 2 :], strict=False) if own.gauge is None and after.gauge
    ]
    later = [datum for datum in datums[k + 1 :] if datum.gauge is None]
    unfit = [name for own in later for name in own.features if own.is_several or not _may_be_later(drawing, part, name)]
    to = ", ".join("-".join(earlier.features) for earlier in datums[:k])
    if between:
        words = f"expected datums at their boundary next to each other, got {between[0].features[0]!r} after {own!r}"
        yield place, f"{words}; give it {datums[k].key} as well, or name it first or last"
    elif unfit:
        words = f"expected one face, hole, pin, axis or slot after {own!r} at its boundary, got {unfit[0]!r}"
        yield place, f"{words}; give it {datums[k].key} as well, or name it first"
    elif len({before.gauge for before in datums[: k + 1] if before.gauge is not None}) > 1:
        yield place, "expected one mmb (or lmb) for all datums of a frame, for their gauges are of one piece"
    elif not drawing.of(own, SizeSpec):
        yield place, f"expected a tolerance of the size of {own!r}, which makes the gauge's room; add one of kind size"
    elif shifts_alone(drawing, part, datums):
        if drawing.of(own, PlusMinusSpec) or drawing.datums(own)[:1] != datums[:1]:
            words = f"expected a zone of {own!r} to {datums[0].features[0]!r} first, for that orients the gauge"
            yield place, f"{words}; add a position or perpendicularity to it"
    elif earlier_zone(drawing, own, datums, k) is None:
        words = f"expected a zone of {own!r} to {to}, which makes its virtual condition there"
        yield place, f"{words}; add a position to these datums, or an orientation"


def _may_be_later(drawing: Drawing, part: str, name: str) -> bool:
    return f"{part}.{name}" not in drawing.names or drawing.kind(f"{part}.{name}").kind in (*SIZED, "plane", "axis")


def unfit_modifiers(scene: Scene) -> Iterator[Problem]:
    """Modifiers of features without a size or a tolerance of it, and two that differ on one feature."""
    drawing = Drawing(scene)
    for own in drawing.stated:
        if isinstance(own, Stated) and own.is_own and isinstance(own.spec, Modified):
            yield from _of_tolerance(drawing, own, own.spec)
    sized = {name for name in drawing.names if drawing.kind(name).kind in SIZED}  # others are reported already
    for name, spec in scene.measures.items():
        if (
            isinstance(spec, InspectedPositionSpec | InspectedPatternSpec | InspectedSetSpec | InspectedTogetherSpec)
            and spec.modifier is not None
        ):
            for own in (feature for _, feature, _ in spec.named() if feature in sized):
                yield from _unsized(drawing, own, ("measures", name, "modifier"), spec.modifier)


def _of_tolerance(drawing: Drawing, own: Stated, spec: Modified) -> Iterator[Problem]:
    place: KeyPath = ("tolerances", own.entry, "modifier")
    if spec.modifier is None or own.feature not in drawing.names:
        return
    yield from _unsized(drawing, own.feature, place, spec.modifier)
    if isinstance(own.spec, OrientationSpec):
        for located in drawing.of(own.feature, LocationSpec):
            other = located.spec.modifier if isinstance(located.spec, Modified) else None
            if other is not None and other != spec.modifier:
                yield place, f"expected that of {located.entry!r}, {other}, or none, got {spec.modifier}"


def _unsized(drawing: Drawing, feature: str, place: KeyPath, modifier: str) -> Iterator[Problem]:
    if drawing.kind(feature).kind not in SIZED:
        words = drawing.kind(feature).words
        yield place, f"expected none, for {feature!r} is {words}, whose zone is not widened by a size, got {modifier}"
    elif not drawing.of(feature, SizeSpec):
        words = f"expected a tolerance of the size of {feature!r}, from which the bonus counts, got none"
        yield place, f"{words}; add one of kind size"
