"""What drawings say of each feature: the tolerances of its location, orientation, form and size, and their datums.

A part that is like another has tolerances of its own, named "position of cover 2" where the other's is "position".
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features import AxisSpec, CylinderSpec, FeatureUnion, PointSpec, SphereSpec
from tol3d.assembly.grammar.features.nominal_frame import Array, unit
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.grammar.tolerances import (
    FeatureTolerance,
    LocationSpec,
    LocatorSpec,
    OrientationSpec,
    PlusMinusSpec,
)
from tol3d.assembly.grammar.tolerances.form import FormSpec
from tol3d.assembly.model.dimension import longer
from tol3d.scene import Scene


@dataclass(frozen=True)
class Stated:
    """A tolerance as it holds for one feature.

    Args:
        name: of the contributor.
        entry: what the scene calls it.
        spec: what it says.
        feature: of which, with its part.
    """

    name: str
    entry: str
    spec: FeatureTolerance
    feature: str


@dataclass(frozen=True)
class Drawing:
    """What a scene's tolerances say, feature by feature."""

    scene: Scene

    @cached_property
    def features(self) -> Mapping[str, Mapping[str, FeatureUnion]]:
        """The features of each part, by its name and theirs; those of a part that is like another are the other's."""
        solids = self.scene.of(SolidSpec)
        return {name: (solids[own.like] if own.like else own).features for name, own in solids.items()}

    def has_solid(self, part: str) -> bool:
        """Whether a part has a builder, or is like one that has."""
        solids = self.scene.of(SolidSpec)
        return solids[solids[part].like or part].builder is not None

    @cached_property
    def stated(self) -> tuple[Stated | str, ...]:
        """Every tolerance, for each part that it holds for, in the scene's order; locators by their names."""
        alike: dict[str, list[str]] = {}
        for name, solid in self.scene.of(SolidSpec).items():
            if solid.like is not None:
                alike.setdefault(solid.like, []).append(name)
        found: list[Stated | str] = []
        for name, spec in self.scene.tolerances.items():
            if isinstance(spec, LocatorSpec):
                found.append(name)
            elif isinstance(spec, FeatureTolerance):
                part, _, feature = spec.of.partition(".")
                found.append(Stated(name, name, spec, spec.of))
                found += [
                    Stated(f"{name} of {other}", name, spec, f"{other}.{feature}") for other in alike.get(part, ())
                ]
        return tuple(found)

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

    def form(self, feature: str) -> float:
        """What its form takes of a location zone's width [mm]."""
        return sum(own.spec.zone.size for own in self.of(feature, FormSpec) if isinstance(own.spec, FormSpec))

    def orientation(self, feature: str) -> float | None:
        """Width of the zone to which its orientation is refined [mm], beside a location zone."""
        widths = [
            own.spec.zone.size for own in self.of(feature, OrientationSpec) if isinstance(own.spec, OrientationSpec)
        ]
        return min(widths, default=None)

    def datums(self, feature: str) -> tuple[DatumSpec, ...]:
        """Those of the tolerance that says where it lies; of its orientation where none says that."""
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

        None where nothing but `along` could say it: of an axis, of a point without a normal that has datums, and of
        what lies off none of its datums along its normal.
        """
        own = self.kind(feature)
        if spec.along is not None:
            return unit(spec.along)
        if isinstance(own, AxisSpec | CylinderSpec):
            return None
        normal = own.frame[:3, 2]
        if not spec.named_datums:
            return normal
        if isinstance(own, SphereSpec) or (isinstance(own, PointSpec) and own.normal is None):
            return None
        features = self.features[part_of(feature)]
        datums = [[features[name] for name in datum.features if name in features] for datum in spec.named_datums]
        found = longer(own.frame[:3, 3], normal, filter(None, datums))  # of unknown names another check tells
        return None if found is None else normal * found[1]

    def parents(self) -> Iterator[tuple[str, tuple[DatumSpec, ...]]]:
        """Each feature, and the datums to which its location is toleranced."""
        for name in self.names:
            yield name, self.datums(name)

    def kind(self, feature: str) -> FeatureUnion:
        """What a scene says of a feature."""
        return self.features[part_of(feature)][feature.partition(".")[2]]
