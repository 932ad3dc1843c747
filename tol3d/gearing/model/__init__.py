"""What a scene means: parts, contributors, moves and measures in mm and rad. Nothing here is text any more."""

from tol3d.gearing.effects import (
    AxesOffset,
    AxisOffset,
    AxisTilt,
    Clocking,
    Effect,
    ReducerBacklash,
    Temperature,
    Together,
    ToothThickness,
    TurningOffset,
)
from tol3d.gearing.model.contributor import Contributor
from tol3d.gearing.model.layout import Layout
from tol3d.gearing.model.measure import Backlash, Kind, LostMotion, Measure, Reading
from tol3d.gearing.model.mesh import Mesh, Seat
from tol3d.gearing.model.model import GearPart, Model
from tol3d.gearing.model.shafts import Arm, Reducer, Shaft, Train
from tol3d.system.draw import Planar, Scalar
from tol3d.system.positions import Positions

from tol3d.gearing.model.from_scene import model_from_scene  # isort: skip  (needs the names above)

__all__ = [
    "Arm",
    "AxesOffset",
    "AxisOffset",
    "AxisTilt",
    "Backlash",
    "Clocking",
    "Contributor",
    "Effect",
    "GearPart",
    "Kind",
    "Layout",
    "LostMotion",
    "Measure",
    "Mesh",
    "Model",
    "Planar",
    "Positions",
    "Reading",
    "Reducer",
    "ReducerBacklash",
    "Scalar",
    "Seat",
    "Shaft",
    "Temperature",
    "Together",
    "ToothThickness",
    "Train",
    "TurningOffset",
    "model_from_scene",
]
