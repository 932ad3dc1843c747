"""Placements of a STEP file as matrices in mm, and the items of its representations."""

import math
from itertools import chain
from typing import Final

from tol3d.cad.step.part21 import Part21
from tol3d.cad.step.refused import StepError
from tol3d.cad.step.units import Unit, unit_of
from tol3d.cad.step.values import Missing

Vector = tuple[float, float, float]
Placement = tuple[tuple[float, float, float, float], ...]
"""Rows of a 4 by 4 matrix, rotation and translation [mm]; `target_from_source`."""

IDENTITY: Final[Placement] = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
SHORTEST_AXIS: Final = 1e-9  # of a direction; files write unit vectors
SCALE_XTOL: Final = 1e-9  # of a transformation's scale, which must be 1


def product(left: Placement, right: Placement) -> Placement:
    """`a_from_c = a_from_b @ b_from_c`."""
    return tuple((dot4(row, right, 0), dot4(row, right, 1), dot4(row, right, 2), dot4(row, right, 3)) for row in left)


def dot4(row: tuple[float, float, float, float], right: Placement, column: int) -> float:
    """One element of a matrix product."""
    return sum(row[i] * right[i][column] for i in range(4))


def inverse(placement: Placement) -> Placement:
    """`b_from_a` of a rigid `a_from_b`."""
    columns = [tuple(placement[i][j] for i in range(3)) for j in range(3)]
    moved = [-sum(column[i] * placement[i][3] for i in range(3)) for column in columns]
    return (*((c[0], c[1], c[2], m) for c, m in zip(columns, moved, strict=True)), IDENTITY[3])


def rigid(x: Vector, y: Vector, z: Vector, origin: Vector) -> Placement:
    """A placement of its axes and origin."""
    return (*((x[i], y[i], z[i], origin[i]) for i in range(3)), IDENTITY[3])


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit_vector(vector: Vector, place: str) -> Vector:
    """A vector of length 1 along it.

    Raises:
        StepError: it has no direction.
    """
    length = math.sqrt(sum(each * each for each in vector))
    if not length > SHORTEST_AXIS:
        raise StepError(f"{place}: expected a direction, got one of length {length:g}")
    return (vector[0] / length, vector[1] / length, vector[2] / length)


def vector_of(file: Part21, identifier: int, keyword: str) -> Vector:
    """The three numbers of a point or a direction.

    Raises:
        StepError: it has another number of them.
    """
    record = file[identifier].needed(keyword)
    numbers = record.numbers(1)
    if len(numbers) != 3:
        raise record.wrong(1, "three numbers")
    return (numbers[0], numbers[1], numbers[2])


def axes(file: Part21, axis: int | None, reference: int | None, place: str) -> tuple[Vector, Vector, Vector]:
    """Right-handed axes of a z direction and one near x; the world's by default. Source: ISO 10303-42."""
    z = unit_vector(vector_of(file, axis, "DIRECTION"), place) if axis is not None else (0.0, 0.0, 1.0)
    near = unit_vector(vector_of(file, reference, "DIRECTION"), place) if reference is not None else (1.0, 0.0, 0.0)
    along = sum(a * b for a, b in zip(near, z, strict=True))
    if reference is None and abs(along) > 1 - SHORTEST_AXIS:
        near, along = (0.0, 1.0, 0.0), z[1]
    x = unit_vector((near[0] - along * z[0], near[1] - along * z[1], near[2] - along * z[2]), place)
    return x, cross(z, x), z


def placement_of(file: Part21, identifier: int, unit: Unit) -> Placement:
    """Placement by an AXIS2_PLACEMENT_3D [mm]: `frame_from_placement`.

    Args:
        file: the file.
        identifier: the placement.
        unit: that of its numbers, which is that of the representation that lists it.

    Raises:
        StepError: its axes have no directions.
    """
    record = file[identifier].needed("AXIS2_PLACEMENT_3D")
    axis, reference = (
        None if index >= len(record) or isinstance(record.argument(index), Missing) else int(record.reference(index))
        for index in (2, 3)
    )
    x, y, z = axes(file, axis, reference, record.instance.place)
    return rigid(x, y, z, located(file, record.reference(1), unit))


def located(file: Part21, point: int, unit: Unit) -> Vector:
    """A point [mm]."""
    at = vector_of(file, point, "CARTESIAN_POINT")
    return (at[0] * unit.factor, at[1] * unit.factor, at[2] * unit.factor)


def representation(file: Part21, identifier: int) -> tuple[tuple[int, ...], int]:
    """The items of a representation, and its context."""
    instance = file[identifier]
    record = instance.record("REPRESENTATION") or instance.inherited("REPRESENTATION")
    return tuple(int(reference) for reference in record.references(1)), int(record.reference(2))


def length_unit(file: Part21, context: int) -> Unit:
    """The unit of lengths of a context.

    Raises:
        StepError: it states none.
    """
    instance = file[context]
    assigned = instance.needed("GLOBAL_UNIT_ASSIGNED_CONTEXT")
    for reference in assigned.references(-1):
        if file[reference].record("LENGTH_UNIT") is not None or "LENGTH_UNIT" in file[reference].keyword:
            return unit_of(file, reference)
    raise StepError(f"{instance.place}: expected a unit of length in the context")


def represented(file: Part21, definition: int) -> tuple[tuple[int, int], ...]:
    """The items that properties of a shape aspect represent, each with its context."""
    properties = {
        record.instance.id for record in file.records("PROPERTY_DEFINITION") if record.argument(2) == definition
    }
    used = chain(file.records("SHAPE_DEFINITION_REPRESENTATION"), file.records("PROPERTY_DEFINITION_REPRESENTATION"))
    found: dict[tuple[int, int], None] = {}
    for each in used:
        if each.argument(0) in properties:
            items, context = representation(file, each.reference(1))
            found.update(dict.fromkeys((item, context) for item in items))
    return tuple(found)
