"""Model of a scene: parts, contributors, moves and measures in mm and rad. Nothing here is text any more."""

from tol3d.gearing.effects import (
    AxesOffset,
    AxialPlay,
    AxisOffset,
    AxisTilt,
    Clocking,
    CombinedEffect,
    Effect,
    LinkDeviation,
    Temperature,
    ToothThickness,
    TurningOffset,
)
from tol3d.gearing.links import Reducer, StatedLink
from tol3d.gearing.model.layout import Layout
from tol3d.gearing.model.measure import Backlash, Kind, LostMotion, Measure, Reading, TransmissionError
from tol3d.gearing.model.model import Contributor, GearPart, Model
from tol3d.gearing.shafts import Arm, Mesh, Seat, Shaft, Train
from tol3d.study.system.draw import Planar, Scalar
from tol3d.study.system.positions import Positions

from tol3d.gearing.model.from_scene import model_from_scene  # isort: skip  (needs the names above)

__all__ = [
    "Arm",
    "AxesOffset",
    "AxialPlay",
    "AxisOffset",
    "AxisTilt",
    "Backlash",
    "Clocking",
    "CombinedEffect",
    "Contributor",
    "Effect",
    "GearPart",
    "Kind",
    "Layout",
    "LinkDeviation",
    "LostMotion",
    "Measure",
    "Mesh",
    "Model",
    "Planar",
    "Positions",
    "Reading",
    "Reducer",
    "Scalar",
    "Seat",
    "Shaft",
    "StatedLink",
    "Temperature",
    "ToothThickness",
    "Train",
    "TransmissionError",
    "TurningOffset",
    "model_from_scene",
]
