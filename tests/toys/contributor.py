"""A contributor of a toy: a deviation in um and how it is drawn."""

from dataclasses import dataclass

from tol3d.statistics.distributions import DeviationLaw
from tol3d.study.system.contributor import column_names
from tol3d.study.system.draw import Draw


@dataclass(frozen=True)
class ToyContributor:
    """Implements Contributor."""

    name: str
    kind: str
    draw: Draw
    description: str = ""
    least: float | None = None

    unit = "um"
    per_unit = 1e-3

    @property
    def columns(self) -> tuple[str, ...]:
        return column_names(self.name, self.draw.components, self.unit)

    @property
    def distribution(self) -> DeviationLaw:
        return self.draw.distribution
