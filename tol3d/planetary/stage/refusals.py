"""What a train with planetary sets in it cannot have: sentences with their places."""

from collections.abc import Mapping
from typing import Any

from tol3d.gearing.grammar.moves import meshes_of
from tol3d.gearing.grammar.parts import ShaftSpec
from tol3d.planetary.grammar.measures.planetary_measure import PlanetaryMeasureSpec
from tol3d.planetary.grammar.moves.planetary import PlanetarySpec
from tol3d.planetary.grammar.parts.carrier import CarrierSpec
from tol3d.planetary.grammar.parts.planet import PlanetSpec
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.refusals import parts_of
from tol3d.scene import Scene

Sets = Mapping[str, PlanetarySet]


def refuse_measures_of_sets(scene: Scene) -> None:
    """Refuse measures of a set alone: trains read it.

    Raises:
        SceneError: with what to write instead.
    """
    for name, spec in scene.measures.items():
        if isinstance(spec, PlanetaryMeasureSpec):
            own = scene.moves[spec.of]
            assert isinstance(own, PlanetarySpec)
            raise scene.refuse(
                ("measures", name, "kind"),
                f"expected a measure of trains, for {spec.of!r} is a stage of one, got {spec.kind}; take lost_motion "
                f"of a train whose output turns with {own.output!r}, and of the set alone one whose held shaft turns "
                f"with {own.input!r}",
            )


def refuse_shared_parts(scene: Scene, sets: Sets) -> None:
    """Refuse parts of two sets, of a set and a mesh, and those of sets that none has.

    Raises:
        SceneError: at the part, or the move.
    """
    owner: dict[str, str] = {}
    for name, own in sets.items():
        spec = scene.moves[name]
        assert isinstance(spec, PlanetarySpec)
        for part in sorted(parts_of(own, spec)):
            if part in owner:
                words = f"expected parts of this set alone, got {part!r}, which {owner[part]!r} has"
                raise scene.refuse(("moves", name), words)
            owner[part] = name
            for mesh in meshes_of(part, scene.moves):
                words = f"expected a gear that is in no planetary set, got {part!r}, which {name!r} has"
                raise scene.refuse(("moves", mesh), f"{words}; put another gear on the same shaft")
    for name, own_part in scene.parts.items():
        if isinstance(own_part, PlanetSpec | CarrierSpec) and name not in owner:
            raise scene.refuse(("parts", name), f"{name!r} takes part in no move; name it in a set or take it out")


def refuse_carried(scene: Scene, sets: Sets) -> None:
    """Refuse parts of sets on shafts that do not turn with them as the train does, or sit otherwise than the set says.

    Raises:
        SceneError: at the part on the shaft.
    """
    owner = {part: own for own in sets.values() for part in _all_parts(scene, own)}
    for name, shaft in scene.parts.items():
        for part, sits in shaft.carries.items() if isinstance(shaft, ShaftSpec) else ():
            if part not in owner:
                continue
            own, path = owner[part], ("parts", name, "carries", part)
            if part not in (own.input, own.output):
                words = f"expected {own.input!r} or {own.output!r}, input and output of {own.name!r}, got {part!r}"
                raise scene.refuse(path, f"{words}, which no shaft of a train turns with")
            if sits.facing != "forward" or sits.phase.internal:
                field: Any = "facing" if sits.facing != "forward" else "phase"
                words = f"expected no {field} of {part!r}: the teeth of {own.name!r} say how its gears stand"
                raise scene.refuse((*path, field), words)


def _all_parts(scene: Scene, own: PlanetarySet) -> set[str]:
    spec = scene.moves[own.name]
    assert isinstance(spec, PlanetarySpec)
    return parts_of(own, spec)
