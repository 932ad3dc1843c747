"""The name of what turns as one."""

from collections.abc import Mapping
from dataclasses import dataclass

from tol3d.gearing.grammar.parts.shaft import ShaftSpec, carried
from tol3d.gearing.grammar.parts.turning import TurningSpec
from tol3d.scene.entry import Entry
from tol3d.scene.part import PartSpec
from tol3d.scene.reference import Reference, Taken


@dataclass(frozen=True)
class ShaftReference(Reference):
    """The name of a shaft, or of a gear that is its own because none carries it."""

    specs: tuple[type[Entry], ...] = (ShaftSpec, TurningSpec)

    @property
    def expected(self) -> str:
        """As of any reference."""
        return "a shaft, or of a gear that none carries"

    @classmethod
    def taken(cls, parts: Mapping[str, PartSpec]) -> Mapping[str, Taken]:
        """Gears that a shaft carries."""
        return {gear: Taken(f"which {shaft!r} carries", shaft) for shaft, gear in carried(parts)}
