"""Parts placed against others by contacts of round features: poses by the contacts, trial by trial."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Contact, Touch
from tol3d.assembly.model.moves import unfit_for_contact
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing import contact_equations
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.contact_equations import ALONG, CROSSING
from tol3d.assembly.placing.contact_solver import lacking_at, touching_poses
from tol3d.assembly.placing.freedoms import free_motions, in_words, seen_steps
from tol3d.assembly.placing.placer import Asked, Placer, rows_about
from tol3d.assembly.placing.poses import Codes, Pose, column, cross, rotated
from tol3d.assembly.placing.surfaces import PARALLEL, common_normal, is_inside, touching_distance
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

INDEPENDENT: Final = 1e-8
"""Least independent part of a contact's constraint; less is rounding of directions."""

NO_DISTANCE: Final = 1e-9
"""Centres or axes nearer than that [mm] have no direction from one to the other."""

KINDS: Final = {
    ("point", "plane"): contact_equations.POINT_PLANE,
    ("plane", "point"): contact_equations.PLANE_POINT,
    ("axis", "plane"): contact_equations.LINE_PLANE,
    ("plane", "axis"): contact_equations.PLANE_LINE,
    ("point", "point"): contact_equations.POINT_POINT,
    ("point", "axis"): contact_equations.POINT_LINE,
    ("axis", "point"): contact_equations.LINE_POINT,
}


@dataclass(frozen=True, eq=False)
class Touching(Placer):
    """A touch with its nominal contacts; solved in the world, with the middle of the part's features at 0.

    Args:
        move: the move.
        kinds: of the contacts (contacts,), see contact_equations.
        signs: of the distances of axes that cross (contacts,).
        inner: which contacts have one inside the other (contacts,).
        reach: of the contacts about the middle [mm].
        nominal: the sides and at what distance they touch (contacts, 6), (contacts, 6), (contacts,).
        start: the nominal pose (3, 4).
        basis: steps that the contacts decide, shift and turn times reach (6, k).
        middle: of the part's features, in its frame (3, 1) [mm].
        origin: where that lies nominally in the world (3, 1) [mm].
        lacking: errors at the nominal pose (k,) [mm].
        side: of the folds, on which the nominal pose lies.
        rows: how errors change with a shift and a turn about the middle there (k, 6).
    """

    move: Touch
    kinds: NDArray[np.int64]
    signs: Array
    inner: NDArray[np.bool_]
    reach: float
    nominal: tuple[Array, Array, Array]
    start: Array
    basis: Array
    middle: Array
    origin: Array
    lacking: Array
    side: float
    rows: Array

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and status codes (n,)."""
        moving, targets, sums = _asked(self.move, world, self.middle, self.origin)
        turn, shift = np.empty((3, 3, world.trials)), np.empty((3, world.trials))
        codes = np.empty(world.trials, dtype=np.int8)
        contacts = (self.kinds, self.signs, self.reach, moving, targets, sums, *self.nominal)
        about = (self.start, self.basis, self.reach, self.lacking, self.side, self._force(world), self.inner)
        touching_poses(*contacts, *about, turn, shift, codes)
        pose = Pose(turn, shift + self.origin - rotated(turn, self.middle))
        return world.with_part_at(self.move.part, pose), codes

    def asked(self, assembly: Assembly, middle: Array) -> Iterator[Asked]:
        """Its contacts, one by one."""
        start = 0
        for contact, kind in zip(self.move.contacts, self.kinds, strict=True):
            end = start + (2 if kind in contact_equations.TWO else 1)
            words = f"{contact.moving} on {contact.target}"
            yield Asked(words, rows_about(self.rows[start:end], self.origin[:, 0] - middle))
            start = end

    def _force(self, world: World) -> Array:
        if self.move.pressed is None:
            return np.zeros((3, 0))
        owner = world.part_of(self.move.contacts[0].target)
        return np.ascontiguousarray(rotated(world.poses[owner].turn, column(self.move.pressed)))


def touching(move: Touch, nominal: World) -> Touching:
    """A touch.

    Args:
        move: the move.
        nominal: the world before it without deviations, the part at its nominal pose.

    Raises:
        InputError: a contact constrains what the others hold; or a feature lies where its contact has no direction.
    """
    pose = nominal.poses[move.part]
    own = [nominal.on_body(contact.moving, move.part).origin for contact in move.contacts]
    turn, middle = pose.turn[:, :, 0], np.mean(own, axis=0)
    origin = pose.point(middle)
    found = [_contact(move, contact, nominal, middle) for contact in move.contacts]
    kinds, signs = np.array([kind for kind, _, _ in found], dtype=np.int64), np.array([sign for _, sign, _ in found])
    reach = max(1.0, *(own for _, _, own in found))
    given = _asked(move, nominal, middle, origin)
    flat = given[0][:, :, 0].copy(), given[1][:, :, 0].copy(), given[2][:, 0].copy()
    start = np.ascontiguousarray(np.column_stack([turn, np.zeros(3)]))
    counts = [2 if kind in contact_equations.TWO else 1 for kind in kinds]
    lacking, rows = np.empty(sum(counts)), np.empty((sum(counts), 6))
    lacking_at(kinds, signs, reach, *given, *flat, start, lacking, rows)
    rows = rows * np.array([1.0, 1.0, 1.0, 1 / reach, 1 / reach, 1 / reach])
    _refuse_redundant(move, rows, np.cumsum(counts).tolist(), origin[:, 0], reach)
    about_origin = rows * np.array([1.0, 1.0, 1.0, reach, reach, reach])
    basis = np.roll(seen_steps(free_motions(about_origin, np.zeros(3), reach), reach), 3, axis=0)
    shapes = [
        [nominal.assembly.features[name].shape for name in (contact.moving, contact.target)]
        for contact in move.contacts
    ]
    made = Touching(
        move,
        kinds,
        signs,
        np.array([is_inside(*shape) for shape in shapes]),
        reach,
        flat,
        start,
        np.ascontiguousarray(basis),
        middle,
        origin,
        lacking,
        float(np.sign(np.linalg.det(rows @ basis))),
        about_origin,
    )
    if made.placed(nominal)[1][0] != OK:
        raise InputError(
            f"moves.{move.name}: {move.part} has no contact even without deviations: expected surfaces that reach each "
            "other near where it is `placed`, and contacts on which it is pressed if it is `pressed`"
        )
    return made


def _contact(move: Touch, contact: Contact, nominal: World, middle: Array) -> tuple[int, float, float]:
    """Its kind, the sign of the distance of crossing axes, and its reach [mm]."""
    own = nominal.on_body(contact.moving, move.part)
    moving, target = own.moved(nominal.poses[move.part]), nominal.placed(contact.target)
    name = f"moves.{move.name}: contact of {contact.moving} and {contact.target}"
    shapes = moving.feature.shape, target.feature.shape
    if words := unfit_for_contact(*shapes):
        raise InputError(f"{name}: {words}")
    apart, sign = (moving.origin - target.origin)[:, 0], 1.0
    sides = shapes[0].surface, shapes[1].surface
    if sides == ("axis", "axis"):
        normal = cross(moving.direction, target.direction)[:, 0]
        crosses = bool(np.linalg.norm(normal) > PARALLEL)
        if crosses and is_inside(*shapes):
            raise InputError(f"{name}: expected axes that are nominally parallel, for one lies inside the other")
        kind, sign = (CROSSING, float(np.sign(normal @ apart))) if crosses else (ALONG, 1.0)
    else:
        kind = KINDS[sides]
    distance = float(common_normal(target, moving, parallel=kind == ALONG)[1][0])
    if "plane" not in sides and not distance > NO_DISTANCE:
        raise InputError(
            f"{name}: lies in its middle, so that there is no direction to it; place {move.part} towards the contact"
        )
    reaches = (np.linalg.norm(own.origin - middle), np.linalg.norm(apart), shapes[0].ends[-1, 2])
    return kind, sign, float(max(reaches))


def _refuse_redundant(move: Touch, rows: Array, ends: Sequence[int], origin: Array, reach: float) -> None:
    """Refuse the first contact that constrains what earlier ones hold, and name the freedom still left."""
    before = 0
    for contact, end in zip(move.contacts, ends, strict=True):
        sizes = np.linalg.svd(rows[:end], compute_uv=False)
        if end > 6 or sizes[-1] < INDEPENDENT * sizes[0]:
            scale = np.array([1.0, 1.0, 1.0, reach, reach, reach])
            left = free_motions((rows * scale)[:before], origin, reach) if before else np.zeros((0, 6))
            free = f"{move.part} is still free: {in_words(left)}" if len(left) else f"nothing of {move.part} is free"
            raise InputError(
                f"moves.{move.name}: contact of {contact.moving} and {contact.target} constrains what earlier contacts "
                f"hold; {free}; expected contacts that are independent of each other where {move.part} is `placed`"
            )
        before = end


def _asked(move: Touch, world: World, middle: Array, origin: Array) -> tuple[Array, Array, Array]:
    """Sides of the part about a middle, of the others about an origin (contacts, 6, n), and touching distances."""
    moving = [world.on_body(contact.moving, move.part) for contact in move.contacts]
    targets = [world.placed(contact.target) for contact in move.contacts]
    sums = [touching_distance(*pair, world.columns) for pair in zip(moving, targets, strict=True)]
    return (
        _stacked([_side(own, own.origin - middle) for own in moving]),
        _stacked([_side(target, target.origin - origin) for target in targets]),
        _stacked(sums),
    )


def _side(actual_feature: ActualFeature, origin: Array) -> Array:
    return np.concatenate(np.broadcast_arrays(origin, actual_feature.direction))


def _stacked(arrays: Sequence[Array]) -> Array:
    """Arrays of all contacts, (contacts, ..., n) or (contacts, ..., 1)."""
    return np.stack(np.broadcast_arrays(*arrays))
