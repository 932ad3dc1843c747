"""Kinds of feature, by numbers."""

from typing import Annotated

from pydantic import Field

from tol3d.assembly.grammar.features.axis import AxisSpec, ConeSpec, CylinderSpec
from tol3d.assembly.grammar.features.plane import PlaneSpec, SlotSpec
from tol3d.assembly.grammar.features.point import PointSpec, SphereSpec

FeatureUnion = Annotated[
    PointSpec | SphereSpec | PlaneSpec | SlotSpec | CylinderSpec | ConeSpec | AxisSpec, Field(discriminator="kind")
]

__all__ = ["AxisSpec", "ConeSpec", "CylinderSpec", "FeatureUnion", "PlaneSpec", "PointSpec", "SlotSpec", "SphereSpec"]
