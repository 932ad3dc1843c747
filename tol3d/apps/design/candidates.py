"""Candidates as a table, one of them mesh by mesh, and as a scene to start from."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from tol3d.apps.design.families import Family
from tol3d.apps.design.optimum import Goal
from tol3d.apps.design.search import Candidate, Found, Wish, in_order, teeth_text
from tol3d.apps.design.shifted_set import step_name
from tol3d.apps.design.working_mesh import WorkingMesh, mesh_efficiency
from tol3d.gearing.planetary import (
    CARRIER,
    MeshEfficiencies,
    Sharing,
    efficiency,
    published_efficiencies,
    shared_sliding_factor,
    sliding_factor,
)
from tol3d.report import declared_table, side_by_side
from tol3d.report.page import BLANK, Line, Page, PageItem, Table, note, page, title
from tol3d.study.runs import Computed, Shows
from tol3d.units import Quantity

FACE_WIDTH: Final = 10.0  # modules, until the user says otherwise
THINNING: Final = "{kind: normal, lower: -50 um, upper: -30 um}"
PLANET: Final = "planets"
SHIFT_DIGITS: Final = 9  # behind the point; a module of 100 mm errs by a ten-thousandth of a micrometre


def scene_text(candidate: Candidate, family: Family) -> str:
    """YAML of a scene; thinning of the teeth and face widths are placeholders, and say so."""
    return (
        "\n".join((*_head(candidate, family), *_parts(candidate), *_tolerances(candidate), *_move(candidate), *_rest()))
        + "\n"
    )


def _head(candidate: Candidate, family: Family) -> Iterator[str]:
    drive = candidate.task.drive
    teeth = teeth_text(candidate.own.teeth)
    yield f"# A {family.words} as tol3d design found it: {family.order} {teeth}, ratio {candidate.ratio:.10g},"
    yield f"# driven at the {drive.input}, {drive.held} held, output {drive.output}."
    yield f"scene: {family.words} {teeth.replace('/', ' ')}"
    yield ""


def _gears(candidate: Candidate) -> Iterator[tuple[str, int, bool]]:
    """Name, teeth, whether it is a ring: each gear once."""
    for mesh in candidate.own.teeth.meshes:
        yield mesh.central, mesh.teeth, mesh.internal
    for step, teeth in enumerate(candidate.own.teeth.steps):
        yield step_name(candidate.own.teeth, step), teeth, False


def _parts(candidate: Candidate) -> Iterator[str]:
    rack = candidate.task.rack
    width, module = Quantity(FACE_WIDTH * rack.module, "mm"), Quantity(rack.module, "mm")
    angle = Quantity(round(math.degrees(rack.pressure_angle), 12), "deg")
    yield "parts:  # face widths are a guess"
    for name, teeth, is_ring in _gears(candidate):
        kind = "internal_gear" if is_ring else "spur_gear"
        shift = round(candidate.own.shifts[name], SHIFT_DIGITS) + 0.0
        shifted = f", profile_shift: {shift:.{SHIFT_DIGITS}f}".rstrip("0").rstrip(".") if shift else ""
        yield (
            f"  {name}: {{kind: {kind}, teeth: {teeth}, module: {module}, pressure_angle: {angle}, "
            f"face_width: {width}{shifted}}}"
        )
    steps = ", ".join(step_name(candidate.own.teeth, step) for step in range(len(candidate.own.teeth.steps)))
    yield f"  {PLANET}: {{kind: planet, gears: [{steps}]}}"
    yield f"  {CARRIER}: {{kind: planet_carrier}}"
    yield ""


def _tolerances(candidate: Candidate) -> Iterator[str]:
    yield "tolerances:  # a guess: without thinner teeth the set cannot turn"
    for name, _, _ in _gears(candidate):
        yield f"  {name} thinning: {{kind: tooth_thickness, of: {name}, measured: normal, distribution: {THINNING}}}"
    yield ""


def _move(candidate: Candidate) -> Iterator[str]:
    drive, teeth = candidate.task.drive, candidate.own.teeth
    meshes = ", ".join(f"{mesh.central}: {step_name(teeth, mesh.step)}" for mesh in teeth.meshes)
    yield "moves:"
    yield "  planetary set:"
    yield "    kind: planetary"
    yield f"    planet: {PLANET}"
    yield f"    planets: {candidate.task.planets}"
    yield f"    carrier: {CARRIER}"
    yield f"    meshes: {{{meshes}}}"
    yield f"    centre_distance: {Quantity(round(candidate.own.centre_distance, SHIFT_DIGITS), 'mm')}"
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


@dataclass(frozen=True)
class CandidateRow:
    """A set that can be assembled."""

    of: Candidate
    family: Family

    teeth = Computed(Shows("{key}"), lambda own: {own.family.order: teeth_text(own.of.own.teeth)})
    ratio = Computed(Shows("ratio", ".6g"), lambda own: own.of.ratio)
    centre_distance = Computed(Shows("a", ".4f", "mm"), lambda own: own.of.own.centre_distance)
    forward = Computed(Shows("forward", ".3f", "%"), lambda own: _driven(own.of.forward))
    backward = Computed(Shows("backward", ".3f", "%"), lambda own: _driven(own.of.backward))
    planet_gap = Computed(Shows("planet gap", ".3f", "mm"), lambda own: own.of.own.planet_gap(own.of.task.planets))
    shifts = Computed(
        Shows("x {key}", ".3f", optional=True),
        lambda own: dict(zip(own.family.order.split("/"), in_order(own.of.own.teeth, own.of.own.shifts), strict=True)),
    )


def candidate_table(found: Found, family: Family) -> Table:
    """A row for each candidate."""
    return declared_table("", [(str(k), CandidateRow(own, family)) for k, own in enumerate(found.candidates, 1)])


def _driven(value: float) -> float | str:
    return value if value > 0.0 else LOCKS_ITSELF


@dataclass(frozen=True)
class MeshColumn:
    """A mesh of a candidate."""

    of: WorkingMesh
    friction: float

    teeth = Computed(Shows("teeth of the central gear", "d"), lambda own: own.of.mesh.teeth)
    planet_teeth = Computed(Shows("teeth of the planet", "d"), lambda own: own.of.mesh.planet_teeth)
    shift = Computed(Shows("profile shift x of the central gear", ".4f"), lambda own: own.of.central_shift)
    planet_shift = Computed(Shows("profile shift x of the planet", ".4f"), lambda own: own.of.planet_shift)
    angle = Computed(Shows("working pressure angle", ".4f", "deg"), lambda own: own.of.working_angle)
    contact_ratio = Computed(Shows("contact ratio", ".4f"), lambda own: own.of.contact_ratio)
    tip = Computed(Shows("tip thickness of the central gear", ".4f", "mm"), lambda own: own.of.tip_thicknesses[0])
    planet_tip = Computed(Shows("tip thickness of the planet", ".4f", "mm"), lambda own: own.of.tip_thicknesses[1])
    clearance = Computed(Shows("least tip clearance", ".4f", "mm"), lambda own: min(own.of.tip_clearances))
    sliding = Computed(Shows("E, published formula", ".5f"), lambda own: sliding_factor(*own.of.contact_ratios))
    shared = Computed(
        Shows("E, equal shares of the load", ".5f"), lambda own: shared_sliding_factor(*own.of.contact_ratios)
    )
    efficiency = Computed(Shows("efficiency, published formula", ".6f"), lambda own: own.by("formula"))
    equal_shares = Computed(Shows("efficiency, equal shares", ".6f"), lambda own: own.by("equal shares"))

    def by(self, kind: Sharing) -> float:
        """Its efficiency by the way in which teeth share the load."""
        return mesh_efficiency(self.of, self.friction, kind)


def mesh_table(candidate: Candidate) -> Table:
    """A column for each mesh of a candidate."""
    names = [f"{mesh.mesh.central} – {step_name(candidate.own.teeth, mesh.mesh.step)}" for mesh in candidate.own.meshes]
    columns = [MeshColumn(mesh, candidate.task.friction) for mesh in candidate.own.meshes]
    return side_by_side("mesh", zip(names, columns, strict=True))


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


def _own_notes(candidate: Candidate) -> Iterator[str]:
    teeth, drive, friction = candidate.own.teeth, candidate.task.drive, candidate.task.friction
    shared = candidate.own.mesh_efficiencies(friction, "equal shares")
    pair = [efficiency(teeth, shared, each) for each in (drive, drive.reversed)]
    yield f"with equal shares of the load: forward {_words(pair[0])}, backward {_words(pair[1])}"
    if len(teeth.meshes) == THREE_MESHES:
        published = published_efficiencies(teeth, MeshEfficiencies(*candidate.own.mesh_efficiencies(friction).values()))
        off = abs(published.forward - candidate.forward)
        if candidate.backward > 0.0:
            off = max(off, abs(published.backward - candidate.backward))
        agree = f"agree within {AGREEMENT:g}" if off <= AGREEMENT else f"are {off:.1e} apart"
        yield f"the published closed form of the set and the equilibrium of its torques {agree}"
    if any(max(mesh.contact_ratios) > 1.0 or min(mesh.contact_ratios) < 0.0 for mesh in candidate.own.meshes):
        yield f"the published E is too large for {_beyond(candidate.own.meshes)}: see docs/planetary.md"


def _words(value: float) -> str:
    return f"{100 * value:.3f} %" if value > 0.0 else LOCKS_ITSELF


def _beyond(meshes: Sequence[WorkingMesh]) -> str:
    """Meshes whose path does not lie within a base pitch on both sides of the pitch point."""
    return " and ".join(
        mesh.mesh.central for mesh in meshes if max(mesh.contact_ratios) > 1.0 or min(mesh.contact_ratios) < 0.0
    )
