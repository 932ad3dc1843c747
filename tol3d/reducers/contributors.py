"""Contributors of a reducer from a scene, alone and in a train: the effect of each tolerance, and its draw.

What a tolerance does to a reducer its model says, by two functions: `acts_of` and `draw_of`.
"""

from collections.abc import Callable, Mapping
from typing import Any

from tol3d.distributions import Distribution
from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearToleranceSpec
from tol3d.gearing.model.brought import acting_in, tolerances_of
from tol3d.gearing.model.contributor import Contributor
from tol3d.gearing.model.pairs import cylindrical_gear
from tol3d.reducers.deviations import Acts
from tol3d.scene import Scene
from tol3d.scene.tolerance import ToleranceSpec
from tol3d.system.draw import Draw, Each, Planar, Scalar
from tol3d.system.each_planar import EachPlanar
from tol3d.system.plain import UNITS, PlainContributor

ActsOf = Callable[[Scene, Any, str, Any], Acts]
"""Effect of a tolerance on a reducer, from the scene, the reducer, its name and the tolerance.

Raises a SceneError where it has none.
"""
DrawOf = Callable[[Scene, Any, Acts, Any], Draw]
"""Draw of its components, from the scene, the reducer, its effect and the tolerance."""
Actions = Mapping[str, list[tuple[str, Acts]]]


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
