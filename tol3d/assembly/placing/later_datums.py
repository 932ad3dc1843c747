"""Datums regardless of size after ones at their boundary: each as near to its simulator as the room of these lets it.

The gauges of the earlier datums limit the part, and hold nothing; within their room a later datum asks what it asks of
any frame, one thing after the other, and each takes the place that is nearest to it: all of it, or as much as the room
leaves. What it has taken stays, and the part floats in the rest of the room. Without room that is the datum regardless
of the sizes of all. A slot closes on its blade from both sides: the largest offset of its corners is least.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Datum, DatumFrame
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.poses import Pose, column, dot
from tol3d.assembly.placing.seen_motions import SeenMotions, point_row
from tol3d.contact.programme import SPARE, least_growth
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array, times

SEEN: Final = 1e-6
"""Change of what is asked by a freedom of length 1 [mm] that is none."""


@dataclass(frozen=True, eq=False)
class Ask:
    """One thing that a later datum asks.

    Args:
        feature: its name.
        what: its direction; its place across an axis; its height, that of its outermost corner, or of a target point;
            the heights of the corners of a slot together.
        nominal: the feature nominally.
        reach: length that a turn counts by [mm].
        target: in its frame (3,) [mm].
    """

    feature: str
    what: str
    nominal: ActualFeature
    reach: float
    target: Array | None = None

    def offsets(self, pose: Pose, actual: ActualFeature, trials: int) -> Array:
        """Distances that it lacks at a pose of the part (places, 2, n) [mm]."""
        own, (x, y, z) = actual.moved(pose), (column(axis) for axis in self.nominal.feature.frame[:3, :3].T)
        if self.what == "direction":
            found = [(-self.reach * dot(own.direction, y), self.reach * dot(own.direction, x))]
        elif self.what == "aside":
            off = own.origin - self.nominal.origin
            found = [(dot(x, off), dot(y, off))]
        elif self.what == "corners":
            pairs = zip(own.ends, self.nominal.ends, strict=True)
            found = [(dot(z, end - place), np.zeros(1)) for end, place in pairs]
        elif self.target is not None:
            found = [(dot(z, own.at(self.target) - self.nominal.at(self.target)), np.zeros(1))]
        else:
            rise = own.rise(z) if self.what == "outermost" else np.zeros(1)
            found = [(dot(z, own.origin - self.nominal.origin) + rise, np.zeros(1))]
        return np.stack([np.stack([np.broadcast_to(one, trials) for one in pair]) for pair in found])

    def rows(self, seen: SeenMotions) -> Array:
        """Change of that by motions of the part (places, 2, freedoms)."""
        x, y, z = self.nominal.feature.frame[:3, :3].T
        nothing = np.zeros(6)
        if self.what == "direction":
            found = [[np.concatenate([np.zeros(3), x]), np.concatenate([np.zeros(3), y])]]
        else:
            places = self.nominal.ends if self.what == "corners" else [self.nominal.origin]
            places = [self.nominal.at(self.target)] if self.target is not None else places
            sides = [x, y] if self.what == "aside" else [z]
            rows = [[point_row(place[:, 0] - seen.middle, side, seen.reach) for side in sides] for place in places]
            found = [[*row, nothing][:2] for row in rows]
        return np.array(found) @ seen.motions


@dataclass(frozen=True, eq=False)
class Taken:
    """An ask with the freedoms that it takes.

    Args:
        ask: what is asked.
        rows: its change by all freedoms (places, 2, freedoms).
        open: what earlier asks leave of them (freedoms, open), orthonormal.
        held: projector to what it takes of these (open, open).
    """

    ask: Ask
    rows: Array
    open: Array
    held: Array


@dataclass(frozen=True, eq=False)
class LaterDatums:
    """The asks of the later datums of a frame, in order.

    Args:
        taken: each ask.
        left: freedoms that they leave (freedoms, left), orthonormal.
    """

    taken: tuple[Taken, ...]
    left: Array

    @property
    def features(self) -> tuple[str, ...]:
        """The feature of each ask."""
        return tuple(own.ask.feature for own in self.taken)

    def nearest(
        self, pose: Pose, features: Sequence[ActualFeature], offsets: Array, clearances: Array, rows: Array,
        asked: NDArray[np.bool_],
    ) -> Array:  # fmt: skip
        """Steps (freedoms, n) to where each is met as nearly as the room lets it.

        Args:
            pose: of the part.
            features: of each ask.
            offsets, clearances, rows: of the room there: o_k (cones, 2, n), c_k (cones, n) [mm], B_k (cones, 2,
                freedoms).
            asked: for which trials (n,).
        """
        trials = clearances.shape[1]
        steps = np.zeros((rows.shape[2], trials))
        for k, (own, feature) in enumerate(zip(self.taken, features, strict=True)):
            its = own.ask.offsets(pose, feature, trials) + times(own.rows, steps)
            every = np.concatenate([its, offsets + times(rows, steps)])
            room = np.concatenate([np.zeros((len(its), trials)), clearances + k * SPARE])
            _, some, _ = least_growth(every, room, np.concatenate([own.rows, rows]) @ own.open, len(its), asked)
            steps = steps + times(own.open @ own.held, some)
        return steps


def later_datums(frame: DatumFrame, nominal: Sequence[ActualFeature], seen: SeenMotions) -> LaterDatums:
    """The asks of the later datums of a frame.

    Args:
        frame: the datum frame.
        nominal: features of these datums, one each.
        seen: motions that gauges and these features see.

    Raises:
        InputError: one takes no freedom.
    """
    left, taken = np.eye(seen.freedoms.shape[1]), list[Taken]()
    for datum, own in zip(frame.later, nominal, strict=True):
        count = len(taken)
        for ask in _asks(datum, own, seen.reach):
            rows = ask.rows(seen)
            _, sizes, right = np.linalg.svd((rows @ left).reshape(2 * len(rows), left.shape[1]))
            rank = int(np.sum(sizes > SEEN))
            if rank:
                taken.append(Taken(ask, rows, left, right[:rank].T @ right[:rank]))
                left = left @ right[rank:].T
        if len(taken) == count:
            raise InputError(
                f"datum frame {frame.name}: {own.feature.name} takes no freedom: datums before it hold all that it "
                "could take; leave it out"
            )
    return LaterDatums(tuple(taken), left)


def _asks(datum: Datum, actual_feature: ActualFeature, reach: float) -> Iterator[Ask]:
    if datum.targets is not None:
        yield from (
            Ask(actual_feature.feature.name, "target", actual_feature, reach, target) for target in datum.targets
        )
        return
    for what in actual_feature.asked:
        outermost = what == "height" and datum.simulator == "contact"
        yield Ask(actual_feature.feature.name, "outermost" if outermost else what, actual_feature, reach)
