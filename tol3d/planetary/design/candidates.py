"""Candidates as a table, one of them mesh by mesh, and as a scene to start from."""

import math
from collections.abc import Iterator, Sequence
from typing import Final

from tol3d.planetary.design.efficiency import (
    MeshEfficiencies,
    Sharing,
    efficiency,
    mesh_efficiency,
    published_efficiencies,
    shared_sliding_factor,
    sliding_factor,
)
from tol3d.planetary.design.families import Family
from tol3d.planetary.design.optimum import Goal
from tol3d.planetary.design.search import Candidate, Found, Wish, in_order, teeth_text
from tol3d.planetary.design.shifted_set import step_name
from tol3d.planetary.design.working_mesh import WorkingMesh
from tol3d.planetary.model.tooth_set import CARRIER
from tol3d.report.number import NOTHING, unsigned_zero
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, note, page, title
from tol3d.units import Quantity

FACE_WIDTH: Final = 10.0  # modules, until the user says otherwise
THINNING: Final = "{kind: normal, lower: -50 um, upper: -30 um}"
PLANET: Final = "planets"
SHIFT_DIGITS: Final = 9  # behind the point; a module of 100 mm errs by a ten-thousandth of a micrometre


def scene_text(own: Candidate, family: Family) -> str:
    """YAML of a scene; thinning of the teeth and face widths are placeholders, and say so."""
    return "\n".join((*_head(own, family), *_parts(own), *_tolerances(own), *_move(own), *_rest())) + "\n"


def _head(own: Candidate, family: Family) -> Iterator[str]:
    drive = own.task.drive
    teeth = teeth_text(own.own.teeth)
    yield f"# A {family.words} as tol3d design found it: {family.order} {teeth}, ratio {own.ratio:.10g},"
    yield f"# driven at the {drive.input}, {drive.held} held, output {drive.output}."
    yield f"scene: {family.words} {teeth.replace('/', ' ')}"
    yield ""


def _gears(own: Candidate) -> Iterator[tuple[str, int, bool]]:
    """Name, teeth, whether it is a ring: each gear once."""
    for mesh in own.own.teeth.meshes:
        yield mesh.central, mesh.teeth, mesh.internal
    for step, teeth in enumerate(own.own.teeth.steps):
        yield step_name(own.own.teeth, step), teeth, False


def _parts(own: Candidate) -> Iterator[str]:
    rack = own.task.rack
    width, module = Quantity(FACE_WIDTH * rack.module, "mm"), Quantity(rack.module, "mm")
    angle = Quantity(round(math.degrees(rack.pressure_angle), 12), "deg")
    yield "parts:  # face widths are a guess"
    for name, teeth, is_ring in _gears(own):
        kind = "internal_gear" if is_ring else "spur_gear"
        shift = round(own.own.shifts[name], SHIFT_DIGITS) + 0.0
        shifted = f", profile_shift: {shift:.{SHIFT_DIGITS}f}".rstrip("0").rstrip(".") if shift else ""
        yield (
            f"  {name}: {{kind: {kind}, teeth: {teeth}, module: {module}, pressure_angle: {angle}, "
            f"face_width: {width}{shifted}}}"
        )
    steps = ", ".join(step_name(own.own.teeth, step) for step in range(len(own.own.teeth.steps)))
    yield f"  {PLANET}: {{kind: planet, gears: [{steps}]}}"
    yield f"  {CARRIER}: {{kind: planet_carrier}}"
    yield ""


def _tolerances(own: Candidate) -> Iterator[str]:
    yield "tolerances:  # a guess: without thinner teeth the set cannot turn"
    for name, _, _ in _gears(own):
        yield f"  {name} thinning: {{kind: tooth_thickness, of: {name}, measured: normal, distribution: {THINNING}}}"
    yield ""


def _move(own: Candidate) -> Iterator[str]:
    drive, teeth = own.task.drive, own.own.teeth
    meshes = ", ".join(f"{mesh.central}: {step_name(teeth, mesh.step)}" for mesh in teeth.meshes)
    yield "moves:"
    yield "  planetary set:"
    yield "    kind: planetary"
    yield f"    planet: {PLANET}"
    yield f"    planets: {own.task.planets}"
    yield f"    carrier: {CARRIER}"
    yield f"    meshes: {{{meshes}}}"
    yield f"    centre_distance: {Quantity(round(own.own.centre_distance, SHIFT_DIGITS), 'mm')}"
    yield f"    held: {drive.held}"
    yield f"    input: {drive.input}"
    yield f"    output: {drive.output}"
    yield ""


def _rest() -> Iterator[str]:
    yield "measures:"
    yield "  lost motion: {kind: planetary_lost_motion, of: planetary set}"
    yield ""
    yield "study: {trials: 20000, seed: 1}"


LOCKS_ITSELF: Final = "locks itself"
THREE_MESHES: Final = 3
AGREEMENT: Final = 1e-12  # of efficiencies; rounding leaves a hundredth of it
GOALS: Final = {
    Goal.SMALLEST: "smallest profile shifts",
    Goal.FORWARD: "profile shifts for the best efficiency forward",
    Goal.BACKWARD: "profile shifts for the best efficiency backward",
}


def design_report(found: Found, wish: Wish, detail: int) -> Page:
    """The table of candidates, and candidate `detail` (from 1) mesh by mesh."""
    own = found.candidates[detail - 1]
    chosen: list[PageItem] = [title(f"candidate {detail}: {teeth_text(own.own.teeth)}"), mesh_table(own)]
    blocks: list[PageItem] = [_title(wish), BLANK, candidate_table(found, wish.family)]
    return page(*blocks, *map(note, _notes(found, wish)), *chosen, *map(note, _own_notes(own)))


def candidate_table(found: Found, family: Family) -> Table:
    """A row for each candidate."""
    headings = [
        Heading(family.order),
        Heading("ratio"),
        Heading("a [mm]"),
        Heading("forward [%]"),
        Heading("backward [%]"),
        Heading("planet gap [mm]"),
        *(Heading(f"x {sign}", optional=True) for sign in family.order.split("/")),
    ]
    return Table("", headings, [_candidate_row(k, own) for k, own in enumerate(found.candidates, 1)])


def _candidate_row(number: int, own: Candidate) -> Row:
    gap = own.own.planet_gap(own.task.planets)
    cells = [
        teeth_text(own.own.teeth),
        Shown(f"{own.ratio:.6g}", own.ratio),
        Shown(f"{own.own.centre_distance:.4f}", own.own.centre_distance),
        _percent(own.forward),
        _percent(own.backward),
        Shown(f"{gap:.3f}", gap) if math.isfinite(gap) else Shown(NOTHING, None),
        *(Shown(unsigned_zero(f"{shift:.3f}"), shift) for shift in in_order(own.own.teeth, own.own.shifts)),
    ]
    return Row(str(number), cells)


def _percent(value: float) -> str:
    return Shown(f"{100 * value:.3f}", 100 * value) if value > 0.0 else LOCKS_ITSELF


def mesh_table(own: Candidate) -> Table:
    """A column for each mesh of a candidate."""
    meshes, friction = own.own.meshes, own.task.friction
    names = [f"{mesh.mesh.central} – {step_name(own.own.teeth, mesh.mesh.step)}" for mesh in meshes]

    def row(label: str, unit: str, digits: int, values: Sequence[float]) -> Row:
        said = f"{label} [{unit}]" if unit not in ("", "1") else label
        return Row(said, [Shown(unsigned_zero(f"{value:.{digits}f}"), value) for value in values], unit=unit)

    def each(kind: Sharing) -> list[float]:
        return [mesh_efficiency(mesh, friction, kind) for mesh in meshes]

    rows = [
        row("teeth of the central gear", "1", 0, [mesh.mesh.teeth for mesh in meshes]),
        row("teeth of the planet", "1", 0, [mesh.mesh.planet_teeth for mesh in meshes]),
        row("profile shift x of the central gear", "1", 4, [mesh.central_shift for mesh in meshes]),
        row("profile shift x of the planet", "1", 4, [mesh.planet_shift for mesh in meshes]),
        row("working pressure angle", "deg", 4, [math.degrees(mesh.working_angle) for mesh in meshes]),
        row("contact ratio", "1", 4, [mesh.contact_ratio for mesh in meshes]),
        row("tip thickness of the central gear", "mm", 4, [mesh.tip_thicknesses[0] for mesh in meshes]),
        row("tip thickness of the planet", "mm", 4, [mesh.tip_thicknesses[1] for mesh in meshes]),
        row("least tip clearance", "mm", 4, [min(mesh.tip_clearances) for mesh in meshes]),
        row("E, published formula", "1", 5, [sliding_factor(*mesh.contact_ratios) for mesh in meshes]),
        row("E, equal shares of the load", "1", 5, [shared_sliding_factor(*mesh.contact_ratios) for mesh in meshes]),
        row("efficiency, published formula", "1", 6, each("formula")),
        row("efficiency, equal shares", "1", 6, each("equal shares")),
    ]
    return Table("mesh", [Heading(name) for name in names], rows)


def _title(wish: Wish) -> Line:
    angle = math.degrees(wish.rack.pressure_angle)
    number = f"{wish.planets} planet{'' if wish.planets == 1 else 's'}"
    words = f" · ratio {wish.ratio:g} ± {wish.tolerance:g} · {number} · module {wish.rack.module:g} mm · {angle:g} deg"
    return Line(((f"{wish.family.words}s", "bold"), (words, "bold dim")))


def _notes(found: Found, wish: Wish) -> Iterator[str]:
    drive = wish.family.drive
    yield (
        f"driven at the {drive.input}, {drive.held} held, output {drive.output}; {GOALS[wish.goal]}; "
        f"coefficient of friction {wish.friction:g}; a positive shift thickens the tooth, of rings too"
    )
    for fallen in found.fallen:
        number = f"{fallen.count} set{'' if fallen.count == 1 else 's'} of that ratio"
        yield f"left out by {fallen.condition}: {number}; {fallen.nearest}"
    if found.left:
        yield f"{found.left} further sets of that ratio can be assembled, and are not judged: --most shows more"


def _own_notes(own: Candidate) -> Iterator[str]:
    teeth, drive, friction = own.own.teeth, own.task.drive, own.task.friction
    shared = own.own.mesh_efficiencies(friction, "equal shares")
    pair = [efficiency(teeth, shared, each) for each in (drive, drive.reversed)]
    yield f"with equal shares of the load: forward {_words(pair[0])}, backward {_words(pair[1])}"
    if len(teeth.meshes) == THREE_MESHES:
        published = published_efficiencies(teeth, MeshEfficiencies(*own.own.mesh_efficiencies(friction).values()))
        off = abs(published.forward - own.forward)
        if own.backward > 0.0:
            off = max(off, abs(published.backward - own.backward))
        agree = f"agree within {AGREEMENT:g}" if off <= AGREEMENT else f"are {off:.1e} apart"
        yield f"the published closed form of the set and the equilibrium of its torques {agree}"
    if any(max(mesh.contact_ratios) > 1.0 or min(mesh.contact_ratios) < 0.0 for mesh in own.own.meshes):
        yield f"the published E is too large for {_beyond(own.own.meshes)}: see docs/planetary.md"


def _words(value: float) -> str:
    return f"{100 * value:.3f} %" if value > 0.0 else LOCKS_ITSELF


def _beyond(meshes: Sequence[WorkingMesh]) -> str:
    """Meshes whose path does not lie within a base pitch on both sides of the pitch point."""
    return " and ".join(
        own.mesh.central for own in meshes if max(own.contact_ratios) > 1.0 or min(own.contact_ratios) < 0.0
    )
