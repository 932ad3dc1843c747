"""Run-out and radial composite deviations of teeth, by the names that ISO 1328-2 and gear drawings have for them."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from tol3d.distributions import Distribution, Normal, Uniform
from tol3d.distributions.base import Stays
from tol3d.distributions.derived import Proportion, Scale
from tol3d.errors import GeometryError, InputError
from tol3d.files import Files
from tol3d.gearing.draws.pitch_draw import tooth_names
from tol3d.gearing.effects import UNIFORM, FlankDeviation, Place
from tol3d.gearing.grammar.tolerances.flank_shape import NormalShapeSpec, UniformShapeSpec
from tol3d.gearing.grammar.tolerances.flank_tolerance import FlankToleranceSpec, no_word
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning
from tol3d.gearing.grammar.tolerances.gears import EccentricitySpec, TYPE_CHECKING
from tol3d.gears import Gear, SpurGear
from tol3d.gears.flank import LEFT, RIGHT
from tol3d.scene.part import Length
from tol3d.standards import iso_1328_2
from tol3d.strict import Strict, refused
from tol3d.system.draw import Each
