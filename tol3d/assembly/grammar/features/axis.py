"""Cylinders, and axes without a size."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tol3d.assembly.grammar.features.feature_spec import FaceKind, Found, OneFaceSpec, known, lengths
from tol3d.assembly.grammar.features.nominal_frame import frame
from tol3d.assembly.model import Axis
from tol3d.scene.part import Length
from tol3d.scene.vector import Direction

if TYPE_CHECKING:
    from tol3d.solids.pick import PickedFace


class AxisSpec(OneFaceSpec):
    """A straight axis."""

    words: ClassVar[str] = "an axis"
    face_kinds: ClassVar[tuple[FaceKind, ...]] = ("cylinder", "cone")
    numbers: ClassVar[tuple[str, ...]] = ("at", "axis", "length")

    kind: Literal["axis"]
    axis: Direction | None = Field(default=None, description="which way it runs")
    length: Length | None = Field(default=None, description="from end to end")

    @property
    def shape(self) -> Axis:
        return Axis(known(self.length, "length").internal)

    @property
    def frame(self) -> NDArray[np.float64]:
        return frame(self.origin, known(self.axis, "axis"))

    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        (face,) = faces
        return {"at": lengths(*face.at), "axis": face.axis(self.axis), "length": lengths(face.extent[0])[0]}


class CylinderSpec(OneFaceSpec):
    """A hole, or a pin: an axis with a size."""

    words: ClassVar[str] = "a cylinder"
    face_kinds: ClassVar[tuple[FaceKind, ...]] = ("cylinder",)
    numbers: ClassVar[tuple[str, ...]] = ("at", "axis", "length", "diameter")

    kind: Literal["cylinder"]
    axis: Direction | None = Field(default=None, description="which way it runs")
    length: Length | None = Field(default=None, description="from end to end")
    diameter: Length | None = Field(default=None, description="nominal")
    hole: bool = Field(default=False, description="whether it is one, not a pin")

    @property
    def shape(self) -> Axis:
        length, diameter = known(self.length, "length"), known(self.diameter, "diameter")
        return Axis(length.internal, diameter.internal, self.hole)

    @property
    def frame(self) -> NDArray[np.float64]:
        return frame(self.origin, known(self.axis, "axis"))

    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        (face,) = faces
        length, diameter = lengths(face.extent[0], 2 * face.radius)
        own: dict[str, Found] = {"at": lengths(*face.at), "axis": face.axis(self.axis), "length": length}
        return {**own, "diameter": diameter, "hole": face.hole}
