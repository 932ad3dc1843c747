"""Profile of the lobes."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.cycloid_disc import CycloidDiscSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class LobeProfileSpec(ToleranceSpec):
    """A length: each lobe has so much more material along the normal; each one's own deviation, on every disc."""

    words: ClassVar[str] = "profiles of lobes"

    kind: Literal["lobe_profile"]
    of: Name = Field(description="the disc")
    each: Literal["lobe"] = Field(default="lobe", description="lobe: every lobe deviates by itself")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CycloidDiscSpec,)),)
