"""Kinds of measure, one file each."""

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
from tol3d.gearing.grammar.measures.transmission_error import TransmissionErrorSpec

__all__ = [
    "AngularBacklashSpec",
    "CircumferentialBacklashSpec",
    "FlankMeasureSpec",
    "LostMotionSpec",
    "MeshMeasureSpec",
    "NormalBacklashSpec",
    "TipDisplacementSpec",
    "TipErrorSpec",
    "TipMeasureSpec",
    "TrainMeasureSpec",
    "TransmissionErrorSpec",
]
