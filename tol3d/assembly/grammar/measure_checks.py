"""Checks of measures: lengths with lengths, angles with angles, points on a plane."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features.feature_spec import AXES
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec
from tol3d.assembly.grammar.measures.clearance import ClearanceSpec, VirtualClearanceSpec
from tol3d.assembly.grammar.measures.inspected import InspectedFlatnessSpec, InspectedPatternSpec
from tol3d.assembly.grammar.measures.pose_errors import DifferenceSpec, DirectionErrorSpec
from tol3d.assembly.grammar.moves.assembly_move import fixed_parts
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.units import Dimension, expectation

Problem = tuple[KeyPath, str]

FLAT = 1e-6  # of the points' extent, or mm
PARALLEL = 1e-4  # deg
LEANING = 5.0  # deg; holes tilted by more do not fit one bolt, and their circles would be ellipses by 0.4 %


def dimension_of(scene: Scene, name: str) -> Dimension:
    """Dimension of a measure, length or angle; a difference has that of its first measure."""
    spec = scene.measures[name]
    return dimension_of(scene, spec.of) if isinstance(spec, DifferenceSpec) else spec.dimension


def mixed_dimensions(scene: Scene) -> Iterator[Problem]:
    """Limits of another dimension than their measure's, and differences of lengths and angles."""
    for name, spec in scene.measures.items():
        if not isinstance(spec, AssemblyMeasureSpec):
            continue
        own = dimension_of(scene, name)
        if isinstance(spec, DifferenceSpec) and (other := dimension_of(scene, spec.minus)) != own:
            yield (
                ("measures", name, "minus"),
                f"expected {_an(own)}, as {spec.of!r} is, got {spec.minus!r}, {_an(other)}",
            )
        for field in ("lower_limit", "upper_limit"):
            limit = getattr(spec, field)
            if limit is not None and limit.dimension != own:
                yield ("measures", name, field), f"expected {expectation(own)}, got {str(limit)!r}"


def seen_by_nothing(scene: Scene) -> Iterator[Problem]:
    """Errors of directions in the world, where no part is fixed in it."""
    if not fixed_parts(scene.moves):
        for name, spec in scene.of(DirectionErrorSpec).items():
            if spec.from_ is None:
                yield ("measures", name, "from"), "expected the part that sees it, for no move is `fix`, got none"


def missing_solids(scene: Scene) -> Iterator[Problem]:
    """Clearances of parts that are stated by their features alone."""
    drawing = Drawing(scene)
    for name, spec in scene.of(ClearanceSpec).items():
        for field, part in (("from", spec.from_), ("to", spec.to)):
            if not drawing.has_solid(part):
                words = f"expected a part with a solid, got {part!r}, which is stated by its features alone"
                advice = "give it a builder, such as {kind: plate, ...}, or measure a gap of its features"
                yield ("measures", name, field), f"{words}; {advice}"


def unfit_points(scene: Scene) -> Iterator[Problem]:
    """Refuse points for a flatness that are nominally not on a plane with that normal, or on a line."""
    drawing = Drawing(scene)
    for name, spec in scene.measures.items():
        if not isinstance(spec, InspectedFlatnessSpec):
            continue
        features = drawing.features[part_of(spec.points[0])]
        known = [features[own] for own in (point.partition(".")[2] for point in spec.points) if own in features]
        places = np.array([feature.origin for feature in known])
        off = (places - places.mean(axis=0)) @ unit(spec.normal)
        if len(known) == len(spec.points) and np.abs(off).max() > FLAT * max(float(np.ptp(places)), 1.0):
            words = "expected the normal of a plane on which all points lie nominally"
            yield ("measures", name, "normal"), f"{words}; one lies {np.abs(off).max():.4g} mm off their middle"
        elif np.linalg.svd(places - places.mean(axis=0), compute_uv=False)[1] < FLAT:
            yield ("measures", name, "points"), "expected points that do not all lie on one line; add one beside it"


def unfit_holes(scene: Scene) -> Iterator[Problem]:
    """Pins, and holes that do not run along the first of those that a bolt passes."""
    drawing = Drawing(scene)
    poses = {name: solid.placed.pose[:3, :3] for name, solid in scene.of(SolidSpec).items()}
    for name, spec in scene.measures.items():
        if not isinstance(spec, VirtualClearanceSpec):
            continue
        known = [hole for hole in spec.holes if hole in drawing.names and drawing.kind(hole).kind == "cylinder"]
        axes = {own: poses[part_of(own)] @ drawing.kind(own).frame[:3, 2] for own in known}
        for k, own in enumerate(spec.holes):
            feature = drawing.kind(own) if own in known else None
            if feature is None:
                continue  # reported already
            path = ("measures", name, "holes", k)
            if not feature.shape.inner:
                yield path, f"expected a hole, got {own!r}, which is a pin; a bolt passes through holes"
            elif spec.holes[0] in axes and (lean := _between(axes[spec.holes[0]], axes[own])) > LEANING:
                yield path, f"expected a hole along {spec.holes[0]!r}, got {own!r} at {lean:.4g} deg to it"


def unfit_patterns(scene: Scene) -> Iterator[Problem]:
    """Features of a pattern that are not parallel, or all on one axis about which the gauge would turn freely."""
    drawing = Drawing(scene)
    for name, spec in scene.measures.items():
        if not isinstance(spec, InspectedPatternSpec) or not set(spec.features) <= set(drawing.names):
            continue
        frames = [drawing.kind(feature).frame for feature in spec.features]
        axis, start = frames[0][:3, 2], frames[0][:3, 3]
        for k, (own, frame) in enumerate(zip(spec.features, frames, strict=True)):
            if drawing.kind(own).kind in AXES and _between(axis, frame[:3, 2]) > PARALLEL:
                lean = _between(axis, frame[:3, 2])
                words = (
                    f"expected an axis parallel to that of {spec.features[0]!r}, got {own!r} at {lean:.4g} deg to it"
                )
                yield ("measures", name, "of", k), words
        far = max(float(np.linalg.norm(np.cross(frame[:3, 3] - start, axis))) for frame in frames)
        if spec.free == "shift_and_turn" and far < FLAT:
            yield ("measures", name, "free"), "expected shift, for all features lie on one axis; got shift_and_turn"


def _between(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """The angle of two axes [deg], 0 to 90."""
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(first, second)), abs(first @ second))))


def _an(dimension: Dimension) -> str:
    return "an angle" if dimension == "angle" else "a length"
