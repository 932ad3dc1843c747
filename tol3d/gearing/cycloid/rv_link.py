"""RV reducers between two shafts of a train, whose play is the reducer's lost motion at its carrier."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from tol3d.gearing.cycloid.from_scene import REDUCERS
from tol3d.gearing.cycloid.grammar.moves import RVReducerSpec
from tol3d.gearing.cycloid.grammar.parts import CycloidDiscSpec
from tol3d.gearing.cycloid.reducer.deviated import PINS, RING, RVDeviated
from tol3d.gearing.cycloid.reducer.formula import stages_by_formula
from tol3d.gearing.cycloid.reducer.neglected import BEND, BentTurning
from tol3d.gearing.cycloid.reducer.problems import problems_at
from tol3d.gearing.cycloid.reducer.resting import lost_motion_rates
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.reducer.shown import ShownReducer
from tol3d.gearing.cycloid.reducer.trials import NO_FIT
from tol3d.gearing.cycloid.reducer.turning import LinearTurning, Turning
from tol3d.gearing.cycloid.system import RVSystem
from tol3d.gearing.links import LinkTrials
from tol3d.gearing.model.brought import Brought
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gearing.reducers.link import UNFOLLOWED, Actions, Lost, ReducerLink
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.system import KeyPath


@dataclass(frozen=True, kw_only=True)
class RVLink(ReducerLink):
    """A reducer whose input and carrier turn with shafts of a train, its pins fixed in the world.

    Its play is below 0 where pins press on both sides, as the lost motion of a reducer by itself: trains add it up so.
    Its height is that of the middle of its discs.

    Args:
        sun_level: of the middle of the sun's teeth, from there [mm].
        crank_hole: diameter of the discs' crank holes where it is shown [mm]; None: as large as walls allow.
    """

    kind: ClassVar[str] = "rv_reducer"
    unfollowed: ClassVar[str] = UNFOLLOWED.format("cycloid_transmission_error")
    presenter: ClassVar[str] = "tol3d.gearing.cycloid.presenting"
    alone: ClassVar[type[RVSystem]] = RVSystem
    pins_act: ClassVar[Acts] = Acts(PINS)

    own: RVSet
    sun_level: float = 0.0
    crank_hole: float | None = None

    @property
    def contacts(self) -> int:
        """Either way."""
        return 2 * self.own.contacts

    def lost(self, turning: Turning, deviated: RVDeviated, turns: Array) -> Lost:
        """See ReducerLink; NaN where nothing touches."""
        on, back = (turning.turned(deviated, turns[:, None], sense) for sense in (1, -1))
        jams = np.any([end.codes[:, 0] == NO_FIT for end in (on, back) if end.codes is not None], axis=0)
        middle = (on.turns[:, 0] + back.turns[:, 0]) / 2
        return on.turns[:, 0] - back.turns[:, 0], middle, np.broadcast_to(jams, len(turns))

    def neglected(self, seen: LinkTrials) -> Mapping[str, Array]:
        """The bend of flanks; see StatedLink, and neglected.py."""
        if self.own.plays:
            return {}
        bent, straight = (self.free_turn(method(self.own), seen).play for method in (BentTurning, LinearTurning))
        return {BEND: np.abs(bent - straight)}

    @property
    def centrals(self) -> Mapping[str, tuple[Acts, float]]:
        """See ReducerLink: pin ring, and sun."""
        first, ring = self.own.first, {self.own.ring: (Acts(RING), 0.0)}
        return ring if first is None else {**ring, first.sun: (Acts("sun offset"), float(self.own.ratio))}

    @property
    def levels(self) -> Mapping[str, float]:
        """See StatedLink: sun at its teeth's middle, ring and carrier at that of the discs."""
        found = {self.own.ring: self.height, self.own.carrier: self.height}
        return found if self.own.first is None else {self.own.first.sun: self.height + self.sun_level, **found}

    # what acts on it --------------------------------------------------------------------------------

    def slopes_at(self, deviated: RVDeviated, turns: Array) -> RVDeviated:
        """See ReducerLink: by the pins and planets that touch at both ends."""
        return lost_motion_rates(self.own, deviated, turns)

    @property
    def pins(self) -> Sequence[tuple[float, float]]:
        """See StatedLink: where cranks turn in the carrier."""
        return [(self.own.crank_circle, float(azimuth)) for azimuth in self.own.azimuths]

    @property
    def offsets(self) -> Mapping[str, Acts]:
        """See ReducerLink: the sun, and the carrier, which its main bearing would displace as well."""
        sun = {} if self.own.first is None else {self.own.first.sun: Acts("sun offset", self.own.first.sun)}
        return {self.own.carrier: Acts("carrier offset"), **sun}

    def sections(self, contributors: Sequence[Contributor]) -> Mapping[str, Any]:
        """Its cycloid stage by formula; see StatedLink."""
        known = [contributor for contributor in contributors if contributor.name in self.acts]
        found = stages_by_formula(self.own, self.acts, known)
        return {"cycloid_stages": found[self.name]} if found else {}

    def problems(self, mean: LinkTrials) -> Iterator[tuple[KeyPath, str]]:
        """Lobes and pins, or teeth, that interfere at the mean build."""
        known = [contributor for contributor in mean.contributors if contributor.name in self.acts]
        return problems_at(self.own, self.acts, known, self.deviated(mean, np.zeros(len(mean))))

    def shown(self, seen: LinkTrials) -> ShownReducer:
        """Its parts in the first trial, in a frame at the middle of its discs that rests."""
        first = seen.part(0, 1)
        turns = self.output_turns(first)[:, 0]
        return ShownReducer(self.own, self.deviated(first, turns), float(turns[0]), self.own.width, self.crank_hole)


# from scenes ------------------------------------------------------------------------------------------


def reducers_as_links(scene: Scene) -> Brought:
    """The RV reducers of a scene as links of a train.

    Raises:
        SceneError: it cannot be built, or such a train cannot have it; with its place.
    """
    return REDUCERS.as_links(scene, _link)


def _link(scene: Scene, rv_set: RVSet, move: RVReducerSpec, actions: Actions) -> RVLink:
    disc = scene.of(CycloidDiscSpec)[move.disc]
    hole = None if disc.hole is None else disc.hole.internal
    sun_level = ShownReducer(rv_set, RVDeviated.nothing(rv_set, 1), 0.0, rv_set.width, hole).shapes.sun_level
    link = RVLink.between(scene, rv_set, actions, {rv_set.input: sun_level, rv_set.output: 0.0})
    return replace(link, sun_level=sun_level, crank_hole=hole)
