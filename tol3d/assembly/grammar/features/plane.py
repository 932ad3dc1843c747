"""A flat face."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from tol3d.assembly.grammar.features.feature_spec import (
    FaceKind,
    FaceSpec,
    FeatureSpec,
    Found,
    OneFaceSpec,
    known,
    lengths,
)
from tol3d.assembly.grammar.features.nominal_frame import frame, is_across
from tol3d.assembly.model import Plane, RoundPlane, Slot
from tol3d.errors import GeometryError
from tol3d.scene.bases import Length
from tol3d.scene.listed import listed
from tol3d.scene.vector import Direction
from tol3d.strict import refused

if TYPE_CHECKING:
    from tol3d.cad.solids.pick import PickedFace


class PlaneSpec(OneFaceSpec):
    """A flat face, rectangular or round."""

    words: ClassVar[str] = "a plane"
    face_kinds: ClassVar[tuple[FaceKind, ...]] = ("plane",)
    numbers: ClassVar[tuple[str, ...]] = ("at", "normal")

    kind: Literal["plane"]
    normal: Direction | None = Field(default=None, description="out of the material")
    extent: Annotated[tuple[Length, Length], listed("lengths", 2, 2)] | None = Field(
        default=None, description="along x and y of the face"
    )
    radius: Length | None = Field(default=None, description="of a round face")
    along: Direction | None = Field(
        default=None, description="x of the face; default: the part's x, or its y if the normal is x"
    )

    @property
    def shape(self) -> Plane | RoundPlane:
        if self.extent is not None:
            return Plane((self.extent[0].internal, self.extent[1].internal))
        if self.radius is None:
            raise ValueError("a plane has an extent or a radius")
        return RoundPlane(self.radius.internal)

    @property
    def frame(self) -> NDArray[np.float64]:
        return frame(self.origin, known(self.normal, "normal"), self.along)

    @property
    def x_picked(self) -> Direction | None:
        return self.along

    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        """See FeatureSpec; the rectangle around the face, or its circle."""
        (face,) = faces
        own: dict[str, Found] = {"at": lengths(*face.at), "normal": face.direction}
        if face.radius and self.extent is None:
            return {**own, "radius": lengths(face.radius)[0]}
        return {**own, "extent": lengths(*face.extent)}

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        several = self.extent is not None and self.radius is not None
        if several or (self.extent is None and self.radius is None and self.face is None):
            got = "both" if several else "neither"
            raise refused("extent", "either an extent such as [100 mm, 60 mm] or a radius", got)
        if self.along is not None and self.normal is not None and not is_across(self.along, self.normal):
            raise refused("along", "a direction across the normal", list(self.along))
        return self


PARALLEL: Final = 1e-9
"""Sine between the walls of a slot, beyond which they are none."""


class SlotSpec(FeatureSpec):
    """A slot, or a tab: two parallel faces by the plane in their middle."""

    words: ClassVar[str] = "a slot"
    face_kinds: ClassVar[tuple[FaceKind, ...]] = ("plane",)
    numbers: ClassVar[tuple[str, ...]] = ("at", "normal", "extent", "width")

    kind: Literal["slot"]
    normal: Direction | None = Field(default=None, description="across its width")
    extent: Annotated[tuple[Length, Length], listed("lengths", 2, 2)] | None = Field(
        default=None, description="of the plane in the middle, along its x and y"
    )
    width: Length | None = Field(default=None, description="nominal")
    along: Direction | None = Field(
        default=None, description="x of the plane in the middle; default: the part's x (or y)"
    )
    faces: Annotated[tuple[FaceSpec, FaceSpec], listed("faces", 2, 2)] | None = Field(
        default=None, description="both walls, of the part's solid; numbers stated beside them are checked"
    )
    tab: bool = Field(default=False, description="whether it is one, not a slot")

    @property
    def shape(self) -> Slot:
        x, y = known(self.extent, "extent")
        return Slot((x.internal, y.internal), known(self.width, "width").internal, not self.tab)

    @property
    def frame(self) -> NDArray[np.float64]:
        return frame(self.origin, known(self.normal, "normal"), self.along)

    @property
    def faces_picked(self) -> Mapping[str, FaceSpec]:
        return {} if self.faces is None else {f"faces.{k}": face for k, face in enumerate(self.faces)}

    @property
    def x_picked(self) -> Direction | None:
        return self.along

    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        """See FeatureSpec; the middle of the rectangles around both walls, and their smaller sides."""
        first, second = faces
        across, there = np.array(first.direction), np.array(second.at) - np.array(first.at)
        if np.linalg.norm(np.cross(across, second.direction)) > PARALLEL or across @ second.direction > 0.0:
            raise GeometryError("expected two parallel walls that face each other, or face away, got others")
        x, y = (min(pair) for pair in zip(first.extent, second.extent, strict=True))
        width = float(across @ there)
        middle = np.array(first.at) + there / 2
        normal = first.direction if self.normal is None or across @ self.normal > 0.0 else second.direction
        own: dict[str, Found] = {"at": lengths(*middle.tolist()), "normal": normal, "extent": lengths(x, y)}
        return {**own, "width": lengths(abs(width))[0], "tab": width < 0.0}

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.along is not None and self.normal is not None and not is_across(self.along, self.normal):
            raise refused("along", "a direction across the normal", list(self.along))
        return self
