"""Links that other mechanisms add to a scene of gears, with their parts and contributors."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final, TypeVar

from tol3d.gearing.effects import LinkDeviation, TurningOffset
from tol3d.gearing.grammar.moves import LinkSpec, meshes_of
from tol3d.gearing.grammar.parts import ShaftSpec, carried
from tol3d.gearing.grammar.tolerances.gearing_tolerance import together
from tol3d.gearing.links import StatedLink
from tol3d.gearing.model.model import Contributor
from tol3d.scene import Scene
from tol3d.study.system.draw import Draw
from tol3d.study.system.mechanism import brought
from tol3d.study.system.plain import UNITS

Owner = TypeVar("Owner")


@dataclass(frozen=True)
class BroughtLink:
    """A link with parts unknown to gears.

    Args:
        link: as a move of the scene stands for it.
        parts: in it; they take part in no other move.
        ends: those of them that may sit on shafts, which turn with its driver or its driven shaft.
    """

    link: StatedLink
    parts: frozenset[str]
    ends: tuple[str, ...]


@dataclass(frozen=True)
class Brought:
    """Links and contributors that mechanisms add to a train.

    Args:
        links: of moves of the scene.
        contributors: by name, those that act in these links alone.
        warnings: of numbers that are possible but likely slips.
    """

    links: tuple[BroughtLink, ...] = ()
    contributors: Mapping[str, Contributor] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    @property
    def owners(self) -> Mapping[str, BroughtLink]:
        """The link that has each part."""
        return {part: link for link in self.links for part in link.parts}


NOTHING: Final = Brought()


def brought_into(scene: Scene) -> Brought:
    """Links and contributors of all mechanisms of a scene together, in the order of its moves.

    Raises:
        SceneError: parts of two moves, or parts on shafts that contradict their link.
    """
    found: list[Brought] = list(brought(scene))
    order = list(scene.moves)
    both = Brought(
        tuple(sorted((link for own in found for link in own.links), key=lambda own: order.index(own.link.name))),
        {name: each for own in found for name, each in own.contributors.items()},
        tuple(line for own in found for line in own.warnings),
    )
    _refuse_shared(scene, both)
    _refuse_other_ends(scene, both)
    return both


def _refuse_shared(scene: Scene, own: Brought) -> None:
    """Refuse parts of two links, and of a link and a mesh."""
    owner: dict[str, str] = {}
    for link in own.links:
        for part in sorted(link.parts):
            if part in owner:
                words = f"expected parts of this move alone, got {part!r}, which {owner[part]!r} has"
                raise scene.refuse(("moves", link.link.name), words)
            owner[part] = link.link.name
            for mesh in meshes_of(part, scene.moves):
                words = f"expected a gear that no other move has, got {part!r}, which {link.link.name!r} has"
                raise scene.refuse(("moves", mesh), f"{words}; put another gear on the same shaft")


def _refuse_other_ends(scene: Scene, own: Brought) -> None:
    """Refuse parts of links that no shaft turns with, and parts on a shaft that contradict their link."""
    owners = own.owners
    for name, move in scene.moves.items():
        for role in ("driver", "driven") if isinstance(move, LinkSpec) else ():
            part = getattr(move, role)
            if part in owners and part not in owners[part].ends:
                raise scene.refuse(("moves", name, role), _not_an_end(owners[part], part))
    for name, shaft in scene.parts.items():
        for part, sits in shaft.carries.items() if isinstance(shaft, ShaftSpec) else ():
            if part not in owners:
                continue
            path = ("parts", name, "carries", part)
            if part not in owners[part].ends:
                raise scene.refuse(path, _not_an_end(owners[part], part))
            if sits.facing != "forward" or sits.phase.internal:
                turned: Any = "facing" if sits.facing != "forward" else "phase"
                words = f"expected no {turned} of {part!r}: the teeth of {owners[part].link.name!r} say how its gears"
                raise scene.refuse((*path, turned), f"{words} stand")


def _not_an_end(brought_link: BroughtLink, part: str) -> str:
    ends = " or ".join(map(repr, brought_link.ends))
    return f"expected {ends} of {brought_link.link.name!r}, got {part!r}, which no shaft of a train turns with"


# what a mechanism brings ----------------------------------------------------------------------------


def shaft_of(scene: Scene, part: str) -> tuple[str, float]:
    """The shaft that carries a part, and where along it [mm]; a part that none carries is its own."""
    for name, own in carried(scene.parts):
        if own == part:
            shaft = scene.parts[name]
            assert isinstance(shaft, ShaftSpec)
            return name, shaft.carries[part].at.internal
    return part, 0.0


def tolerances_of(scene: Scene, owners: Mapping[str, Owner]) -> Iterator[tuple[str, Owner]]:
    """Tolerances of parts, each with its owner."""
    for name, spec in scene.tolerances.items():
        of: Any = getattr(spec, "of", ())
        for part in (of,) if isinstance(of, str) else of:
            if part in owners:
                yield str(name), owners[part]


def acting_in(
    scene: Scene, name: str, link: str, draw: Draw, turning: str | None = None, least: float | None = None
) -> Contributor:
    """A tolerance that acts in a link alone; `turning` is the part of it with which the deviation turns."""
    spec: Any = scene.tolerances[name]
    unit: Any = UNITS[spec.dimensions[0]][0]
    return Contributor(name, spec.kind, LinkDeviation(link, turning), draw, unit, spec.description, least, spec.nominal)


# shafts that carry its parts ------------------------------------------------------------------------


def with_shared_shafts(
    scene: Scene, own: Brought, contributors: Sequence[Contributor]
) -> tuple[Brought, tuple[Contributor, ...]]:
    """The links with the effect of shaft run-outs on their parts.

    Raises:
        SceneError: a tolerance moves a shaft otherwise, or a part that its link does not let run out.
    """
    owners, found = own.owners, []
    links = {link.link.name: link.link for link in own.links}
    for contributor in contributors:
        effects = contributor.effect.singles
        moved = [(effect, part) for effect in effects if (part := str(getattr(effect, "part", ""))) in owners]
        for effect, part in moved:
            name = owners[part].link.name
            offset = links[name].offset_by(contributor.name, part) if isinstance(effect, TurningOffset) else None
            if offset is None:
                words = f"expected a shaft without parts of {name!r}, got one that carries {part!r}, which turns about"
                raise scene.refuse(("tolerances", contributor.name), f"{words} one axis there; put it on its own shaft")
            links[name] = offset
        if moved:
            inside = (LinkDeviation(owners[part].link.name, part) for _, part in moved)
            kept = (effect for effect in effects if effect not in [of_a_link for of_a_link, _ in moved])
            contributor = replace(contributor, effect=together((*kept, *inside)))
        found.append(contributor)
    return replace(own, links=tuple(replace(link, link=links[link.link.name]) for link in own.links)), tuple(found)
