"""An axis leans, about the gear's origin or about another point of it."""

from collections.abc import Iterator

from tol3d.gearing.displacements.displacement import Displacement, PivotShift, displacements
from tol3d.gearing.displacements.seat_frame import in_seat
from tol3d.gearing.displacements.slots import TURN
from tol3d.gearing.effects import AxisTilt
from tol3d.gearing.model import Model


@displacements.register
def _(effect: AxisTilt, model: Model, components: int) -> Iterator[Displacement | PivotShift]:
    """A planar tilt is about the gear's origin: bearings of a shaft shift their gears by an effect of their own."""
    for seat in model.seats_of(effect.part, effect.mesh):
        own = model.seats[seat]
        if components == 2:
            yield Displacement(seat, TURN, effect.matrix(own.azimuth))
            continue
        axis = in_seat(effect.axis, own, effect.mesh)
        yield Displacement(seat, TURN, axis[:, None], effect.per_length)
        if effect.pivot != 0.0:
            yield PivotShift(seat, effect.per_length * axis, effect.pivot)
