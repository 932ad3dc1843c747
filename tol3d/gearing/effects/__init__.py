"""Effects: on what one deviation acts, and in which sense. Data for both roads; each has its own formulas for it."""

from tol3d.gearing.effects.axes_offset import AxesOffset
from tol3d.gearing.effects.axis_offset import AxisOffset
from tol3d.gearing.effects.axis_tilt import AxisTilt
from tol3d.gearing.effects.clocking import Clocking
from tol3d.gearing.effects.effect import NOTHING, Effect, Together
from tol3d.gearing.effects.flank_deviation import FORM, HELIX, SHAPES, SLOPE, UNIFORM, FlankDeviation, Place
from tol3d.gearing.effects.link_deviation import LinkDeviation
from tol3d.gearing.effects.plane import AS_COUNTED, Plane
from tol3d.gearing.effects.temperature import Temperature
from tol3d.gearing.effects.tooth_thickness import ToothThickness
from tol3d.gearing.effects.turning_offset import TurningOffset

__all__ = [
    "AS_COUNTED",
    "FORM",
    "HELIX",
    "NOTHING",
    "SHAPES",
    "SLOPE",
    "UNIFORM",
    "AxesOffset",
    "AxisOffset",
    "AxisTilt",
    "Clocking",
    "Effect",
    "FlankDeviation",
    "LinkDeviation",
    "Place",
    "Plane",
    "Temperature",
    "Together",
    "ToothThickness",
    "TurningOffset",
]
