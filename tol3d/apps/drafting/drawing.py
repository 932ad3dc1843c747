"""The drawing of a part in its file as a scene's tolerances and measures, and its omissions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.apps.drafting.drawn_part import (
    FORMS,
    SMALLEST_ZONE,
    SQUARE,
    Drawn,
    modifier_of,
    piece,
    sized,
    take_distance,
    take_size,
    zone,
)
from tol3d.apps.drafting.entry import LAW, Entry, Wording
from tol3d.apps.drafting.features import USABLE, Group
from tol3d.apps.drafting.words import comment, direction, length, scalar
from tol3d.cad.step import (
    LOCATIONS,
    MATERIAL,
    ORIENTATIONS,
    Dimension,
    FoundFeature,
    Meaning,
    StepError,
    Tolerance,
    Triple,
    extent,
    frame,
    shape_of,
)
from tol3d.numerics.arrays import Array

INSPECTED: Final = frozenset(("inspected_position", "inspected_orientation"))
NOTHING: Final = "left out"
TURNED: Final = ORIENTATIONS | {"axial_run_out"}
UNUSABLE: Final = frozenset(("torus", "free form"))
"""Features of which a scene has no profile."""
AROUND: Final = 72  # directions in which the edges of a face are felt for the farthest one: to 1e-3 of a corner
MOST_OF_ALL: Final = 6  # faces on which a tolerance of the whole part is written
MOST_OF_A_SET: Final = 64  # features that `inspected_set` takes


@dataclass
class Drawing(Drawn):
    """Reading of a drawing."""

    @property
    def product(self) -> int:
        """Product of the part."""
        return self.features.part.body.product

    @cached_property
    def tolerances(self) -> tuple[tuple[Tolerance, Meaning], ...]:
        """Tolerances of this part, uppers before their lower segments, locations before orientations."""
        own = [
            (each, meaning)
            for each, meaning in zip(self.text.tolerances, self.meanings.all, strict=True)
            if self.text.product(each.feature) == self.product
        ]
        return tuple(
            sorted(
                own, key=lambda pair: (pair[0].above is not None, pair[0].kind not in LOCATIONS, pair[0].feature.whole)
            )
        )

    @cached_property
    def dimensions(self) -> tuple[Dimension, ...]:
        """Dimensions of this part."""
        return tuple(
            dimension for dimension in self.text.dimensions if self.text.product(dimension.features[0]) == self.product
        )

    def read(self) -> None:
        """Make all entries."""
        self.take_datums()
        self.take_families()
        for dimension in self.dimensions:
            take_size(self, dimension)
        for tolerance, meaning in self.tolerances:
            if meaning.how != NOTHING and not (tolerance.above and meaning.kind not in ORIENTATIONS):
                self.say(tolerance, meaning)  # a lower segment of a pattern is said with its upper one
        for dimension in self.dimensions:
            take_distance(self, dimension)

    def take_datums(self) -> None:
        """Select the feature of each datum, under its letter."""
        for datum in self.text.datums:
            shape, feature = self.meanings.datum_shapes.get(datum.id), self.meanings.datum_features.get(datum.id)
            if shape is None or feature is None or self.text.product(feature) != self.product:
                continue
            try:
                found = self.features.of_faces(feature.faces)
                if shape.kind == "cylinders" and all(self.features.named(own) is None for own in found):
                    group = self.features.add(found, datum.letter, datum.letter)
                    self.datums[datum.letter] = "-".join(group.names)
                elif shape.kind == "slot" and len(found) == 2:
                    self.datums[datum.letter] = self.features.slot(found, datum.letter).name
                elif len(found) == 1:
                    known = self.features.named(found[0])
                    name = known[1] if known else self.features.add(found, datum.letter, datum.letter).name
                    self.datums[datum.letter] = name
            except StepError:
                continue  # what refers to it is left out, and says so

    def members(self, tolerance: Tolerance) -> list[FoundFeature]:
        """The features that a tolerance is of; of a slot both walls.

        Raises:
            StepError: a scene can do nothing with them.
        """
        shape = shape_of(tolerance.feature, self.meanings.surfaces, self.text.structure)
        if shape.kind in ("mixed", "round") and tolerance.kind == "position":
            return self.features.of_faces(tolerance.feature.faces, frozenset(("plane",)))
        if shape.kind == "mixed" and (tolerance.kind in ORIENTATIONS or tolerance.above):
            return self.features.of_faces(tolerance.feature.faces, USABLE - {"plane"} | UNUSABLE)
        skipped = UNUSABLE if tolerance.kind == "surface profile" else frozenset()
        return self.features.of_faces(tolerance.feature.faces, skipped)

    def is_slot(self, tolerance: Tolerance, kind: str) -> bool:
        """True if a tolerance applies to the middle of two walls; a profile applies to each wall."""
        shape = shape_of(tolerance.feature, self.meanings.surfaces, self.text.structure)
        return shape.kind == "slot" and kind not in ("profile", "flatness")

    def take_families(self) -> None:
        """Select features of one name in the drawing, such as six holes, in one line."""
        signed: dict[tuple[int, ...], tuple[FoundFeature, list[int]]] = {}
        by_name: dict[int, str] = {}
        for tolerance, meaning in self.tolerances:
            if meaning.how == NOTHING or tolerance.feature.whole:
                continue
            try:
                found = self.members(tolerance)
            except StepError as error:
                self.reasons[tolerance.id] = str(error)
                continue
            if self.is_slot(tolerance, meaning.kind):
                if len(found) == 2:
                    self.features.slot(found)
                continue
            by_name[tolerance.id] = tolerance.name
            for own in found:
                signed.setdefault(own.faces, (own, []))[1].append(tolerance.id)
        for dimension in self.dimensions:
            for own in sized(self, dimension):
                if own.faces in signed:
                    signed[own.faces][1].append(dimension.id)
                    by_name[dimension.id] = dimension.name
        families: dict[tuple[tuple[int, ...], str, float], list[FoundFeature]] = {}
        for own, ids in signed.values():
            if self.features.named(own) is None:
                families.setdefault((tuple(ids), own.kind, round(own.radius, 6)), []).append(own)
        for (named_by, *_), family in families.items():
            self.take_family(family, [by_name[each] for each in named_by])

    def take_family(self, family: Sequence[FoundFeature], pmi: Sequence[str]) -> None:
        """Select features that the drawing names alike: in one line, if one means them, else each by itself."""
        if len(family) == 1 and (disc := self.disc(family[0])) is not None:
            self.features.disc(family[0], *disc)
            return
        outward = [self.outward(own) for own in family]
        if any(outward):
            for own, along in zip(family, outward, strict=True):
                self.features.projected(own, along or own.direction, self.features.kind_name(own.kind))
            return
        if len(family) > 1 and family[0].kind != "plane":
            try:
                self.features.add(family, pmi=pmi)
                return
            except StepError:
                pass  # each by itself
        for own in family:
            self.features.add([own], pmi=pmi)

    def outward(self, member: FoundFeature) -> Triple | None:
        """Direction in which a projected zone leads out of a hole, if that is against the hole's axis; else None."""
        for tolerance, meaning in self.tolerances:
            shown = tolerance.projected
            if shown is None or meaning.how == NOTHING or not {*member.faces} & {*tolerance.feature.faces}:
                continue
            axis = np.array(member.direction)
            for end in shown.ends:
                for face in end.faces:
                    own = self.features.part.shell.faces.get(face)
                    if own is None or own.kind != "plane" or abs(np.dot(own.axis, axis)) < 1.0 - SQUARE:
                        continue
                    above = float(np.dot(np.subtract(own.at, member.at), axis))
                    return None if above > 0.0 else (-float(axis[0]), -float(axis[1]), -float(axis[2]))
        return None

    def disc(self, member: FoundFeature) -> tuple[Array, Array, float] | None:
        """Middle, normal and radius of the circle to the farthest edge of a face that runs out about an axis.

        None of a face that is a disc about it already, or that is no plane.
        """
        for tolerance, meaning in self.tolerances:
            if meaning.kind != "axial_run_out" or not {*member.faces} & {*tolerance.feature.faces}:
                continue
            own = self.meanings.datum(tolerance.datums[0].references[0])
            shape = None if own is None else self.meanings.datum_shapes.get(own.id)
            if member.kind != "plane" or shape is None or shape.kind not in ("cylinder", "cone"):
                continue
            axis, normal = np.array(shape.surfaces[0].direction), np.array(member.direction)
            off = np.subtract(member.at, shape.surfaces[0].at)
            if abs(float(axis @ normal)) < 1.0 - SQUARE:
                continue
            middle = np.array(shape.surfaces[0].at) + axis * float(off @ normal) / float(axis @ normal)
            if member.radius and np.linalg.norm(middle - member.at) < SQUARE:
                return None
            x, y = np.array(member.x), np.cross(normal, member.x)
            edges = [edge for face in member.faces for edge in self.features.part.shell.edges[face]]
            ways = [x * np.cos(angle) + y * np.sin(angle) for angle in np.arange(AROUND) * 2.0 * np.pi / AROUND]
            return middle, normal, max(extent(edges, way)[1] - float(way @ middle) for way in ways)
        return None

    def say(self, tolerance: Tolerance, meaning: Meaning) -> None:
        """A tolerance as entries: one of each group of features, and measures that inspect it."""
        try:
            found = [] if tolerance.feature.whole else self.members(tolerance)
            if tolerance.feature.whole:
                groups = self.left_to_all()
            elif self.is_slot(tolerance, meaning.kind):
                if len(found) != 2:
                    raise StepError(f"a slot or tab of {len(found)} faces")
                groups = [self.features.slot(found)]
            else:
                known = [self.features.named(own) for own in found]
                groups = list({id(own[0]): own[0] for own in known if own is not None}.values())
            datums = self.datum_wordings(tolerance)
            together = self.together(tolerance, meaning, groups)
            for group in groups:
                if group not in together[1:]:
                    self.say_of(tolerance, meaning, group, datums, together[1:] if group in together else ())
        except StepError as error:
            self.reasons[tolerance.id] = str(error)

    def together(self, tolerance: Tolerance, meaning: Meaning, groups: Sequence[Group]) -> list[Group]:
        """Those groups that the lower segment of a profile holds to each other, but for what others locate."""
        below = [other for each, other in self.tolerances if each.above == tolerance.id and other.kind == "profile"]
        if meaning.kind != "profile" or not below:
            return []
        return [group for group in groups if group.name not in self.located and group.kind != "cone"]

    def left_to_all(self) -> list[Group]:
        """Features that a tolerance of the whole part locates: the largest planes that nothing else names.

        Raises:
            StepError: there is none.
        """
        of_them = [each.feature.faces for each, _ in self.tolerances] + [datum.faces for datum in self.text.datums]
        taken = {face for faces in of_them for face in faces}
        found = [feature for feature in self.features.part.features if feature.kind == "plane" and not feature.loose]
        left = [own for own in found if not taken & {*own.faces} and self.features.named(own) is None]
        if not left:
            raise StepError("of the whole part: other tolerances and datums name each flat face")
        return [self.features.add([own]) for own in sorted(left, key=lambda own: -own.area)[:MOST_OF_ALL]]

    def datum_wordings(self, tolerance: Tolerance) -> tuple[tuple[str, str], ...]:
        """The datums as a tolerance has them, and as a measure does; the second pair is regardless of size.

        Raises:
            StepError: the scene has no feature for one.
        """
        said, plain, read = [], [], []
        for datum in tolerance.datums:
            letters = [reference.letter for reference in datum.references]
            if missing := [letter for letter in letters if letter not in self.datums]:
                raise StepError(f"datum {', '.join(missing)} is no feature of this scene")
            name = scalar("-".join(self.datums[letter] for letter in letters))
            plain.append(f"{{feature: {name}, simulator: pattern}}" if self.meanings.is_pattern(datum) else name)
            words = sorted({word for reference in datum.references for word in reference.modifiers} & MATERIAL)
            boundary = "lmb" if words and "least" in words[0] else "mmb"
            said.append(f"{{feature: {name}, {boundary}: random}}" if words else plain[-1])
            read.append(f"{{feature: {name}, {boundary}: least}}" if words else plain[-1])
        pairs = [(", ".join(said), ", ".join(read))]
        if said != plain:
            pairs.append((", ".join(plain), ", ".join(plain)))
        return tuple(pairs)

    def say_of(
        self,
        tolerance: Tolerance,
        meaning: Meaning,
        group: Group,
        datums: tuple[tuple[str, str], ...],
        rigid_with: Sequence[Group] = (),
    ) -> None:
        """A tolerance of one group of features, and of others that are one rigid set with it."""
        kind = self.kind_of(tolerance, meaning, group)
        lower = [each for each, other in self.tolerances if each.above == tolerance.id and other.kind == kind]
        below = [] if group.kind == "cone" else lower
        segments = ", ".join(f"#{own.id}" for own in below)
        remark = (f"(lower segment {segments}) " if below else "") + source(tolerance)
        count = sum(len(own.members) for own in (group, *rigid_with))
        name = self.names.new(tolerance.name or kind.replace("_", " "), kind, count)
        locates = tolerance.kind in LOCATIONS and kind not in TURNED and kind not in FORMS
        if locates and kind not in INSPECTED and group.name in self.located:
            words = f"#{self.located[group.name]} locates the feature: this one is inspected only, without a verdict"
            self.doubled[tolerance.id] = words
            kind = "inspected_position"
        if kind in INSPECTED:
            self.inspect(tolerance, kind, group, datums, remark)
            return
        has_law = locates or group.name not in self.located
        wordings = list(self.wordings(tolerance, kind, group, datums, has_law=has_law, rigid_with=rigid_with))
        if not has_law or kind in FORMS:  # a form has a law only where a contact reads it
            wordings += self.wordings(tolerance, kind, group, datums, has_law=not has_law)
        entry = Entry(
            "tolerances", scalar(name), [Wording((line,), remark, lost) for line, lost in wordings],
            tolerance.id, remark, below=tuple(each.id for each in below),
        )  # fmt: skip
        self.entries.append(entry)
        for own in (group, *rigid_with) if locates else ():
            self.located.setdefault(own.name, tolerance.id)
            self.frames.setdefault(own.name, (datums, len(tolerance.datums)))
        if kind in FORMS or (tolerance.unequal is not None and kind != "profile"):
            return
        inspected, count = self.frames.get(group.name, (datums, 0))
        if locates or len(tolerance.datums) != 1 or count < 2 or not self.turns(tolerance, group):
            inspected = datums  # else to one datum alone the turn about it would count, which its zone leaves free
        for own in (group, *rigid_with):
            self.inspect(tolerance, kind, own, inspected, remark, entry)
        for each in below:
            self.inspect_pattern(each, (group, *rigid_with), entry)

    def turns(self, tolerance: Tolerance, group: Group) -> bool:
        """True if a feature may turn about the one datum of its orientation."""
        datum = self.meanings.datum_shape(tolerance.datums[0])
        if datum is None or not datum.surfaces:
            return False
        return abs(float(np.dot(group.members[0].direction, datum.surfaces[0].direction))) < 1.0 - SQUARE

    def kind_of(self, tolerance: Tolerance, meaning: Meaning, group: Group) -> str:
        """The kind of an entry: of an orientation of several faces that of this one."""
        if meaning.kind not in ORIENTATIONS or tolerance.kind in ORIENTATIONS or not tolerance.datums:
            return meaning.kind
        first = self.meanings.datum_shape(tolerance.datums[0])
        if first is None or not first.surfaces:
            return meaning.kind
        cosine = abs(float(np.dot(group.members[0].direction, first.surfaces[0].direction)))
        if first.surfaces[0].kind != "plane":
            cosine = 1.0 - cosine if cosine in (0.0, 1.0) else cosine
        return "parallelism" if cosine > 1.0 - SQUARE else "perpendicularity" if cosine < SQUARE else "angularity"

    def wordings(
        self,
        tolerance: Tolerance,
        kind: str,
        group: Group,
        datums: tuple[tuple[str, str], ...],
        *,
        has_law: bool,
        rigid_with: Sequence[Group] = (),
    ) -> Iterator[tuple[str, str]]:
        """Ways to write a tolerance, the best first, with the losses."""
        own = zone(self.meanings, tolerance, kind, group) + piece(tolerance, kind)
        if kind == "straightness" and group.kind == "plane":
            own += f", lines: {'x' if group.members[0].extent[0] >= group.members[0].extent[1] else 'y'}"
        segments = [("", [])] if group.kind == "cone" else [*self.lower_segments(tolerance, kind, group)]
        if rigid_with:
            others = ", ".join(self.of(own.name) for own in rigid_with)
            segments = [(f", rigid_with: [{others}]{lower}", lost) for lower, lost in segments if lower]
        law = f", law: {LAW}" if has_law else ""
        modifier = modifier_of(tolerance) if group.name in self.sizes and kind not in FORMS else ""
        for k, (said, _) in enumerate(datums):
            for bonus in dict.fromkeys((modifier, "")):
                lost = ["datums at their boundary are taken regardless of size"] if k else []
                lost += ["the bonus is lost"] if bonus != modifier else []
                frame_words = f", datums: [{said}]" if said and kind not in FORMS else ""
                extra = f", modifier: {bonus}" if bonus else ""
                for lower, without in segments:
                    head = f"{{kind: {kind}, of: {self.of(group.name)}, zone: {own}"
                    yield f"{head}{law}{frame_words}{extra}{lower}}}", "; ".join([*lost, *without])
        if kind == "axial_run_out":
            yield from (
                (line, "; ".join(filter(None, (lost, "axial run-out is a perpendicularity: its form is lost"))))
                for line, lost in self.wordings(tolerance, "perpendicularity", group, datums, has_law=has_law)
            )

    def lower_segments(self, tolerance: Tolerance, kind: str, group: Group) -> Iterator[tuple[str, list[str]]]:
        """The lower segment of a composite tolerance as YAML, then none, with what is lost; none alone of others."""
        for each, meaning in self.tolerances:
            if each.above == tolerance.id and meaning.kind == kind:
                datums = self.datum_wordings(each)[-1][0]
                words = f", datums: [{datums}]" if datums else ""
                yield f", lower_segment: {{zone: {zone(self.meanings, each, kind, group)}{words}}}", []
                yield "", ["the lower segment is lost"]
                return
        yield "", []

    def inspect_pattern(self, tolerance: Tolerance, groups: Sequence[Group], entry: Entry) -> None:
        """A measure of a lower segment's own limit: over the places that its datums leave the features together."""
        features = [self.of(own) for group in groups for own in group.names]
        kinds = {group.kind for group in groups}
        if not kinds <= {"cylinder", "plane", "sphere"} or len(features) > MOST_OF_A_SET or not entry.stands:
            return
        assert tolerance.magnitude is not None
        surfaces = ", surfaces: true" if tolerance.kind == "surface profile" else ""
        modifier = modifier_of(tolerance) if groups[0].name in self.sizes and not surfaces else ""
        if tolerance.unequal is not None:
            surfaces += f", middle: {length(tolerance.unequal.value - 0.5 * tolerance.magnitude.value)}"
        read = self.datum_wordings(tolerance)[-1][1]
        frame_words = f", datums: [{read}]" if read else ""
        limit = length(max(tolerance.magnitude.value, SMALLEST_ZONE))
        extra = f", modifier: {modifier}" if modifier else ""
        head = f"{{kind: inspected_set, of: [{', '.join(features)}]{surfaces}, free: oriented"
        words = f"{head}{frame_words}{extra}, upper_limit: {limit}}}"
        name = scalar(self.names.new(f"inspected {tolerance.name or 'pattern'}", "inspected_set"))
        wordings, remark = [Wording((words,))], source(tolerance)
        self.entries.append(Entry("measures", name, wordings, None, remark, (entry,), inspects=tolerance.id))

    def inspect(
        self,
        tolerance: Tolerance,
        kind: str,
        group: Group,
        datums: tuple[tuple[str, str], ...],
        remark: str,
        entry: Entry | None = None,
    ) -> None:
        """Measures of a tolerance, one of each feature: against its own limit, if the scene draws within its zone.

        Another one, such as a second location of a feature, is inspected without a verdict.
        """
        assert tolerance.magnitude is not None
        turned = kind in TURNED or kind == "inspected_orientation"
        measured = "inspected_orientation" if turned else "inspected_position"
        modifier = modifier_of(tolerance) if group.name in self.sizes and not turned else ""
        surface = ""
        if kind == "profile" and (tolerance.unequal is not None or group.kind != "plane"):
            measured, surface = "inspected_set", ", surfaces: true"
            if tolerance.unequal is not None:
                surface += f", middle: {length(tolerance.unequal.value - 0.5 * tolerance.magnitude.value)}"
        projected = ""
        if tolerance.projected is not None and group.kind == "cylinder":
            projected = f", projected: {length(tolerance.projected.length.value)}"
        along = self.meanings.limited(tolerance, group.members[0].direction)
        if turned and group.kind == "cylinder" and tolerance.zone == "width" and along is not None:
            projected += f", direction: {direction(along)}"
        limit = f", upper_limit: {length(max(tolerance.magnitude.value, SMALLEST_ZONE))}" if entry is not None else ""
        label = tolerance.name or kind.replace("_", " ")
        needs = (entry,) if entry is not None else ()
        for feature in group.names:
            words = []
            for _, read in datums:
                for bonus in dict.fromkeys((modifier, "")):
                    frame_words = f", datums: [{read}]" if read else ""
                    extra = f", modifier: {bonus}" if bonus else ""
                    of = f"[{self.of(feature)}]" if measured == "inspected_set" else self.of(feature)
                    head = f"{{kind: {measured}, of: {of}{surface}{frame_words}{extra}{projected}"
                    lost = "" if bonus == modifier else "inspected without the bonus"
                    told = "" if entry else f"{remark}: inspected only, without a verdict"
                    words.append(Wording((f"{head}{limit}}}",), told, lost))
            number = f" {feature.removeprefix(group.name).strip()}" if len(group.names) > 1 else ""
            name = self.names.new(f"inspected {label}{number}", measured)
            source_id = None if entry is not None else tolerance.id
            made = Entry("measures", scalar(name), words, source_id, remark, needs, inspects=tolerance.id)
            self.entries.append(made)


def source(tolerance: Tolerance) -> str:
    """The frame of a tolerance and its place in the file, for a comment."""
    unit = tolerance.magnitude.unit.name if tolerance.magnitude is not None else "mm"
    words = comment(frame(tolerance)) + ("" if unit == "mm" else f" [{comment(unit)}]")
    name = comment(tolerance.name)
    return f"{words}: {name + ', ' if name else ''}#{tolerance.id}"
