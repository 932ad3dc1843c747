"""Pitch of the lobes."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.cycloid_disc import CycloidDiscSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class LobePitchSpec(ToleranceSpec):
    """A length: each lobe lies counter-clockwise of its place by this arc; each one's own deviation, on every disc.

    Its best flank moves by K of it along the normal, K = a Zp/rp.
    """

    words: ClassVar[str] = "places of lobes"

    kind: Literal["lobe_pitch"]
    of: Name = Field(description="the disc")
    each: Literal["lobe"] = Field(default="lobe", description="lobe: every lobe deviates by itself")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CycloidDiscSpec,)),)
