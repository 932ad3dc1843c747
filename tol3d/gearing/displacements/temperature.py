"""Parts that are warmer grow."""

from collections.abc import Iterator

from tol3d.gearing.displacements.displacement import Growth, displacements
from tol3d.gearing.effects import Temperature
from tol3d.gearing.model import Model


@displacements.register
def _(effect: Temperature, model: Model, components: int) -> Iterator[Growth]:
    yield from (Growth(part) for part in effect.parts)
