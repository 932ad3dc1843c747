"""Where something with play lies in its room, as a term: a part on its pins, or the gauges of a datum frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Floating
from tol3d.assembly.torsors.centring import Cones, centred
from tol3d.assembly.torsors.floating import along_rays, by_pairs, pushed
from tol3d.assembly.torsors.ordered import ordered_product
from tol3d.assembly.torsors.terms import Form

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Room:
    """The freedoms of a part with play, and its slack, trial by trial.

    Args:
        forms: offsets (places * 2), clearances (places), then what is drawn of the float.
        rows: change of the offsets by the freedoms (places, 2, freedoms).
        floating: where in its room it lies.
        directions: of what is drawn as a shift and a turn, the freedoms (freedoms, 6).
        push: the direction in which it goes as far as it can (freedoms,); 0 where it does not.
        bolt_of: see Cones; the freedoms of bolts come after the part's.
    """

    forms: Array
    rows: Array
    floating: Floating
    directions: Array
    push: Array
    bolt_of: tuple[int, ...] = ()
    form: Form = "place in a room"

    @property
    def count(self) -> int:
        """Freedoms of the part, and the slack."""
        return len(self.directions) + 1

    def values(self, read: Array) -> Array:
        """(freedoms + 1, trials) [mm]."""
        places = len(self.rows)
        cones = Cones(read[: 2 * places].reshape(places, 2, -1), read[2 * places : 3 * places], self.rows, self.bolt_of)
        q = centred(cones)
        slack = cones.slack(q)
        inside = slack > 0.0
        if inside.any() and self.floating.kind != "centred":
            own = cones.of(inside)
            if self.floating.kind == "toward":
                q[:, inside] = pushed(own, q[:, inside], self.push)
            elif self.floating.by_pairs:
                q[:, inside] = by_pairs(own, q[:, inside], read[3 * places :, inside])
            else:
                drawn = read[3 * places :, inside]
                q[:, inside] = along_rays(own, q[:, inside], ordered_product(self.directions, drawn[:6]), drawn[6])
        return np.concatenate([q[: len(self.directions)], slack[None]])
