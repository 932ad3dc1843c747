"""Parts that engage with play: offsets of pins, tabs, holes and slots, and poses in the clearance, trial by trial."""

import weakref
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Engage, Engagement, Mate
from tol3d.assembly.model.statuses import FITS, NO_BUILD, OK, SINGULAR
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.alignment import Seat
from tol3d.assembly.placing.chords import ray
from tol3d.assembly.placing.float_position import Floats, floats_of
from tol3d.assembly.placing.mate_move import KeptRelations, Mating, kept_motions, kept_of, mating
from tol3d.assembly.placing.placer import Asked, RoomPlacer, rows_about
from tol3d.assembly.placing.play_offsets import ENDS, at_places, engaged_places
from tol3d.assembly.placing.play_rooms import EngagedRoom
from tol3d.assembly.placing.poses import (
    Codes,
    Pose,
    column,
    full,
    moved_about,
    product,
    rotated,
    rotated_back,
)
from tol3d.assembly.placing.world import World
from tol3d.contact.programme import Programme
from tol3d.contact.seat import Seated, seated, strayed
from tol3d.numerics.arrays import Array, times

ROUNDS: Final = 20
"""Corrections of a pin towards its drawn place at most; each leaves a turn's share of the correction."""
MET: Final = 1e-9
"""Step [mm] at which a trial is done."""
LOST: Final = 1e-6
"""Step [mm] left after all rounds at which the pose counts as not found."""
NUDGE: Final = 1e-4
"""Motion [mm] by which the free motions under relations are found."""
EQUAL: Final = 1e-6
"""Share of a pair in the least slack by which it is not larger than another's."""
SEEN: Final = 1e-6
"""Change of all offsets per unit freedom that counts as none."""


@dataclass(frozen=True, eq=False)
class Engaging(RoomPlacer):
    """A move with play, as its features lie nominally.

    Args:
        move: the move.
        mating: of its relations.
        middle: of all places, nominally in the world (3,) [mm].
        reach: of them about it [mm].
        origin: the middle in the part's frame (3,) [mm].
        freedoms: motions that relations leave and offsets see: shift of the middle, turn times reach (6, freedoms).
        rows: change of each offset by them, and by shifts and leans of each bolt (cones, 2, freedoms + 4 bolts).
        floats: position of the part within its clearance.
        relations: that are kept.
        undo: steps, turn times reach and shift, that undo a change of what they keep (6, kept).
        nudge: a step (freedoms,) [mm] from where relations lay it that is all that the part does; None for its float.
    """

    move: Engage
    mating: Mating
    middle: Array
    reach: float
    origin: Array
    freedoms: Array
    rows: Array
    floats: Floats
    relations: KeptRelations
    undo: Array
    nudge: Array | None = None

    @property
    def motions(self) -> int:
        return int(self.freedoms.shape[1])

    @property
    def words(self) -> str:
        return f"{self.move.words}; {self.motions} freedoms, {self.move.floating.kind}"

    def asked(self, assembly: Assembly, middle: Array) -> Iterator[Asked]:
        """Its relations, then what clearances limit."""
        yield from self.mating.asked(assembly, middle)
        rows = self.rows[..., : self.motions].reshape(2 * len(self.rows), self.motions) @ self.freedoms.T
        rows = np.hstack([rows[:, :3], self.reach * rows[:, 3:]])
        yield Asked(self.move.words, rows_about(rows, self.middle - middle), is_room=True)

    def nudged(self, by: Array) -> "Engaging":
        """The same with the part a step (freedoms,) from where relations lay it."""
        return replace(self, nudge=by)

    def pushed_alike(self, move: Engage, settled: Assembly) -> tuple[Engage, float]:
        turn = settled.part[settled.features[move.floating.at].part].pose[:3, :3]
        pose = settled.part[move.part].pose
        gone = pose[:3, :3] @ self.origin + pose[:3, 3] - self.middle  # by the push, not from where it was drawn
        second_order = float(np.linalg.norm(gone) * np.linalg.norm(pose[:3, :3] - self.floats.turn, 2))
        return replace(move, floating=replace(move.floating, along=turn.T @ self.floats.along)), second_order

    def at_support_point(self, push: Array) -> "Engaging":
        """The move with the part pushed to the limit along a direction of its freedoms (freedoms,); centred along 0."""
        return replace(self, floats=self.floats.at_support_point(push))

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and status codes (n,)."""
        start, seats = Pose.of(world.assembly.part[self.move.part].pose), self.mating.seats(world)
        pose, codes = self.mating.poses(world, seats, start)
        pose, count = full(pose, world.trials), world.trials
        if self.nudge is not None:
            pose, _ = self.mating.poses(world, seats, self._moved(pose, self.nudge[:, None] * np.ones(count)))
            return world.with_part_at(self.move.part, pose), codes
        pose, slacks, shares, found = self._found(world, seats, pose)
        codes = np.where(codes == OK, np.where(slacks < FITS, NO_BUILD, OK), codes)
        if self.floats.by_pairs is not None:
            pose, met = self._by_pairs(world, seats, pose, found & (slacks > 0.0))
            found = found & met
        codes = np.where((codes == OK) & ~found, SINGULAR, codes).astype(np.int8)
        slacks = np.where(found, slacks, np.nan)
        world = world.with_part_at(self.move.part, pose)
        return world.with_slack(self.move.name, slacks, self._tightest(shares)), codes

    def _found(self, world: World, seats: Sequence[Seat], start: Pose) -> tuple[Pose, Array, Array, NDArray[np.bool_]]:
        """Poses within the clearance, slacks (n,), shares of places in them (places, n), flags of those found (n,)."""
        origin, middle = column(self.origin), column(self.middle)
        room, sweeps = self._room(world, seats, start), self.floats.sweeps(world)
        seat, programme = self._centred(world, room, start, keeps_place=sweeps is not None)
        slacks, shares = np.where(seat.found, programme.slack, 0.0), programme.multipliers
        alone = ~(np.take_along_axis(shares, programme.tightest[None], axis=0)[0] > 0.0)  # no freedom moves it
        shares = np.where(alone, np.arange(len(shares))[:, None] == programme.tightest, shares)
        found, goes, after = seat.found, seat.found & (slacks > 0.0), seat
        if room.push is not None:
            after = seated(room, seat.pose, programme, goes, pushes=True)
        elif sweeps is not None and seat.place is not None:
            along, share = ray(seat.place, *sweeps, room.way)
            after = strayed(room, seat.pose, along, share, goes)
        turn, shift, _ = after.pose
        return Pose(turn, shift + middle - rotated(turn, origin)), slacks, shares, np.where(goes, after.found, found)

    def _centred(self, world: World, room: EngagedRoom, start: Pose, *, keeps_place: bool) -> tuple[Seated, Programme]:
        """Centred poses and the programme there: found once, for the float of the trial and for pushes of measures."""
        key = f"centred by {self.move.name}"
        of, seat, programme = world.kept.get(key, (None, None, None))
        if seat is None or of() is not world or (keeps_place and seat.place is None):
            places, _, unknowns = self.rows.shape
            programme = Programme.of(places, unknowns, world.trials)
            bolts = np.zeros(((unknowns - self.motions) // ENDS, ENDS, world.trials))
            at = start.turn, start.point(column(self.origin)) - column(self.middle), bolts
            every = np.ones(world.trials, dtype=np.bool_)
            seat = seated(room, at, programme, every, keeps_place=keeps_place)
            world.kept[key] = weakref.ref(world), seat, programme
        return seat, programme.copied()

    def _room(self, world: World, seats: Sequence[Seat], start: Pose) -> EngagedRoom:
        """Its room in the trials, as relations lay the part."""
        origin = column(self.origin)
        kept = self.relations.kept_by(seats).about(origin)
        room = EngagedRoom(
            tuple(engaged_places(self.move, world, self.origin, self.middle)), kept, self.undo, np.zeros((0, 1)),
            np.roll(self.freedoms, 3, axis=0)[..., None], self.rows[..., None], self.reach,
            self.floats.goal(world, self.origin),
        )  # fmt: skip
        return replace(room, first=room.kept_at(start.turn, start.point(origin) - column(self.middle)))

    def _by_pairs(
        self, world: World, seats: Sequence[Seat], pose: Pose, asked: NDArray[np.bool_]
    ) -> tuple[Pose, NDArray[np.bool_]]:
        """Poses at which each pin is where a float by pairs draws it, and flags of those found (n,)."""
        assert self.floats.by_pairs is not None
        drawn, lacking = world.columns[self.move.floating.columns], np.zeros(world.trials)
        targets = [world.placed(target) for target in self._targets(world)]
        for _ in range(ROUNDS):
            offsets, clearances = self._offsets(world, pose, targets)
            steps = self.floats.by_pairs.steps(offsets, clearances, self.rows, drawn)
            lacking = np.where(asked, np.abs(steps).max(axis=0), lacking)
            moved, _ = self.mating.poses(world, seats, self._moved(pose, steps))
            pose = Pose(np.where(asked, moved.turn, pose.turn), np.where(asked, moved.shift, pose.shift))
            asked = asked & ~(lacking < MET)
            if not asked.any():
                break
        return pose, lacking < LOST

    def _tightest(self, shares: Array) -> NDArray[np.str_]:
        """Pair that decides the least slack (n,): that of the largest share, of equal ones the first as written.

        Args:
            shares: of its cones (cones, n).
        """
        sums, start = np.zeros((len(self.move.engagements), shares.shape[1])), 0
        for own, engagement in zip(sums, self.move.engagements, strict=True):
            for share in shares[start : start + _cones_of(engagement)]:
                own += share
            start += _cones_of(engagement)
        names = np.array([own.name for own in self.move.engagements])
        told: NDArray[np.str_] = names[np.argmax(sums >= sums.max(axis=0) - EQUAL, axis=0)]
        return told

    def _targets(self, world: World) -> Sequence[str]:
        body = world.bodies[self.move.part]
        return [
            engagement.outer if world.part_of(engagement.inner) in body else engagement.inner
            for engagement in self.move.engagements
        ]

    def _offsets(self, world: World, pose: Pose, targets: Sequence[ActualFeature]) -> tuple[Array, Array]:
        """Offsets (cones, 2, n) and clearances (cones, n) of the part at a pose."""
        offsets = np.zeros((len(self.rows), 2, world.trials))
        clearances = np.empty((len(self.rows), world.trials))
        start = 0
        for own, target in zip(self.move.engagements, targets, strict=True):
            moving_name = own.inner if target.feature.name == own.outer else own.outer
            moving = world.on_body(moving_name, self.move.part).moved(pose)
            inner, outer = (moving, target) if moving_name == own.inner else (target, moving)
            for k, (own_offsets, clearance) in enumerate(at_places(own, inner, outer, world.columns)):
                for r, offset in enumerate(own_offsets):
                    offsets[start + k, r] = offset
                clearances[start + k] = clearance
            start += len(own.places)
        return offsets, clearances

    def _moved(self, pose: Pose, steps: Array) -> Pose:
        """A pose after steps (freedoms, n) as finite motions."""
        motion = times(self.freedoms, steps)
        return moved_about(pose, self.middle, motion[:3], motion[3:] / self.reach)


def engaging(move: Engage, nominal: World) -> Engaging:
    """A move with play.

    Args:
        move: the move.
        nominal: the world before it without deviations, the part at its nominal pose.

    Raises:
        InputError: see `mating`, `floats_of`.
    """
    mate = mating(Mate(move.name, move.part, move.relations), nominal)
    start, _ = mate.poses(nominal, mate.seats(nominal), nominal.poses[move.part])
    world = nominal.with_part_at(move.part, start)
    places, ways = [], []
    for engagement in move.engagements:
        if engagement.bolt is not None:
            for name, its_places in (
                (engagement.inner, engagement.places),
                (engagement.outer, engagement.outer_places),
            ):
                turn = world.placed(name).pose.turn[:, :, 0]
                moves = world.part_of(name) in world.bodies[move.part]
                places += [world.placed(name).at(its_place)[:, 0] for its_place in its_places]
                ways += [[-turn[:, 0], -turn[:, 1]] if moves else [np.zeros(3), np.zeros(3)] for _ in its_places]
            continue
        frame, inner_moves = (
            world.placed(engagement.inner).pose,
            world.part_of(engagement.inner) in world.bodies[move.part],
        )
        sign = -1.0 if inner_moves else 1.0  # an offset is of the outer one
        sides = [sign * frame.turn[:, k, 0] for k in range(3)][world.assembly.features[engagement.inner].shape.located]
        for outer_place in engagement.outer_places:
            places.append(world.placed(engagement.outer).at(outer_place)[:, 0])
            ways.append([*sides, np.zeros(3)][:2])
    at = np.array(places)
    middle = at.mean(axis=0)
    reach = max(float(np.linalg.norm(at - middle, axis=1).max()), 1.0)
    arms = (at - middle)[:, None]
    whole = np.concatenate([np.array(ways), np.cross(arms, np.array(ways)) / reach], axis=2)  # (cones, 2, 6)
    free = _free(mate, nominal, start, middle, reach)
    _, sizes, right = np.linalg.svd((whole @ free).reshape(2 * len(whole), free.shape[1]), full_matrices=True)
    freedoms = free @ right[: int(np.sum(sizes > SEEN))].T
    rows = np.ascontiguousarray(np.concatenate([whole @ freedoms, _bolt_rows(move, world, at)], axis=2))
    origin = rotated_back(start.turn, column(middle) - start.shift)[:, 0]
    relations = kept_of(mate, nominal, reach)
    kept = relations.kept_by(mate.seats(nominal))
    kept = replace(kept, vectors=kept.vectors - kept.shifts[:, None, None] * column(origin))
    _, undo = kept_motions(kept, start.turn[:, :, 0], reach, np.eye(6))
    floats = floats_of(move, world, freedoms, rows, middle, reach)
    return Engaging(move, mate, middle, reach, origin, freedoms, rows, floats, relations, undo)


def _cones_of(engagement: Engagement) -> int:
    return len(engagement.places) if engagement.bolt is None else len(engagement.places) + len(engagement.outer_places)


def _bolt_rows(move: Engage, world: World, at: Array) -> Array:
    """Change of nominal offsets at (cones, 3) by shifts and leans of bolts (cones, 2, 4 bolts)."""
    bolts = [own for own in move.engagements if own.bolt is not None]
    rows, start, number = np.zeros((len(at), 2, 4 * len(bolts))), 0, 0
    for engagement in move.engagements:
        if engagement.bolt is not None:
            across = engagement.bolt.frame[:3, :2]
            for k in range(_cones_of(engagement)):
                name = engagement.inner if k < len(engagement.places) else engagement.outer
                seen = world.placed(name).pose.turn[:, :2, 0].T @ across
                height = (at[start + k] - engagement.bolt.frame[:3, 3]) @ engagement.bolt.frame[:3, 2]
                columns = slice(4 * number, 4 * number + 4)
                rows[start + k, :, columns] = np.concatenate([seen, height / engagement.bolt.reach * seen], axis=1)
            number += 1
        start += _cones_of(engagement)
    return rows


def _free(mate: Mating, world: World, start: Pose, middle: Array, reach: float) -> Array:
    """Orthonormal motions (6, free) that keep the relations: shift of the middle, turn times reach."""
    ends, seats = [], mate.seats(world)
    for sign in (1.0, -1.0):
        motion = sign * NUDGE * np.eye(6)
        many = moved_about(full(start, 6), middle, motion[:, :3].T, motion[:, 3:].T / reach)
        poses = [Pose(many.turn[:, :, k : k + 1], many.shift[:, k : k + 1]) for k in range(6)]
        ends.append([mate.poses(world, seats, pose)[0] for pose in poses])
    made = np.empty((6, 6))
    for k, (after, before) in enumerate(zip(*ends, strict=True)):
        turn = product(after.turn, np.swapaxes(before.turn, 0, 1))[:, :, 0]
        spin = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
        own = column(middle) - start.shift
        back = rotated(np.swapaxes(start.turn, 0, 1), own)
        made[:3, k] = (after.point(back) - before.point(back))[:, 0] / (2 * NUDGE)
        made[3:, k] = spin * reach / (2 * NUDGE)
    left, sizes, _ = np.linalg.svd(made)
    return np.asarray(left[:, sizes > 1e-3])
