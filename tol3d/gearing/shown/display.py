"""A build simulated again for pictures and files: every mesh seated, its deviations magnified if wanted."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from tol3d.errors import InputError, RunError
from tol3d.gearing.engines import NO_CONTACT
from tol3d.gearing.meshing.mesh import Meshing, MeshSeat
from tol3d.gearing.meshing.seats import Seats
from tol3d.gearing.model import Measure, Mesh, Model
from tol3d.gearing.play.play import SeatKey, seat_keys
from tol3d.gearing.shown.placed import PlacedGear, SeatedMesh, allowed_factor
from tol3d.gearing.system import gears_in
from tol3d.numerics.arrays import Array
from tol3d.study.results.replaying import Replay, enlarged

Side = Literal["drive", "back"]
"""Flanks on which meshes rest: those that the first shaft pushes with, or the others."""


@dataclass(frozen=True, eq=False)
class SeatedBuild:
    """A build at rest.

    Args:
        model: whose build it is.
        label: such as "trial-17" or "nominal", usable as the start of a file's name.
        magnify: the factor of its deviations.
        meshes: each in a world of its own; those that are measured, or all of a model whose shafts are shown.
        values: value of each measure on the geometric method, in the measure's unit, magnified too.
        notes: for the user.
        seen: the build itself, simulated again with its deviations as they are magnified.
    """

    model: Model
    label: str
    magnify: float
    meshes: tuple[SeatedMesh, ...]
    values: Mapping[str, object]
    notes: tuple[str, ...]
    seen: Replay


def seated_build(seen: Replay, label: str, *, magnify: float = 1.0) -> SeatedBuild:
    """A build that was replayed, seated again, under a label.

    Args:
        seen: the build.
        label: see SeatedBuild.
        magnify: scales every deviation; lowered where the teeth would not seat, their gap would leave
            the tooth space or a tip would fold, as a note then says.

    Raises:
        InputError: no such factor. RunError: its working flanks found no contact.
    """
    require_factor(magnify)
    rows = _rows(seen)
    meshes = _seated(seen, rows)
    for seat in meshes:
        if seat.status == NO_CONTACT:
            raise RunError(f"{label}: the working flanks of {seat.mesh.name} found no contact; choose another build")
    notes = () if seen.status == "ok" else (f"{label}: {seen.status}; shown where its working flanks touch",)
    if magnify == 1.0:
        return SeatedBuild(_model(seen), label, 1.0, meshes, seen.geometric, notes, seen)
    used, note = allowed_factor(lambda factor: _seated(enlarged(seen, factor), rows), magnify)
    again = enlarged(seen, used)
    label += f"-x{used:g}" if used != 1.0 else ""
    return SeatedBuild(_model(seen), label, used, _seated(again, rows), again.geometric, (*notes, note), again)


def magnified_build(seen: Replay, label: str, magnify: float) -> tuple[Replay, str, tuple[str, ...]]:
    """A build with its deviations magnified, its label, and notes.

    Raises:
        InputError: no such factor.
    """
    require_factor(magnify)
    if magnify == 1.0:
        return seen, label, ()
    return enlarged(seen, magnify), f"{label}-x{magnify:g}", (f"deviations magnified {magnify:g} times",)


def require_factor(magnify: float) -> None:
    """Refuse a factor of deviations that is no number of at least 0.

    Raises:
        InputError: it is none.
    """
    if not (math.isfinite(magnify) and magnify >= 0.0):
        raise InputError(f"magnify: expected a number of at least 0, got {magnify:g}")


def _model(seen: Replay) -> Model:
    return gears_in(seen.simulation.system).model


def _seats_of(seen: Replay) -> Seats:
    """Its meshes as they came to rest."""
    seats: Seats = seen.build
    return seats


# positions ----------------------------------------------------------------------------------------


def shows_shafts(model: Model) -> bool:
    """True if its parts make more than single pairs: they are shown in one world then, at the trial's position."""
    plain = all(len(drive.moves) == 1 for drive in model.layout.drives)
    return bool(model.shafts or model.arms or model.links) or not plain


def _first_measure(model: Model, mesh: Mesh) -> Measure | None:
    return next((measure for measure in model.measures if _key(model, measure, mesh)), None)


def _key(model: Model, measure: Measure, mesh: Mesh) -> SeatKey | None:
    """Key of a measure's reading of a mesh; None if it does not read the mesh."""
    return next((key for key in seat_keys(model, measure) if key[0] == mesh.name), None)


def _rows(seen: Replay) -> dict[str, int]:
    """Position of its first measure at which each mesh is shown: the extreme that the measure takes, or the first."""
    if shows_shafts(_model(seen)):
        return {mesh.name: 0 for mesh in _model(seen).meshes}
    rows = {}
    for mesh in _model(seen).meshes:
        measure = _first_measure(_model(seen), mesh)
        if measure is not None:
            rows[mesh.name] = _extreme(measure, _of_measure(seen, mesh).non_working.smallest())
    return rows


def _extreme(measure: Measure, gaps: Array) -> int:
    if measure.take not in ("min", "max", "range") or np.isnan(gaps).all():
        return 0
    return int(np.nanargmin(gaps) if measure.take == "min" else np.nanargmax(gaps))


def _of_measure(seen: Replay, mesh: Mesh) -> MeshSeat:
    """A mesh at the positions of its first measure."""
    return _seats_of(seen).seats[_own_key(seen, mesh)]


def _own_key(seen: Replay, mesh: Mesh) -> SeatKey:
    """Key of the first reading of a mesh; a mesh that is not read takes the first that is."""
    measure = _first_measure(_model(seen), mesh)
    key = _key(_model(seen), measure, mesh) if measure else None
    return key or next(iter(_seats_of(seen).seats))


def _seats(seen: Replay, rows: Mapping[str, int]) -> Mapping[str, MeshSeat]:
    if shows_shafts(_model(seen)):
        return _along_shafts(seen)
    return {mesh.name: _of_measure(seen, mesh) for mesh in _model(seen).meshes if mesh.name in rows}


def seats_turned(seen: Replay, driver_angles: Mapping[str, float], beyond: float, side: Side) -> Mapping[str, MeshSeat]:
    """Meshes of a build further on, on either side of their backlash.

    Args:
        seen: the build.
        driver_angles: turns [rad] of the drivers of its meshes in it, by mesh; those that are shown.
        beyond: turn of the first shafts, or of the drivers of single pairs, from there on [rad].
        side: of all meshes.
    """
    if shows_shafts(_model(seen)):
        return _along_shafts(seen, beyond, side)
    meshes = (mesh for mesh in _model(seen).meshes if mesh.name in driver_angles)
    return {
        mesh.name: _meshing(seen, mesh, side).seat(np.array([driver_angles[mesh.name] + beyond])) for mesh in meshes
    }


def _along_shafts(seen: Replay, beyond: float = 0.0, side: Side | None = None) -> Mapping[str, MeshSeat]:
    """Meshes at the trial's position, each driver turned to where the links before it came to rest.

    Where load paths join, the first link decides where the shaft rests; how gears are clocked on their shafts is not
    shown.

    Args:
        seen: the build.
        beyond: turn of the first shafts from the trial's position on [rad].
        side: of their backlash that all meshes rest on; None: each on that of its first measure.
    """
    layout = _model(seen).layout
    angles = {
        name: angle + beyond * float(layout.mesh_turn[name].rate) if name in layout.mesh_turn else angle
        for name, angle in seen.trials.positions.items()
    }
    meshes = {mesh.name: mesh for mesh in _model(seen).meshes}
    ahead: dict[str, float] = {}  # of its nominal angle, by shaft [rad]
    seats = {}
    for link in sorted(layout.links, key=lambda link: len(layout.upstream(link.driven))):
        before = ahead.get(link.driver, 0.0)
        mesh = meshes.get(link.name)
        if mesh is None:
            about = ahead.get(link.carrier or "", 0.0)
            ahead.setdefault(link.driven, about + (before - about) * float(link.rate))
            continue
        meshing = _meshing(seen, mesh, side)
        (_, driver), (_, driven) = layout.carrying[mesh.driver], layout.carrying[mesh.driven]
        seats[mesh.name] = meshing.seat(angles[mesh.name] + driver.sense * before)
        off = seats[mesh.name].driven_angle - mesh.pair.driven_angle(angles[mesh.name])
        ahead.setdefault(link.driven, driven.sense * float(off[0]))
    return seats


def _meshing(seen: Replay, mesh: Mesh, side: Side | None) -> Meshing:
    """A mesh as its first measure reads it, or on a side of its backlash."""
    known = _seats_of(seen).meshings[_own_key(seen, mesh)]
    reading = known.reading if side is None else replace(known.reading, flank=side)
    return Meshing(known.engine, _model(seen), mesh, _seats_of(seen).build, reading)


def _seated(seen: Replay, rows: Mapping[str, int]) -> tuple[SeatedMesh, ...]:
    seats = _seats(seen, rows)
    return tuple(
        seated_mesh(seen, mesh, seats[mesh.name], rows[mesh.name]) for mesh in _model(seen).meshes if mesh.name in seats
    )


def seated_mesh(seen: Replay, mesh: Mesh, seat: MeshSeat, row: int) -> SeatedMesh:
    """A mesh of a build, its gears placed as a row of its seat has them."""
    at_work, idle = seat.working, seat.non_working
    touching = int(np.argmin(np.where(np.isnan(at_work.value[row]), np.inf, at_work.value[row])))
    nearest = int(np.argmin(np.where(np.isnan(idle.value[row]), np.inf, idle.value[row])))
    driver_angle, driven_angle = float(seat.driver_angle[row]), float(seat.driven_angle[row])
    return SeatedMesh(
        mesh=mesh,
        driver=_placed(seen, mesh, mesh.driver, driver_angle),
        driven=_placed(seen, mesh, mesh.driven, driven_angle),
        driver_angle=driver_angle,
        driven_angle=driven_angle,
        contact=at_work.driver_point[row, touching],
        normal=at_work.normal[row, touching],
        gap=np.stack([idle.driver_point[row, nearest], idle.driven_point[row, nearest]]),
        gap_value=float(idle.smallest()[row]),
        status=int(seat.status[row]),
    )


def _placed(seen: Replay, mesh: Mesh, name: str, angle: float) -> PlacedGear:
    seat, build = _model(seen).seat_index[mesh.name, name], _seats_of(seen).build
    gear = mesh.gear(name)
    return PlacedGear(
        name=name,
        gear=gear,
        world_from_gear=build.world_from_gear(seat, np.array([angle]))[0],
        flank_turn=float(build.flank_turn[0, seat] + build.flank_offset[0, seat] / gear.section_arm),
        scale=float(build.scale[0, seat]),
    )
