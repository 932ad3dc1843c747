"""Model of an assembly, nominal and by its drawings: input of both methods, without any computation.

Frames and poses are 4x4, lengths mm. Nominal poses of parts are in the world, frames of features in their part.
"""

from tol3d.assembly.model.assembly import Assembly, Part
from tol3d.assembly.model.datum_frame import Datum, DatumFrame, Gauges
from tol3d.assembly.model.feature import Axis, Cone, Contribution, Feature, Plane, Point, RoundPlane, Shape, Slot
from tol3d.assembly.model.measures import Measured
from tol3d.assembly.model.move import Acts, Move, PartMove
from tol3d.assembly.model.moves import (
    BestFit,
    Contact,
    Fit,
    Fix,
    Locate,
    Mate,
    Pair,
    Relation,
    Rest,
    Touch,
    Weld,
)
from tol3d.assembly.model.play import Bolt, Engage, Engagement, Floating

__all__ = [
    "Acts",
    "Assembly",
    "Axis",
    "BestFit",
    "Bolt",
    "Cone",
    "Contact",
    "Contribution",
    "Datum",
    "DatumFrame",
    "Engage",
    "Engagement",
    "Feature",
    "Fit",
    "Fix",
    "Floating",
    "Gauges",
    "Locate",
    "Mate",
    "Measured",
    "Move",
    "Pair",
    "Part",
    "PartMove",
    "Plane",
    "Point",
    "Relation",
    "Rest",
    "RoundPlane",
    "Shape",
    "Slot",
    "Touch",
    "Weld",
]
