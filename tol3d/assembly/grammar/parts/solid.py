"""A part of any shape, of which a scene names features.

A part from a STEP file.
"""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.assembly.grammar.builders import BuilderUnion, OwnFileSpec
from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.features.nominal_frame import frame, is_across
from tol3d.assembly.grammar.features.selector import SelectedUnion, SelectorSpec
from tol3d.scene.bases import GrowingSpec
from tol3d.scene.entry import Contradiction, Reference
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction, Vector
from tol3d.strict import Strict, refused
from tol3d.units import shown

MOST_ALIKE: Final = 8  # parts in sequence that copy each other; as many as a reader can follow


class Placement(Strict):
    """Nominal pose of a part."""

    at: Vector | None = Field(default=None, description="its origin, in the world; default: the world's origin")
    z: Direction = Field(default=(0.0, 0.0, 1.0), description="its z axis")
    x: Direction | None = Field(default=None, description="its x axis, as near as may be")

    @property
    def pose(self) -> NDArray[np.float64]:
        """In the world (4, 4) [mm]."""
        at = np.zeros(3) if self.at is None else np.array([own.internal for own in self.at])
        return frame(at, self.z, self.x)

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.x is not None and not is_across(self.x, self.z):
            raise refused("x", "a direction across z", list(self.x))
        return self


class SolidSpec(GrowingSpec):
    """A rigid part with features, by numbers or picked from its solid, or `like` another part, or both."""

    words: ClassVar[str] = "a solid part"
    origin_field: ClassVar[KeyPath] = ("placed", "at")

    kind: Literal["solid"]
    features: Mapping[OwnName, FeatureUnion] = Field(default_factory=dict, description="what its drawing names")
    builder: BuilderUnion | None = Field(default=None, description="its solid by dimensions, for what needs one")
    like: Name | None = Field(
        default=None,
        description="another part of the same drawing, whose features, tolerances and solid it has, with deviations of "
        "its own; features beside it replace those of their names, or are further ones",
    )
    placed: Placement = Field(default_factory=Placement, description="nominal place; moves find theirs near it")

    def references(self) -> tuple[Reference, ...]:
        """The part that it is like."""
        return () if self.like is None else (Reference(("like",), self.like, (SolidSpec,)),)

    def contradictions(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> Iterator[Contradiction]:
        """Refuse parts that copy each other in a ring, reported at the first of them, and too many in sequence."""
        chain: list[str] = []
        like = self.like
        while like is not None and like not in chain:
            chain.append(like)
            like = parts[like].like
        if like is not None:
            ring = chain[chain.index(like) :]
            if next(own for name, own in parts.items() if name in ring) is self:
                names = " like ".join((ring[-1], *ring))
                yield Contradiction(("like",), "a part that is not like itself", f"a ring: {names}", leads=True)
        elif len(chain) == MOST_ALIKE + 1:
            expected = f"at most {MOST_ALIKE} parts in sequence that are each like another"
            yield Contradiction(("like",), expected, f"one more; write like: {chain[-1]}", leads=True)

    @property
    def has_solid(self) -> bool:
        return self.builder is not None

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """The program that builds it."""
        if isinstance(self.builder, OwnFileSpec):
            yield ("builder", "file"), self.builder.file

    @model_validator(mode="after")
    def _refuse_faces_of_nothing(self) -> Self:
        for name, feature in self.features.items() if self.builder is None else ():
            for field in feature.faces_picked:
                raise refused(f"features.{name}.{field}", "a part with a builder, whose solid has faces", "none")
        return self

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if not self.features and self.like is None:
            raise refused("features", "features, or `like: another part`", "neither")
        for name, feature in self.features.items():
            if twice := next(
                (member for member in feature.members(name) if member != name and member in self.features), None
            ):
                expected = f"a name of its own, for the pattern {name!r} has such a feature"
                raise refused(f"features.{twice}", expected, shown(twice))
        if self.builder is not None and self.like is not None:
            raise refused("builder", "none beside `like`, which brings that part's", self.builder.kind)
        return self


def likes(name: str, solids: Mapping[str, SolidSpec]) -> tuple[str, ...]:
    """A part and those that it copies, the nearest first; the last one has the solid, if any has.

    Args:
        name: of the part.
        solids: all of a scene; of a ring, which is refused elsewhere, each is told once.
    """
    found = [name]
    while (like := solids[found[-1]].like) is not None and like not in found:
        found.append(like)
    return tuple(found)


class StepSpec(SolidSpec):
    """A rigid part whose solid is that of a STEP file, with features selected on it; it has no `builder`."""

    words: ClassVar[str] = "a part from a STEP file"

    kind: Literal["step"]  # type: ignore[assignment]
    file: str = Field(description="the STEP file, in the scene's folder")
    product: str | None = Field(default=None, description="which of its products; default: the only one")
    use: str | None = Field(
        default=None,
        description="a part as it stands in the file's assembly, such as lower/bolt_2, in place of `product`; "
        "placed as there if `placed` is not given",
    )
    features: Mapping[OwnName, SelectedUnion] = Field(  # type: ignore[assignment]
        default_factory=dict, description="what its drawing names: selected on its faces, or by numbers"
    )

    @property
    @override
    def has_solid(self) -> bool:
        return True

    @property
    def selectors(self) -> Mapping[str, SelectorSpec]:
        """The features that are selected on its faces, by their names."""
        return {name: own for name, own in self.features.items() if isinstance(own, SelectorSpec)}

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """The STEP file."""
        yield ("file",), self.file

    @model_validator(mode="after")
    def _refuse_other_solids(self) -> Self:
        if self.builder is not None:
            raise refused("builder", "none of a part from a STEP file, which has its solid", "one")
        if self.product is not None and self.use is not None:
            raise refused("product", "none beside `use`, which says it", "both")
        return self
