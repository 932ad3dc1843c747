"""Planetary sets between two shafts of a train, whose play is the set's lost motion at its output."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from tol3d.gearing.links import LinkTrials
from tol3d.gearing.model.brought import Brought
from tol3d.gearing.planetary.backlash import set_backlash
from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.exact.shown import Made, ShownSet, heights_of, made_gears, shown_set
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.from_scene import SETS
from tol3d.gearing.planetary.grammar.moves import PlanetarySpec
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.problems import problems_at
from tol3d.gearing.planetary.sections import set_sections
from tol3d.gearing.planetary.summary_types import PlanetarySetSummary
from tol3d.gearing.planetary.trials import SetTrials
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gearing.reducers.link import UNFOLLOWED, Actions, Lost, ReducerLink
from tol3d.gearing.summary.types import BacklashLimits
from tol3d.numerics.arrays import Array
from tol3d.numerics.programme import NO_ROOM
from tol3d.scene import Scene
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import Copula
from tol3d.study.system.system import KeyPath


@dataclass(frozen=True, kw_only=True)
class SetLink(ReducerLink):
    """A set whose input and output turn with shafts of a train; its height is that of its first planet gear's middle.

    Args:
        made: its gears by their names, nominal, to be shown.
        friction: coefficient of friction of its teeth; None where it is not given.
    """

    kind: ClassVar[str] = "planetary_set"
    unfollowed: ClassVar[str] = UNFOLLOWED.format("planetary_transmission_error")
    presenter: ClassVar[str] = "tol3d.gearing.planetary.presenting"
    alone: ClassVar[type[SetTrials]] = SetTrials
    pins_act: ClassVar[Acts] = Acts("pin")

    own: PlanetarySet
    made: Made = field(default_factory=dict)
    friction: float | None = None

    @property
    def contacts(self) -> int:
        """One for each mesh of each planet."""
        return self.own.planets * len(self.own.meshes)

    @property
    @override
    def twists(self) -> Mapping[str, float]:
        """Of central gears kappa; of the carrier by its planets, which screw in sun and ring against each other.

        Planets whose gears have one lead leave the carrier where it is: their thrusts cancel.
        """
        own = self.own
        ends = ((self.driver, own.input), (self.driven, own.output))
        return {shaft: float(own.slide_turns(part)[own.shafts.index(part)]) for shaft, part in ends}

    def lost(self, turning: StackUp | Contact, deviated: Deviated, turns: Array) -> Lost:
        """See ReducerLink; a set that jams lacks room at both ends."""
        own = self.own
        free = turning.free(deviated, turns, own.output, own.opposite(own.output))
        return free.play(own, deviated, own.output), free.ends.mean(axis=1), np.asarray(free.status == NO_ROOM)

    @property
    def centrals(self) -> Mapping[str, tuple[Acts, float]]:
        """See ReducerLink: in the frame of the carrier."""
        carrier = -float(self.own.turn(self.own.held) * self.own.planet_turns)
        names = [mesh.central.name for mesh in self.own.meshes]
        return {name: (Acts("aside", name, -1.0), carrier) for name in names}

    def shown(self, seen: LinkTrials) -> ShownSet:
        """Its gears in the first trial, in a frame at the driver's origin that rests, its height not counted."""
        turns = self.output_turns(seen)[:, 0]
        return shown_set(self.own, self.made, self.deviated(seen, turns), float(turns[0]))

    # what acts on it --------------------------------------------------------------------------------

    def slopes_at(self, deviated: Deviated, turns: Array) -> Deviated:
        """See ReducerLink: by the contacts that are met."""
        return StackUp(self.own).lost_motion_slopes(deviated, turns, self.own.output)

    @property
    def levels(self) -> Mapping[str, float]:
        """See StatedLink: central gears at the middle of their faces, the carrier at that of all its planets' gears."""
        heights = heights_of(self.own, self.made)
        centrals = [heights[mesh.central.name] for mesh in self.own.meshes]
        middle = (min(centrals) + max(centrals)) / 2
        return {name: self.height + (middle if name == self.own.carrier else at) for name, at in heights.items()}

    @property
    @override
    def pins(self) -> Sequence[tuple[float, float]]:
        return [(self.own.centre_distance, azimuth) for azimuth in self.own.azimuths]

    @property
    def offsets(self) -> Mapping[str, Acts]:
        """See ReducerLink: central gears."""
        return {mesh.central.name: Acts("offset", mesh.central.name) for mesh in self.own.meshes}

    def sections(self, contributors: Sequence[Contributor]) -> Mapping[str, Any]:
        """Efficiencies, where the friction of its teeth is given; see StatedLink."""
        return {"planetary_sets": self.summaries[self.name]} if self.summaries else {}

    @override
    def backlash_limits(self, contributors: Sequence[Contributor], copula: Copula) -> Sequence[BacklashLimits]:
        return set_backlash(self.own, self.made, contributors, self.acts, copula)

    @property
    def summaries(self) -> Mapping[str, PlanetarySetSummary]:
        """Efficiencies by the set's name; empty without friction."""
        return set_sections(self.own, self.friction)

    def problems(self, mean: LinkTrials) -> Iterator[tuple[KeyPath, str]]:
        """Meshes that overlap at the mean build, then load paths of several planets that do."""
        return problems_at(self.own, self.deviated(mean, np.zeros(len(mean))), self.own.output)


# from scenes ------------------------------------------------------------------------------------------


def sets_as_links(scene: Scene) -> Brought:
    """The sets of a scene as links of a train.

    Raises:
        SceneError: it cannot be built, or such a train cannot have it; with its place.
    """
    return SETS.as_links(scene, _link)


def _link(scene: Scene, planetary_set: PlanetarySet, move: PlanetarySpec, actions: Actions) -> SetLink:
    made = made_gears(scene, planetary_set)
    link = SetLink.between(scene, planetary_set, actions, heights_of(planetary_set, made))
    return replace(link, made=made, friction=move.friction)
