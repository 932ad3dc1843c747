"""Cylinders, cones, and axes without a size."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from tol3d.assembly.grammar.features.feature_spec import FaceKind, Found, OneFaceSpec, known, lengths
from tol3d.assembly.grammar.features.nominal_frame import frame
from tol3d.assembly.model import Axis, Cone
from tol3d.scene.bases import Length
from tol3d.scene.listed import listed
from tol3d.scene.vector import Direction
from tol3d.strict import refused
from tol3d.units import Of, Quantity

if TYPE_CHECKING:
    from tol3d.cad.solids.pick import PickedFace


class AxisSpec(OneFaceSpec):
    """A straight axis."""

    words: ClassVar[str] = "an axis"
    face_kinds: ClassVar[tuple[FaceKind, ...]] = ("cylinder", "cone")
    numbers: ClassVar[tuple[str, ...]] = ("at", "axis", "length")

    kind: Literal["axis"]
    axis: Direction | None = Field(default=None, description="direction from start to end")
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
    axis: Direction | None = Field(default=None, description="direction from start to end")
    length: Length | None = Field(default=None, description="from end to end")
    diameter: Length | None = Field(default=None, description="nominal")
    hole: bool = Field(default=False, description="True for a hole, False for a pin")

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
        of_axis: dict[str, Found] = {"at": lengths(*face.at), "axis": face.axis(self.axis), "length": length}
        return {**of_axis, "diameter": diameter, "hole": face.hole}


LEAST_ANGLE: Final = 1e-4
"""Least half angle of a cone, and of its complement [rad]: a more slender cone holds no place along its axis, a wider
one is a face."""


class ConeSpec(OneFaceSpec):
    """A taper or countersink: an axis with a cone about it, which also holds a mating part along the axis."""

    words: ClassVar[str] = "a cone"
    face_kinds: ClassVar[tuple[FaceKind, ...]] = ("cone",)
    numbers: ClassVar[tuple[str, ...]] = ("at", "axis", "length")

    kind: Literal["cone"]
    axis: Direction | None = Field(default=None, description="direction from start to end")
    length: Length | None = Field(default=None, description="from end to end, along the axis")
    diameters: Annotated[tuple[Annotated[Quantity, Of("length")], ...], listed("lengths", 2, 2)] | None = Field(
        default=None, description="nominal, at its start and at its end along the axis; 0 mm at an apex"
    )
    diameter: Length | None = Field(
        default=None, description="nominal, at its middle, with a `half_angle`, instead of `diameters`"
    )
    half_angle: Annotated[Quantity, Of("angle")] | None = Field(
        default=None, description="from the axis to its lines: it widens along the axis"
    )
    hole: bool = Field(default=False, description="True if the material is outside it")

    @property
    def shape(self) -> Cone:
        length = known(self.length, "length").internal
        if self.diameters is None:
            middle, angle = known(self.diameter, "diameter").internal, known(self.half_angle, "half_angle").internal
            ends = middle - length * math.tan(angle), middle + length * math.tan(angle)
        else:
            ends = self.diameters[0].internal, self.diameters[1].internal
        return Cone(length, inner=self.hole, diameters=ends)

    @property
    def frame(self) -> NDArray[np.float64]:
        return frame(self.origin, known(self.axis, "axis"))

    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        (face,) = faces
        axis = face.axis(self.axis)
        radii = face.radii if axis == face.direction else face.radii[::-1]
        of_axis: dict[str, Found] = {"at": lengths(*face.at), "axis": axis, "length": lengths(face.extent[0])[0]}
        return {**of_axis, "diameters": lengths(*(2 * radius for radius in radii)), "hole": face.hole}

    @model_validator(mode="after")
    def _refuse_no_cone(self) -> Self:
        by_angle = self.diameter is not None or self.half_angle is not None
        if by_angle and (self.diameters is not None or self.face is not None):
            beside = "`diameters`" if self.diameters is not None else "a face"
            raise refused("diameter" if self.diameter is not None else "half_angle", f"none beside {beside}", "both")
        if self.face is not None and self.diameters is None:
            return self
        if self.diameters is None and (self.diameter is None or self.half_angle is None):
            expected = "`diameters`, at both its ends, or its `diameter` at the middle with its `half_angle`"
            raise refused("diameters", expected, "neither" if not by_angle else "one of these")
        if self.face is None or self.length is not None:
            self._refuse_unfit_sizes()
        return self

    def _refuse_unfit_sizes(self) -> None:
        field = "diameters" if self.diameters is not None else "half_angle"
        low, high = LEAST_ANGLE, math.pi / 2 - LEAST_ANGLE
        if self.half_angle is not None and not low < self.half_angle.internal < high:
            raise refused(field, "an angle above 0 deg and below 90 deg; turn the axis of one that narrows",
                          self.half_angle)  # fmt: skip
        ends, slope = self.shape.diameters, self.shape.slope
        if min(ends) < 0.0:
            raise refused(field, "diameters of 0 mm or more at both its ends", f"{min(ends):.6g} mm")
        if not low < math.atan(abs(slope)) < high:
            raise refused(field, "two diameters that differ, else it is a cylinder or a face",
                          " and ".join(f"{end:g} mm" for end in ends))  # fmt: skip
