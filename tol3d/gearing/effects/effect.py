"""On what one deviation acts: gears, meshes, links. Data; each road has its own formulas for what that changes."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


class Effect(ABC):
    """What a deviation acts on. Frozen data.

    The geometric road reads its displacements (displacements/), the analytic road its terms (stack_up/terms/), each
    registered there for the class of the effect.
    """

    @property
    def singles(self) -> tuple["Effect", ...]:
        """The effects that it is made of; itself alone."""
        return (self,)

    @abstractmethod
    def acts_in(self, mesh: "Mesh") -> bool:
        """Whether it changes how the gears of a mesh lie to each other, or their flanks."""

    def clocking(self, mesh: "Mesh") -> float:
        """Turn of the shaft that a mesh drives, about the driven gear's z, with the teeth in contact [rad per unit]."""
        return 0.0

    def acts_on(self, link: str) -> bool:
        """Whether it is a deviation of a link that is no gear mesh."""
        return False

    @property
    def turns_with(self) -> str | None:
        """The gear with which the deviation turns; None where it rests."""
        return None

    def deviates_teeth(self, gear: str) -> bool:
        """Whether it makes the teeth of a gear differ from each other, so that curves have tooth-mesh orders."""
        return False

    @property
    def mirrored(self) -> bool:
        """Whether the deviation's azimuths count against those of the gear with which it turns."""
        return False


@dataclass(frozen=True)
class Together(Effect):
    """Several effects of one deviation, such as a shaft that moves with all that it carries."""

    effects: tuple[Effect, ...]

    @property
    def singles(self) -> tuple[Effect, ...]:
        """See Effect."""
        return self.effects

    def acts_in(self, mesh: "Mesh") -> bool:
        """See Effect."""
        return any(effect.acts_in(mesh) for effect in self.effects)

    def clocking(self, mesh: "Mesh") -> float:
        """See Effect."""
        return sum(effect.clocking(mesh) for effect in self.effects)

    def acts_on(self, link: str) -> bool:
        """See Effect."""
        return any(effect.acts_on(link) for effect in self.effects)

    def deviates_teeth(self, gear: str) -> bool:
        """See Effect."""
        return any(effect.deviates_teeth(gear) for effect in self.effects)

    @property
    def turns_with(self) -> str | None:
        """Of the first gear: they all turn alike."""
        return self.effects[0].turns_with if self.effects else None

    @property
    def mirrored(self) -> bool:
        """Of the same gear."""
        return self.effects[0].mirrored if self.effects else False


NOTHING = Together(())
