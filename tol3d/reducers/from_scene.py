"""Reducers from scenes, alone and in trains: their moves and parts, and of each tolerance its effect and its draw.

What a tolerance does to a reducer its model says, by two functions: `acts_of` and `draw_of`.
"""

import math
from collections.abc import Callable, Container, Mapping
from typing import Any, TypeVar

from tol3d.distributions import Distribution
from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearToleranceSpec
from tol3d.gearing.model.brought import acting_in, tolerances_of
from tol3d.gearing.model.contributor import Contributor
from tol3d.gearing.model.pairs import cylindrical_gear
from tol3d.gears.pair import SAME_LENGTH
from tol3d.reducers.deviations import Acts
from tol3d.scene import Scene
from tol3d.scene.move import MoveSpec
from tol3d.scene.part import PartSpec
from tol3d.scene.tolerance import ToleranceSpec
from tol3d.system.draw import Draw, Each, Planar, Scalar
from tol3d.system.each_planar import EachPlanar
from tol3d.system.plain import UNITS, PlainContributor
from tol3d.units import Quantity

ActsOf = Callable[[Scene, Any, str, Any], Acts]
"""Effect of a tolerance on a reducer, from the scene, the reducer, its name and the tolerance.

Raises a SceneError where it has none.
"""
DrawOf = Callable[[Scene, Any, Acts, Any], Draw]
"""Draw of its components, from the scene, the reducer, its effect and the tolerance."""
Move = TypeVar("Move", bound=MoveSpec)
Actions = Mapping[str, list[tuple[str, Acts]]]


def only_reducer(scene: Scene, kind: type[Move]) -> tuple[str, Move]:
    """The reducer of a scene that has nothing else, and its name.

    Raises:
        SceneError: several moves.
    """
    reducers = scene.of(kind)
    others = [name for name in scene.moves if name not in reducers]
    if others or len(reducers) != 1:
        words = f"expected one {kind.words.split(maxsplit=1)[1]} and no other move, got {len(scene.moves)} moves"
        train = "" if others else "; several make a train, which a move of kind train names"
        raise scene.refuse(("moves", (others or list(reducers)[-1:])[0]), words + train)
    ((name, spec),) = reducers.items()
    return str(name), spec


def refuse_unused(scene: Scene, kinds: tuple[type[PartSpec], ...], used: Container[str], words: str) -> None:
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


def contributors_of(
    scene: Scene, own: Any, acts_of: ActsOf, draw_of: DrawOf
) -> tuple[tuple[PlainContributor, ...], Mapping[str, Acts]]:
    """Contributors of a reducer that is alone in its scene, and the effect of each by its name.

    Raises:
        SceneError: a tolerance that does not act on it.
    """
    contributors, effects = [], {}
    for name, spec in scene.tolerances.items():
        effects[name] = acts = acts_of(scene, own, name, spec)
        unit, per_unit = UNITS[spec.dimensions[0] if isinstance(spec, ToleranceSpec) else "length"]
        nominal = spec.nominal if isinstance(spec, ToleranceSpec) else ""
        draw = draw_of(scene, own, acts, spec)
        contributors.append(
            PlainContributor(name, spec.kind, draw, unit, per_unit, spec.description, least=acts.least, nominal=nominal)
        )
    return tuple(contributors), effects


def contributors_in_trains(
    scene: Scene, owners: Mapping[str, Any], acts_of: ActsOf, draw_of: DrawOf
) -> tuple[Mapping[str, Contributor], Actions]:
    """Contributors of the reducers of trains, and their effects by the reducer's name.

    Args:
        scene: the scene.
        owners: the reducer that has a part, by the part's name.
        acts_of, draw_of: see ActsOf and DrawOf.

    Raises:
        SceneError: a tolerance of such a part that does not act on its reducer.
    """
    actions: dict[str, list[tuple[str, Acts]]] = {own.name: [] for own in owners.values()}
    contributors = {}
    for name, own in tolerances_of(scene, owners):
        spec: Any = scene.tolerances[name]
        acts = acts_of(scene, own, name, spec)
        actions[own.name].append((name, acts))
        draw = draw_of(scene, own, acts, spec)
        contributors[name] = acting_in(scene, name, own.name, draw, acts.turning, acts.least)
    return contributors, actions


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
