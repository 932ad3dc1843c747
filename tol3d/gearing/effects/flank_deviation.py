"""Flanks that deviate tooth by tooth."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from tol3d.gearing.effects.effect import Effect
from tol3d.gears.flank import Flank

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh

UNIFORM: Final = 0
SLOPE: Final = 1
FORM: Final = 2
HELIX: Final = 3
SHAPES: Final = 4
"""How an offset goes over a flank: alike everywhere, along the profile, in its form, along the face."""


@dataclass(frozen=True)
class Place:
    """A flank that a component of a deviation moves out of its tooth, by `factor` [mm/mm] along its normal."""

    tooth: int
    flank: Flank
    factor: float


@dataclass(frozen=True)
class FlankDeviation(Effect):
    """Offsets of single flanks of a gear along their normals, positive adds material.

    With the roll t of a point, its height z over the middle of the face b, and u = (t - t_mid)/(t_tip - t_form):
    1, u, the form's wave of u, or z/b times the deviation.

    Args:
        part: the gear.
        shape: UNIFORM, SLOPE, FORM or HELIX.
        places: by component of the deviation the flanks that it moves.
        waves: of a FORM, how many cosine waves there are over the profile, (1/2) cos(2 pi waves u); 0 for a barrel,
            1/3 - 4 u^2.
    """

    part: str
    shape: int
    places: tuple[tuple[Place, ...], ...]
    waves: float = 0.0

    def acts_in(self, mesh: "Mesh") -> bool:
        """In every mesh of the gear."""
        return self.part in (mesh.driver, mesh.driven)

    def deviates_teeth(self, gear: str) -> bool:
        """See Effect."""
        return gear == self.part
