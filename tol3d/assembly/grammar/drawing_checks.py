"""Checks across the tolerances of each feature."""

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Final

import numpy as np

from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features.feature_spec import AXES
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.forms import units, whole_form
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.grammar.tolerances.location import (
    AxialRunOutSpec,
    CircularRunOutSpec,
    CoaxialitySpec,
    Composite,
    FlatnessSpec,
    FormSpec,
    LocationSpec,
    OrientationSpec,
    StraightnessSpec,
    SymmetrySpec,
    TotalRunOutSpec,
    is_of_round_surface,
)
from tol3d.assembly.grammar.tolerances.plus_minus import ENVELOPED, PlusMinusSpec, SizeSpec
from tol3d.assembly.grammar.zone import ProcessLawSpec, are_alike
from tol3d.files import Files
from tol3d.scene import Scene
from tol3d.scene.implausible import Implausible, another_size, larger_end
from tol3d.scene.place import KeyPath
from tol3d.units import angle_text

Problem = tuple[KeyPath, str]

ROUNDING = 1e-9  # mm, of a sum of widths; cosine of a right angle
MOTIONS = ("shift", "shift and turn")
"""Names of the motion of a pattern as a whole, after the tolerance's own."""
REFINED = "a tilt that it refines is an orientation tolerance beside the other"


def contradicting_tolerances(scene: Scene) -> Iterator[Problem]:
    """Tolerances of a feature that would count twice or contradict each other."""
    drawing = Drawing(scene)
    yield from dict.fromkeys(problem for feature in drawing.names for problem in _twice(drawing, feature))
    for feature in drawing.names:
        yield from _apart(drawing, feature)
    yield from dict.fromkeys(problem for feature in drawing.names for problem in _zones(drawing, feature))
    yield from _names(drawing)
    yield from cyclic_datums(drawing)


def _twice(drawing: Drawing, feature: str) -> Iterator[Problem]:
    located, dimensions = _counted_once(drawing, feature), drawing.of(feature, PlusMinusSpec)
    for several, what, instead in (
        ((*located, *dimensions) if located else (), "where it lies", f"; {REFINED}"),
        (drawing.of(feature, OrientationSpec), "how it is turned", ""),
        (drawing.of(feature, SizeSpec), "its size", ""),
        *((own, "its form", "") for own in _forms_alike(drawing, feature)),
    ):
        if len(several) > 1 and not several[1].alike:
            first, second = several[0].entry, several[1].entry
            words = f"expected one tolerance of {feature!r} for {what}, got {first!r} too, which would count twice"
            yield ("tolerances", second), f"{words}; remove one{instead}"


def _forms_alike(drawing: Drawing, feature: str) -> Iterator[Sequence[Stated]]:
    """Its forms of one kind; that of every piece stands beside that of the whole."""
    found: dict[object, list[Stated]] = {}
    for own in drawing.of(feature, FormSpec):
        assert isinstance(own.spec, FormSpec)
        key = type(own.spec), getattr(own.spec, "per", None) is None, own.spec.zone.diameter is None
        found.setdefault(key, []).append(own)
    yield from found.values()


def _form_problems(here: KeyPath, spec: FormSpec, drawing: Drawing, feature: str) -> Iterator[Problem]:
    zone, own, shape = spec.zone, drawing.kind(feature), drawing.kind(feature).shape
    of_axis = isinstance(spec, StraightnessSpec) and own.kind in AXES
    if not of_axis and (zone.diameter is not None or zone.along is not None):
        yield (*here, "zone"), "expected a width alone: the distance of what lies about the surface"
    if of_axis and own.kind == "axis" and zone.width is not None and zone.along is None:
        yield (*here, "zone"), "expected a diameter, or a width with `along`, for an axis has no surface"
    for field in ("projected", "outward"):
        if getattr(zone, field) is not None:
            yield (*here, "zone", field), f"expected none of a {spec.kind}; take it out"
    if isinstance(spec, StraightnessSpec) and (own.kind == "plane") != (spec.lines is not None):
        wanted = (
            "x or y, along which lines of the plane run" if own.kind == "plane" else "none: lines run along the axis"
        )
        yield (*here, "lines"), f"expected {wanted}, got {spec.lines or 'none'}"
        return
    for length, piece in units(spec, shape):
        if piece > length:
            words = f"expected a piece of the feature, which is {length:g} mm long, got {piece:g} mm"
            yield (*here, "per"), f"{words}; leave `per` out, and the zone is of the whole"
            return
    beside = [each for each in drawing.of(feature, type(spec)) if getattr(each.spec, "per", None) is None]
    if units(spec, shape) and beside and spec.law is not None:
        yield (*here, "law"), f"expected none, for that of {beside[0].entry!r}, of the whole, counts; leave it out"


def _axial_problems(here: KeyPath, spec: AxialRunOutSpec, drawing: Drawing, feature: str) -> Iterator[Problem]:
    kind = drawing.kind(feature)
    if kind.kind != "plane" or kind.radius is None:
        yield (*here, "of"), f"expected a plane with a `radius`, which turns about the axis, got {feature!r}"
    elif spec.radius is not None and spec.radius.internal > kind.radius.internal:
        words = f"expected a circle on the face, whose radius is {kind.radius.internal:g} mm, got {spec.radius}"
        yield (*here, "radius"), words
    if drawing.form(feature, spec) >= spec.zone.size:
        words = f"expected more than the {drawing.form(feature, spec) * 1e3:g} um of its form, which it holds too"
        yield (*here, "zone"), f"{words}, got {spec.zone.size * 1e3:g} um"


def _counted_once(drawing: Drawing, feature: str) -> tuple[Stated, ...]:
    """Its location tolerances; of two flat ones across each other, in one frame, only the first."""
    found = drawing.of(feature, LocationSpec)
    specs = [own.spec for own in found if isinstance(own.spec, LocationSpec)]
    along = [spec.zone.along for spec in specs]
    if len(found) == 2 and along[0] is not None and along[1] is not None:
        across = abs(float(unit(along[0]) @ unit(along[1]))) < ROUNDING
        if across and specs[0].named_datums == specs[1].named_datums:
            return found[:1]
    return found


def _apart(drawing: Drawing, feature: str) -> Iterator[Problem]:
    dimensions = drawing.of(feature, PlusMinusSpec)
    for other in dimensions[1:]:
        if other.is_own and other.spec.named_datums != dimensions[0].spec.named_datums:
            first = dimensions[0].entry
            yield ("tolerances", other.entry), f"expected the datums of {first!r}, which is of {feature!r} too"


def _zones(drawing: Drawing, feature: str) -> Iterator[Problem]:
    for own in drawing.of(feature, FeatureTolerance):
        here: KeyPath = ("tolerances", own.entry)
        spec = own.spec
        if not own.is_own or drawing.kind(feature).kind not in spec.applies_to:
            continue  # reported already, see unknown_features
        if isinstance(spec, LocationSpec | OrientationSpec):
            yield from _shape_problems(here, spec, drawing.kind(feature).kind)
        if isinstance(spec, LocationSpec):
            yield from _room_problems(here, spec, drawing, feature)
            if is_of_round_surface(spec, drawing.kind(feature).kind):
                yield from _surface_problems(here, own, drawing)
            if isinstance(spec, Composite) and spec.lower_segment is not None and len(drawing.composite(own)) < 2:
                words = (
                    f"expected a pattern of {spec.of!r} or rigid_with, features that lie to each other, got one alone"
                )
                instead = f"of one feature write an orientation tolerance of {spec.lower_segment.zone.stated} beside"
                yield (*here, "lower_segment"), f"{words}; {instead} {own.entry!r}"
        elif isinstance(spec, OrientationSpec):
            if isinstance(spec, AxialRunOutSpec):
                yield from _axial_problems(here, spec, drawing, feature)
            located = drawing.of(feature, LocationSpec)
            if located and spec.modifier is not None and _held_otherwise(drawing, feature, spec, located[0]):
                words = f"expected none, for {located[0].entry!r} holds the axis over another length"
                yield (*here, "modifier"), f"{words}; leave it out, or project both alike"
            if spec.zone.projected is not None and drawing.kind(feature).kind not in ("axis", "cylinder"):
                yield (
                    (*here, "zone", "projected"),
                    f"expected an axis or a cylinder, got {feature!r}; take projected out",
                )
            if located and spec.law is not None:
                yield (*here, "law"), f"expected none, for that of {located[0].entry!r} counts; leave it out"
            if not located and spec.law is None:
                words = "expected a law, such as {kind: uniform}: no other zone says where the feature lies"
                yield here, words
        elif isinstance(spec, FormSpec):
            yield from _form_problems(here, spec, drawing, feature)
        elif isinstance(spec, SizeSpec) and spec.envelope and drawing.kind(feature).kind not in ENVELOPED:
            words = f"expected none of {drawing.kind(feature).words}, got it of {feature!r}"
            yield (*here, "envelope"), f"{words}; an envelope is of a cylinder, a slot or a tab"
        elif isinstance(spec, PlusMinusSpec):
            yield from _direction_problems(here, spec, drawing, feature)


def _held_otherwise(drawing: Drawing, feature: str, spec: OrientationSpec, located: Stated) -> bool:
    """True if a zone of orientation holds a feature over another length than that of its location."""
    other = located.spec
    assert isinstance(other, LocationSpec)
    return drawing.held_over(feature, spec.zone) != drawing.held_over(feature, other.zone)


def _shape_problems(here: KeyPath, spec: LocationSpec | OrientationSpec, kind: str) -> Iterator[Problem]:
    zone, place = spec.zone, (*here, "zone")
    if kind in ("plane", "slot"):
        if zone.diameter is not None:
            yield (*place, "diameter"), "expected a width, for a plane lies between two planes"
        if zone.along is not None:
            yield (*place, "along"), "expected none, for a plane deviates along its normal"
    elif isinstance(spec, CircularRunOutSpec | TotalRunOutSpec):
        if zone.diameter is not None or zone.along is not None:
            yield place, "expected a width alone: the run-out that is allowed"
    elif isinstance(spec, CoaxialitySpec) and zone.diameter is None:
        yield place, "expected a diameter, for the axis lies in a cylinder about the datum's"
    elif isinstance(spec, SymmetrySpec) and zone.width is None:
        yield place, "expected a width, about the datum's middle"
    elif zone.width is not None and zone.along is None and spec.kind != "profile":
        yield place, "expected the direction `along` in which the width limits, or a diameter"
    elif spec.kind == "profile" and (zone.diameter is not None or zone.along is not None):
        which = "the point's normal" if kind == "point" else "the normal of the surface"
        yield place, f"expected a width alone, which limits along {which}"
    if zone.outward is not None and spec.kind != "profile":
        yield (*place, "outward"), f"expected it of a profile tolerance, got a {spec.kind}"


def _surface_problems(here: KeyPath, own: Stated, drawing: Drawing) -> Iterator[Problem]:
    """Refuse tolerances beside the profile of a round surface, which limits size and orientation too."""
    kind = drawing.kind(own.feature).kind
    if kind == "cone" and isinstance(own.spec, Composite) and own.spec.lower_segment is not None:
        words = "expected none of a cone, whose pattern would shift along it too"
        yield (*here, "lower_segment"), f"{words}; write size and position, which may have one"
    for other in drawing.of(own.feature, SizeSpec):
        words = f"expected no size of {own.feature!r} beside a profile, which holds the {kind}'s diameter too"
        yield here, f"{words}, got {other.entry!r}; write a position for where it lies, or take {other.entry!r} out"
    for other in drawing.of(own.feature, OrientationSpec):
        words = f"expected no orientation beside the profile of a {kind}, got {other.entry!r}"
        yield here, f"{words}; write size and position, which an orientation may refine"


def _room_problems(here: KeyPath, spec: LocationSpec, drawing: Drawing, feature: str) -> Iterator[Problem]:
    lower = spec.lower_segment if isinstance(spec, Composite) else None
    width = spec.zone.size if lower is None else lower.zone.size
    taken = drawing.form(feature, spec)
    for other in (*drawing.of(feature, OrientationSpec), *drawing.of(feature, FormSpec)):
        assert isinstance(other.spec, OrientationSpec | FormSpec)
        is_form = isinstance(other.spec, FormSpec)
        own = (
            whole_form(other.spec, drawing.kind(feature).shape, width)
            if isinstance(other.spec, FormSpec)
            else drawing.oriented(other)
        )
        if is_form and taken < width:
            continue  # another form limits it more, or it uses none of this zone
        if other.spec.zone.projected != spec.zone.projected:
            continue  # over another length it may be just as wide
        if own > width or (own == width and isinstance(other.spec, FormSpec)):
            got = f"got {width * 1e3:g} um"
            yield (
                (*here, "zone") if lower is None else (*here, "lower_segment", "zone"),
                f"expected more than the {own * 1e3:g} um of {other.entry!r}, which refines it, {got}",
            )


def _direction_problems(here: KeyPath, spec: PlusMinusSpec, drawing: Drawing, feature: str) -> Iterator[Problem]:
    own = drawing.kind(feature)
    z = own.frame[:3, 2]
    if spec.along is None:
        if own.kind == "cone":
            yield here, "expected `along`, a direction across the cone or along its axis, got none"
        elif own.kind in AXES:
            yield here, "expected a direction across the axis as `along`, got none"
        elif drawing.positive(feature, spec) is None:
            yield here, _unclear(spec, drawing, feature)
        return
    length = float(sum(number**2 for number in spec.along)) ** 0.5
    share = float(z @ spec.along) / length
    if own.kind in ("plane", "slot") and abs(share) < ROUNDING:
        yield (*here, "along"), "expected a direction that is not in the plane, which would not move it"
    if own.kind in ("axis", "cylinder") and 1.0 - abs(share) < ROUNDING:
        yield (*here, "along"), "expected a direction across the axis, got one along it, where it does not deviate"


def _unclear(spec: PlusMinusSpec, drawing: Drawing, feature: str) -> str:
    """Error text for a dimension whose positive direction no datum defines."""
    names = ", ".join("-".join(datum.features) for datum in spec.named_datums)
    expected = "expected `along`, the direction in which the dimension is positive, got none"
    own = drawing.kind(feature)
    if not own.has_direction:
        return f"{expected}, and {feature!r} has no normal to say it"
    return f"{expected}, and {feature!r} lies off none of its datums ({names}) along its normal"


def _names(drawing: Drawing) -> Iterator[Problem]:
    taken = {name: ("tolerances", name) for name in drawing.scene.tolerances}
    for own in drawing.stated:
        if not isinstance(own, Stated) or own.name == own.entry:
            continue
        if own.name in taken:
            yield taken[own.name], f"expected another name: {own.entry!r} has {own.name!r} for {own.feature!r}"
        taken[own.name] = ("tolerances", own.entry)
    for own in drawing.stated:
        if isinstance(own, Stated) and own.is_own and drawing.composite(own):
            for word in MOTIONS:
                if (name := f"{own.entry} {word}") in taken:
                    yield taken[name], f"expected another name: {own.entry!r} has {name!r} for its pattern"


def cyclic_datums(drawing: Drawing) -> Iterator[Problem]:
    """Features whose datums depend on the features themselves."""
    after = {
        name: {f"{part_of(name)}.{feature}" for datum in datums for feature in datum.features}
        for name, datums in drawing.parents()
    }
    waiting = dict(after)
    while ready := [name for name, needed in waiting.items() if not needed & waiting.keys()]:
        waiting = {name: needed for name, needed in waiting.items() if name not in ready}
    while ends := [name for name in waiting if not any(name in needed for needed in waiting.values())]:
        waiting = {name: needed for name, needed in waiting.items() if name not in ends}
    for name in waiting:
        own = [stated for stated in drawing.of(name, FeatureTolerance) if stated.spec.named_datums and stated.is_own]
        if own:
            ring = " and ".join(repr(other) for other in waiting)
            words = f"expected datums that do not depend on {name!r} themselves, got a ring of {ring}"
            yield ("tolerances", own[0].entry, "datums"), words
            return


HALF: Final = Implausible(0.5)
SIZE: Final = Implausible(0.5, "state the deviation from nominal, not the size, and check the unit")


def implausible_sizes(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Deviations of sizes, zones and displacements beyond half of a diameter or width; other features have no size."""
    drawing = Drawing(scene)
    for name, spec in scene.of(FeatureTolerance).items():
        feature = drawing.kind(spec.of)
        if (nominal := feature.shape.nominal_size) is None:
            continue
        of = f"the {'width' if feature.kind == 'slot' else 'diameter'} of {spec.of!r}"
        for field, deviation in _deviations(spec, scene.files):
            rule = SIZE if isinstance(spec, SizeSpec) else HALF
            if sentence := rule.sentence(of, nominal, deviation):
                yield ("tolerances", name, *field), sentence


def forms_beyond_orientations(scene: Scene) -> Iterator[Problem]:
    """Straightnesses and flatnesses wider than the orientation of the same feature, whose zone holds its form too.

    A form beyond its location is refused. An orientation that grows with the size, as the form does, does not limit it.
    """
    drawing = Drawing(scene)
    for feature in drawing.names:
        forms = [own for own in drawing.of(feature, FormSpec) if isinstance(own.spec, StraightnessSpec | FlatnessSpec)]
        for own, other in product(filter(lambda each: each.is_own, forms), drawing.of(feature, OrientationSpec)):
            form, around = own.spec, other.spec
            assert isinstance(form, FormSpec)
            assert isinstance(around, OrientationSpec)
            grows = around.modifier is not None and drawing.is_enveloped(feature)
            apart = around.zone.along is not None and not are_alike(around.zone, form.zone)
            if grows or apart or isinstance(around, AxialRunOutSpec) or around.zone.projected is not None:
                continue
            if form.zone.size <= around.zone.size:
                continue
            limit, got = (f"{zone.size * 1e3:g} um" for zone in (around.zone, form.zone))
            words = f"expected at most the {limit} of {other.entry!r}, whose zone holds the form of {feature!r} too"
            yield ("tolerances", own.entry, "zone"), f"{words}, got {got}; state the form that is left"


def implausible_leans(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Orientation zones in which a feature may lean by more than ten degrees."""
    drawing = Drawing(scene)
    for name, spec in scene.of(OrientationSpec).items():
        shape = drawing.kind(spec.of).shape
        reach = float(np.ptp(shape.ends, axis=0).max())
        if spec.zone.projected is not None:
            reach = spec.zone.projected.internal
        if reach > 0.0 and (lean := math.atan(spec.zone.size / reach)) > MOST_LEAN:
            words = f"expected a lean of at most 10° of {spec.of!r} over its {reach:.4g} mm, got {angle_text(lean)}"
            yield ("tolerances", name, "zone"), f"{words}; check the unit"


def features_far_off(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Features that lie more than ten metres from all others of their part."""
    drawing = Drawing(scene)
    for part, features in drawing.features.items():
        places = np.array([feature.frame[:3, 3] for feature in features.values()])
        for name, place in zip(features, places, strict=True):
            others = np.sort(np.linalg.norm(places - place, axis=1))[1:]
            if others.size and others[0] > FARTHEST and np.linalg.norm(place) >= np.linalg.norm(places, axis=1).max():
                words = (
                    f"expected a place within 10 m of another feature of {part!r}, got one {others[0] / 1e3:.4g} m off"
                )
                yield ("parts", part, "features", name), f"{words}; check the unit"


def fits_of_other_sizes(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Tolerance classes of sizes that are taken at another nominal size than the feature has."""
    drawing = Drawing(scene)
    for name, spec in scene.of(SizeSpec).items():
        nominal = drawing.kind(spec.of).shape.nominal_size
        if nominal and (sentence := another_size(spec.distribution.drawn, nominal, f"size of {spec.of!r}")):
            yield ("tolerances", name, "distribution", "of"), sentence


MOST_LEAN: Final = math.radians(10.0)  # rad; more is another nominal direction
FARTHEST: Final = 10_000.0  # mm; the largest machine tools have such beds


def _deviations(spec: FeatureTolerance, files: Files) -> Iterator[tuple[KeyPath, float]]:
    """Each length that a tolerance states of its feature [mm], with its field."""
    if isinstance(spec, SizeSpec | PlusMinusSpec):
        yield ("distribution",), larger_end(spec.distribution.resolve(files))
    if isinstance(spec, SizeSpec) and spec.limits is not None:
        yield ("limits",), max((limit.internal for limit in spec.limits), key=abs)
    if isinstance(spec, LocationSpec | OrientationSpec | FormSpec):
        yield ("zone",), spec.zone.size
        if isinstance(spec.law, ProcessLawSpec):
            yield ("law", "distribution"), larger_end(spec.law.distribution.resolve(files))
