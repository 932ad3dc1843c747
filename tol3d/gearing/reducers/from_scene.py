"""Reducers from scenes, alone and in trains: their moves and parts, and of each tolerance its effect and its draw."""

import math
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearToleranceSpec
from tol3d.gearing.model.brought import Brought, BroughtLink, acting_in, tolerances_of
from tol3d.gearing.model.pairs import cylindrical_gear
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gearing.reducers.link import Actions, ReducerLink
from tol3d.gears.pair import SAME_LENGTH
from tol3d.scene import Scene
from tol3d.scene.bases import MoveSpec, PartSpec
from tol3d.statistics.distributions import Distribution
from tol3d.study.system.draw import Draw, Each, Planar, Scalar
from tol3d.study.system.each_planar import EachPlanar
from tol3d.study.system.plain import UNITS, PlainContributor
from tol3d.units import Quantity

LinkOf = Callable[[Scene, Any, Any, Actions], ReducerLink]
"""Link of a train, from the scene, the reducer's model, its move, and the effects of its contributors."""


@dataclass(frozen=True)
class ReducerKind:
    """A kind of reducers in scenes.

    Args:
        called: its noun with an article, such as "a set".
        move: kind of move that stands for one; it refers to all its parts.
        measures: kinds of measure of one that is alone in its scene.
        parts: kinds of part that stand in such reducers alone.
        model_of: model of one, from the scene, its name and its move; raises a SceneError where it cannot be built.
        implausible: warnings of one, from the scene and its model.
        acts_of: effect of a tolerance, from the scene, the model, its name and the tolerance; raises a SceneError where
            it has none.
        draw_of: draw of its components, from the scene, the model, its effect and the tolerance.
    """

    called: str
    move: type[MoveSpec]
    measures: type[Any]
    parts: tuple[type[PartSpec], ...]
    model_of: Callable[[Scene, str, Any], Any]
    implausible: Callable[[Scene, Any], Iterable[str]]
    acts_of: Callable[[Scene, Any, str, Any], Acts]
    draw_of: Callable[[Scene, Any, Acts, Any], Draw]

    def alone(self, scene: Scene) -> Any:
        """Model of the reducer of a scene that has nothing else.

        Raises:
            SceneError: not one reducer and nothing else, or one that cannot be built.
        """
        reducers = scene.of(self.move)
        others = [name for name in scene.moves if name not in reducers]
        if others or len(reducers) != 1:
            noun = self.move.words.split(maxsplit=1)[1]
            words = f"expected one {noun} and no other move, got {len(scene.moves)} moves"
            train = "" if others else "; several make a train, which a move of kind train names"
            raise scene.refuse(("moves", (others or list(reducers)[-1:])[0]), words + train)
        ((name, spec),) = reducers.items()
        own = self.model_of(scene, str(name), spec)
        _refuse_unused(scene, (PartSpec,), parts_of(spec), repr(name))
        return own

    def contributors(self, scene: Scene, own: Any) -> tuple[tuple[PlainContributor, ...], Mapping[str, Acts]]:
        """Contributors of a reducer that is alone in its scene, and the effect of each by its name.

        Raises:
            SceneError: a tolerance that does not act on it.
        """
        contributors, effects = [], {}
        for name, spec in scene.tolerances.items():
            effects[name] = acts = self.acts_of(scene, own, name, spec)
            draw, unit = self.draw_of(scene, own, acts, spec), UNITS[spec.dimensions[0]]
            words = spec.description
            contributors.append(
                PlainContributor(name, spec.kind, draw, *unit, words, least=acts.least, nominal=spec.nominal)
            )
        return tuple(contributors), effects

    def as_links(self, scene: Scene, link_of: LinkOf) -> Brought:
        """All reducers of a scene as links of a train, and what acts on them.

        Raises:
            SceneError: one that cannot be built, or that such a train cannot have; with its place.
        """
        moves = scene.of(self.move)
        reducers = {str(name): self.model_of(scene, str(name), spec) for name, spec in moves.items()}
        parts = {name: parts_of(moves[name]) for name in reducers}
        owners = {part: own for name, own in reducers.items() for part in parts[name]}
        self._refuse_measures(scene, reducers)
        _refuse_unused(scene, self.parts, owners, self.called)
        actions: dict[str, list[tuple[str, Acts]]] = {name: [] for name in reducers}
        contributors = {}
        for name, own in tolerances_of(scene, owners):
            spec: Any = scene.tolerances[name]
            acts = self.acts_of(scene, own, name, spec)
            actions[own.name].append((name, acts))
            draw = self.draw_of(scene, own, acts, spec)
            contributors[name] = acting_in(scene, name, own.name, draw, acts.turning, acts.least)
        links = [link_of(scene, own, moves[name], tuple(actions[name])) for name, own in reducers.items()]
        warnings = [line for reducer in reducers.values() for line in self.implausible(scene, reducer)]
        brought = (BroughtLink(link, parts[link.name], (link.own.input, link.own.output)) for link in links)
        return Brought(tuple(brought), contributors, tuple(warnings))

    def _refuse_measures(self, scene: Scene, reducers: Mapping[str, Any]) -> None:
        """Refuse measures of a reducer alone, which trains read."""
        for name, spec in scene.of(self.measures).items():
            own, noun = reducers[spec.of], self.called.rpartition(" ")[2]
            raise scene.refuse(
                ("measures", name, "kind"),
                f"expected a measure of trains, for {spec.of!r} is a stage of one, got {spec.kind}; take lost_motion "
                f"of a train whose output turns with {own.output!r}, and of the {noun} alone one whose held shaft "
                f"turns with {own.input!r}",
            )


def parts_of(move: MoveSpec) -> frozenset[str]:
    """Parts of a reducer: all that its move refers to."""
    return frozenset(reference.name for reference in move.references())


def _refuse_unused(scene: Scene, kinds: tuple[type[PartSpec], ...], used: Container[str], words: str) -> None:
    """Refuse parts of some kinds that no move names, which `words` of the scene would have."""
    for name, part in scene.parts.items():
        if isinstance(part, kinds) and name not in used:
            raise scene.refuse(("parts", name), f"{name!r} is used by no move; name it in {words} or take it out")


def unlike(scene: Scene, one: str, other: str) -> tuple[str, Quantity, Quantity] | None:
    """The field in which two gears differ that therefore do not roll on each other, and its values; None if alike."""
    for field in ("module", "pressure_angle"):
        own, mate = (getattr(scene.parts[gear], field) for gear in (one, other))
        if not math.isclose(own.internal, mate.internal, rel_tol=SAME_LENGTH):
            return field, own, mate
    return None


def law_of(scene: Scene, spec: Any) -> Distribution:
    """The law of a tolerance; of one of teeth, that on their gear."""
    if isinstance(spec, GearToleranceSpec):
        return spec.law_on(cylindrical_gear(scene, spec.of), scene.files)
    found: Distribution = spec.distribution.resolve(scene.files)
    return found


def drawn(
    law: Distribution, alike: tuple[str, ...] = (), *, planar: bool = False, direction: float | None = None
) -> Draw:
    """Draw of one deviation, or of one for each of several alike parts.

    Args:
        law: of each.
        alike: names of the parts; none for one deviation.
        planar: True for a length in a direction.
        direction: that direction [rad]; None: any.
    """
    if planar:
        return EachPlanar(law, alike, direction) if alike else Planar(law, direction)
    return Each(law, alike) if alike else Scalar(law)


def numbered(word: str, count: int) -> tuple[str, ...]:
    """Names of alike parts, counted from 1."""
    return tuple(f"{word} {k + 1}" for k in range(count))
