"""What a scene means: parts, contributors, moves and measures in mm and rad. Nothing here is text any more."""

from tol3d.model.contributor import (
    AxesOffset,
    AxisOffset,
    AxisTilt,
    Contributor,
    Effect,
    Planar,
    Scalar,
    Temperature,
    ToothThickness,
    TurningOffset,
)
from tol3d.model.measure import Backlash, Measure, Positions, Reading
from tol3d.model.model import GearPart, Mesh, Model, Study, Until

from tol3d.model.from_scene import model_from_scene  # isort: skip  (needs the names above)

__all__ = [
    "AxesOffset",
    "AxisOffset",
    "AxisTilt",
    "Backlash",
    "Contributor",
    "Effect",
    "GearPart",
    "Measure",
    "Mesh",
    "Model",
    "Planar",
    "Positions",
    "Reading",
    "Scalar",
    "Study",
    "Temperature",
    "ToothThickness",
    "TurningOffset",
    "Until",
    "model_from_scene",
]
