"""Positions of a REXS text's components, and its shafts: what couplings join turns as one."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from tol3d.apps.drafting.rexs.document import Component, Document, LeftOut, RexsError, SpoiltError
from tol3d.apps.drafting.rexs.gearbox import Gear, Shaft
from tol3d.numerics.arrays import Array

COUPLINGS: Final = ("coupling", "switchable_coupling")
HOUSINGS: Final = ("gear_casing", "gear_unit")
SQUARE: Final = 1e-4  # of unit vectors; files print them with 6 digits and more
DEEPEST: Final = 50  # positions that refer to positions


def pose_of(document: Document, component: Component) -> Array | None:
    """World from a component's u, v, w axes (4, 4) [mm], v = w × u; None if the file does not state it.

    Raises:
        RexsError: positions refer to each other in a ring, or axes are not square to each other.
    """
    pose, asked = np.eye(4), component
    for _ in range(DEEPEST):
        own = _local(asked)
        if own is None:
            return None if asked is component else pose
        pose = own @ pose
        reference = asked.whole("reference_component_for_position")
        if reference is None or reference == asked.id:
            return np.asarray(pose)
        if reference not in document.components:
            raise RexsError(
                f"{asked}: reference_component_for_position: expected a component of the file, got the id {reference}, "
                "which it does not have"
            )
        asked = document.components[reference]
    raise RexsError(f"{component}: expected a position that refers to no position of its own, got a ring")


def _local(component: Component) -> Array | None:
    """Pose in the frame of the component that it refers to."""
    at, u = component.vector("support_vector"), component.vector("u_axis_vector")
    if at is None or u is None:
        return None
    along = np.array(u)
    written = component.vector("w_axis_vector")
    up = np.array(_any_square(along) if written is None else written)
    if not (np.linalg.norm(along) > SQUARE and np.linalg.norm(up) > SQUARE):
        raise RexsError(f"{component}: expected u and w axes with a length, got none")
    along, up = along / np.linalg.norm(along), up / np.linalg.norm(up)
    if abs(along @ up) > SQUARE:
        raise RexsError(f"{component}: expected a w axis square to the u axis, got another")
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = along, np.cross(up, along), up, at
    return pose


def _any_square(along: Array) -> Array:
    start = np.eye(3)[int(np.argmin(np.abs(along)))]
    return np.asarray(np.cross(np.cross(along, start), along))


def shafts_of(document: Document, gears: Mapping[int, Gear], left: LeftOut) -> list[Shaft]:
    """Shafts that carry gears or a carrier, in the order of the file; those that couplings join are one.

    Args:
        document: their text.
        gears: by id.
        left: takes positions that are lost.

    Raises:
        RexsError: a gear is on two shafts, or a position cannot be.
    """
    group = _joined(document)
    carried: dict[int, int] = {}
    for relation in document.of_type.get("assembly", ()):
        gear, shaft = relation.one("part"), relation.one("assembly")
        is_on_shaft = gear in gears and document.components[shaft].type == "shaft"
        if is_on_shaft and carried.setdefault(gear, shaft) != shaft:
            others = f"{carried[gear]} and {shaft}"
            raise RexsError(f"{document.components[gear]}: expected it on one shaft, got {others}")
    carriers = [own.one("shaft") for own in document.of_type.get("planet_carrier_shaft", ())]
    heads: dict[int, list[int]] = {}
    for shaft in dict.fromkeys((*sorted(carried.values()), *carriers)):
        heads.setdefault(group[shaft], []).append(shaft)
    held = set(_held(document, group))
    loaded = {
        group[own.one("assembly")]
        for own in document.of_type.get("assembly", ())
        if document.components[own.one("part")].type == "external_load" and own.one("assembly") in group
    }
    poses = {own: _pose_unless_lost(document.components[own], document, left) for ids in heads.values() for own in ids}
    on_shaft: dict[int, list[int]] = {}
    for gear, shaft in carried.items():
        on_shaft.setdefault(shaft, []).append(gear)
    return [
        Shaft(
            ids,
            document.components[ids[0]].name,
            poses[ids[0]],
            [gears[own] for each in ids for own in on_shaft.get(each, ())],
            _offsets({own: poses[own] for own in ids}, on_shaft),
            head in held,
            head in loaded,
        )
        for head, ids in heads.items()
    ]


def _couplings(document: Document) -> Iterator[tuple[Component, Component]]:
    """Components that an engaged coupling joins."""
    for relation in document.of_type.get("side", ()):
        coupling = document.components[relation.one("assembly")]
        if coupling.type in COUPLINGS and coupling.flag("is_engaged") is not False:
            yield document.components[relation.one("inner_part")], document.components[relation.one("outer_part")]


def _joined(document: Document) -> dict[int, int]:
    """The first component of those that turn with each component: couplings join them, and a carrier its parts."""
    parent = {own: own for own in document.components}

    def head(component: int) -> int:
        while parent[component] != component:
            parent[component] = parent[parent[component]]
            component = parent[component]
        return component

    def join(first: int, second: int) -> None:
        low, high = sorted((head(first), head(second)))
        parent[high] = low

    for inner, outer in _couplings(document):
        if not {inner.type, outer.type} & {*HOUSINGS}:
            join(inner.id, outer.id)
    on_planets = {
        own.one("shaft") for kind in ("planet_shaft", "planet_pin") for own in document.of_type.get(kind, ())
    }  # a pin turns with the carrier only where a coupling joins them
    carriers: dict[int, int] = {}
    for relation in document.of_type.get("assembly", ()):
        whole, part = relation.one("assembly"), relation.one("part")
        if document.components[whole].type == "planet_carrier" and part not in on_planets:
            join(whole, part)
        if document.components[part].type == "planet_carrier":
            carriers[whole] = part
    for own in document.of_type.get("planet_carrier_shaft", ()):
        if own.one("planetary_stage") in carriers:
            join(carriers[own.one("planetary_stage")], own.one("shaft"))
    return {own: head(own) for own in document.components}


def _held(document: Document, group: Mapping[int, int]) -> Iterator[int]:
    """Groups that a coupling joins to the casing."""
    for inner, outer in _couplings(document):
        if {inner.type, outer.type} & {*HOUSINGS}:
            yield group[outer.id if inner.type in HOUSINGS else inner.id]


def _pose_unless_lost(component: Component, document: Document, left: LeftOut) -> Array | None:
    try:
        return pose_of(document, component)
    except SpoiltError as error:
        left.lines.append(str(error))
        return None


def _offsets(poses: Mapping[int, Array | None], on_shaft: Mapping[int, Sequence[int]]) -> dict[int, float]:
    """Start of each shaft of those that are joined, also of that of each gear, along the first one's u [mm]."""
    first = next(iter(poses.values()))
    along = {
        own: 0.0 if pose is None or first is None else float((pose - first)[:3, 3] @ first[:3, 0])
        for own, pose in poses.items()
    }
    return along | {gear: at for shaft, at in along.items() for gear in on_shaft.get(shaft, ())}
