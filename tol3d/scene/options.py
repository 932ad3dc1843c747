"""Options that a vocabulary adds to a scene's study."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from tol3d.strict import Strict

Option = bool | int | float | str


class StudyOptions(Strict):
    """Keys of `study` that one vocabulary understands: fields of plain values, each with a default."""


def options_of(stated: StudyOptions, kind: type[StudyOptions]) -> Mapping[str, Option]:
    """The values of a kind's options."""
    return {name: getattr(stated, name) for name in kind.model_fields}


THEORY: Final = "analytic"
"""The engine of every system: its theory alone, no 3D simulation."""


@dataclass(frozen=True)
class Engines:
    """Engines for scenes of some kinds.

    Args:
        names: words of study.engine, besides "analytic"; the first is the default.
        witnesses: those of them that check the others.
    """

    names: tuple[str, ...]
    witnesses: tuple[str, ...]

    @property
    def unwitnessed(self) -> frozenset[str]:
        """Engines without a witness."""
        return frozenset((THEORY, *self.witnesses))

    def without_witness(self, engine: str) -> str:
        """Expected witness of an engine that has none, in words; empty for the others."""
        if engine == THEORY:
            return f"none for {engine}, which has no 3D simulation to check; an {self.names[0]} study may have one"
        itself = f"none for {engine}, which is the witness itself; an {self.names[0]} study may have one"
        return itself if engine in self.witnesses else ""
