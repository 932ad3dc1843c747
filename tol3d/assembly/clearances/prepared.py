"""Preparation of an assembly's clearances: places where parts may be nearest, and data for workers."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from importlib import import_module
from typing import Any

from tol3d.assembly.clearances.faces import SolidMesh
from tol3d.assembly.clearances.pair import SolidPair, meshes_of, relative_pose, solid_pair
from tol3d.assembly.model import Assembly, Measured
from tol3d.errors import GeometryError, InputError
from tol3d.numerics.arrays import Array

Torsors = Callable[[str, int], Array]
"""Small displacements (motions, 6) of a part after a move, seen at the world's origin [mm, rad]."""

FCL = "tol3d.assembly.clearances"
"""Package whose `nearest` and `distances` load FCL: imported only if there is a clearance to read."""
WITNESS = "tol3d.assembly.witness"
"""It loads FCL too."""


def clearances_of(assembly: Assembly) -> Mapping[str, Measured]:
    """The clearances of whole parts among the measures of an assembly."""
    return {name: own for name, own in assembly.measures.items() if own.reads.by_solids}


def with_facing(assembly: Assembly, torsors: Torsors) -> Assembly:
    """The assembly with the nominal data of its clearances; unchanged if there are none.

    Args:
        assembly: at nominal poses.
        torsors: motions like those of trials, the widest of them included.

    Raises:
        InputError: parts that touch or overlap nominally, or whose meshes would take too many triangles.
    """
    measures = dict(assembly.measures)
    for name, own in clearances_of(assembly).items():
        measures[name] = _faced(assembly, name, own, torsors)
    return replace(assembly, measures=measures) if clearances_of(assembly) else assembly


def _faced(assembly: Assembly, name: str, measured: Measured, torsors: Torsors) -> Measured:
    nearest = import_module(f"{FCL}.nearest")
    start, end = measured.parts
    meshes = _meshes(assembly, name, measured)
    displaced = nearest.Displaced(
        assembly.part[start].pose,
        assembly.part[end].pose,
        torsors(start, measured.after),
        torsors(end, measured.after),
    )
    distance = nearest.nominal_distance(meshes, displaced.relative)
    if distance <= measured.chord_error:
        raise InputError(f"measures.{name}: {_touching(start, end, distance, measured.chord_error)}")
    return replace(measured, facing=nearest.facing(meshes, displaced, distance, measured.chord_error))


def _touching(start: str, end: str, distance: float, chord_error: float) -> str:
    words = f"expected parts that are apart nominally, got {start!r} and {end!r}"
    if distance > 0.0:
        words = f"{words}, {1000 * distance:.3g} um apart by meshes that may be {1000 * chord_error:.3g} um off"
        return f"{words}; state a smaller chord_error"
    words = f"{words}, which touch or overlap as they are placed; the clearance of parts that lie on each other is 0"
    return f"{words}: measure a gap of their features where they are apart, or a clearance to another part"


def _meshes(assembly: Assembly, name: str, measured: Measured) -> tuple[SolidMesh, SolidMesh]:
    start, end = (assembly.part[part].solid for part in measured.parts)
    if start is None or end is None:
        raise InputError(f"measures.{name}: expected parts with solids, got {' and '.join(measured.parts)}")
    try:
        return meshes_of(start, end, measured.chord_error)
    except GeometryError as error:
        raise InputError(f"measures.{name}: {error}") from None


@lru_cache(maxsize=4)
def solid_pairs(assembly: Assembly, share: float = 1.0) -> Mapping[str, SolidPair]:
    """Solid pairs from which a reader of distances is made, by measure; they can be pickled.

    Args:
        assembly: with the nominal data of its clearances.
        share: chord error of its meshes, at most, as a fraction of the stated one.
    """
    stated = clearances_of(assembly)
    return {
        name: _pair(assembly, name, replace(own, chord_error=share * own.chord_error)) for name, own in stated.items()
    }


def _pair(assembly: Assembly, name: str, measured: Measured) -> SolidPair:
    assert measured.facing is not None
    start, end = (assembly.part[part].pose for part in measured.parts)
    meshes, facing = _meshes(assembly, name, measured), measured.facing
    return solid_pair(meshes, relative_pose(start, end), float(facing.lengths.min()), facing.reach)


def witness_of(assembly: Assembly, given: Mapping[str, SolidPair], finer: Mapping[str, SolidPair]) -> Any:
    """Reads gaps and clearances by FCL, see FclWitness."""
    return import_module(WITNESS).FclWitness(assembly, given, finer)


def reader_of(pairs: Mapping[str, SolidPair]) -> Any:
    """Reads distances, see SolidDistances; made in the worker."""
    return import_module(f"{FCL}.distances").SolidDistances(pairs)
