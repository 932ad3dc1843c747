"""Tables of an identification, and of a rig's expected accuracy."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.apps.records.findings import Identified
from tol3d.apps.records.pair import ARCSEC, TURN, Specimen
from tol3d.apps.records.planning import RigPlan, row_variance
from tol3d.apps.records.prediction import Figure
from tol3d.apps.records.rig import Rig
from tol3d.apps.records.scene_mesh import SceneMesh
from tol3d.apps.records.summary import UNITS, alone_figures
from tol3d.report import NOTHING, declared_table
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, line, note, page, titled, warning
from tol3d.study.runs import Computed, Shows

WORDS: Final = {
    "e1": "e1, eccentricity of the driver",
    "theta1": "θ1, its phase",
    "e2": "e2, eccentricity of the driven gear",
    "theta2": "θ2, its phase",
    "jc": "constant part of the backlash",
    "j0": "backlash at φ1 = 0",
    "jmin": "least backlash of the long period",
    "jmin at": "  at φ1",
    "jmax": "largest backlash of the long period",
    "jmax at": "  at φ1",
    "jmin eccentric": "least of the eccentricities alone",
    "jmin eccentric at": "  at φ1",
    "jmax eccentric": "largest of the eccentricities alone",
    "jmax eccentric at": "  at φ1",
}
SIGNS: Final = {"um": "µm", "deg": "°", "arcsec": "″"}
PLAN_DIGITS: Final = 3  # significant ones; a half-width known better says nothing


def identified_report(found: Identified, scene_mesh: SceneMesh) -> Page:
    """Figures, encoders, values held as in the scene, residual, warnings."""
    title = _title(found, scene_mesh.scene, scene_mesh.mesh.name)
    blocks: list[PageItem] = [title, *_read_lines(found), BLANK, _figures(found)]
    blocks += [
        *map(note, [*_notes(found), *_held(found, scene_mesh)]),
        *titled("what the fit leaves, by orders of the driver's turn", _orders(found)),
    ]
    return page(*blocks, *map(warning, found.warnings))


def _title(found: Identified, scene: str, mesh: str) -> Line:
    pair = found.pair
    words = f" · {mesh} · z {pair.driver_teeth}/{pair.driven_teeth} · long period {pair.long_period_turns} turns"
    return Line(((scene, "bold"), (words, "bold dim")))


def _read_lines(found: Identified) -> Iterator[Line]:
    for side, passes in found.read.items():
        rows, turns = sum(own.rows for own in passes), max(own.travel for own in passes) / TURN
        shifted = [own.turns for own in found.passes[side] if own.turns]
        moved = f", shifted by {', '.join(map(str, shifted))} turns of the driver" if shifted else ""
        several = f" in {len(passes)} passes" if len(passes) > 1 else ""
        yield line(f"{side} side: {rows} rows{several}, {turns:.2f} turns of the driver{moved}", "dim")


@dataclass(frozen=True)
class FigureRow:
    """A figure by both sides and by each alone; `one` is 1 of its unit."""

    of: Figure
    one: float
    drive_alone: Figure | None = None
    back_alone: Figure | None = None
    both = Computed(Shows("both sides", ".3f", decides=True), lambda own: own.of.value / own.one)
    half_width = Computed(Shows("± 95 %", ".3f"), lambda own: own.of.half_width / own.one)
    drive = Computed(Shows("drive alone", ".3f"), lambda own: own.drive_alone and own.drive_alone.value / own.one)
    back = Computed(Shows("back alone", ".3f"), lambda own: own.back_alone and own.back_alone.value / own.one)


@dataclass(frozen=True)
class OrderRow:
    """Amplitudes that a fit leaves at an order ["]."""

    drive: Annotated[float, Shows("drive", ".3f")]
    back: Annotated[float, Shows("back", ".3f")]
    noise: Annotated[float, Shows("white noise below, 95 %", ".3f")]


def _figures(found: Identified) -> Table:
    drive, back = (alone_figures(own) for own in found.alone.values())
    rows = []
    for name, own in found.figures.items():
        unit, one = UNITS[name]
        row = FigureRow(own, one, drive.get(name), back.get(name))
        rows.append((Row(f"{WORDS[name]} [{SIGNS[unit]}]", (), unit=unit), row))
    others = {f"{name}, once per turn": own for name, own in found.encoders.items()}
    others |= {f"{name}, twice per turn": own for name, own in found.encoders_twice.items()}
    for closing, own in found.closure.items():
        others[f"closure of the {'backlash' if closing == 'backlash' else f'{closing} side'}"] = own
    rows += [(Row(f"{name} [″]", (), unit="arcsec"), FigureRow(own, ARCSEC)) for name, own in others.items()]
    if found.winding is not None:
        rows.append((Row("winding 1/k [″/(N m)]", (), unit="arcsec/(N m)"), FigureRow(found.winding, ARCSEC)))
    return declared_table("", rows)


def _notes(found: Identified) -> Iterator[str]:
    sigma, noise = math.sqrt(found.fit.variance) / ARCSEC, found.teeth.noise / ARCSEC
    teeth = "tooth mesh is fitted along" if found.fit.terms.teeth else "too few rows in a tooth to fit tooth mesh"
    yield f"rows scatter by {sigma:.3f}″ about the fit, by {noise:.3f}″ about their neighbours; {teeth}"
    yield (
        "least, largest and first backlash are as measured: both sides cover the long period"
        if found.whole.covered
        else "least and largest backlash are predicted, with what teeth may do where a side has no rows"
    )
    yield "angles count in each gear's own sense of rotation in the drive run, phases from the encoders' zeros"
    if found.closure:
        turns = found.pair.long_period_turns
        yield f"closure: change from the first quarter turn to that after the long period of {turns} turns, or its last"
    if found.fit.terms.winding:
        yield "backlash extrapolated to zero torque: B(T) = j + T/k"


def _held(found: Identified, scene_mesh: SceneMesh) -> Iterator[str]:
    pair = found.pair
    yield (
        f"held as the scene has it: base radii, axes parallel and {pair.centre_distance:.4f} mm apart, which makes a "
        f"working angle of {math.degrees(pair.working_angle):.3f}°"
    )
    if shafts := scene_mesh.builds.in_bores:
        yield (
            f"{', '.join(shafts)}: in bores, which are held at the means of their tolerances; how far apart they "
            "lie in this unit is read as constant backlash"
        )


def _orders(found: Identified) -> Table:
    sides = found.fit.terms.sides
    rows = []
    for own in found.spectrum.lines:
        values = [*(own.amplitude[side] / ARCSEC for side in sides), max(own.noise.values()) / ARCSEC]
        rows.append((f"{own.order}: {own.words}", OrderRow(*values)))
    return declared_table("[″]", rows)


def plan_report(plans: Sequence[RigPlan], specimen: Specimen, rig: Rig, scene: str) -> Page:
    """Half-widths of the 95 % interval of each figure."""
    blocks: list[PageItem] = [_plan_title(specimen, scene), _rig_line(specimen, rig), BLANK, plan_table(plans)]
    return page(*blocks, *map(note, _plan_notes(plans)))


def plan_table(plans: Sequence[RigPlan]) -> Table:
    """The same as one table."""
    names = next((list(plan.figures) for plan in plans if plan.figures), [])
    headings = [Heading(f"{plan.turns:g} turn{'' if plan.turns == 1 else 's'}") for plan in plans]
    rows = [
        Row("rows, both sides", [Shown(f"{plan.rows}", plan.rows) for plan in plans], unit="1"),
        Row("condition number", [Shown(f"{plan.condition:.3g}", plan.condition) for plan in plans], unit="1"),
    ]
    for name in names:
        unit, one = UNITS.get(name, ("arcsec", ARCSEC))
        words = WORDS.get(name, f"{name}, once per turn")
        cells = [_cell(plan, name, one) for plan in plans]
        rows.append(
            Row(
                f"{words} [±{SIGNS[unit]}]", cells, "bold" if name in ("jmin eccentric", "jmax eccentric") else "", unit
            )
        )
    return Table("half-width of the 95 % interval", headings, rows)


def _cell(plan: RigPlan, name: str, one: float) -> str:
    if name not in plan.figures:
        return NOTHING
    value = plan.figures[name].half_width / one
    return Shown(f"{value:.{PLAN_DIGITS}g}", value)


def _plan_title(specimen: Specimen, scene: str) -> Line:
    pair = specimen.pair
    words = f" · z {pair.driver_teeth}/{pair.driven_teeth} · long period {pair.long_period_turns} turns of the driver"
    return Line(((scene, "bold"), (words, "bold dim")))


def _rig_line(specimen: Specimen, rig: Rig) -> Line:
    row = math.sqrt(row_variance(specimen.pair, rig)) / ARCSEC
    passes = f", {rig.repeats} passes" if rig.repeats > 1 else ""
    text = (
        f"e1 {1e3 * specimen.e1:g} µm, e2 {1e3 * specimen.e2:g} µm; {rig.samples} rows per turn{passes}; "
        f"each encoder scatters by {rig.noise / ARCSEC:g}″ with steps of {rig.resolution / ARCSEC:g}″: {row:.3g}″ a row"
    )
    return line(text, "dim")


def _plan_notes(plans: Sequence[RigPlan]) -> Iterator[str]:
    short = [f"{plan.turns:g}" for plan in plans if not plan.suffices]
    if short:
        words = "turn does" if short == ["1"] else "turns do"
        yield f"{', '.join(short)} {words} not tell the driver's part from the driven gear's: `identify` refuses them"
    yield "both gears' eccentricities, the play and both encoders' errors once and twice per turn are fitted together"
    yield "teeth do not deviate here: what pitches add to the intervals is known when they are measured"
