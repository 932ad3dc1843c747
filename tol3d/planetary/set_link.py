"""Planetary sets between two shafts of a train, whose play is the set's lost motion at its output."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from tol3d.gearing.links import FreeTurn, LinkTrials, pin_name
from tol3d.gearing.model.brought import Brought, BroughtLink, acting_in, shaft_of, tolerances_of
from tol3d.gearing.model.output_link import OutputLink, refuse_alone, refuse_unused
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import turned
from tol3d.numerics.programme import NO_ROOM, ranges
from tol3d.planetary.exact.contact import Contact
from tol3d.planetary.exact.contact_kernel import seated_ranges
from tol3d.planetary.exact.shown import Made, ShownSet, heights_of, made_gears, shown_set
from tol3d.planetary.first_order.stack_up import StackUp
from tol3d.planetary.from_scene import implausible_set
from tol3d.planetary.grammar.measures import PlanetaryMeasureSpec
from tol3d.planetary.grammar.moves import PlanetarySpec
from tol3d.planetary.grammar.parts import CarrierSpec, PlanetSpec
from tol3d.planetary.model.deviated import Acts, Deviated
from tol3d.planetary.model.draws import acts_of, draw_of, refuse_other_tolerance
from tol3d.planetary.model.planetary_set import PlanetarySet
from tol3d.planetary.problems import problems_at
from tol3d.planetary.refusals import parts_of, set_of
from tol3d.planetary.sections import set_sections
from tol3d.scene import Scene
from tol3d.system.contributor import Contributor
from tol3d.system.system import KeyPath


@dataclass(frozen=True, kw_only=True)
class SetLink(OutputLink):
    """A set whose input and output turn with shafts of a train; its height is that of its first planet gear's middle.

    Args:
        made: its gears by their names, nominal, to be shown.
        friction: coefficient of friction of its teeth; None where it is not given.
    """

    kind: ClassVar[str] = "planetary_set"
    unfollowed: ClassVar[str] = (
        "whose error recurs with turns of its output, not of the motor (planetary_transmission_error reads it, in a "
        "scene of its own)"
    )
    presenter: ClassVar[str] = "tol3d.planetary.presenting"

    own: PlanetarySet
    made: Made
    friction: float | None = None

    @property
    def contacts(self) -> int:
        """One for each mesh of each planet."""
        return self.own.planets * len(self.own.meshes)

    def is_compiled(self) -> bool:
        """See StatedLink."""
        return bool(ranges.kept and seated_ranges.kept)

    # its play ---------------------------------------------------------------------------------------

    def exact(self, seen: LinkTrials) -> FreeTurn:
        """The free turn of the output with all gears placed."""
        return self._free(Contact(self.own), seen)

    def analytic(self, seen: LinkTrials) -> FreeTurn:
        """The same to first order."""
        return self._free(StackUp(self.own), seen)

    def _free(self, method: StackUp | Contact, seen: LinkTrials) -> FreeTurn:
        own, stands = self.own, self.own.opposite(self.own.output)
        found = [
            method.free(deviated, turns, own.output, stands)
            for turns in self.output_turns(seen).T
            for deviated in [self.deviated(seen, turns)]
        ]
        jams = np.stack([free.status == NO_ROOM for free in found], axis=1)
        lacking = np.stack([free.lacking for free in found], axis=1)
        ends = np.stack([free.ends for free in found], axis=1)
        play = np.where(jams, -2 * lacking / own.arm(own.output), ends[..., 1] - ends[..., 0])
        return FreeTurn(play, np.where(jams, 0.0, ends.mean(axis=-1)), jams)

    def deviated(self, seen: LinkTrials, turns: Array) -> Deviated:
        """Deviations of the set's gears and pins at turns of the output (trials,)."""
        own, found = self.own, Deviated.nothing(self.own, len(seen))
        for contributor in seen.contributors:
            if contributor.name in self.acts:
                found.add(own, self.acts[contributor.name], seen.deviations[contributor.name])
        asides, none = self.asides(seen), np.zeros((len(seen), 2))
        for m, mesh in enumerate(own.meshes if asides else ()):
            aside = asides.get(own.carrier, none) - asides.get(mesh.central.name, none)
            found.aside[:, m] = turned(aside, -self._carrier_rate * turns)
        for k in range(own.planets):
            found.pins[:, k] += asides.get(pin_name(k), none)
        return found

    @property
    def _carrier_rate(self) -> float:
        """Turns of the carrier in the world a turn of the output."""
        return -float(self.own.turn(self.own.held) * self.own.planet_turns)

    def shown(self, seen: LinkTrials) -> ShownSet:
        """Its gears in the first trial, in a frame at the driver's origin that rests, its height not counted."""
        turns = self.output_turns(seen)[:, 0]
        return shown_set(self.own, self.made, self.deviated(seen, turns), float(turns[0]))

    # what acts on it --------------------------------------------------------------------------------

    def part_of(self, slopes: Deviated, acts: Acts, off: Array) -> Array:
        """See OutputLink."""
        return np.asarray((slopes.of(self.own, acts) * off).sum(axis=1))

    def slopes_at(self, piece: LinkTrials, turns: Array) -> Deviated:
        """See OutputLink: by the contacts that are met."""
        own, deviated, method = self.own, self.deviated(piece, turns[:, 0]), StackUp(self.own)
        senses = ((end, np.full((len(piece), 1), 2.0 * end - 1.0)) for end in range(2))
        low, high = (
            method.slopes(deviated, turns, own.output, own.opposite(own.output), end, sign) for end, sign in senses
        )
        return low.plus(high)

    @property
    def levels(self) -> Mapping[str, float]:
        """See StatedLink: central gears at the middle of their faces, the carrier at that of all its planets' gears."""
        heights = heights_of(self.own, self.made)
        centrals = [heights[mesh.central.name] for mesh in self.own.meshes]
        middle = (min(centrals) + max(centrals)) / 2
        return {name: self.height + (middle if name == self.own.carrier else at) for name, at in heights.items()}

    @property
    def pins(self) -> Sequence[tuple[float, float]]:
        """See StatedLink."""
        return [(self.own.centre_distance, azimuth) for azimuth in self.own.azimuths]

    @property
    def held(self) -> str:
        """See StatedLink."""
        return self.own.held

    def aside_slopes(self, seen: LinkTrials) -> Mapping[str, Array]:
        """See StatedLink."""
        found = [
            (turned(slopes.aside, (self._carrier_rate * turns)[:, None]), slopes.pins)
            for _, turns, slopes in self.slopes(seen)
        ]
        aside, pins = (np.concatenate(own) for own in zip(*found, strict=True))
        of_gears = {mesh.central.name: -aside[:, m] for m, mesh in enumerate(self.own.meshes)}
        of_pins = {pin_name(k): pins[:, k] for k in range(self.own.planets)}
        return {**of_gears, **of_pins, self.own.carrier: aside.sum(axis=1)}

    def offset_by(self, contributor: str, part: str) -> "SetLink | None":
        """See StatedLink: of a central gear."""
        if part not in {mesh.central.name for mesh in self.own.meshes}:
            return None
        return replace(self, actions=(*self.actions, (contributor, Acts("offset", part))))

    def sections(self, contributors: Sequence[Contributor]) -> Mapping[str, Any]:
        """Efficiencies, where the friction of its teeth is given; see StatedLink."""
        found = set_sections(self.own, self.friction)
        return {"planetary_sets": found[self.name]} if found else {}

    def problems(self, mean: LinkTrials) -> Iterator[tuple[KeyPath, str]]:
        """Meshes that overlap at the mean build, then load paths of several planets that do."""
        return problems_at(self.own, self.deviated(mean, np.zeros(len(mean))), self.own.output)


# from scenes ------------------------------------------------------------------------------------------


def sets_as_links(scene: Scene) -> Brought:
    """The sets of a scene as links of a train.

    Raises:
        SceneError: it cannot be built, or such a train cannot have it; with its place.
    """
    specs = {str(name): spec for name, spec in scene.of(PlanetarySpec).items()}
    sets = {name: set_of(scene, name, spec) for name, spec in specs.items()}
    owners = {part: own for name, own in sets.items() for part in parts_of(own, specs[name])}
    refuse_alone(scene, PlanetaryMeasureSpec, {name: (own.input, own.output) for name, own in sets.items()}, "set")
    refuse_unused(scene, (PlanetSpec, CarrierSpec), owners, "a set")
    actions: dict[str, list[tuple[str, Acts]]] = {name: [] for name in sets}
    contributors = {}
    for name, own in tolerances_of(scene, owners):
        refuse_other_tolerance(scene, name)
        spec: Any = scene.tolerances[name]
        acts = acts_of(scene, own, name, spec)
        turning = acts.gear if acts.effect == "offset" else None
        actions[own.name].append((name, acts))
        contributors[name] = acting_in(scene, name, own.name, draw_of(scene, own, spec), turning)
    links = [_link(scene, own, specs[name], tuple(actions[name])) for name, own in sets.items()]
    return Brought(
        tuple(
            BroughtLink(each, frozenset(parts_of(each.own, specs[each.name])), (each.own.input, each.own.output))
            for each in links
        ),
        contributors,
        tuple(line for each in links for line in implausible_set(scene, each.own, each.made)),
    )


def _link(scene: Scene, own: PlanetarySet, spec: PlanetarySpec, actions: tuple[tuple[str, Acts], ...]) -> SetLink:
    """A set as a link of the shafts that turn with its input and its output."""
    (driver, first), (driven, last) = (shaft_of(scene, part) for part in (own.input, own.output))
    made = made_gears(scene, own)
    heights = heights_of(own, made)
    return SetLink(
        name=own.name,
        driver=driver,
        driven=driven,
        rate=1 / own.ratio,
        offset=(first - heights[own.input]) - (last - heights[own.output]),
        own=own,
        made=made,
        height=first - heights[own.input],
        actions=actions,
        friction=spec.friction,
    )
