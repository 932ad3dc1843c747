"""A candidate as a scene to start from: its gears, their shifts, the set as a move, its lost motion as the measure."""

import math
from collections.abc import Iterator
from typing import Final

from tol3d.planetary.design.families import Family
from tol3d.planetary.design.search import Candidate, teeth_text
from tol3d.planetary.design.shifted_set import step_name
from tol3d.planetary.tooth_set import CARRIER
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
