"""Sizes and looks of reducers that tables and pictures of all models share."""

from collections.abc import Mapping, Sequence

import numpy as np

from tol3d.gearing.presenting.drawing_sizes import Thickness, sizes_table
from tol3d.gears import Gear
from tol3d.numerics.arrays import Array
from tol3d.reducers.deviations import Acts
from tol3d.reducers.link import ReducerLink
from tol3d.report.body import World
from tol3d.report.motion import FRONT, Look, around
from tol3d.report.page import PageItem
from tol3d.system.contributor import Contributor

UP = np.array([0.0, 1.0, 0.0])


def gear_sizes(
    gears: Mapping[str, Gear], acts: Mapping[str, Acts], contributors: Sequence[Contributor]
) -> Sequence[PageItem]:
    """Sizes of teeth that shops measure, of gears by their names, with the tolerances of their thickness."""
    stated = (
        (act.gear, Thickness(each.draw.distribution, act.factor, act.over))
        for each in contributors
        if (act := acts.get(each.name)) is not None and act.effect.endswith("thickness")
    )
    return sizes_table(gears, stated)


def from_front(world: World) -> Look:
    """All parts along the common axis."""
    return around(np.concatenate([body.mesh[0] for body in world.bodies]), np.zeros(3), FRONT, UP)


def world_from_middle(link: ReducerLink, world_from_driver: Array) -> Array:
    """Pose (4, 4) of the middle of a reducer in the world of its train."""
    above = np.eye(4)
    above[2, 3] = link.height
    return np.asarray(world_from_driver @ above)
