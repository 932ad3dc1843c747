"""Locators: six contacts of points on planes, at once."""

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Locate, Pair, Rest
from tol3d.assembly.torsors.features import summed
from tol3d.assembly.torsors.freedoms import Freedoms, freedom_in_words
from tol3d.assembly.torsors.torsor import height_at
from tol3d.assembly.torsors.world import World
from tol3d.errors import InputError

Array = NDArray[np.float64]


def located(move: Locate, world: World) -> Array:
    """The torsor (6, columns) of a part on six locators: rows (n, p x n) of each contact, solved together.

    Raises:
        InputError: the contacts leave a freedom.
    """
    contacts = [contact(pair, move, world) for pair in move.pairs]
    rows, values = (np.concatenate(each) for each in zip(*contacts, strict=True))
    points = [world.origin(pair.moving) for pair in move.pairs]
    freedoms = Freedoms(world.assembly.part[move.part].pose[:3, 3], points, world.columns.count)
    if freedoms.take(rows, values) < 6:
        raise InputError(
            f"moves.{move.name}: its contacts leave {move.part} free: {freedom_in_words(freedoms.left)}; "
            "expected six that hold all six freedoms"
        )
    return freedoms.torsor


def contact(pair: Pair, move: Locate | Rest, world: World) -> tuple[Array, Array]:
    """Row (1, 6) and values (1, columns) of the condition n . (moving - target) = locator, n turning with its part."""
    moving, target = world.origin(pair.moving), world.origin(pair.target)
    target_part = world.part_of(pair.target)
    normal = world.turned(pair.normal, target_part if move.points_on == "part" else move.part)
    at_moving, at_target = height_at(moving, normal), height_at(target, normal)
    row = at_moving if move.points_on == "part" else at_target
    # what a feature does on its part or body counts at its own origin, what the frame of the normal does at the point
    own = at_moving @ world.on_body(pair.moving, move.part)
    other = row @ world.parts[target_part] + at_target @ world.on_part(pair.target)
    gap = world.columns.constants(normal @ (moving - target)[:, None])
    return row, other - own - gap + summed(pair.locator, 1, world.columns)
