"""Coefficients of a scene's contributors in its measures as tables, one for all measures that have the same."""

from collections.abc import Sequence

from tol3d.gearing.model import Backlash, Measure, Model
from tol3d.gearing.slopes.coefficients import DISAGREES, ONE_SIDED, Coefficient, coefficients_by_value, of_one_value
from tol3d.report.number import degrees_text, percent_cell
from tol3d.report.page import Heading, PageItem, Row, Table, line, titled

OTHER = "≠"
AT_ONE_POSITION = "of the value at a random position; run gives those of what is taken of all positions"
NO_SUM = "the tighter load path counts, which is no sum; run gives the shares of its trials"


def coefficients_tables(model: Model) -> list[PageItem]:
    """A table for all measures with the same coefficients, and the meaning of its signs."""
    names: dict[Measure, list[str]] = {}
    for measure in model.measures:
        names.setdefault(of_one_value(measure), []).append(measure.name)
    headings = [Heading(word) for word in ("unit", "stack-up", "3D", "share [%]")]
    found = coefficients_by_value(model)
    tables = [
        block
        for measure, rows in found.items()
        if rows
        for block in titled(
            f"{', '.join(names[measure])}: change by each deviation, {_where(model, measure)}",
            Table("", headings, [_row(own) for own in rows]),
        )
    ]
    formless = [name for measure, of in names.items() if not measure.kind.adds_up for name in of]
    shown = {name for measure, of in names.items() if found[measure] and measure.kind.adds_up for name in of}
    elsewhere = [own.name for own in model.measures if own.take != "value" and own.name in shown]
    return [*tables, *(line(f" {note}", "dim") for note in _notes(model, formless, elsewhere))]


def _row(own: Coefficient) -> Row:
    geometry = f"{OTHER} {own.geometry}" if own.disagrees else str(own.geometry)
    return Row(own.name, (own.unit, str(own.stack_up), geometry, percent_cell(own.percent)))


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
