"""Touch: the torsor of a part laid against others at contacts of round features."""

import numpy as np

from tol3d.assembly.model import Contact, Touch
from tol3d.assembly.torsors.freedoms import Freedoms, freedom_in_words
from tol3d.assembly.torsors.surfaces import Surfaces
from tol3d.assembly.torsors.torsor import height_at
from tol3d.assembly.torsors.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array


def touched(move: Touch, world: World) -> World:
    """The world with a part by its contacts; freedoms that none decides stay as nominal.

    Raises:
        InputError: a contact constrains what earlier ones hold, or two surfaces have no common normal.
    """
    points = [world.origin(name) for contact in move.contacts for name in (contact.moving, contact.target)]
    freedoms = Freedoms(world.assembly.part[move.part].pose[:3, 3], points, world.columns.count)
    for contact in move.contacts:
        rows, values = _asked(contact, move, world)
        before = freedoms.left
        if freedoms.take(rows, values) < len(rows):
            free = f"{move.part} is still free: {freedom_in_words(before)}" if before.size else "nothing is free"
            raise InputError(
                f"moves.{move.name}: contact of {contact.moving} and {contact.target} constrains what earlier contacts "
                f"hold; {free}; expected contacts that are independent of each other"
            )
    freedoms.settle(np.mean([world.origin(contact.moving) for contact in move.contacts], axis=0))
    return world.with_part_at(move.part, freedoms.rest())


def _asked(contact: Contact, move: Touch, world: World) -> tuple[Array, Array]:
    """Rows (equations, 6) and values (equations, columns): the gap of the surfaces, and the tilt of a line [mm]."""
    surfaces = Surfaces(world, contact.target, contact.moving)
    try:
        normal, distance, point = surfaces.checked()
    except InputError as error:
        raise InputError(f"moves.{move.name}: {error}") from None
    nominal, varying = surfaces.touching()
    others = world.placed(contact.target) - world.on_body(contact.moving, move.part)
    rows = [height_at(point, normal)]
    values = [rows[0] @ others + world.columns.constants(np.array([nominal - distance])) + varying]
    if (hinge := surfaces.hinge()) is not None:
        turn, sine = hinge
        length = max(1.0, float(np.linalg.norm(point - world.assembly.part[move.part].pose[:3, 3])))
        rows.append(length * turn)
        values.append(length * turn @ others + world.columns.constants(np.array([-length * sine])))
    return np.concatenate(rows), np.concatenate(values)
