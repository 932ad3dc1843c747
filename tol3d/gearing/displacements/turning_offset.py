"""A gear's centre lies off its axis, in all of its meshes."""

from collections.abc import Iterator

from tol3d.gearing.displacements.displacement import Displacement, displacements
from tol3d.gearing.displacements.slots import CENTRE
from tol3d.gearing.effects import TurningOffset
from tol3d.gearing.model import Model


@displacements.register
def _(effect: TurningOffset, model: Model, components: int) -> Iterator[Displacement]:
    for seat in model.seats_of(effect.part):
        yield Displacement(seat, CENTRE, effect.plane.seen_from(-model.seats[seat].ahead).matrix)
