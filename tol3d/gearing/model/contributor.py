"""A contributor: one toleranced deviation, its draw, and its effect on the parts."""

from dataclasses import dataclass

from tol3d.distributions import DeviationLaw
from tol3d.gearing.effects import Effect
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Unit
from tol3d.system import contributor as system_contributor
from tol3d.system.contributor import column_names
from tol3d.system.draw import Draw
from tol3d.units import RAD_PER_ARCMIN

INTERNAL_PER_UNIT: dict[Unit, float] = {"um": 1e-3, "mrad": 1e-3, "K": 1.0, "arcmin": RAD_PER_ARCMIN}


@dataclass(frozen=True)
class Contributor:
    """A tolerance in the simulation.

    Args:
        name: as in the scene.
        kind: the tolerance's kind, the scene's word.
        effect: of a deviation.
        draw: of its components, from uniforms.
        unit: unit of its columns in results ("um", "mrad", "arcmin", "K").
        description: the scene's own words.
        least: smallest physical deviation [mm, rad or K], such as 0 for a clearance; draws below it are kept
            as they come, and counted.
        nominal: word of a drawing for what moves its mean; "" where it has nothing to be moved.
    """

    name: str
    kind: str
    effect: Effect
    draw: Draw
    unit: Unit
    description: str = ""
    least: float | None = None
    nominal: str = ""

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names in results: `name.component [unit]`."""
        return column_names(self.name, self.draw.components, self.unit)

    @property
    def per_unit(self) -> float:
        """Factor from its unit to mm, rad or K."""
        return INTERNAL_PER_UNIT[self.unit]

    @property
    def distribution(self) -> DeviationLaw:
        """The law of the deviation, or of its length where it has a direction."""
        return self.draw.distribution


def gear_contributor(contributor: system_contributor.Contributor) -> Contributor:
    """A contributor that a study hands back: one of this model's."""
    if not isinstance(contributor, Contributor):
        raise TypeError(f"{contributor.name} is no contributor of gears")
    return contributor
