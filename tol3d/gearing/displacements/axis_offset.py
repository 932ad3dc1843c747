"""An axis lies beside its place: along a direction, or anywhere across it."""

from collections.abc import Iterator

from tol3d.gearing.displacements.displacement import Displacement, displacements
from tol3d.gearing.displacements.seat_frame import in_seat
from tol3d.gearing.displacements.slots import OFFSET
from tol3d.gearing.effects import AxisOffset
from tol3d.gearing.model import Model


@displacements.register
def _(effect: AxisOffset, model: Model, components: int) -> Iterator[Displacement]:
    for seat in model.seats_of(effect.part, effect.mesh):
        own = model.seats[seat]
        if components == 2:
            matrix = effect.plane.seen_from(own.azimuth).matrix
        else:
            matrix = in_seat(effect.direction, own, effect.mesh)[:, None]
        yield Displacement(seat, OFFSET, matrix, effect.factor)
