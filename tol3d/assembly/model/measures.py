"""What is measured of an assembly: features, a direction, when."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model.bonus import GaugeRoom, MaterialBonus
from tol3d.assembly.model.facing import Facing

Array = NDArray[np.float64]

MeasureKind = Literal[
    "distance",
    "gap",
    "point_plane",
    "angle",
    "size",
    "position",
    "orientation",
    "flatness",
    "virtual_clearance",
    "pattern",
    "contact_angle",
    "surface_gap",
    "slack",
    "clearance",
    "turn",
]
"""What is read, of features' origins and z directions as they are in the trial (p, z), in the world:

- distance: |p_to - p_from|; with a direction along it only, see gap.
- gap (and flush, where `to` stands proud): (p_to - p_from) . n, n the direction as it is fixed in the part of `from`,
  or in a datum frame of it.
- point_plane: (p_point - p_plane) . z_plane; features: the point, the plane.
- angle: from z_from to z_to [rad], 0 to pi; with a direction n, fixed as for gap, signed about it: atan2(n . (z_from x
  z_to), z_from . z_to).
- size: nominal size and its deviation.
- position: twice the largest distance of the feature's ends from where `frame` has them nominally: of an axis across
  the nominal axis, of a plane along the nominal normal, of a point in space; across the direction if there is one,
  which is fixed in that frame. With a bonus less that of the feature's size: what is judged against the zone at its
  material condition, for 2 distance <= t0 + bonus.
- orientation: width of the zone that holds the feature and is oriented nominally in `frame`: of a plane the range of
  its ends' heights along the nominal normal, of an axis how far its ends lie apart across the nominal axis.
- flatness: smallest distance of two parallel planes with all the points between them, of points of one part that lie
  nominally on a plane with normal `direction`, in the part's frame.
- virtual_clearance: diameter of the largest straight bolt through all holes, along the nominal axis of the first as its
  part or `frame` carries it.
- pattern: the largest of several positions (less bonuses) at the best pose of their nominal places, which may shift
  across the nominal axis of the first, or also turn about it.
- surface_gap: how far the surfaces of two features are apart, at least one of them round: as contacts of a touch ask,
  0 where they touch; negative where they overlap.
- contact_angle: between the normal of such a contact, from the first feature's axis, centre or plane towards the
  second's, and the z of a third feature or a direction that is fixed as for gap [rad], 0 to pi.
- slack: of the move `of_move`, an Engage; no features.
- turn: of the rotation vector that turns the first feature's frame into the second's, the component along a direction,
  which is fixed in the part of the first, or its length without one [rad].
- clearance: least distance of the solids of two parts as they stand, within a chord error; no features.
"""


Rocking = Literal["least", "middle", "largest"]
"""Where a part may rock on its contacts: which value over its ends is read, middle of both."""


Gauge = Literal["shift", "shift_and_turn"]

OverPlay = Literal["least", "largest"]
"""Which value over all poses that play leaves is read."""


@dataclass(frozen=True, eq=False)
class Measured:
    """What a measure reads; see each kind.

    Args:
        kind: which formula.
        features: names, in the order of the kind: from, to.
        direction: (3,), of unit length, nominally in the frame of the first feature's part.
        frame: name of a datum frame of that part in which the direction is fixed, or to which a position or an
            orientation is inspected; "" for the part's frame.
        after: index of the move after which it is read; -1 for the end.
        bonuses: of a position and a pattern, what the size of each feature takes from it; () for nothing.
        room: of a position, in which the gauge of its last datum takes the shift that makes it least.
        over_gauges: of a position, whether the gauges of its datum frame take the place that makes it least.
        gauge: how a pattern's gauge finds its best pose in the frame.
        of_move: index of the move whose slack is read; -1 of other kinds.
        over_play: which value it has over the rooms of parts with play; None where the floats of the moves decide.
        parts: of a clearance.
        chord_error: of a clearance, how far its surfaces may be off [mm].
        facing: of a clearance, where its parts may be nearest.
        minus: a second one that is subtracted in the same trial.
        rocking: which value it has where a part may rock on its contacts; None where it then has none. Not of `minus`.
    """

    kind: MeasureKind
    features: tuple[str, ...]
    direction: Array | None = None
    frame: str = ""
    after: int = -1
    bonuses: tuple[MaterialBonus, ...] = ()
    gauge: Gauge = "shift"
    room: GaugeRoom | None = None
    over_gauges: bool = False
    of_move: int = -1
    minus: "Measured | None" = None
    rocking: Rocking | None = None
    over_play: OverPlay | None = None
    parts: tuple[str, ...] = ()
    chord_error: float = 0.0
    facing: Facing | None = None
