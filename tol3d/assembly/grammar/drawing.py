"""Drawing of each feature: tolerances of location, orientation, form and size, and their datums.

A part that copies another has its own tolerances, "position of cover 2" for "position"; so has each feature of a
pattern, such as "position 3".
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.features.feature_spec import AXES
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.forms import of_location, of_section, of_total_run_out
from tol3d.assembly.grammar.parts import SolidSpec, likes
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.grammar.tolerances.location import (
    AxialRunOutSpec,
    CircularRunOutSpec,
    Composite,
    FlatnessSpec,
    FormSpec,
    LocationSpec,
    OrientationSpec,
    ProfileSpec,
    StraightnessSpec,
    TotalRunOutSpec,
    is_of_round_surface,
)
from tol3d.assembly.grammar.tolerances.plus_minus import ENVELOPED, LocatorSpec, PlusMinusSpec, SizeSpec
from tol3d.assembly.grammar.zone import ZoneSpec
from tol3d.assembly.model.dimension import longer
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene

MOST_FEATURES: Final = 100_000  # of a scene, patterns written out: fifty a part of the most parts; 10 kB each


@dataclass(frozen=True)
class Stated:
    """A tolerance as applied to one feature.

    Args:
        name: of the contributor.
        entry: its name in the scene.
        spec: its entry.
        feature: the feature, with its part.
        is_first: True for the only feature, or the first of a pattern.
        alike: True for a part that copies the entry's part.
    """

    name: str
    entry: str
    spec: FeatureTolerance
    feature: str
    is_first: bool = True
    alike: bool = False

    @property
    def is_own(self) -> bool:
        """True of a feature by which its entry is judged: that of the scene, each of a set, the first of a pattern."""
        return (self.is_first or len(self.spec.all_of) > 1) and not self.alike


@dataclass(frozen=True)
class Drawing:
    """Tolerances of a scene, feature by feature."""

    scene: Scene

    @cached_property
    def written(self) -> Mapping[str, Mapping[str, FeatureUnion]]:
        """The features of each part as in the scene, patterns as one: its own, and those of the part that it copies."""
        solids = self.scene.of(SolidSpec)
        found: dict[str, dict[str, FeatureUnion]] = {}
        for name in solids:
            found[name] = {}
            for like in reversed(likes(name, solids)):
                found[name].update(solids[like].features)
        return found

    @cached_property
    def features(self) -> Mapping[str, Mapping[str, FeatureUnion]]:
        """The features of each part, by its name and theirs; a pattern's each by itself.

        Raises:
            SceneError: they are too many.
        """
        count = 0
        for part, entries in self.written.items():
            count += sum(entry.pattern.count if entry.pattern else 1 for entry in entries.values())
            if count > MOST_FEATURES:
                words = f"expected at most {MOST_FEATURES} features in a scene, got {count} up to here"
                raise self.scene.refuse(("parts", part), words)
        return {
            part: {name: own for entry in entries for name, own in self._members(part, entry).items()}
            for part, entries in self.written.items()
        }

    @cached_property
    def toleranced(self) -> Mapping[str, Mapping[str, FeatureUnion]]:
        """Names that tolerances may use of each part: its features, and patterns as a whole."""
        return {part: {**self.written[part], **features} for part, features in self.features.items()}

    def _members(self, part: str, entry: str) -> Mapping[str, FeatureUnion]:
        """Features that an entry of a part stands for: itself, or a pattern's but for those written by themselves."""
        entries = self.written.get(part, {})
        if entry not in entries:
            return {}
        found: Mapping[str, FeatureUnion] = entries[entry].members(entry)
        return {name: own for name, own in found.items() if name == entry or name not in entries}

    def has_solid(self, part: str) -> bool:
        """True if a part, or the one that it copies, has a builder or a file."""
        solids = self.scene.of(SolidSpec)
        return solids[likes(part, solids)[-1]].has_solid

    @cached_property
    def stated(self) -> tuple[Stated | str, ...]:
        """Every tolerance, for each feature and part that it holds for, in the scene's order; locators by their names.

        A copy's own tolerances replace those of the same group of the part that it copies.
        """
        solids = self.scene.of(SolidSpec)
        chains = {name: likes(name, solids) for name in solids}
        alike: dict[str, list[str]] = {}
        for name, chain in chains.items():
            for other in chain[1:]:
                alike.setdefault(other, []).append(name)
        specs = self.scene.of(FeatureTolerance).values()
        said = {(own, _group(spec)) for spec in specs for name in spec.all_of for own in self._meant(*_split(name))}
        found: list[Stated | str] = []
        for name, spec in self.scene.tolerances.items():
            if isinstance(spec, LocatorSpec):
                found.append(name)
            elif isinstance(spec, FeatureTolerance):
                part = part_of(spec.of)
                found += self._each(name, spec, part)
                for other in alike.get(part, ()):
                    nearer = chains[other][: chains[other].index(part)]
                    for own in self._each(name, spec, other):
                        its = _split(own.feature)[1]
                        instead = any((f"{near}.{its}", _group(spec)) in said for near in nearer)
                        if its in self.features[other] and not instead:
                            found.append(replace(own, name=f"{own.name} of {other}", alike=True))
        return tuple(found)

    def _meant(self, part: str, feature: str) -> tuple[str, ...]:
        """The features of a part that a name in a tolerance means: one, or those of a pattern."""
        own = self.written.get(part, {}).get(feature)
        names = (feature,) if own is None or own.pattern is None else own.members(feature)
        return tuple(f"{part}.{name}" for name in names)

    def _each(self, name: str, spec: FeatureTolerance, part: str) -> Iterator[Stated]:
        written = [_split(own)[1] for own in spec.all_of]
        features = [own for feature in written for own in self._meant(part, feature)]
        if features == [f"{part}.{written[0]}"]:
            yield Stated(name, name, spec, features[0])
            return
        for k, own in enumerate(features):
            number = int(own.rpartition(" ")[2]) if len(written) == 1 else k + 1
            yield Stated(f"{name} {number}", name, spec, own, is_first=k == 0)

    @cached_property
    def _by_feature(self) -> Mapping[str, Sequence[Stated]]:
        found: dict[str, list[Stated]] = {}
        for own in self.stated:
            if isinstance(own, Stated):
                found.setdefault(own.feature, []).append(own)
        return found

    def of(self, feature: str, spec: type[FeatureTolerance]) -> tuple[Stated, ...]:
        """Its tolerances of a kind, or of several with a class in common."""
        return tuple(own for own in self._by_feature.get(feature, ()) if isinstance(own.spec, spec))

    def composite(self, own: Stated) -> Sequence[Stated]:
        """A composite tolerance of each feature of the pattern of which one is; none of another tolerance."""
        if not isinstance(own.spec, Composite) or own.spec.lower_segment is None:
            return ()
        return self._patterns[own.entry, part_of(own.feature)]

    @cached_property
    def _patterns(self) -> Mapping[tuple[str, str], Sequence[Stated]]:
        """By entry and part."""
        found: dict[tuple[str, str], list[Stated]] = {}
        for own in self.stated:
            if isinstance(own, Stated):
                found.setdefault((own.entry, part_of(own.feature)), []).append(own)
        return found

    def form(self, feature: str, located: FeatureTolerance | None = None) -> float:
        """Part of a zone's width used by form [mm]; default that of a location or an axial run-out."""
        forms = [own.spec for own in self.of(feature, FormSpec) if isinstance(own.spec, FormSpec)]
        shape, room = self.kind(feature).shape, self.room(located)
        match located:
            case CircularRunOutSpec():
                return of_section(forms, shape, room)
            case TotalRunOutSpec() | ProfileSpec() if self.kind(feature).kind in TotalRunOutSpec.applies_to:
                return of_total_run_out(forms, shape, room)
            case ProfileSpec() if shape.diameter is not None:
                return of_section(forms, shape, room)
        return of_location(forms, shape, room)

    @staticmethod
    def room(located: FeatureTolerance | None) -> float:
        """Width of the zone in which a tolerance of location or axial run-out holds the form too [mm]."""
        lower = located.lower_segment if isinstance(located, Composite) else None
        if lower is not None:
            return lower.zone.size
        return located.zone.size if isinstance(located, LocationSpec | AxialRunOutSpec) else math.inf

    def oriented(self, own: Stated) -> float:
        """Width of a zone of orientation [mm], where a location zone, or else itself, holds the feature.

        For an axial run-out it is that of the whole face, without its form; for a projected axis it scales with the
        lengths of both zones.
        """
        assert isinstance(own.spec, OrientationSpec)
        width = own.spec.zone.size
        if located := self.of(own.feature, LocationSpec):
            spec = located[0].spec
            assert isinstance(spec, LocationSpec)
            width *= self.held_over(own.feature, spec.zone) / self.held_over(own.feature, own.spec.zone)
        if not isinstance(own.spec, AxialRunOutSpec):
            return width
        whole, radius = self.kind(own.feature).shape.rim_radius, own.spec.radius
        left = max(width - self.form(own.feature, own.spec), 0.0)
        return left if radius is None or whole is None else left * whole / radius.internal  # None: refused elsewhere

    def held_over(self, feature: str, zone: ZoneSpec) -> float:
        """The length over which a zone holds a feature [mm]: its own, or beyond its end; 1 of a point."""
        if zone.projected is not None:
            return zone.projected.internal
        return self.kind(feature).shape.longest or 1.0

    def is_sized(self, feature: str) -> bool:
        """True if a tolerance states its size: a size tolerance, or a profile of a round surface."""
        kind = self.kind(feature).kind
        surfaces = (own for own in self.of(feature, LocationSpec) if is_of_round_surface(own.spec, kind))
        return bool(self.of(feature, SizeSpec)) or any(surfaces)

    def is_enveloped(self, feature: str) -> bool:
        """True if limits of size bound its form: its size says so, or else the scene and its standard.

        Rule #1 of ASME Y14.5 does not hold for a feature whose axis or median plane has a form tolerance of its own.
        """
        if self.kind(feature).kind not in ENVELOPED:
            return False
        specs = [own.spec for own in self.of(feature, SizeSpec)]
        said = next((spec.envelope for spec in specs if isinstance(spec, SizeSpec)), False)
        if said is None and self.scene.standard == "asme":
            return self.scene.envelope is not False and not any(map(_is_of_middle, self.of(feature, FormSpec)))
        return bool(self.scene.envelope if said is None else said)

    def datums(self, feature: str) -> tuple[DatumSpec, ...]:
        """Datums of its location tolerance; those of its orientation if it has none."""
        for spec in (LocationSpec, PlusMinusSpec, OrientationSpec):
            for own in self.of(feature, spec):
                return own.spec.named_datums
        return ()

    @cached_property
    def names(self) -> tuple[str, ...]:
        """All features, with their parts."""
        return tuple(f"{part}.{feature}" for part, features in self.features.items() for feature in features)

    def positive(self, feature: str, spec: PlusMinusSpec) -> Array | None:
        """The direction (3,) in which a dimension of a feature is positive, in its part's frame, of unit length.

        None if only `along` can state it: for an axis, for a point with datums but without a normal, and for a feature
            that is off none of its datums along its normal.
        """
        own = self.kind(feature)
        if spec.along is not None:
            return unit(spec.along)
        if own.kind in AXES:
            return None
        normal = own.frame[:3, 2]
        if not spec.named_datums:
            return normal
        if not own.has_direction:
            return None
        features = self.features[part_of(feature)]
        datums = [[features[name] for name in datum.features if name in features] for datum in spec.named_datums]
        found = longer(own.frame[:3, 3], normal, filter(None, datums))  # another check reports unknown names
        return None if found is None else normal * found[1]

    def parents(self) -> Iterator[tuple[str, tuple[DatumSpec, ...]]]:
        """Each feature, and the datums to which its location is toleranced."""
        for name in self.names:
            yield name, self.datums(name)

    def kind(self, feature: str) -> FeatureUnion:
        """Entry of a feature in the scene; of a pattern, of its first."""
        part, own = _split(feature)
        features = self.features[part]
        return features[own] if own in features else next(iter(self._members(part, own).values()))


def _split(feature: str) -> tuple[str, str]:
    part, _, own = feature.partition(".")
    return part, own


def _is_of_middle(own: Stated) -> bool:
    """True of the straightness of an axis and the flatness of a median plane; lines of a surface have a width alone."""
    match own.spec:
        case StraightnessSpec(zone=zone):
            return zone.diameter is not None or zone.along is not None
        case FlatnessSpec():
            return True
    return False


def _group(spec: FeatureTolerance) -> type[FeatureTolerance]:
    """Group of a tolerance: location, orientation, size or form."""
    if isinstance(spec, LocationSpec | PlusMinusSpec):
        return LocationSpec
    return next((kind for kind in (OrientationSpec, SizeSpec, FormSpec) if isinstance(spec, kind)), type(spec))
