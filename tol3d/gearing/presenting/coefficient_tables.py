"""Coefficients of a scene's contributors in its measures as tables, one for all measures that have the same."""

import math
from collections.abc import Sequence

from tol3d.gearing.model import Backlash, Measure, Model
from tol3d.gearing.slopes.coefficients import (
    DISAGREES,
    ONE_SIDED,
    Coefficient,
    Slopes,
    coefficients_by_value,
    of_one_value,
)
from tol3d.report.declared import declared_table
from tol3d.report.number import degrees_text
from tol3d.report.page import PageItem, Shown, line, titled
from tol3d.study.runs.summary.shows import Computed, RowOf, Shows

OTHER = "≠"
AT_ONE_POSITION = "of the value at a random position; run gives those of what is taken of all positions"
NO_SUM = "the tighter load path counts, which is no sum; run gives the shares of its trials"


class CoefficientRow(RowOf[Coefficient]):
    """A coefficient by both methods."""

    unit_sign = Computed(Shows("unit"), lambda own: own.of.unit)
    stack_up = Computed(Shows("stack-up"), lambda own: _cell(own.of.stack_up))
    geometry = Computed(Shows("3D"), lambda own: _cell(own.of.geometry, f"{OTHER} " if own.of.disagrees else ""))
    share = Computed(Shows("share [%]", ".1f"), lambda own: own.of.percent)


def _cell(slopes: Slopes, before: str = "") -> str:
    """Slopes as a cell, with their number where they are one."""
    one = not math.isnan(slopes.below + slopes.above) and not slopes.bends
    return Shown(f"{before}{slopes}", (slopes.below + slopes.above) / 2) if one else f"{before}{slopes}"


def coefficients_tables(model: Model) -> list[PageItem]:
    """A table for all measures with the same coefficients, and the meaning of its signs."""
    names: dict[Measure, list[str]] = {}
    for measure in model.measures:
        names.setdefault(of_one_value(measure), []).append(measure.name)
    found = coefficients_by_value(model)
    tables = [
        block
        for measure, rows in found.items()
        if rows
        for block in titled(
            f"{', '.join(names[measure])}: change by each deviation, {_where(model, measure)}",
            declared_table("", [(row.name, CoefficientRow(row)) for row in rows]),
        )
    ]
    formless = [name for measure, of in names.items() if not measure.kind.adds_up for name in of]
    shown = {name for measure, of in names.items() if found[measure] and measure.kind.adds_up for name in of}
    elsewhere = [own.name for own in model.measures if own.take != "value" and own.name in shown]
    return [*tables, *(line(f" {note}", "dim") for note in _notes(model, formless, elsewhere))]


def _where(model: Model, measure: Measure) -> str:
    """The position to which coefficients belong."""
    of_driver = measure.positions.over == "at" and isinstance(measure.kind, Backlash)
    alone = len(model.layout.links) == len(model.layout.drives)
    what = "driver" if of_driver or alone else "first shaft"
    return f"{what} at {degrees_text(measure.positions.angle)}°"


def _notes(model: Model, formless: Sequence[str], elsewhere: Sequence[str]) -> list[str]:
    """Below the tables, of measures without shares and of those whose shares are of one position."""
    notes = [
        "stack-up and 3D: at the mean build, per unit of the deviation; for a length with a direction, in its worst "
        "direction; a/b: below and above the mean, where they differ; "
        f"{OTHER}: the geometry disagrees by more than {100 * DISAGREES:g} %"
    ]
    tilts = [c.name for c in model.contributors if c.kind in ONE_SIDED]
    if tilts:
        more = "; of two that cross only the larger counts" if len(tilts) > 1 else ""
        notes.append(f"{', '.join(tilts)}: a tilt closes the gap whichever way it goes{more}")
    if formless:
        notes.append(f"no shares of {', '.join(formless)}: {NO_SUM}")
    if elsewhere:
        notes.append(f"shares of {', '.join(elsewhere)}: {AT_ONE_POSITION}")
    return notes
