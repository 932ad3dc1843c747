"""Effects: what one deviation acts on, one a file. Data that both roads read; neither is told here how far it goes."""

from tol3d.gearing.model.effects.axes_offset import AxesOffset
from tol3d.gearing.model.effects.axis_offset import AxisOffset
from tol3d.gearing.model.effects.axis_tilt import AxisTilt
from tol3d.gearing.model.effects.clocking import Clocking
from tol3d.gearing.model.effects.effect import NOTHING, Effect, Together
from tol3d.gearing.model.effects.plane import AS_COUNTED, Plane
from tol3d.gearing.model.effects.reducer_backlash import ReducerBacklash
from tol3d.gearing.model.effects.temperature import Temperature
from tol3d.gearing.model.effects.tooth_thickness import ToothThickness
from tol3d.gearing.model.effects.turning_offset import TurningOffset

__all__ = [
    "AS_COUNTED",
    "NOTHING",
    "AxesOffset",
    "AxisOffset",
    "AxisTilt",
    "Clocking",
    "Effect",
    "Plane",
    "ReducerBacklash",
    "Temperature",
    "Together",
    "ToothThickness",
    "TurningOffset",
]
