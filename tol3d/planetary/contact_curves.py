"""The exact road over positions: gears placed at each, going on from the position before."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.contact import Contact
from tol3d.planetary.deviated import Deviated
from tol3d.planetary.free import Followed, cosines_and_sines
from tol3d.planetary.placed_curve import placed_curve

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ContactCurves(Contact):
    """Sets as they are placed, and where their shafts rest at positions one after another."""

    def followed(self, deviated: Deviated, turns: Array, shaft: str, stands: str, end: int) -> Followed:
        """The lower (0) or upper (1) end of a shaft's turn at turns (positions,) of the output; see Contact.free."""
        own, found = self.own, Followed.of(len(deviated.pins), len(turns))
        planet = float(own.planet_turns)
        rates = np.array([float(mesh.turn * own.planet_turns) for mesh in own.teeth.meshes])
        placed_curve(
            *self.given(deviated, np.zeros(len(found.ends))),
            cosines_and_sines(turns[:, None] * rates),
            cosines_and_sines(turns * planet),
            np.stack(own.pushed),
            np.array(own.unknowns(stands)),
            own.objective(stands, shaft),
            np.ascontiguousarray(own.wanted(stands, shaft)[end]),
            own.begun(stands),
            found.ends,
            found.status,
            found.row,
            found.lacking,
        )
        return found
