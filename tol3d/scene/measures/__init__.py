"""Kinds of measure, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.scene.measures.angular_backlash import AngularBacklashSpec
from tol3d.scene.measures.circumferential_backlash import CircumferentialBacklashSpec
from tol3d.scene.measures.measure import MeasureSpec
from tol3d.scene.measures.normal_backlash import NormalBacklashSpec

MeasureUnion = Annotated[
    NormalBacklashSpec | CircumferentialBacklashSpec | AngularBacklashSpec, Field(discriminator="kind")
]

__all__ = ["AngularBacklashSpec", "CircumferentialBacklashSpec", "MeasureSpec", "MeasureUnion", "NormalBacklashSpec"]
