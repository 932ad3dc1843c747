"""Planetary sets and the train around them, from one scene."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from tol3d.gearing.effects import LinkDeviation, TurningOffset
from tol3d.gearing.grammar.parts import ShaftSpec, carried
from tol3d.gearing.grammar.tolerances.gearing_tolerance import together
from tol3d.gearing.model import Contributor
from tol3d.gearing.model.brought import Brought
from tol3d.gearing.system import GearSystem, gear_system
from tol3d.planetary.deviated import Acts
from tol3d.planetary.grammar.moves.planetary import PlanetarySpec
from tol3d.planetary.implausible import implausible_set
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.refusals import parts_of, set_of
from tol3d.planetary.shown import heights_of, made_gears
from tol3d.planetary.stage.refusals import refuse_carried, refuse_measures_of_sets, refuse_shared_parts
from tol3d.planetary.stage.set_link import SetLink
from tol3d.planetary.stage.system import SetTrain
from tol3d.planetary.tolerances import acts_of, draw_of, refuse_other_tolerance
from tol3d.scene import Scene

ByName = dict[str, tuple[tuple[str, Acts], ...]]
"""What contributors act on in each set."""


def train_system(scene: Scene) -> SetTrain:
    """A train some of whose links are planetary sets.

    Raises:
        SceneError: what nobody can build, or what such a train cannot have, with its place.
    """
    refuse_measures_of_sets(scene)
    sets = {str(name): set_of(scene, name, spec) for name, spec in scene.of(PlanetarySpec).items()}
    refuse_shared_parts(scene, sets)
    refuse_carried(scene, sets)
    inside = {part: own for name, own in sets.items() for part in parts_of(own, _spec(scene, name))}
    acts = {
        str(name): (own, acts_of(scene, own, name, spec))
        for name, spec in scene.tolerances.items()
        for own in _sets_of(scene, inside, str(name))
    }
    links = tuple(_link(scene, own, tuple(_actions(acts, own))) for own in sets.values())
    contributors = {name: _contributor(scene, name, *own) for name, own in acts.items()}
    system = gear_system(scene, Brought(links, frozenset(inside), contributors))
    return _with_shared(scene, system, inside)


def _spec(scene: Scene, name: str) -> PlanetarySpec:
    spec = scene.moves[name]
    assert isinstance(spec, PlanetarySpec)
    return spec


def _sets_of(scene: Scene, inside: Mapping[str, PlanetarySet], name: str) -> Iterator[PlanetarySet]:
    """The set on which a tolerance acts, if it is of one of its parts.

    Raises:
        SceneError: it is a kind that no set has.
    """
    of: Any = getattr(scene.tolerances[name], "of", ())
    for part in (of,) if isinstance(of, str) else of:
        if part in inside:
            refuse_other_tolerance(scene, name)
            yield inside[part]


def _actions(acts: Mapping[str, tuple[PlanetarySet, Acts]], own: PlanetarySet) -> Iterator[tuple[str, Acts]]:
    for name, (other, acting) in acts.items():
        if other is own:
            yield name, acting


def _contributor(scene: Scene, name: str, own: PlanetarySet, acts: Acts) -> Contributor:
    """A tolerance that acts in a set alone."""
    spec: Any = scene.tolerances[name]
    turning = acts.gear if acts.effect == "offset" else None
    return Contributor(
        name,
        spec.kind,
        LinkDeviation(own.name, turning),
        draw_of(scene, own, spec),
        "arcmin" if acts.effect == "clocking" else "um",
        spec.description,
    )


def _link(scene: Scene, own: PlanetarySet, actions: tuple[tuple[str, Acts], ...]) -> SetLink:
    """A set as a link of the shafts that turn with its input and its output."""
    (driver, first), (driven, last) = (_shaft_of(scene, part) for part in (own.input, own.output))
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
        friction=_spec(scene, own.name).friction,
    )


def _shaft_of(scene: Scene, part: str) -> tuple[str, float]:
    """The shaft that carries a part, and where along it [mm]; a part that none carries is its own."""
    for name, own in carried(scene.parts):
        if own == part:
            shaft = scene.parts[name]
            assert isinstance(shaft, ShaftSpec)
            return name, shaft.carries[part].at.internal
    return part, 0.0


def _with_shared(scene: Scene, system: GearSystem, inside: Mapping[str, PlanetarySet]) -> SetTrain:
    """With what run-outs of shafts do to the gears of sets on them.

    Raises:
        SceneError: another tolerance moves a shaft that carries a gear of a set.
    """
    model, found = system.model, []
    added: ByName = {own.name: () for own in inside.values()}
    for contributor in model.contributors:
        effects = contributor.effect.singles
        moved = [(effect, part) for effect in effects if (part := str(getattr(effect, "part", ""))) in inside]
        for effect, part in moved:
            if not isinstance(effect, TurningOffset):
                raise scene.refuse(
                    ("tolerances", contributor.name),
                    f"expected a shaft without gears of planetary sets, got one that carries {part!r}: "
                    f"{inside[part].name!r} turns about one axis; put its gear on a shaft of its own",
                )
            added[inside[part].name] += ((contributor.name, Acts("offset", part)),)
        if moved:
            own = (LinkDeviation(inside[part].name, part) for _, part in moved)
            kept = (effect for effect in effects if effect not in [of_a_set for of_a_set, _ in moved])
            contributor = replace(contributor, effect=together((*kept, *own)))
        found.append(contributor)
    links = tuple(
        replace(link, actions=link.actions + added[link.name]) if isinstance(link, SetLink) else link
        for link in model.links
    )
    warnings = (line for own in links if isinstance(own, SetLink) for line in implausible_set(scene, own.own, own.made))
    return SetTrain(replace(model, contributors=tuple(found), links=links, warnings=(*model.warnings, *warnings)))
