"""Moves: each places one body, a part and what is welded to it, against placed ones."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np

from tol3d.assembly.model.feature import Axis, Contribution, Plane, Point, RoundPlane, Shape
from tol3d.assembly.model.stated_move import StatedMove
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class Contact:
    """A feature of the part that is placed, and the one of placed parts that its surface touches.

    What it asks, c the origin of a sphere, a point or a cylinder, all with the sizes of the trial: a sphere's or a
    point's c lies at its radius over a plane, or at the contact's distance from the other's c or axis: the sum of the
    radii outside each other, their difference for one inside the other. A cylinder also lies along what it touches: on
    a plane its axis is square to the normal; beside or inside a cylinder that is nominally parallel its axis is square
    to the common normal, and c of the moving one counts. Cylinders that cross touch where their axes are nearest.

    Args:
        moving, target: names of the features.
    """

    moving: str
    target: str


@dataclass(frozen=True, eq=False)
class Touch:
    """A part is laid against placed ones at its contacts, all at once, near its nominal pose.

    Freedoms that no contact decides stay nominal: the least turn, then the least shift of the middle of the part's
        features in contact.

    Args:
        name, part: of the move, and what it places. contacts: of which none asks what the others hold.
        pressed: direction (3,) of the force that presses the part on, through the mean of its moving features' origins,
            in the nominal frame of the first target's part; a contact that would have to pull is lost. None: not asked.
    """

    name: str
    part: str
    contacts: tuple[Contact, ...]
    pressed: Array | None = None


def is_inner(shape: Shape) -> bool:
    """True for a bore or a socket."""
    return isinstance(shape, Axis | Point) and shape.inner


def unfit_surfaces(start: Shape, end: Shape) -> str:
    """Why two surfaces have no common normal, in words; "" where they have one."""
    if any(isinstance(own, Axis) and own.diameter is None for own in (start, end)):
        return "expected a cylinder, got an axis without a diameter"
    if [getattr(own, "diameter", None) for own in (start, end)] == [None, None]:
        return "expected a cylinder or a sphere on one side at least"
    if is_inner(start) and is_inner(end):
        return "expected one of them to lie inside the other, got two holes"
    if not is_inner(start) and not is_inner(end):
        return ""
    hole, other = (start, end) if is_inner(start) else (end, start)
    if isinstance(other, Plane | RoundPlane):
        return "expected what lies in the hole, got a plane"
    if isinstance(hole, Point) and isinstance(other, Axis):
        return "expected a sphere or a point in a socket, got a cylinder"
    return ""


def unfit_for_contact(moving: Shape, target: Shape) -> str:
    """Why two surfaces do not touch as a `Contact` asks, in words; "" where they do."""
    words = unfit_surfaces(moving, target)
    if words or is_inner(moving) == is_inner(target):
        return words
    hole, other = (moving, target) if is_inner(moving) else (target, moving)
    room, size = getattr(hole, "diameter", None) or 0.0, getattr(other, "diameter", None) or 0.0
    return "" if size < room else f"expected less than the {room:g} mm of the hole in which it lies, got {size:g} mm"


PointsOn = Literal["part", "fixture"]
"""Side of the points: on the placed part, with planes on the target, or the reverse."""


@dataclass(frozen=True, eq=False)
class Pair:
    """A feature of the part that is placed, and the one of placed parts against which it lies.

    Origins count: normal . (origin of moving - origin of target) = locator. The normal turns with the part. Where one
    of the two is a point of a plane (Feature.plane), that plane counts as it lies and tilts in the trial, with its own
    normal: the other one lies on it wherever the trial puts it. To first order that is the point where it is nominally.

    Args:
        moving, target: names of the features.
        normal: nominal direction (3,), of unit length, in the frame of the part on which the plane stays: the target's
            for points on the part, else that of the part that is placed, where it points INTO that part's material
            side, so that a positive deviation lifts the part in either case.
        locator: contributions of the locator itself (1, components) along the normal; positive lifts the part.
    """

    moving: str
    target: str
    normal: Array
    locator: tuple[Contribution, ...] = ()


@dataclass(frozen=True)
class Fix:
    """The part stays at its nominal pose."""

    name: str
    part: str


@dataclass(frozen=True, eq=False)
class Locate:
    """Six contacts of points on planes, met at once: three_two_one or six_plane.

    Args:
        name, part: of the move, and what it places.
        pairs: six; rank 6.
        points_on: which side the points ride on.
    """

    name: str
    part: str
    pairs: tuple[Pair, ...]
    points_on: PointsOn = "part"


@dataclass(frozen=True, eq=False)
class Fit:
    """A pair of points that a best fit brings together.

    Args:
        moving, target: names of the features; their origins count.
        weight: of its square.
        directions: (directions, 3) orthonormal, in the target part's nominal frame, in which the residual counts.
    """

    moving: str
    target: str
    weight: float
    directions: Array


@dataclass(frozen=True)
class BestFit:
    """The pose of least weighted squares of residuals, or of the least largest residual; finite, no scale.

    Freedoms without effect on residuals stay nominal: least rotation, then the least shift of the middle of the points.

    Args:
        name, part: of the move, and what it places.
        fits: which points.
        criterion: "squares" or "minimax" (largest length of a fit's residual vector).
    """

    name: str
    part: str
    fits: tuple[Fit, ...]
    criterion: Literal["squares", "minimax"] = "squares"


@dataclass(frozen=True)
class Relation:
    """Relation of two features in a mate; it takes some of the freedoms that earlier relations left.

    Directions come first, then heights: those of the origin of `moving` over the target's plane as it tilts in the
    trial. Coaxial asks the origin of `moving` across the target's axis, then the direction. What is held already is met
    as nearly as the freedoms left allow (least squares over its components).

    Args:
        kind: "coincident" (plane on plane with normals opposed, point on point, point on plane, point on axis, a
            cone in a conical hole as in `cone_seat`),
            "coaxial" (axis on axis), "tangent" (cylinder on plane, by the radius of the trial), "distance".
        moving, target: names of the features.
        distance: for "distance": of plane from plane or of point from plane, along the target's normal [mm].
    """

    kind: Literal["coincident", "coaxial", "tangent", "distance"]
    moving: str
    target: str
    distance: float = 0.0


@dataclass(frozen=True)
class Mate:
    """Relations in order; each turns by the least rotation, about its moving origin in the trial where shifts are free.

    Freedoms that none takes stay as nominal.
    """

    name: str
    part: str
    relations: tuple[Relation, ...]


@dataclass(frozen=True, eq=False)
class Rest:
    """One-sided contacts of points on planes, without friction: the part goes as far along the force as they allow.

    Which contacts carry follows from the lever arms of the pose; where nominally some carry nothing the part rocks,
    whatever a tilt of the trial does to their arms. Freedoms that no relation, contact or force sees stay as nominal
    (least rotation, then the least shift of the middle of the part's features that touch).

    Args:
        name, part: of the move, and what it places.
        pairs: one or more, see Pair; a gap is normal . (origin of moving - origin of target) - locator, 0 or more.
        force: direction (3,), of unit length, in the world.
        at: a point on its line (3,), in the frame of the part [mm].
        points_on: which side the points ride on.
        relations: met first, as those of a mate, and kept.
    """

    name: str
    part: str
    pairs: tuple[Pair, ...]
    force: Array
    at: Array
    points_on: PointsOn = "part"
    relations: tuple[Relation, ...] = ()


@dataclass(frozen=True)
class Weld:
    """Parts that are placed already become one body, which may be moved again.

    Args:
        name: of the move.
        part: by whose name the body is moved again.
        others: what is welded to it.
    """

    name: str
    part: str
    others: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Bolt:
    """A bolt that goes through two holes, loose in both.

    Args:
        diameter: nominal [mm].
        size_by: contributions to it (1, components); positive is larger.
        frame: nominally in the world (4, 4): z along it, the origin in the middle of all ends of its holes.
        reach: distance from there to the farthest of these ends [mm], over which a tilt counts.
    """

    diameter: float
    size_by: tuple[Contribution, ...]
    frame: Array
    reach: float


@dataclass(frozen=True, eq=False)
class Engagement:
    """A pin in a hole, a pin in a slot or a tab in a slot; or two holes with a bolt through both.

    Its offset at a place: how far the outer one's point lies from the inner one's, across the inner one's axis (both
    components of a hole) or across its width (one of a slot). Its clearance: half of how much larger the inner one is.

    Args:
        inner, outer: names of the features: hole or slot, pin or tab.
        places: where it engages, (places, 3) in the frame of the inner one: on a hole's axis, on a slot's plane.
        outer_places: the same in the frame of the outer one.
        bolt: through two holes, `inner` and `outer`, whose ends the places are, each hole's own. Its axis is a line;
            the offset at a hole's end is how far it lies from the hole's axis, across that, where it passes the end.
    """

    inner: str
    outer: str
    places: Array
    outer_places: Array
    bolt: Bolt | None = None

    @property
    def name(self) -> str:
        """In words."""
        return f"{self.outer} in {self.inner}" if self.bolt is None else f"bolt in {self.inner} and {self.outer}"


SWEEPS: Final = 12
"""Sweeps of a random float before the last: each leaves half of what sigmas are off or less, in up to five freedoms."""
SWEEPS_OF_BOLTS: Final = 4
"""The same of a part with bolts, where a chord takes a hundred times as long: sigmas are right to 1 %."""


@dataclass(frozen=True, eq=False)
class Floating:
    """Position of a part with play within its clearance.

    - centred: where the least slack (clearance less offset) is largest; of several such poses that in which the least
      of the others is, and so on.
    - random, by_pairs: the first engagement anywhere in its disc (in the lens of both ends' discs), the second one
      anywhere in what is left of its slot; each as often by area.
    - random: anywhere in the room of its freedoms, each pose as often: shift at the middle of all places and turn times
      their largest distance from it; of bolts, where each of them has a place. By Gibbs sampling: from the centred
      pose, freedom by freedom, the part is drawn anew along the chord of the room, SWEEPS times over; the last sweep is
      drawn as deviations, those before it follow from the last deviation.
    - toward: where a point of the part goes farthest along a direction; what that leaves open is as centred as may be.

    Args:
        kind: its kind.
        columns: of the draws: components of a unit disc (and of an interval -1 to 1), or a shift and a turn (6) of the
            last sweep, each from -1 to 1, and the start of the sweeps before it; 0 for none: then a shift and a turn
            are shares of the way from the centred pose to where the room ends.
        by_pairs: see random.
        at: the name of the feature, for `toward`.
        along: (3,), of unit length, in the frame of its part, for `toward`.
    """

    kind: Literal["centred", "random", "toward"]
    columns: slice = field(default_factory=lambda: slice(0, 0))
    by_pairs: bool = False
    at: str = ""
    along: Array | None = None

    def sweeps(self, drawn: Array, freedoms: Sequence[int], bolts: int) -> Array:
        """Uniforms of a random float (sweeps * freedoms, n), sweep by sweep; all but the last sweep NaN for no start.

        Those before the last sweep are SplitMix64's (Steele et al., OOPSLA 2014), seeded by the bits of the start.

        Args:
            drawn: a shift and a turn, and the start (7, n).
            freedoms: which of the shift and the turn, in the order of the sweep.
            bolts: number of them.
        """
        count = (SWEEPS_OF_BOLTS if bolts else SWEEPS) * len(freedoms)
        start = np.ascontiguousarray(drawn[6])
        places = np.arange(1, count + 1, dtype=np.uint64)[:, None]
        mixed = start.view(np.uint64)[None] + places * np.uint64(0x9E3779B97F4A7C15)
        mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        before = ((mixed ^ (mixed >> np.uint64(31))) >> np.uint64(11)).astype(np.float64) * 2.0**-53
        last = np.clip((1.0 + drawn[list(freedoms)]) / 2.0, 0.0, 1.0)  # slopes ask beyond its ends
        return np.concatenate([np.where(start == 0.0, np.nan, before), last])


@dataclass(frozen=True, eq=False)
class Engage:
    """Relations first, as of a mate; the freedoms that they leave are limited by clearances.

    Args:
        name, part: of the move, and what it places.
        relations: in order.
        engagements: all at once.
        floating: where in its room the part lies.
    """

    name: str
    part: str
    relations: tuple[Relation, ...]
    engagements: tuple[Engagement, ...]
    floating: Floating


Move = Fix | Locate | BestFit | Mate | Engage | Rest | Weld | Touch | StatedMove


def pairs_of(move: Move) -> Sequence[tuple[str, str]]:
    """The features by which a move places its part: moving and target; for play inner and outer."""
    match move:
        case Fix() | Weld():
            return ()
        case StatedMove():
            return move.pairs
        case BestFit():
            return [(own.moving, own.target) for own in move.fits]
        case Touch():
            return [(own.moving, own.target) for own in move.contacts]
    related = [] if isinstance(move, Locate) else [(own.moving, own.target) for own in move.relations]
    if isinstance(move, Engage):
        return [*related, *((own.inner, own.outer) for own in move.engagements)]
    return related if isinstance(move, Mate) else [*related, *((own.moving, own.target) for own in move.pairs)]
