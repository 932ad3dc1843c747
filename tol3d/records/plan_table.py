"""How well a rig would identify, as a table over its turns."""

import math
from collections.abc import Iterator, Sequence
from typing import Final

from tol3d.records.identified_table import SIGNS, WORDS
from tol3d.records.pair import ARCSEC, Specimen
from tol3d.records.planning import RigPlan, row_variance
from tol3d.records.rig import Rig
from tol3d.records.summary import UNITS
from tol3d.report.number import NOTHING
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, line, note, page

DIGITS: Final = 3  # significant ones; a half-width known better says nothing


def plan_report(plans: Sequence[RigPlan], specimen: Specimen, rig: Rig, scene: str) -> Page:
    """Half-widths of the 95 % interval of each figure."""
    blocks: list[PageItem] = [_title(specimen, scene), _rig_line(specimen, rig), BLANK, plan_table(plans)]
    return page(*blocks, *map(note, _notes(plans)))


def plan_table(plans: Sequence[RigPlan]) -> Table:
    """The same as one table."""
    names = next((list(own.figures) for own in plans if own.figures), [])
    headings = [Heading(f"{own.turns:g} turn{'' if own.turns == 1 else 's'}") for own in plans]
    rows = [
        Row("rows, both sides", [Shown(f"{own.rows}", own.rows) for own in plans], unit="1"),
        Row("condition number", [Shown(f"{own.condition:.3g}", own.condition) for own in plans], unit="1"),
    ]
    for name in names:
        unit, one = UNITS.get(name, ("arcsec", ARCSEC))
        words = WORDS.get(name, f"{name}, once per turn")
        cells = [_cell(own, name, one) for own in plans]
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
    return Shown(f"{value:.{DIGITS}g}", value)


def _title(specimen: Specimen, scene: str) -> Line:
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


def _notes(plans: Sequence[RigPlan]) -> Iterator[str]:
    short = [f"{own.turns:g}" for own in plans if not own.suffices]
    if short:
        words = "turn does" if short == ["1"] else "turns do"
        yield f"{', '.join(short)} {words} not tell the driver's part from the driven gear's: `identify` refuses them"
    yield "both gears' eccentricities, the play and both encoders' errors once and twice per turn are fitted together"
    yield "teeth do not deviate here: what pitches add to the intervals is known when they are measured"
