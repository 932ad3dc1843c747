"""What scenes may be measured with."""

from dataclasses import dataclass
from typing import Final

THEORY: Final = "analytic"
"""The engine of every system: its theory alone, no 3D simulation."""


@dataclass(frozen=True)
class Engines:
    """What scenes of some kinds may be measured with.

    Args:
        names: words of study.engine, besides "analytic"; the first is taken where nothing is said.
        witnesses: those of them that check the others.
    """

    names: tuple[str, ...]
    witnesses: tuple[str, ...]

    @property
    def unwitnessed(self) -> frozenset[str]:
        """Those that have no witness."""
        return frozenset((THEORY, *self.witnesses))

    def without_witness(self, engine: str) -> str:
        """What is expected of the witness of an engine that has none; nothing for the others."""
        if engine == THEORY:
            return f"none for {engine}, which has no 3D simulation to check; an {self.names[0]} study may have one"
        itself = f"none for {engine}, which is the witness itself; an {self.names[0]} study may have one"
        return itself if engine in self.witnesses else ""
