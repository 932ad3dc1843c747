"""What must hold of orientation and its datums: it is toleranced in the frame in which its feature lies."""

from collections.abc import Iterator

import numpy as np

from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features.nominal_frame import is_across
from tol3d.assembly.grammar.tolerances import (
    AngularitySpec,
    CircularRunOutSpec,
    CoaxialitySpec,
    LocationSpec,
    OrientationSpec,
    PerpendicularitySpec,
    PlusMinusSpec,
    TotalRunOutSpec,
)
from tol3d.assembly.grammar.zone import ZoneSpec
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]

FLAT = ("plane", "slot")  # kinds with a normal, not an axis
SQUARE = 1e-6  # cosine; directions nearer to a right angle are square to each other


def unfit_orientations(scene: Scene) -> Iterator[Problem]:
    """Orientations in another frame than their feature's, in zones of another shape, or of another nominal angle."""
    drawing = Drawing(scene)
    for feature in drawing.names:
        for own in drawing.of(feature, OrientationSpec):
            if own.name == own.entry:
                yield from _elsewhere(drawing, own)
                yield from _other_angle(drawing, own)
        for own in drawing.of(feature, LocationSpec):
            if own.name == own.entry and isinstance(own.spec, CoaxialitySpec | CircularRunOutSpec | TotalRunOutSpec):
                yield from _without_axis(drawing, own)


def _elsewhere(drawing: Drawing, own: Stated) -> Iterator[Problem]:
    spec = own.spec
    assert isinstance(spec, OrientationSpec)
    for located in (*drawing.of(own.feature, LocationSpec), *drawing.of(own.feature, PlusMinusSpec)):
        datums = located.spec.named_datums
        if datums[: len(spec.datums)] != spec.datums:
            here, there = (_words(each) or "those of its part" for each in (spec.datums, datums))
            words = (
                f"expected the first datums of {located.entry!r}, in whose frame it lies ({there}), got {here}; "
                f"give {located.entry!r} datums that begin with {here}"
            )
            yield ("tolerances", own.entry, "datums"), words
        elif isinstance(located.spec, LocationSpec) and not _alike(located.spec.zone, spec.zone):
            words = (
                f"expected a zone of the shape of {located.entry!r}, which it refines: a diameter, or a width `along`"
            )
            yield ("tolerances", own.entry, "zone"), words


def _words(datums: tuple[DatumSpec, ...]) -> str:
    return ", ".join("-".join(datum.features) for datum in datums)


def _alike(zone: ZoneSpec, other: ZoneSpec) -> bool:
    """Whether both zones are round, or both flat along one direction."""
    if (zone.diameter is None) != (other.diameter is None) or (zone.along is None) != (other.along is None):
        return False
    return zone.along is None or other.along is None or not is_across(zone.along, other.along)


def _other_angle(drawing: Drawing, own: Stated) -> Iterator[Problem]:
    """A perpendicularity of what is not square to the primary datum nominally, or a parallelism of what is."""
    spec = own.spec
    assert isinstance(spec, OrientationSpec)
    datum = spec.datums[0]
    features = drawing.features[part_of(own.feature)]
    if isinstance(spec, AngularitySpec) or len(datum.features) > 1:
        return
    feature, other = drawing.kind(own.feature), features.get(datum.features[0])
    if other is None or other is feature or {"point", "sphere"} & {other.kind, feature.kind}:
        return  # unknown, a ring, of the wrong kind: said already
    along = abs(float(feature.frame[:3, 2] @ other.frame[:3, 2]))
    normals = (feature.kind in FLAT) == (other.kind in FLAT)  # else an axis and a normal: parallel is square
    angle = float(np.degrees(np.arccos(min(along, 1.0))))
    angle = angle if normals else 90.0 - angle
    if abs(angle - (90.0 if isinstance(spec, PerpendicularitySpec) else 0.0)) > np.degrees(SQUARE):
        words = f"expected a feature that is nominally so to {datum.features[0]!r}, got one at {angle:.4g} deg to it"
        yield ("tolerances", own.entry, "of"), f"{words}; that is an angularity"


def _without_axis(drawing: Drawing, own: Stated) -> Iterator[Problem]:
    features = drawing.features[part_of(own.feature)]
    named = [features[name] for datum in own.spec.named_datums for name in datum.features if name in features]
    if named and not any(feature.kind in ("axis", "cylinder") for feature in named):
        common = any(len(datum.features) == 2 for datum in own.spec.named_datums)
        if not common:
            yield ("tolerances", own.entry, "datums"), "expected an axis among them, such as a bore or a shaft's seat"
