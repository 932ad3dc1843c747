"""Moves with play: pins, tabs, holes, slots and bolts that engage, and where in its room the part lies."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Final, Literal

import numpy as np

from tol3d.assembly.model.feature import Contribution
from tol3d.assembly.model.move import Acts, PartMove
from tol3d.assembly.model.moves import PLACING, TORSORS, Relation
from tol3d.numerics.arrays import Array


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
class Engage(PartMove):
    """Relations first, as of a mate; the freedoms that they leave are limited by clearances.

    Args:
        name, part: of the move, and what it places.
        relations: in order.
        engagements: all at once.
        floating: where in its room the part lies.
    """

    acts: ClassVar[Acts] = Acts(
        "play", "play on", f"{PLACING}.play_move:engaging", f"{TORSORS}.play_move:engaged", has_room=True
    )

    relations: tuple[Relation, ...]
    engagements: tuple[Engagement, ...]
    floating: Floating

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        related = [(relation.moving, relation.target) for relation in self.relations]
        return [*related, *((engagement.inner, engagement.outer) for engagement in self.engagements)]

    @property
    def terms(self) -> int:
        return 7

    @property
    def is_pushed(self) -> bool:
        return self.floating.kind == "toward"

    @property
    def words(self) -> str:
        return ", ".join(engagement.name for engagement in self.engagements)
