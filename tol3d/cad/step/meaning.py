"""Meaning of each tolerance of a STEP file in a scene: said, said approximately, or left out, each with its reason.

The grammar is that of docs/assemblies.md. A tolerance is *said* where a zone of the grammar limits the same features in
the same frame; *approximately* where something of it is lost, which is named; else it is *left out*, and why. Each
tolerance has one meaning, so their counts add up to the file's.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal

from tol3d.cad.step.datum import Compartment, Datum, DatumReference
from tol3d.cad.step.feature import NamedFeature
from tol3d.cad.step.outline import StepText
from tol3d.cad.step.placement import Vector
from tol3d.cad.step.shape import Shape, shape_of
from tol3d.cad.step.surfaces import SAME_PLACE, Surface, aligned, dot, product_unit, surface_of
from tol3d.cad.step.tolerance import Tolerance

Class = Literal["said", "approximately", "left out"]

LOCATIONS: Final = frozenset(
    ("position", "surface profile", "concentricity", "coaxiality", "symmetry", "circular runout", "total runout")
)
ORIENTATIONS: Final = frozenset(("perpendicularity", "parallelism", "angularity"))
MATERIAL: Final = frozenset(
    (
        "maximum material requirement",
        "maximum material condition",
        "least material requirement",
        "least material condition",
    )
)
DATUM_SHAPES: Final = frozenset(("plane", "slot", "cylinder", "cylinders", "cone"))
MOST_TOGETHER: Final = 10  # features of one datum
SQUARE: Final = 1e-6  # cosine between directions that are square

PROFILED: Final = ("plane", "cylinder", "cone", "sphere")
"""Surfaces that a profile may be of."""
RIGID: Final = ("plane", "cylinder", "sphere")
"""Those that the lower segment of one may hold to each other."""
FLAT_ALONE: Final = "it is of its flat faces alone"
LOST_RELATION: Final = "how the faces lie to each other is lost"
FORM_ALONE: Final = {
    "plane": ("flatness", ""),
    **dict.fromkeys(("planes", "slot"), ("flatness", LOST_RELATION)),
    **dict.fromkeys(("cylinder", "cylinders"), ("cylindricity", "its size is lost")),
}
"""A profile without datums by what it is of: the form that it holds, and what is lost."""

DROPPED: Final = {
    "free state": "the free state is dropped",
    "tangent plane": "the tangent plane is taken as the face itself",
    "statistical tolerance": "that it is statistical is lost: the law of the zone says how deviations lie",
}
"""Modifiers for which the grammar has no word yet, and the loss without them."""


@dataclass(frozen=True)
class Meaning:
    """Meaning of one tolerance in a scene.

    Args:
        tolerance: its `#id`.
        how: said, approximately or left out.
        kind: the kind of tolerance or measure in the scene; empty if it is left out.
        shape: the toleranced shape, in words.
        why: the loss, or the reason why it is left out; empty if it is said.
    """

    tolerance: int
    how: Class
    kind: str
    shape: str
    why: str = ""


@dataclass(frozen=True)
class Meanings:
    """The meanings of a file's tolerances.

    Args:
        text: the file.
        surfaces: from each face to its surface; that of the text (`surfaces_of`), or of the geometry.
    """

    text: StepText
    surfaces: Mapping[int, Surface]

    @cached_property
    def all(self) -> tuple[Meaning, ...]:
        """One of each tolerance, in the file's order."""
        located: dict[int, int] = {}  # from each face to the tolerance that locates it
        found: dict[int, Meaning] = {}
        uppers_first = sorted(
            self.text.tolerances, key=lambda each: (each.above is not None, each.kind in ORIENTATIONS)
        )
        for each in uppers_first:
            found[each.id] = meaning = self.of(each, located, found)
            if meaning.how != "left out" and each.kind in LOCATIONS and each.above is None:
                for face in each.feature.faces:
                    located.setdefault(face, each.id)
        return tuple(found[tolerance.id] for tolerance in self.text.tolerances)

    @cached_property
    def by_id(self) -> dict[int, Tolerance]:
        """The tolerances by their instances."""
        return {tolerance.id: tolerance for tolerance in self.text.tolerances}

    @cached_property
    def datum_shapes(self) -> dict[int, Shape]:
        """The shape of each datum that is taken from one feature, by where the datum stands."""
        return {
            own: shape_of(feature, self.surfaces, self.text.structure) for own, feature in self.datum_features.items()
        }

    @cached_property
    def datum_features(self) -> dict[int, NamedFeature]:
        """The feature from which each datum is taken: what the file names, else the flat faces at its targets."""
        found: dict[int, NamedFeature] = {}
        for datum in self.text.datums:
            if len(datum.features) == 1:
                found[datum.id] = datum.features[0]
            elif datum.targets and not datum.features and (faces := self.faces_at(datum)):
                found[datum.id] = replace(datum.targets[0].feature, groups=(faces,))
        return found

    def faces_at(self, datum: Datum) -> tuple[int, ...]:
        """The flat faces on which the targets of a datum lie by their places; () where the file does not say it."""
        faces: list[int] = []
        for target in datum.targets:
            product = self.text.product(target.feature)
            if target.placement is None or product is None:
                return ()
            (_, _, z, at) = zip(*target.placement[:3], strict=True)
            for face in self.text.structure.products[product].faces:
                own = self.surfaces.get(face)
                if own is not None and own.kind == "plane" and aligned(z, own.direction) > 0:
                    height = dot(at, own.direction) - dot(own.at, own.direction)
                    faces += [face] if abs(height) < SAME_PLACE else []
        return tuple(dict.fromkeys(faces))

    def datum(self, reference: DatumReference) -> Datum | None:
        """The datum that a frame refers to; in a file of several parts their letters may be the same."""
        own = next((datum for datum in self.text.datums if datum.id == reference.datum), None)
        return own if own is not None and own.letter == reference.letter else self.text.datum(reference.letter)

    def datum_shape(self, compartment: Compartment) -> Shape | None:
        """The shape of the one datum of a compartment; None for several, or for anything but a single feature."""
        own = self.datum(compartment.references[0]) if len(compartment.references) == 1 else None
        return None if own is None else self.datum_shapes.get(own.id)

    def of(self, tolerance: Tolerance, located: Mapping[int, int], found: Mapping[int, Meaning]) -> Meaning:
        """The meaning of one tolerance.

        Args:
            tolerance: it.
            located: the tolerance that locates each face, of those before it.
            found: the meanings before it.
        """
        shape = shape_of(tolerance.feature, self.surfaces, self.text.structure)
        why_not = self.obstacle(tolerance, shape) or next(filter(None, map(self.datum_obstacle, tolerance.datums)), "")
        if why_not:
            return Meaning(tolerance.id, "left out", "", shape.words, why_not)
        if tolerance.above is not None:
            return self.lower_segment(tolerance, shape, found.get(tolerance.above))
        kind, lost = self.kind_and_loss(tolerance, shape)
        before = next((located[face] for face in tolerance.feature.faces if face in located), None)
        if before is not None and tolerance.kind in LOCATIONS and tolerance.datums:
            told = f"#{before} locates the feature: this one only limits what is inspected"
            return Meaning(tolerance.id, "approximately", "inspected_position", shape.words, told)
        if before is not None and tolerance.kind in ORIENTATIONS:
            told = self.refining_loss(tolerance, self.by_id[before])
            if told:
                told += f"; {lost}" if lost else ""
                return Meaning(tolerance.id, "approximately", "inspected_orientation", shape.words, told)
            lost = lost or self.turn_loss(tolerance, shape, self.by_id[before])
        lost = lost or self.modifier_loss(tolerance) or self.boundary_loss(tolerance)
        return Meaning(tolerance.id, "approximately" if lost else "said", kind, shape.words, lost)

    def obstacle(self, tolerance: Tolerance, shape: Shape) -> str:
        """Reason why the feature or the kind of a tolerance cannot be said at all; empty if it can."""
        if tolerance.magnitude is None:
            return "the file states no value"
        if why_not := unphysical(tolerance):
            return why_not
        if tolerance.magnitude.value == 0.0 and not self.has_size(tolerance.feature):
            return f"a zone of {tolerance.magnitude}, and without a size that has limits there is no bonus"
        if tolerance.feature.whole and tolerance.kind == "surface profile" and tolerance.datums:
            return ""
        if tolerance.feature.lies_on != "faces":
            return f"it is of {tolerance.feature.lies_on}, not of faces"
        if "non-uniform zone" in tolerance.modifiers:
            return "a zone that is not as wide everywhere"
        if tolerance.per_unit is not None and tolerance.kind not in ("straightness", "flatness"):
            return f"{tolerance.kind} per unit of length or area"
        if tolerance.kind == "line profile":
            return "line profile is form of lines"
        axes = ("cylinder", "cylinders", "cone", "cones")
        round_ones = (*axes, "sphere", "spheres")
        allowed = {
            "position": ("plane", "slot", *round_ones),
            "surface profile": ("plane", "planes", "slot", *round_ones),
            "flatness": ("plane",),
            "straightness": (*axes, "plane"),
            "roundness": round_ones,
            "cylindricity": ("cylinder", "cylinders"),
            **dict.fromkeys(("circular runout", "total runout"), ("cylinder", "cone", "plane")),
            **dict.fromkeys(("concentricity", "coaxiality"), axes),
            "symmetry": ("plane", "slot", "cylinder"),
            **dict.fromkeys(ORIENTATIONS, ("plane", "slot", *axes)),
        }.get(tolerance.kind)
        if allowed is None:
            return "the file states no kind of tolerance"
        if tolerance.kind == "surface profile" and tolerance.datums and shape.of_kinds(*PROFILED):
            return ""
        if tolerance.kind == "position" and shape.is_bored and tolerance.zone == "diameter":
            return ""
        if tolerance.kind in ORIENTATIONS and shape.kind == "mixed" and shape.of_kinds("plane"):
            return ""
        if tolerance.kind == "surface profile" and not tolerance.datums and shape.kind not in FORM_ALONE:
            return f"a profile without datums of {shape.words}"
        return "" if shape.kind in allowed else f"{tolerance.kind} of {shape.words}"

    def datum_obstacle(self, compartment: Compartment) -> str:
        """Reason why a compartment of a datum system cannot be said; empty if it can."""
        shapes: list[Shape] = []
        for reference in compartment.references:
            datum = self.datum(reference)
            if datum is None:
                return f"datum {reference.letter}, which the file does not have"
            shape = self.datum_shapes.get(datum.id)
            if shape is None and datum.targets:
                return f"datum {reference.letter} at its targets, of which the file says no place"
            if shape is None or shape.kind not in DATUM_SHAPES:
                return f"datum {reference.letter} of {shape.words if shape else 'no single feature'}"
            if set(reference.modifiers) - MATERIAL:
                return f"datum {reference.letter} with {', '.join(sorted(set(reference.modifiers) - MATERIAL))}"
            if reference.modifiers and shape.kind == "cone":
                return f"datum {reference.letter} of a cone at its boundary"
            shapes.append(shape)
        return self.together_obstacle(compartment, shapes)

    def together_obstacle(self, compartment: Compartment, shapes: Sequence[Shape]) -> str:
        """Why the features of a compartment cannot be one datum; empty where they can, or where there is one."""
        surfaces = [surface for shape in shapes for surface in shape.surfaces]
        kinds = {shape.kind for shape in shapes}
        if len(shapes) == 1 and shapes[0].kind != "cylinders":
            return ""
        what = f"the {'common datum' if len(shapes) > 1 else 'pattern as datum'} {compartment.letters}"
        if not kinds <= {"cylinder", "cylinders"} and kinds != {"plane"}:
            return f"{what} of {' and '.join(shape.words for shape in shapes)}"
        if len(surfaces) > MOST_TOGETHER:
            return f"{what} of {len(surfaces)} features: a datum has {MOST_TOGETHER} at most"
        if not all(aligned(surfaces[0].direction, surface.direction) for surface in surfaces):
            return f"{what} of features that are not parallel"
        bounded = [set(reference.modifiers) & MATERIAL for reference in compartment.references]
        if any(own != bounded[0] for own in bounded):
            return f"{what} at different boundaries of its features"
        return ""

    def is_pattern(self, compartment: Compartment) -> bool:
        """True if a compartment is of features beside each other; False of one, and of holes or pins on one axis."""
        known = [self.datum(reference) for reference in compartment.references]
        shapes = [self.datum_shapes.get(own.id) for own in known if own is not None]
        first, *others = [surface for shape in shapes if shape is not None for surface in shape.surfaces]
        if not others or [shape.kind for shape in shapes if shape is not None] == ["slot"]:
            return False
        return first.kind == "plane" or not all(first.is_coaxial_with(other) for other in others)

    def kind_and_loss(self, tolerance: Tolerance, shape: Shape) -> tuple[str, str]:
        """The kind in the scene, and its loss; empty for none."""
        if tolerance.kind == "surface profile":
            return ("profile", self.profile_loss(tolerance, shape)) if tolerance.datums else FORM_ALONE[shape.kind]
        if tolerance.kind in ORIENTATIONS and shape.kind == "mixed":
            return tolerance.kind, FLAT_ALONE
        if tolerance.kind in ("circular runout", "total runout"):
            radial = tolerance.kind.replace("runout", "run_out").replace(" ", "_")
            return "axial_run_out" if shape.kind == "plane" else radial, ""
        if tolerance.kind == "straightness" and shape.kind == "plane":
            return tolerance.kind, "the direction of its lines is a guess: along the longer side"
        if tolerance.kind in ("concentricity", "symmetry"):
            kind = "coaxiality" if tolerance.kind == "concentricity" else "symmetry"
            return kind, f"{tolerance.kind} of median points is taken of the axis or median plane"
        return tolerance.kind, ""

    def profile_loss(self, tolerance: Tolerance, shape: Shape, kinds: Sequence[str] = PROFILED) -> str:
        """Loss of a profile: faces that are not of some kinds."""
        if tolerance.feature.whole:
            return "it is of the largest flat faces alone that nothing else names"
        lost = sorted({surface.kind for surface in shape.surfaces} - {*kinds})
        words = {"cone": "cones", "torus": "tori", "other": "free forms"}
        return f"its {' and '.join(words[own] for own in lost)} are left out" if lost else ""

    def lower_segment(self, tolerance: Tolerance, shape: Shape, upper: Meaning | None) -> Meaning:
        """The meaning of a lower segment: that of a composite tolerance of a pattern; of one feature an orientation."""
        if upper is None or upper.how == "left out":
            return Meaning(tolerance.id, "left out", "", shape.words, "the lower segment of a frame that is left out")
        above = self.by_id[upper.tolerance]
        if upper.kind not in ("position", "profile"):
            told = f"the lower segment of #{upper.tolerance}, which only limits what is inspected"
            return Meaning(tolerance.id, "left out", "", shape.words, told)
        datum = self.datum_shape(tolerance.datums[0]) if tolerance.datums else None
        if shape.kind in ("cylinders", "spheres"):
            lost = self.segment_loss(tolerance, above)
            return Meaning(tolerance.id, "approximately" if lost else "said", upper.kind, shape.words, lost)
        if upper.kind == "profile" and len(shape.of_kinds(*RIGID)) > 1:
            lost = self.segment_loss(tolerance, above) or self.profile_loss(tolerance, shape, RIGID)
            return Meaning(tolerance.id, "approximately" if lost else "said", upper.kind, shape.words, lost)
        flat = shape.of_kinds("plane")
        if shape.kind in ("mixed", "round") and flat:
            shape = Shape("planes", tuple(flat))
        if shape.kind not in ("plane", "planes", "cylinder") or datum is None:
            why = f"the lower segment of a composite {tolerance.kind}: how the features lie to each other"
            return Meaning(tolerance.id, "left out", "", shape.words, why)
        lost = self.refining_loss(tolerance, above) or self.turn_loss(tolerance, shape, above)
        if shape.kind == "planes":
            lost = f"the lower segment is an orientation of each flat face: {LOST_RELATION}"
        how: Class = "approximately" if lost else "said"
        return Meaning(tolerance.id, how, orientation(shape, datum), shape.words, lost)

    def segment_loss(self, tolerance: Tolerance, above: Tolerance) -> str:
        """Loss of the lower segment of a pattern, which has its modifiers and datums from the upper one."""
        if set(tolerance.modifiers) & MATERIAL != set(above.modifiers) & MATERIAL:
            return "its bonus is that of the upper segment"
        letters = [[datum.letters for datum in own.datums] for own in (tolerance, above)]
        if letters[0] != letters[1][: len(letters[0])]:
            return f"its datums are not the first of #{above.id}: it only limits what is inspected"
        return ""

    def refining_loss(self, tolerance: Tolerance, location: Tolerance) -> str:
        """Loss of an orientation that cannot refine the location zone of its feature."""
        letters = [[datum.letters for datum in own.datums] for own in (tolerance, location)]
        if letters[0] != letters[1][: len(letters[0])]:
            return f"its datums are not the first of #{location.id}: it only limits what is inspected"
        if location.kind == "circular runout":
            return f"an axis does not lean in #{location.id}, a circular run-out: it only limits what is inspected"
        axes = shape_of(tolerance.feature, self.surfaces, self.text.structure).of_kinds("cylinder")
        if axes and tolerance.zone == "width" and self.limited(tolerance, axes[0].direction) is None:
            return "a width of an axis, in a direction that the file does not say: it only limits what is inspected"
        return ""

    def limited(self, tolerance: Tolerance, axis: Vector) -> Vector | None:
        """The one direction in which a width limits an axis: across the last flat datum along it; None if none is."""
        shapes = (self.datum_shape(datum) for datum in reversed(tolerance.datums))
        flat = (
            shape.surfaces[0].direction for shape in shapes if shape is not None and shape.kind in ("plane", "slot")
        )
        return next((own for own in flat if abs(dot(own, axis)) < SQUARE), None)

    def turn_loss(self, tolerance: Tolerance, shape: Shape, location: Tolerance) -> str:
        """Loss of an orientation to one datum whose feature may turn about it, within a zone that stops it."""
        datum = self.datum_shape(tolerance.datums[0]) if len(tolerance.datums) == 1 else None
        if datum is None or len(location.datums) < 2 or not shape.surfaces or not datum.surfaces:
            return ""
        if all(aligned(surface.direction, datum.surfaces[0].direction) != 0 for surface in shape.surfaces):
            return ""
        letter = tolerance.datums[0].letters
        zone = f"here its zone is that of #{location.id}, which limits the turn"
        return f"to {letter} alone it may turn about {letter}: {zone}"

    def modifier_loss(self, tolerance: Tolerance) -> str:
        """Loss of the modifiers of a tolerance."""
        lost = [
            DROPPED.get(modifier, f"{modifier} is dropped")
            for modifier in tolerance.modifiers
            if modifier not in MATERIAL
        ]
        if set(tolerance.modifiers) & MATERIAL and not self.has_size(tolerance.feature):
            lost.append("without a size that has limits there is no bonus")
        if tolerance.maximum is not None:
            lost.append("MAX is lost")
        return "; ".join(lost)

    def boundary_loss(self, tolerance: Tolerance) -> str:
        """Loss of datums at their boundary in words: their bonus counts from a size, which has to have limits."""
        references = [
            reference
            for datum in tolerance.datums
            for reference in datum.references
            if set(reference.modifiers) & MATERIAL
        ]
        known = [self.datum(reference) for reference in references]
        if all(own is not None and self.has_size(self.datum_features[own.id]) for own in known):
            return ""
        letters = "-".join(reference.letter for reference in references)
        return f"without sizes that have limits datum {letters} is taken regardless of size"

    def has_size(self, feature: NamedFeature) -> bool:
        """True if a dimension with limits is of the same faces."""
        faces = set(feature.faces)
        sizes = [dimension for dimension in self.text.dimensions if dimension.is_size and dimension.limits is not None]
        return any(faces & set(size.features[0].faces) for size in sizes)


def unphysical(tolerance: Tolerance) -> str:
    """Reason why the numbers of a tolerance limit nothing; empty if they do."""
    stated, bounded = tolerance.magnitude, MATERIAL & {*tolerance.modifiers}
    if stated is not None and (stated.value < 0.0 or (stated.value == 0.0 and not bounded)):
        return f"a zone of {stated}: expected one wider than 0, or 0 with Ⓜ or Ⓛ"
    lengths = (
        ("projected by", tolerance.projected and tolerance.projected.length),
        ("per", tolerance.per_unit and tolerance.per_unit.size),
        ("per", tolerance.per_unit and tolerance.per_unit.second),
    )
    wrong = next((f"{words} {own}" for words, own in lengths if own and own.value <= 0.0), "")
    return wrong and f"a zone {wrong}: expected a length above 0"


def orientation(shape: Shape, datum: Shape) -> str:
    """The kind of an orientation of planes to a datum by the angle that both have nominally."""
    face, other = shape.surfaces[0], datum.surfaces[0]
    along = aligned(face.direction, other.direction) != 0
    square = abs(dot(face.direction, other.direction)) < SQUARE
    if not along and not square:
        return "angularity"
    return "parallelism" if along == (other.kind == "plane") else "perpendicularity"


def surfaces_of(text: StepText) -> dict[int, Surface]:
    """The surface of every face of every product, by the text alone."""
    found: dict[int, Surface] = {}
    for product in text.structure.products.values():
        unit = product_unit(text.file, product) if product.faces else None
        if unit is not None:
            found |= {face: surface_of(text.file, face, unit) for face in product.faces}
    return found


def meanings(text: StepText, surfaces: Mapping[int, Surface] | None = None) -> tuple[Meaning, ...]:
    """The meaning of each tolerance of a file, in the file's order.

    Args:
        text: the file.
        surfaces: from each face to its surface, if the geometry knows better than the text.

    Raises:
        StepError: a face's surface cannot be read.
    """
    return Meanings(text, surfaces if surfaces is not None else surfaces_of(text)).all
