"""Links that another mechanism brings into a scene of gears, with what of the scene is theirs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from tol3d.gearing.links import StatedLink
from tol3d.gearing.model.contributor import Contributor


@dataclass(frozen=True)
class Brought:
    """Links of shafts whose parts and tolerances gears know nothing of.

    Args:
        links: as moves of the scene stand for them.
        parts: in these links; they take part in no mesh.
        contributors: by name, those that act in the links alone.
    """

    links: tuple[StatedLink, ...] = ()
    parts: frozenset[str] = frozenset()
    contributors: Mapping[str, Contributor] = field(default_factory=dict)


NOTHING: Final = Brought()
