"""Teeth that are thicker turn their flanks out, and move them along their normals."""

from collections.abc import Iterator

import numpy as np

from tol3d.gearing.displacements.displacement import Displacement, displacements
from tol3d.gearing.displacements.slots import FLANK_TURN
from tol3d.gearing.effects import ToothThickness
from tol3d.gearing.model import Model


@displacements.register
def _(effect: ToothThickness, model: Model, components: int) -> Iterator[Displacement]:
    for seat in model.seats_of(effect.part):
        yield Displacement(seat, FLANK_TURN, np.array([[effect.turn], [effect.offset]]))
