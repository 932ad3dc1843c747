"""The driven axis passes the driver's: it lies at +y of the mesh."""

from collections.abc import Iterator

from tol3d.gearing.displacements.displacement import Displacement, displacements
from tol3d.gearing.displacements.slots import OFFSET
from tol3d.gearing.effects import AxesOffset
from tol3d.gearing.model import Model


@displacements.register
def _(effect: AxesOffset, model: Model, components: int) -> Iterator[Displacement]:
    sideways = model.mesh(effect.mesh).pair.world_from_wheel[1]  # +y of the world in the driven gear's frame
    yield Displacement(model.seat_index[effect.mesh, effect.part], OFFSET, sideways[:, None])
