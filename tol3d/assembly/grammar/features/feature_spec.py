"""Common base of all kinds of feature."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Final, Literal, Self, TypeVar

import numpy as np
from pydantic import Field, SerializeAsAny, model_validator

from tol3d.assembly.grammar.features.nominal_frame import ALONG
from tol3d.assembly.grammar.features.pattern import PatternSpec, Scattered
from tol3d.assembly.model import Shape
from tol3d.numerics.arrays import Array
from tol3d.scene.name import Name
from tol3d.scene.vector import Direction, Vector
from tol3d.strict import Strict, refused
from tol3d.units import Quantity

if TYPE_CHECKING:
    from tol3d.cad.solids.pick import PickedFace


FaceKind = Literal["plane", "cylinder", "cone", "sphere"]

AXES: Final = ("cylinder", "axis", "cone")
"""Kinds of feature with an axis, which may lie off across itself."""
ROUND: Final = ("cylinder", "cone", "sphere")
"""Kinds of feature with a round surface."""
SIZED: Final = ("cylinder", "slot")
"""Kinds of feature with opposed surfaces, which engage and whose size widens their zones."""


class FaceSpec(Strict):
    """A face by its name, or the nearest one to a point."""

    name: Name | None = Field(default=None, description="of the face, as the builder has it")
    near: Vector | None = Field(
        default=None, description="a point in the frame of the part that no other such face is as near to"
    )
    kind: FaceKind | None = Field(default=None, description="what it is; default: whatever the feature may be")

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if (self.name is None) == (self.near is None):
            raise refused("", "either a name or a point `near` it", "neither" if self.name is None else "both")
        return self


Known = TypeVar("Known")

Found = Quantity | tuple[Quantity, ...] | tuple[float, float, float] | bool
"""Property of a feature read from its face: a length, some lengths, a direction or a flag."""


class FeatureSpec(Strict):
    """A feature as a scene writes it, in the frame of its part: by numbers, or by a face of the part's solid."""

    words: ClassVar[str]
    face_kinds: ClassVar[tuple[FaceKind, ...]]
    """Kinds of face that it may have; any kind if empty."""
    numbers: ClassVar[tuple[str, ...]] = ("at",)
    """Fields required for a feature stated by numbers."""

    kind: str
    at: Vector | None = Field(default=None, description="the middle of it; default: that of its face")
    pattern: SerializeAsAny[PatternSpec] | None = Field(
        default=None, description="rows and columns of such features, the first of them here; default: one alone"
    )

    @property
    def origin(self) -> Array:
        """Its middle (3,) [mm]."""
        return np.array([coordinate.internal for coordinate in known(self.at, "at")])

    @property
    @abstractmethod
    def shape(self) -> Shape:
        """Shape with the deviations that it can have."""

    @property
    @abstractmethod
    def frame(self) -> Array:
        """Nominally, in its part's frame (4, 4)."""

    @property
    def has_direction(self) -> bool:
        """True if z of its frame is a direction of its own: a normal or an axis."""
        return True

    @property
    def faces_picked(self) -> Mapping[str, FaceSpec]:
        """The faces from which it is picked, by their fields; none for a feature stated by numbers."""
        return {}

    @property
    def x_picked(self) -> Direction | None:
        """Direction of x on a flat face, if stated."""
        return None

    @abstractmethod
    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        """Its fields from the faces.

        Args:
            faces: those of `faces_picked`.

        Raises:
            GeometryError: they form no such feature.
        """

    def members(self, name: str) -> "Mapping[str, Self]":
        """The features that it stands for: itself, or those of its pattern, numbered row by row."""
        if self.pattern is None:
            return {name: self}
        if isinstance(self.pattern, Scattered):  # only in a scene with resolved selectors
            return {f"{name} {k}": own for k, own in enumerate(self.pattern.members, start=1)}
        places = self.pattern.places(known(self.at, "at"), self.frame)
        return {
            f"{name} {k}": self.model_copy(update={"at": at, "pattern": None}) for k, at in enumerate(places, start=1)
        }

    @model_validator(mode="after")
    def _refuse_missing_numbers(self) -> Self:
        for name in self.numbers if not self.faces_picked else ():
            if getattr(self, name) is None:
                raise refused(name, f'the key "{name}" here, or a face of the solid that it is', "neither")
        return self

    @model_validator(mode="after")
    def _refuse_unfit_faces(self) -> Self:
        for field, face in self.faces_picked.items():
            if face.kind is not None and self.face_kinds and face.kind not in self.face_kinds:
                raise refused(f"{field}.kind", " or ".join(self.face_kinds), repr(face.kind))
        return self

    @model_validator(mode="after")
    def _refuse_faces_in_patterns(self) -> Self:
        if self.pattern is None:
            return self
        if self.faces_picked:
            raise refused("pattern", "none of a face of a solid; write its numbers", "both")
        x, y = self.pattern.ways(self.frame)
        if self.pattern.rows > 1 and np.linalg.norm(np.cross(x, y)) <= ALONG:
            raise refused("pattern", "`across`, from row to row, that is not along the columns", "none")
        return self


class OneFaceSpec(FeatureSpec):
    """A feature that is one face."""

    face: FaceSpec | None = Field(
        default=None, description="the face of the part's solid that it is; numbers stated beside it are checked"
    )

    @property
    def faces_picked(self) -> Mapping[str, FaceSpec]:
        return {} if self.face is None else {"face": self.face}


def known(value: Known | None, field: str) -> Known:
    """A field of a feature with known numbers: stated, or found on its face.

    Raises:
        ValueError: it is not.
    """
    if value is None:
        raise ValueError(f"{field} is that of a face that was not looked up")
    return value


def lengths(*values: float) -> tuple[Quantity, ...]:
    """Lengths [mm] as a scene has them."""
    return tuple(Quantity(value, "mm") for value in values)
