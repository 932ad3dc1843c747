"""The zone of a feature with all its refinements, and the draw by its law."""

import math
from dataclasses import dataclass, replace

import numpy as np

from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.features import (
    ConeSpec,
    CylinderSpec,
    FeatureUnion,
    PlaneSpec,
    PointSpec,
    SlotSpec,
    SphereSpec,
)
from tol3d.assembly.grammar.features.feature_spec import AXES
from tol3d.assembly.grammar.features.nominal_frame import Triple, unit
from tol3d.assembly.grammar.tolerances.feature_tolerance import Modified
from tol3d.assembly.grammar.tolerances.location import (
    CircularRunOutSpec,
    Composite,
    LocationSpec,
    OrientationSpec,
    ProfileSpec,
    TotalRunOutSpec,
    is_of_round_surface,
)
from tol3d.assembly.grammar.tolerances.plus_minus import SizeSpec
from tol3d.assembly.grammar.zone import LawSpec, RingLawSpec, ZoneSpec, are_alike
from tol3d.assembly.model import Contribution, Feature
from tol3d.assembly.model.datum_frame import Modifier
from tol3d.assembly.zones import (
    Bonus,
    Confined,
    Envelope,
    JudgedProcess,
    Process,
    SizedBy,
    Widened,
    Zone,
    ZoneDraw,
    catalogue,
)
from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.import_path import named
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene

LEAST_SINE = 1e-9
"""Sine of an angle from the axis; a direction nearer to it has no direction across."""


def drawn_in(scene: Scene, own: Stated, drawing: Drawing) -> tuple[ZoneDraw, Array]:
    """The draw of a zone's deviations, and the matrix to the feature's components (its components, the draw's).

    Raises:
        SceneError: the zone does not fit the feature.
    """
    spec = own.spec
    assert isinstance(spec, LocationSpec | OrientationSpec)
    assert spec.law is not None
    feature = drawing.kind(own.feature)
    if isinstance(spec.law, RingLawSpec):
        _refuse_no_ring(scene, own, drawing)
    try:
        if isinstance(spec.law, RingLawSpec):
            zone = _section(spec, feature, drawing.form(own.feature, spec))
        elif isinstance(spec, LocationSpec):
            zone = _location(spec, feature, _refined(own, drawing), drawing.form(own.feature, spec))
        else:
            zone = _orientation(spec.zone, feature, drawing.oriented(own))
    except InputError as error:
        raise scene.refuse(("tolerances", own.entry, "zone"), str(error)) from None
    draw, size = drawn_by(spec.law, zone, scene.files), _size(scene, own, drawing, zone)
    matrix = draw.matrix if spec.zone.projected is None else _projecting(scene, own, drawing) @ draw.matrix
    if lacking := len(feature.shape.components) - len(matrix):  # of a cone it limits the axis alone
        matrix = np.vstack([matrix, np.zeros((lacking, matrix.shape[1]))])
    if size is None:
        return draw, matrix
    judged = JudgedProcess(draw.zone, draw.laws, size) if isinstance(draw, Process) else Widened(draw.zone, draw, size)
    return judged, matrix


@dataclass(frozen=True)
class Refined:
    """The orientation zone within a location zone.

    Args:
        width: t_o, at most that of the location zone [mm].
        zone: as it is stated.
    """

    width: float
    zone: ZoneSpec


def _refined(own: Stated, drawing: Drawing) -> Refined | None:
    """The orientation that refines a location zone; not by a zone along another of two flat ones."""
    spec = own.spec
    assert isinstance(spec, LocationSpec)
    beside = drawing.of(own.feature, LocationSpec)
    for other in drawing.of(own.feature, OrientationSpec):
        assert isinstance(other.spec, OrientationSpec)
        if len(beside) > 1 and not are_alike(spec.zone, other.spec.zone):
            continue
        lower = spec.lower_segment if isinstance(spec, Composite) else None
        width = min(drawing.oriented(other), spec.zone.size if lower is None else lower.zone.size)
        return Refined(width, other.spec.zone)
    return None


def _refuse_no_ring(scene: Scene, own: Stated, drawing: Drawing) -> None:
    """A ring is of where an axis lies, in a cylinder or at a section, and of an axis that does not lean."""
    spec, path = own.spec, ("tolerances", own.entry, "law")
    surface = isinstance(spec, ProfileSpec)  # whose zone holds the size too
    located = isinstance(spec, LocationSpec) and drawing.kind(own.feature).kind in AXES and not surface
    if not isinstance(spec, LocationSpec) or not located or spec.zone.along is not None:
        words = f"expected uniform, normal or process, got ring of a {spec.kind} of {own.feature!r}"
        raise scene.refuse(path, f"{words}; a ring is of where an axis lies, in a cylinder or at a section")
    for other in drawing.of(own.feature, OrientationSpec):
        words = f"expected no tolerance of the orientation beside the law ring, got {other.entry!r}"
        raise scene.refuse(path, f"{words}; on a ring the axis does not lean, take it out")


def _projecting(scene: Scene, own: Stated, drawing: Drawing) -> Array:
    """(4, 4): effect of the ends of an axis' projected part on its own ends; for an orientation about its middle.

    Raises:
        SceneError: the feature is no axis, or is read at one section.
    """
    assert isinstance(own.spec, LocationSpec | OrientationSpec)
    projected = own.spec.zone.projected
    assert projected is not None
    kind, path = drawing.kind(own.feature), ("tolerances", own.entry, "zone", "projected")
    if kind.kind not in ("axis", "cylinder") or isinstance(own.spec, CircularRunOutSpec | ProfileSpec):
        words = (
            f"expected a location or an orientation of an axis or a cylinder, got {own.spec.kind} of {own.feature!r}"
        )
        raise scene.refuse(path, f"{words}; take projected out")
    if isinstance(own.spec, OrientationSpec):
        return np.eye(4) * (kind.shape.longest / projected.internal)
    return seen_from_projected(kind.shape.longest, projected.internal)


def _size(scene: Scene, own: Stated, drawing: Drawing, zone: Zone) -> SizedBy | None:
    """The size that widens a zone; None without a modifier on it or on its refinements, and a form that it bounds."""
    spec = own.spec
    of_zone = spec.modifier if isinstance(spec, Modified) else None
    refining = drawing.of(own.feature, OrientationSpec) if isinstance(spec, LocationSpec) else ()
    of_orientation = next((each.spec.modifier for each in refining if isinstance(each.spec, Modified)), None)
    modifier, is_enveloped = of_zone or of_orientation, zone.form > 0.0 and drawing.is_enveloped(own.feature)
    if modifier is None and not is_enveloped:
        return None
    found = sized_by(drawing, own.feature, modifier or "mmc")
    bonus = replace(found.bonus, of_zone=of_zone is not None, of_orientation=of_orientation is not None)
    size = replace(found, bonus=bonus)
    return enveloped(size, drawing, own.feature, zone.form) if is_enveloped else size


def enveloped(size: SizedBy, drawing: Drawing, feature: str, form: float) -> SizedBy:
    """A size that bounds the form of its feature, whose tolerance of form is so wide [mm]."""
    shape, bonus = drawing.kind(feature).shape, size.bonus
    return replace(size, bonus=replace(bonus, envelope=Envelope(bonus.low, bonus.high, shape.inner, form)))


def sized_by(drawing: Drawing, feature: str, modifier: Modifier) -> SizedBy:
    """The size of a feature that has a tolerance of it, and its bonus.

    Raises:
        SceneError: its distribution has no limits and none are stated, so that there is no material condition.
    """
    (own,) = drawing.of(feature, SizeSpec)
    spec, shape = own.spec, drawing.kind(feature).shape
    assert isinstance(spec, SizeSpec)
    law = spec.distribution.resolve(drawing.scene.files)
    limits = law.limits if spec.limits is None else tuple(limit.internal for limit in spec.limits)
    if limits is None:
        words = "expected the drawing's limits of size, such as [0 um, 15 um], from which the bonus counts; got none"
        raise drawing.scene.refuse(("tolerances", own.entry), f"{words}, and its distribution has none")
    low, high = limits
    bonus = Bonus.at(modifier, low, high, inner=shape.inner)
    return SizedBy(own.name, law, bonus, of_drawing=spec.limits is not None)


def drawn_by(law: LawSpec, zone: Zone, files: Files) -> Confined | Process:
    """The draw that a law of a scene makes of a zone.

    Args:
        law: as the scene states it.
        zone: without bonus.
        files: those that a distribution may read.
    """
    found: Confined | Process = named(law.draws)(law, zone, files)
    return found


def limited_along(spec: LocationSpec, feature: FeatureUnion) -> Array:
    """Directions (directions, 3) in which the zone of a location limits a feature, in the feature's frame."""
    axes, along = np.eye(3)[feature.shape.located], spec.zone.along
    if len(axes) == 2 and along is not None:
        x, y = _across(along, feature)
        return np.array([[x, y, 0.0]]) / math.hypot(x, y)
    if len(axes) < 3 or spec.zone.diameter is not None or is_of_round_surface(spec, feature.kind):
        return axes
    return np.array([_seen(along, feature)])


def _location(spec: LocationSpec, feature: FeatureUnion, refined: Refined | None, form: float) -> Zone:
    orientation = None if refined is None else refined.width
    width, outward = spec.zone.size, None if spec.zone.outward is None else spec.zone.outward.internal
    if isinstance(spec, Composite) and spec.lower_segment is not None:  # about the middle of the upper zone
        own = spec.lower_segment.zone.size
        width, outward = own, None if outward is None else outward + 0.5 * (own - width)
    if isinstance(spec, ProfileSpec) and isinstance(feature, CylinderSpec):
        return catalogue.cylinder_surface(width, outward, form)
    if isinstance(spec, ProfileSpec) and isinstance(feature, ConeSpec):
        return catalogue.cone_surface(width, feature.shape, outward, form)
    if isinstance(spec, ProfileSpec) and isinstance(feature, SphereSpec):
        return catalogue.sphere_surface(width, outward, form)
    if isinstance(feature, PlaneSpec | SlotSpec):
        made = catalogue.rectangle if feature.extent is not None else catalogue.round_face
        return made(width, orientation, outward, form)
    if isinstance(feature, PointSpec | SphereSpec):
        if spec.zone.diameter is not None:
            return catalogue.point_in_sphere(width)
        return catalogue.point_between_planes(width, _seen(spec.zone.along, feature), outward)
    if isinstance(spec, CircularRunOutSpec):
        return _section(spec, feature, form)
    if isinstance(spec, TotalRunOutSpec) and isinstance(feature, ConeSpec):
        if orientation is not None:
            raise InputError("expected no orientation beside the total run-out of a cone, which limits its lean too")
        return catalogue.cone_run_out(width, feature.shape, form)
    along = None if spec.zone.along is None else _across(spec.zone.along, feature)
    if refined is not None and not are_alike(spec.zone, refined.zone):
        return _mixed(width, along, refined, feature, form)
    if along is not None:
        return catalogue.flat_axis(width, along, orientation, form)
    return catalogue.axis(width, orientation, form)


def _mixed(
    width: float, along: tuple[float, float] | None, refined: Refined, feature: FeatureUnion, form: float
) -> Zone:
    """The zone of an axis, of a width flat along a direction or else round, refined by one of another shape."""
    turned = None if refined.zone.along is None else _across(refined.zone.along, feature)
    if along is None:
        assert turned is not None, "both round are alike"
        return catalogue.axis_along(width, turned, refined.width, form)
    if turned is None:
        return catalogue.flat_axis_round(width, along, refined.width, form)
    return catalogue.flat_axis_along(width, along, turned, refined.width, form)


def _section(spec: LocationSpec | OrientationSpec, feature: FeatureUnion, form: float) -> Zone:
    """The zone of an axis at one section; a run-out of a cone is read square to its surface."""
    slant = feature.shape.slant if isinstance(spec, CircularRunOutSpec) else 1.0
    return catalogue.axis_section(spec.zone.size, form, slant)


def _orientation(zone: ZoneSpec, feature: FeatureUnion, width: float) -> Zone:
    if isinstance(feature, PlaneSpec | SlotSpec):
        made = catalogue.rectangle_orientation if feature.extent is not None else catalogue.round_face_orientation
        return made(width)
    if zone.along is not None:
        return catalogue.flat_axis_orientation(width, _across(zone.along, feature))
    return catalogue.axis_orientation(width)


def _seen(along: Triple | None, feature: FeatureUnion) -> Triple:
    """A direction in the feature's frame; its normal if there is none."""
    if along is None:
        return 0.0, 0.0, 1.0
    x, y, z = feature.frame[:3, :3].T @ unit(along)
    return float(x), float(y), float(z)


def _across(along: Triple, feature: FeatureUnion) -> tuple[float, float]:
    """A direction across a feature's axis, in its frame."""
    x, y, _ = _seen(along, feature)
    if math.hypot(x, y) < LEAST_SINE:
        raise InputError("expected a direction `along` across the axis, got one along it")
    return x, y


def projected_name(feature: str, length: float) -> str:
    """The name of the projected part of an axis; scenes cannot name one so."""
    return f"{feature}..{length:.9g} mm beyond"


def projected(feature: Feature, length: float) -> Feature:
    """The part of an axis beyond its end along +z, of some length [mm], as a feature. ISO 10578, ASME Y14.5."""
    frame, own_length = feature.frame.copy(), feature.shape.longest
    frame[:3, 3] += (own_length + length) / 2 * frame[:3, 2]
    share = length / own_length
    ends = _at_ends(0.0, 1.0, -share, 1.0 + share)
    moved_by = tuple(Contribution(own.contributor, own.columns, ends @ own.matrix) for own in feature.moved_by)
    name, shape = projected_name(feature.name, length), feature.shape.of_length(length)
    return replace(feature, name=name, shape=shape, frame=frame, moved_by=moved_by, is_named=False)


def seen_from_projected(own_length: float, length: float) -> Array:
    """(4, 4): components of the projected part of an axis -> those of the axis itself, both lengths in mm."""
    share = own_length / length
    return _at_ends(1.0 + share, -share, 1.0, 0.0)


def _at_ends(start_by_start: float, start_by_end: float, end_by_start: float, end_by_end: float) -> Array:
    """Ends of one piece of a straight line by those of another, x and y alike."""
    return np.kron(np.array([[start_by_start, start_by_end], [end_by_start, end_by_end]]), np.eye(2))
