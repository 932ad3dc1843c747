"""Kinds of measure, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.gearing.grammar.measures.angular_backlash import AngularBacklashSpec
from tol3d.gearing.grammar.measures.circumferential_backlash import CircumferentialBacklashSpec
from tol3d.gearing.grammar.measures.flank_measure import FlankMeasureSpec
from tol3d.gearing.grammar.measures.lost_motion import LostMotionSpec
from tol3d.gearing.grammar.measures.mesh_measure import MeshMeasureSpec
from tol3d.gearing.grammar.measures.normal_backlash import NormalBacklashSpec
from tol3d.gearing.grammar.measures.tip_displacement import TipDisplacementSpec
from tol3d.gearing.grammar.measures.tip_error import TipErrorSpec
from tol3d.gearing.grammar.measures.tip_measure import TipMeasureSpec
from tol3d.gearing.grammar.measures.train_measure import TrainMeasureSpec
from tol3d.scene.measure import MeasureSpec

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
