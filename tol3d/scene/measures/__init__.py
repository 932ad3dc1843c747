"""Kinds of measure, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.scene.measures.angular_backlash import AngularBacklashSpec
from tol3d.scene.measures.circumferential_backlash import CircumferentialBacklashSpec
from tol3d.scene.measures.flank_measure import FlankMeasureSpec
from tol3d.scene.measures.lost_motion import LostMotionSpec
from tol3d.scene.measures.measure import MeasureSpec
from tol3d.scene.measures.mesh_measure import MeshMeasureSpec
from tol3d.scene.measures.normal_backlash import NormalBacklashSpec
from tol3d.scene.measures.tip_displacement import TipDisplacementSpec
from tol3d.scene.measures.tip_error import TipErrorSpec
from tol3d.scene.measures.tip_measure import TipMeasureSpec
from tol3d.scene.measures.train_measure import TrainMeasureSpec

MeasureUnion = Annotated[
    NormalBacklashSpec
    | CircumferentialBacklashSpec
    | AngularBacklashSpec
    | LostMotionSpec
    | TipDisplacementSpec
    | TipErrorSpec,
    Field(discriminator="kind"),
]

__all__ = [
    "AngularBacklashSpec",
    "CircumferentialBacklashSpec",
    "FlankMeasureSpec",
    "LostMotionSpec",
    "MeasureSpec",
    "MeasureUnion",
    "MeshMeasureSpec",
    "NormalBacklashSpec",
    "TipDisplacementSpec",
    "TipErrorSpec",
    "TipMeasureSpec",
    "TrainMeasureSpec",
]
