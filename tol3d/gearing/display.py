"""One build as it came to rest, its deviations magnified if wanted: poses, contact and gap of every mesh."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError, RunError
from tol3d.gearing.engines import NO_CONTACT, OK
from tol3d.gearing.meshing import Meshing, MeshSeat
from tol3d.gearing.model import Measure, Mesh, Model
from tol3d.gearing.play import SeatKey, seat_keys
from tol3d.gears import Gear
from tol3d.report.number import measured_text
from tol3d.runs.run import Run
from tol3d.runs.worst import worst_trial
from tol3d.simulate import Replay, model_of, replay, replay_block
from tol3d.solids import DisplayMesh, display_mesh
from tol3d.study.block import Block, mean_block, nominal_block

Array = NDArray[np.float64]
Which = int | str

DISPLAY_DEFLECTION: Final = 0.5e-3  # mm; a hundredth of a common backlash, and 40 000 triangles a gear at most
CONE_DEFLECTION: Final = 5e-3  # mm; of a bevel gear, whose faces OCC meshes one by one and much finer than asked
OPEN_SHARE: Final = 1 / 8  # of the base pitch; a magnified gap stays this small, a third of a tooth
MAGNIFY_STEPS: Final = 16  # halvings of the range of magnifications; 1/65536 of it
MAGNIFY_DIGITS: Final = 3  # of the magnification in use, rounded down


@dataclass(frozen=True, eq=False)
class PlacedGear:
    """A perturbed gear where it ended up.

    Args:
        name: the part's.
        gear: nominal geometry.
        world_from_gear: (4, 4), rotation and translation [mm].
        flank_turn: by what each flank is turned out of its tooth [rad]; offsets are shown as such turns.
        scale: thermal growth, 1 at the reference temperature.
    """

    name: str
    gear: Gear
    world_from_gear: Array
    flank_turn: float
    scale: float

    def mesh(self) -> tuple[Array, NDArray[np.int64]]:
        """Closed triangle mesh in the world: vertices (n, 3) [mm], triangles (m, 3)."""
        display = self.display
        own = self.scale * display.thickened(self.flank_turn)
        rotation, translation = self.world_from_gear[:3, :3], self.world_from_gear[:3, 3]
        return own @ rotation.T + translation, display.triangles

    @property
    def display(self) -> DisplayMesh:
        return display_mesh(self.gear, CONE_DEFLECTION if self.gear.pitch_angle else DISPLAY_DEFLECTION)

    @property
    def unfolded(self) -> bool:
        """Whether the deviation turns no triangle over, as it does where a flank passes points of the tip."""
        display = self.display
        corners = (shape[display.triangles] for shape in (display.vertices, display.thickened(self.flank_turn)))
        before, after = (np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]) for c in corners)
        return bool(((before * after).sum(axis=1) >= 0.0).all())

    @property
    def perturbed(self) -> Gear:
        """The gear with its deviation and its growth in its numbers.

        Raises:
            GeometryError: such a gear cannot be made.
        """
        return self.gear.perturbed(self.flank_turn, self.scale)


@dataclass(frozen=True, eq=False)
class SeatedMesh:
    """A mesh of the build: its gears, where they touch, and how far their other flanks are apart.

    Args:
        mesh: which.
        driver, driven: the placed gears, in the world of the mesh.
        driver_angle, driven_angle: their turns about their own axes [rad].
        contact, normal: point on the driver's working flank (3,) [mm] and the unit vector to the driven.
        gap: the nearest points of the non-working flanks, driver's and driven's, (2, 3) [mm].
        gap_value: their distance [mm], the normal backlash; nan where the flanks overlap too deep to tell.
        status: OK, INTERFERES or NO_CONTACT.
    """

    mesh: Mesh
    driver: PlacedGear
    driven: PlacedGear
    driver_angle: float
    driven_angle: float
    contact: Array
    normal: Array
    gap: Array
    gap_value: float
    status: int

    @property
    def tip_clearance(self) -> float:
        """Smaller free distance [mm] between a tip and the mate's root."""
        origins = np.stack([part.world_from_gear[:3, 3] for part in (self.driver, self.driven)])
        return self.mesh.pair.tip_clearance(origins, (self.driver.scale, self.driven.scale))


@dataclass(frozen=True, eq=False)
class Assembly:
    """A build at rest.

    Args:
        model: whose build it is.
        label: what it is, such as "trial-17" or "nominal", good as the start of a file's name.
        magnify: by what its deviations were scaled.
        meshes: each in a world of its own; those that are measured, or all of a model whose shafts are shown.
        values: value of each measure on the geometric road, in the measure's unit, magnified too.
        notes: what the user should know.
    """

    model: Model
    label: str
    magnify: float
    meshes: tuple[SeatedMesh, ...]
    values: Mapping[str, object]
    notes: tuple[str, ...]


def assemble(run: Run, which: Which, *, magnify: float = 1.0) -> Assembly:
    """A build of a run, seated again.

    Args:
        which: a trial, or "worst", "nominal", "mean".
        magnify: scales every deviation; lowered where the teeth would not seat, their gap would leave
            the tooth space or a tip would fold, which a note then tells.

    Raises:
        InputError: no such build, or one without contact.
    """
    if not (math.isfinite(magnify) and magnify >= 0.0):
        raise InputError(f"magnify: expected a number of at least 0, got {magnify:g}")
    label, seen = _replayed(run, which)
    plain = assembly_of(seen, label)
    if magnify == 1.0:
        return plain
    used, seen, meshes, note = _magnified(seen, _rows(seen), magnify)
    label += f"-x{used:g}" if used != 1.0 else ""
    return Assembly(seen.model, label, used, meshes, seen.geometric, (*plain.notes, note))


def assembly_of(seen: Replay, label: str) -> Assembly:
    """A build that was replayed, seated again, under a label.

    Raises:
        RunError: its working flanks found no contact.
    """
    meshes = _seated(seen, _rows(seen))
    for seat in meshes:
        if seat.status == NO_CONTACT:
            raise RunError(f"{label}: the working flanks of {seat.mesh.name} found no contact; choose another build")
    said = _said(label, seen)
    return Assembly(seen.model, label, 1.0, meshes, seen.geometric, (said,) if said else ())


def _replayed(run: Run, which: Which) -> tuple[str, Replay]:
    if which == "worst":
        which = worst_trial(run)
    if isinstance(which, int):
        return f"trial-{which}", replay(run, which)
    if which not in ("nominal", "mean"):
        raise InputError(f"expected a trial's number, worst, nominal or mean, got {which!r}")
    model = model_of(run)
    block = nominal_block(model) if which == "nominal" else mean_block(model, model.measures[0])
    return which, replay_block(model, block)


def _said(label: str, seen: Replay) -> str:
    if seen.status != "ok":
        return f"{label}: {seen.status}; shown where its working flanks touch"
    return ""


# positions ----------------------------------------------------------------------------------------


def shows_shafts(model: Model) -> bool:
    """Whether its parts make more than single pairs: they are shown in one world then, at the trial's position."""
    plain = all(len(drive.meshes) == 1 for drive in model.layout.drives)
    return bool(model.shafts or model.arms or model.reducers) or not plain


def _first_measure(model: Model, mesh: Mesh) -> Measure | None:
    return next((measure for measure in model.measures if _key(model, measure, mesh)), None)


def _key(model: Model, measure: Measure, mesh: Mesh) -> SeatKey | None:
    """Where a measure reads a mesh; None where it does not."""
    return next((key for key in seat_keys(model, measure) if key[0] == mesh.name), None)


def _rows(seen: Replay) -> dict[str, int]:
    """At which position of its first measure each mesh is shown: the extreme that the measure takes, or the first."""
    if shows_shafts(seen.model):
        return {mesh.name: 0 for mesh in seen.model.meshes}
    rows = {}
    for mesh in seen.model.meshes:
        measure = _first_measure(seen.model, mesh)
        if measure is not None:
            rows[mesh.name] = _extreme(measure, _of_measure(seen, mesh).non_working.smallest())
    return rows


def _extreme(measure: Measure, gaps: Array) -> int:
    if measure.take not in ("min", "max", "range") or np.isnan(gaps).all():
        return 0
    return int(np.nanargmin(gaps) if measure.take == "min" else np.nanargmax(gaps))


def _of_measure(seen: Replay, mesh: Mesh) -> MeshSeat:
    """A mesh at the positions of its first measure."""
    return seen.seats.seats[_own_key(seen, mesh)]


def _own_key(seen: Replay, mesh: Mesh) -> SeatKey:
    """Where a mesh is read first; one that is not read counts as the first that is."""
    measure = _first_measure(seen.model, mesh)
    key = _key(seen.model, measure, mesh) if measure else None
    return key or next(iter(seen.seats.seats))


def _seats(seen: Replay, rows: Mapping[str, int]) -> Mapping[str, MeshSeat]:
    if shows_shafts(seen.model):
        return _along_shafts(seen)
    return {mesh.name: _of_measure(seen, mesh) for mesh in seen.model.meshes if mesh.name in rows}


def _along_shafts(seen: Replay) -> Mapping[str, MeshSeat]:
    """Meshes at the trial's position, each driver turned to where the links before it came to rest.

    Where ways meet, the first link says where the shaft rests; how gears are clocked on their shafts is not shown.
    """
    layout, angles, meshings = seen.model.layout, seen.block.random_angle, seen.seats.meshings
    meshes = {mesh.name: mesh for mesh in seen.model.meshes}
    ahead: dict[str, float] = {}  # of its nominal angle, by shaft [rad]
    seats = {}
    for link in sorted(layout.links, key=lambda link: len(layout.behind(link.driven))):
        before = ahead.get(link.driver, 0.0)
        mesh = meshes.get(link.name)
        if mesh is None:
            ahead.setdefault(link.driven, before * float(link.rate))
            continue
        known = meshings[_own_key(seen, mesh)]
        meshing = Meshing(known.engine, seen.model, mesh, seen.seats.build, known.reading)
        (_, driver), (_, driven) = layout.carrying[mesh.driver], layout.carrying[mesh.driven]
        seats[mesh.name] = meshing.seat(angles[mesh.name] + driver.sense * before)
        off = seats[mesh.name].driven_angle - mesh.pair.driven_angle(angles[mesh.name])
        ahead.setdefault(link.driven, driven.sense * float(off[0]))
    return seats


def _seated(seen: Replay, rows: Mapping[str, int]) -> tuple[SeatedMesh, ...]:
    seats = _seats(seen, rows)
    return tuple(
        _seated_mesh(seen, mesh, seats[mesh.name], rows[mesh.name]) for mesh in seen.model.meshes if mesh.name in seats
    )


def _seated_mesh(seen: Replay, mesh: Mesh, seat: MeshSeat, row: int) -> SeatedMesh:
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
    seat, build = seen.model.seat_index[mesh.name, name], seen.seats.build
    gear = mesh.gear(name)
    return PlacedGear(
        name=name,
        gear=gear,
        world_from_gear=build.world_from_gear(seat, np.array([angle]))[0],
        flank_turn=float(build.flank_turn[0, seat] + build.flank_offset[0, seat] / gear.section_arm),
        scale=float(build.scale[0, seat]),
    )


# magnification ------------------------------------------------------------------------------------


def _magnified(
    seen: Replay, rows: Mapping[str, int], wanted: float
) -> tuple[float, Replay, tuple[SeatedMesh, ...], str]:
    """The build with its deviations scaled by the largest allowed number up to `wanted`, and what to say of it."""

    def scaled(factor: float) -> tuple[Replay, tuple[SeatedMesh, ...]]:
        again = replay_block(seen.model, _scaled(seen.block, factor))
        return again, _seated(again, rows)

    plain = _seated(seen, rows)
    widest = {mesh.mesh.name: max(OPEN_SHARE * mesh.driver.gear.base_pitch, mesh.gap_value) for mesh in plain}

    def allowed(meshes: tuple[SeatedMesh, ...]) -> bool:
        return all(_in_its_space(mesh, widest[mesh.mesh.name]) for mesh in meshes)

    again, meshes = scaled(wanted)
    if wanted < 1.0 or allowed(meshes):
        return wanted, again, meshes, f"deviations magnified {wanted:g} times: {_gaps_text(plain, meshes)}"
    if not allowed(plain):
        return 1.0, seen, plain, "not magnified: the teeth do not run free in this build"
    low, high = 1.0, wanted
    for _ in range(MAGNIFY_STEPS):
        middle = (low + high) / 2
        low, high = (middle, high) if allowed(scaled(middle)[1]) else (low, middle)
    used = max(1.0, _rounded_down(low))
    again, meshes = scaled(used)
    return (
        used,
        again,
        meshes,
        f"deviations magnified {used:g} times, not {wanted:g}: beyond that the gap would leave the tooth space "
        f"(allowed are 0 to {' or '.join(f'{1000 * width:.0f}' for width in widest.values())} µm) or a tip would fold; "
        f"{_gaps_text(plain, meshes)}",
    )


def _scaled(block: Block, factor: float) -> Block:
    return Block(factor * block.deviations, block.random_angle)


def _in_its_space(mesh: SeatedMesh, widest: float) -> bool:
    free = mesh.status == OK and mesh.gap_value <= widest and mesh.tip_clearance > 0.0
    return free and mesh.driver.unfolded and mesh.driven.unfolded


def _gaps_text(plain: tuple[SeatedMesh, ...], meshes: tuple[SeatedMesh, ...]) -> str:
    texts = [
        f"{mesh.mesh.name} has a normal backlash of {measured_text(1000 * mesh.gap_value, 'um')} instead of "
        f"{measured_text(1000 * before.gap_value, 'um')}"
        for before, mesh in zip(plain, meshes, strict=True)
    ]
    return ", ".join(texts)


def _rounded_down(value: float) -> float:
    step = 10.0 ** (math.floor(math.log10(value)) - MAGNIFY_DIGITS + 1)
    return round(math.floor(value / step) * step, 10)
