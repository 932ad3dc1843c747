"""Single flanks lie off their places, or have another shape."""

from collections.abc import Iterator

from tol3d.gearing.displacements.displacement import FlankOffsets, displacements
from tol3d.gearing.effects import FlankDeviation
from tol3d.gearing.model import Model


@displacements.register
def _(effect: FlankDeviation, model: Model, components: int) -> Iterator[FlankOffsets]:
    yield FlankOffsets(effect)
