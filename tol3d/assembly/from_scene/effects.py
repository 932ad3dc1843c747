"""Effects of contributors: on components and sizes of features, on locators, on surfaces where they are touched."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final, Literal

from tol3d.assembly.model import Contribution
from tol3d.numerics.arrays import Array
from tol3d.study.system.plain import PlainContributor

Touch = tuple[str, str]
"""A move, and one of its pairs by the name that locators have."""


@dataclass(frozen=True, eq=False)
class Effect:
    """Effect of a contributor.

    Args:
        acts: the field of Effects.
        on: a feature, or a touch.
        matrix: see Contribution.
    """

    acts: Literal["moved_by", "size_by", "formed_by", "grown_by", "locators", "heights"]
    on: str | Touch
    matrix: Array


@dataclass(frozen=True, eq=False)
class Drawn:
    """A contributor with its effects.

    Args:
        contributor: by its draw.
        effects: on features and touches.
        of: the move or the datum frame that reads its columns itself; "" for none.
    """

    contributor: PlainContributor
    effects: tuple[Effect, ...] = ()
    of: str = ""


@dataclass(frozen=True, eq=False)
class Effects:
    """Contributors in order, and their effects.

    Args:
        contributors: in the order of their columns.
        moved_by, size_by, formed_by, grown_by: by feature, see Feature.
        locators: by touch, shifts of its points.
        heights: by touch, form contributions of surfaces at its points.
        drawn: by move and by datum frame, columns of its own contributors by their names.
        width: columns of all.
    """

    contributors: tuple[PlainContributor, ...]
    moved_by: Mapping[str, tuple[Contribution, ...]]
    size_by: Mapping[str, tuple[Contribution, ...]]
    formed_by: Mapping[str, tuple[Contribution, ...]]
    grown_by: Mapping[str, tuple[Contribution, ...]]
    locators: Mapping[Touch, tuple[Contribution, ...]]
    heights: Mapping[Touch, tuple[Contribution, ...]]
    drawn: Mapping[str, Mapping[str, slice]]
    width: int

    def with_drawn(self, further: Iterable[Drawn]) -> "Effects":
        """These, then further contributors with their effects."""
        contributors, width = list(self.contributors), self.width
        added: dict[str, dict[Any, list[Contribution]]] = {}
        own: dict[str, dict[str, slice]] = {}
        for each in further:
            contributor, columns = each.contributor, slice(width, width + len(each.contributor.draw.components))
            contributors.append(contributor)
            width = columns.stop
            for effect in each.effects:
                contribution = Contribution(contributor.name, columns, effect.matrix)
                added.setdefault(effect.acts, {}).setdefault(effect.on, []).append(contribution)
            if each.of:
                own.setdefault(each.of, {})[contributor.name] = columns
        changed: dict[str, Any] = {}
        for acts, by_target in added.items():
            before = getattr(self, acts)
            joined = {target: (*before.get(target, ()), *more) for target, more in by_target.items()}
            changed[acts] = MappingProxyType({**before, **joined})
        drawn = {**self.drawn, **{of: MappingProxyType(columns) for of, columns in own.items()}}
        return replace(self, contributors=tuple(contributors), width=width, drawn=MappingProxyType(drawn), **changed)


NONE: Final[Mapping[Any, Any]] = MappingProxyType({})
NO_EFFECTS: Final = Effects((), NONE, NONE, NONE, NONE, NONE, NONE, NONE, 0)
