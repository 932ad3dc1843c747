"""Moves: each places one body, a part and what is welded to it, against placed ones."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Literal

from tol3d.assembly.model.feature import Contribution, Shape
from tol3d.assembly.model.move import Acts, Move, PartMove
from tol3d.numerics.arrays import Array

PLACING: Final = "tol3d.assembly.placing"
TORSORS: Final = "tol3d.assembly.torsors"
"""Package of each method's code for the moves bundled with tol3d."""
STATED_BY: Final = "tol3d.assembly.from_scene"
"""Package of the functions that make their models from scenes."""


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
class Touch(PartMove):
    """A part is laid against placed ones at its contacts, all at once, near its nominal pose.

    Freedoms that no contact decides stay nominal: the least turn, then the least shift of the middle of the part's
        features in contact.

    Args:
        name, part: of the move, and what it places. contacts: of which none asks what the others hold.
        pressed: direction (3,) of the force that presses the part on, through the mean of its moving features' origins,
            in the nominal frame of the first target's part; a contact that would have to pull is lost. None: not asked.
    """

    acts: ClassVar[Acts] = Acts(
        "touch", "touch on", f"{PLACING}.contact_move:touching", f"{TORSORS}.contact_move:touched"
    )

    contacts: tuple[Contact, ...]
    pressed: Array | None = None

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        return [(contact.moving, contact.target) for contact in self.contacts]

    @property
    def words(self) -> str:
        return f"{len(self.contacts)} contacts"


def unfit_surfaces(start: Shape, end: Shape) -> str:
    """Why two surfaces have no common normal, in words; "" where they have one."""
    if any(own.surface in ("axis", "cone") and own.diameter is None for own in (start, end)):
        return "expected a cylinder, got an axis without a diameter"
    if start.diameter is None and end.diameter is None:
        return "expected a cylinder or a sphere on one side at least"
    if start.inner and end.inner:
        return "expected one of them to lie inside the other, got two holes"
    if not start.inner and not end.inner:
        return ""
    hole, other = (start, end) if start.inner else (end, start)
    if other.surface == "plane":
        return "expected what lies in the hole, got a plane"
    if (hole.surface, other.surface) == ("point", "axis"):
        return "expected a sphere or a point in a socket, got a cylinder"
    return ""


def unfit_for_contact(moving: Shape, target: Shape) -> str:
    """Why two surfaces do not touch as a `Contact` asks, in words; "" where they do."""
    words = unfit_surfaces(moving, target)
    if words or moving.inner == target.inner:
        return words
    hole, other = (moving, target) if moving.inner else (target, moving)
    room, size = hole.diameter or 0.0, other.diameter or 0.0
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
class Fix(PartMove):
    """The part stays at its nominal pose."""

    acts: ClassVar[Acts] = Acts("fixed", "fixed", f"{PLACING}.placer:fixing", f"{TORSORS}.world:fixed")

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        return ()

    @property
    def holds(self) -> Sequence[tuple[str, str]]:
        return [("all six", "as drawn")]


@dataclass(frozen=True, eq=False)
class Locate(PartMove):
    """Six contacts of points on planes, met at once: three_two_one or six_plane.

    Args:
        name, part: of the move, and what it places.
        pairs: six; rank 6.
        points_on: which side the points ride on.
    """

    acts: ClassVar[Acts] = Acts(
        "six contacts", "six contacts on", f"{PLACING}.locator_move:locating", f"{TORSORS}.mate_move:located"
    )

    pairs: tuple[Pair, ...]
    points_on: PointsOn = "part"

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        return [(pair.moving, pair.target) for pair in self.pairs]

    @property
    def words(self) -> str:
        return f"points ride on the {self.points_on}"


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
class BestFit(PartMove):
    """The pose of least weighted squares of residuals, or of the least largest residual; finite, no scale.

    Freedoms without effect on residuals stay nominal: least rotation, then the least shift of the middle of the points.

    Args:
        name, part: of the move, and what it places.
        fits: which points.
        criterion: "squares" or "minimax" (largest length of a fit's residual vector).
    """

    acts: ClassVar[Acts] = Acts(
        "best fit", "best fit on", f"{PLACING}.best_fit_move:best_fitting", f"{TORSORS}.best_fit_move:fitted"
    )

    fits: tuple[Fit, ...]
    criterion: Literal["squares", "minimax"] = "squares"

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        return [(fit.moving, fit.target) for fit in self.fits]

    @property
    def terms(self) -> int:
        return 6 if self.criterion == "minimax" else 0

    @property
    def words(self) -> str:
        return f"{len(self.fits)} points, {self.criterion}"


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
class Mate(PartMove):
    """Relations in order; each turns by the least rotation, about its moving origin in the trial where shifts are free.

    Freedoms that none takes stay as nominal.
    """

    acts: ClassVar[Acts] = Acts("mate", "mate on", f"{PLACING}.mate_move:mating", f"{TORSORS}.mate_move:mated")

    relations: tuple[Relation, ...]

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        return [(relation.moving, relation.target) for relation in self.relations]

    @property
    def words(self) -> str:
        return ", ".join(f"{relation.kind} {relation.target}" for relation in self.relations)


@dataclass(frozen=True, eq=False)
class Rest(PartMove):
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

    acts: ClassVar[Acts] = Acts(
        "rest", "rest on", f"{PLACING}.rest_move:resting", f"{TORSORS}.rest_move:rested",
        presents="tol3d.assembly.presenting.tables:rest_blocks", rocks=True,
    )  # fmt: skip

    pairs: tuple[Pair, ...]
    force: Array
    at: Array
    points_on: PointsOn = "part"
    relations: tuple[Relation, ...] = ()

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        related = [(relation.moving, relation.target) for relation in self.relations]
        return [*related, *((pair.moving, pair.target) for pair in self.pairs)]

    @property
    def terms(self) -> int:
        return 6

    @property
    def words(self) -> str:
        return f"{len(self.pairs)} contacts, points ride on the {self.points_on}"


@dataclass(frozen=True)
class Weld(Move):
    """Parts that are placed already become one body, which may be moved again.

    Args:
        name: of the move.
        part: by whose name the body is moved again.
        others: what is welded to it.
    """

    acts: ClassVar[Acts] = Acts("weld", "welded to", f"{PLACING}.placer:welding", f"{TORSORS}.world:welded")

    part: str
    others: tuple[str, ...]

    @property
    def parts(self) -> tuple[str, ...]:
        return ()

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        return ()

    @property
    def joined(self) -> tuple[str, ...]:
        return (self.part, *self.others)

    @property
    def words(self) -> str:
        return ", ".join(self.others)

    @property
    def holds(self) -> Sequence[tuple[str, str]]:
        return [("all six", f"{', '.join(self.others)} with {self.part}")]
