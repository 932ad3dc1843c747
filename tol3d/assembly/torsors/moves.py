"""Moves: the torsor of the part that each places."""

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import BestFit, Engage, Fix, Locate, Mate, Move, Rest, StatedMove, Touch, Weld
from tol3d.assembly.torsors.best_fit import fitted
from tol3d.assembly.torsors.engaging import engaged
from tol3d.assembly.torsors.locators import located
from tol3d.assembly.torsors.mating import mated
from tol3d.assembly.torsors.resting import rested
from tol3d.assembly.torsors.touching import touched
from tol3d.assembly.torsors.world import World

Array = NDArray[np.float64]


def after(move: Move, world: World, leaning: Array | None = None) -> World:
    """The world after a move.

    Args:
        move: which.
        world: before it.
        leaning: of a rest, along its unknowns, how the part lies where it may rock; in the middle if not given. Of
            play, along its freedoms, whither the part is pushed; by its float if not given.

    Raises:
        InputError: it leaves a freedom that it should hold, or asks twice for the same.
    """
    match move:
        case Fix():
            return world.with_part_at(move.part, world.columns.zeros(6))
        case Locate():
            return world.with_part_at(move.part, located(move, world))
        case Mate():
            return world.with_part_at(move.part, mated(move, world))
        case BestFit():
            return world.with_part_at(move.part, fitted(move, world))
        case Rest():
            return world.with_part_at(move.part, rested(move, world, leaning))
        case Touch():
            return world.with_part_at(move.part, touched(move, world))
        case Engage():
            return engaged(move, world, leaning)
        case StatedMove():
            return move.displaced(world)
        case Weld():
            return world.with_welded((move.part, *move.others))
