"""Flanks that deviate tooth by tooth."""

from collections.abc import Iterator
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

    With the roll t of a point, its height z over the middle of the face b, and u = (t - t_mid)/(t_tip - t_form) over
    the whole involute: a mix of 1, u, a form and z/b, times the deviation.

    Args:
        part: the gear.
        shape: UNIFORM, SLOPE, FORM or HELIX: what the deviation is.
        places: by component of the deviation the flanks that it moves.
        waves: of a FORM, how many cosine waves there are over `span`, (1/2) cos(2 pi waves u); 0 for a barrel,
            1/3 - 4 u^2.
        mix: (SHAPES,), what one of the deviation adds to each; of its own shape alone where none is given.
        span: of waves, the rolls from which u goes from -1/2 to 1/2 [rad]; None over the whole involute.
    """

    part: str
    shape: int
    places: tuple[tuple[Place, ...], ...]
    waves: float = 0.0
    mix: tuple[float, ...] = ()
    span: tuple[float, float] | None = None

    @property
    def terms(self) -> Iterator[tuple[int, Place, int, float]]:
        """Of each component, flank and shape: the first three, and how much of the shape one of the component adds."""
        mix = self.mix or tuple(float(shape == self.shape) for shape in range(SHAPES))
        for component, places in enumerate(self.places):
            for place in places:
                for shape, factor in enumerate(mix):
                    if factor:
                        yield component, place, shape, factor * place.factor

    def acts_in(self, mesh: "Mesh") -> bool:
        """In every mesh of the gear."""
        return self.part in (mesh.driver, mesh.driven)

    def deviates_teeth(self, gear: str) -> bool:
        """See Effect."""
        return gear == self.part
