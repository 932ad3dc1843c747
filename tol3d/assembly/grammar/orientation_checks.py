"""Checks of orientation and its datums: a feature is oriented in the frame that locates it."""

from collections.abc import Iterator

import numpy as np

from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features.feature_spec import AXES
from tol3d.assembly.grammar.tolerances.location import (
    AngularitySpec,
    AxialRunOutSpec,
    CircularRunOutSpec,
    CoaxialitySpec,
    LocationSpec,
    OrientationSpec,
    PerpendicularitySpec,
    TotalRunOutSpec,
)
from tol3d.assembly.grammar.tolerances.plus_minus import PlusMinusSpec
from tol3d.assembly.grammar.zone import ZoneSpec, are_alike
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]

FLAT = ("plane", "slot")  # kinds with a normal, not an axis
SQUARE = 1e-6  # cosine; directions nearer to a right angle are perpendicular
ON_AXIS = 1e-3  # mm; rounding of drawings


def unfit_orientations(scene: Scene) -> Iterator[Problem]:
    """Orientations in another frame than their feature's, in zones of another shape, or of another nominal angle."""
    drawing = Drawing(scene)
    for feature in drawing.names:
        for own in drawing.of(feature, OrientationSpec):
            if own.is_own:
                yield from _elsewhere(drawing, own)
                yield from _other_angle(drawing, own)
                if isinstance(own.spec, AxialRunOutSpec):
                    yield from _without_axis(drawing, own)
        for own in drawing.of(feature, LocationSpec):
            if own.is_own and isinstance(own.spec, CoaxialitySpec | CircularRunOutSpec | TotalRunOutSpec):
                yield from _without_axis(drawing, own)
                yield from _beside(drawing, own)


def _elsewhere(drawing: Drawing, own: Stated) -> Iterator[Problem]:
    spec = own.spec
    assert isinstance(spec, OrientationSpec)
    for located in (*drawing.of(own.feature, LocationSpec), *drawing.of(own.feature, PlusMinusSpec)):
        datums = located.spec.named_datums
        if datums[: len(spec.datums)] != spec.datums:
            here, there = (_words(each) or "those of its part" for each in (spec.datums, datums))
            words = f"expected the first datums of {located.entry!r}, in whose frame it lies ({there}), got {here}"
            yield ("tolerances", own.entry, "datums"), f"{words}; {_instead(drawing, own, located)}"
    yield from _unfit_shape(drawing, own, spec.zone)


def _unfit_shape(drawing: Drawing, own: Stated, zone: ZoneSpec) -> Iterator[Problem]:
    """Refuse a lean beside a circular run-out, and one that two flat zones would share."""
    located = [each for each in drawing.of(own.feature, LocationSpec) if isinstance(each.spec, LocationSpec)]
    path = ("tolerances", own.entry, "zone")
    if located and isinstance(located[0].spec, CircularRunOutSpec):
        words = f"expected none beside {located[0].entry!r}, a circular run-out, in which the axis does not lean"
        yield path, f"{words}; take it out, or write total_run_out"
    elif len(located) > 1:
        alike = [each for each in located if isinstance(each.spec, LocationSpec) and are_alike(each.spec.zone, zone)]
        if not alike:
            names = " or ".join(repr(each.entry) for each in located)
            yield path, f"expected a width along that of {names}; a lean in both of these zones is not supported"


def _instead(drawing: Drawing, own: Stated, located: Stated) -> str:
    """Name of the tolerance that limits the same tilts in the frame that locates the feature."""
    spec, datums = own.spec, located.spec.named_datums
    assert isinstance(spec, OrientationSpec)
    known = [datum.features for datum in datums]
    if not known or any(datum.features not in known for datum in spec.datums):
        return f"give {located.entry!r} datums that begin with {_words(spec.datums)}"
    first = datums[: 1 + max(known.index(datum.features) for datum in spec.datums)]
    kind = _nominal_kind(drawing, own.feature, first[0]) or spec.kind
    turns = f"which limits how {own.feature!r} leans in that frame"
    return f"write kind: {kind} with datums: [{_words(first)}] as {located.entry!r} states them, {turns}"


def _words(datums: tuple[DatumSpec, ...]) -> str:
    return ", ".join("-".join(datum.features) for datum in datums)


def _other_angle(drawing: Drawing, own: Stated) -> Iterator[Problem]:
    """Refuse a perpendicularity of a feature not nominally perpendicular to the primary datum; likewise parallelism."""
    spec = own.spec
    assert isinstance(spec, OrientationSpec)
    datum = spec.datums[0]
    kind = _nominal_kind(drawing, own.feature, datum)
    if not kind or isinstance(spec, AngularitySpec) or kind == spec.kind:
        return
    if isinstance(spec, AxialRunOutSpec) and kind == "perpendicularity":
        return
    angle = _angle(drawing, own.feature, datum)
    got = {"parallelism": "parallel", "perpendicularity": "square"}.get(kind, f"at {angle:.4g} deg")
    wanted = "square" if isinstance(spec, PerpendicularitySpec | AxialRunOutSpec) else "parallel"
    words = f"expected a feature that is nominally {wanted} to {datum.features[0]!r}, got one that is {got} to it"
    article = "an" if kind == "angularity" else "a"
    yield ("tolerances", own.entry, "of"), f"{words}; that is {article} {kind}, write kind: {kind}"


def _nominal_kind(drawing: Drawing, feature: str, datum: DatumSpec) -> str:
    """The kind of orientation that a feature has nominally to a datum; "" where the two have no one angle."""
    angle = _angle(drawing, feature, datum)
    if angle is None:
        return ""
    near = np.degrees(SQUARE)
    return "parallelism" if angle <= near else "perpendicularity" if angle >= 90.0 - near else "angularity"


def _angle(drawing: Drawing, name: str, datum: DatumSpec) -> float | None:
    """Nominal angle of a feature to a datum, 0 to 90 deg; None for rings, points and unknown features."""
    feature, other = drawing.kind(name), drawing.features[part_of(name)].get(datum.features[0])
    if len(datum.features) > 1 or other is None or other is feature or {"point", "sphere"} & {other.kind, feature.kind}:
        return None  # unknown, a ring, of the wrong kind: reported already
    along = abs(float(feature.frame[:3, 2] @ other.frame[:3, 2]))
    normals = (feature.kind in FLAT) == (other.kind in FLAT)  # else an axis and a normal: parallel means perpendicular
    angle = float(np.degrees(np.arccos(min(along, 1.0))))
    return angle if normals else 90.0 - angle


def _without_axis(drawing: Drawing, own: Stated) -> Iterator[Problem]:
    features = drawing.features[part_of(own.feature)]
    named = [features[name] for datum in own.spec.named_datums for name in datum.features if name in features]
    if named and not any(feature.kind in AXES for feature in named):
        common = any(len(datum.features) > 1 for datum in own.spec.named_datums)
        if not common:
            yield ("tolerances", own.entry, "datums"), "expected an axis among them, such as a bore or a shaft's seat"


def _beside(drawing: Drawing, own: Stated) -> Iterator[Problem]:
    """Refuse a feature that is nominally off the axis of its coaxiality or run-out."""
    features, feature = drawing.features[part_of(own.feature)], drawing.kind(own.feature)
    names = [datum.features[0] for datum in own.spec.named_datums if len(datum.features) == 1]
    axes = [name for name in names if name in features and features[name].kind in AXES]
    if len(axes) != 1 or feature.kind not in AXES:
        return  # of two it is on the line through both, if on any; a wrong kind is reported already
    frame, datum = feature.frame, features[axes[0]].frame
    off = float(np.linalg.norm(np.cross(frame[:3, 3] - datum[:3, 3], datum[:3, 2])))
    if off > ON_AXIS:
        words = f"expected a feature that is nominally on the axis of {axes[0]!r}, got one {off:.4g} mm beside it"
        yield ("tolerances", own.entry, "of"), f"{words}; that is a position"
