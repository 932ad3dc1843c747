"""Tooth thickness of every gear as a drawing states it: arc, span and size over pins, nominal and at its limits."""

import math
from collections.abc import Iterator
from dataclasses import replace

from tol3d.errors import GeometryError
from tol3d.gearing.effects import ToothThickness
from tol3d.gearing.model import Model
from tol3d.gears import Gear, InternalGear, SpurGear
from tol3d.gears.tooth_measures import ToothMeasure, pins_of, span_of
from tol3d.report.number import NOTHING, value_cell
from tol3d.report.page import Heading, PageItem, Row, Table, note, titled

MEANING = (
    "span and pins are chosen to touch near the reference circle shifted by x m; their limits are those of the tooth "
    "thickness (the sum of its tolerances), not of the measuring; of an internal gear over spaces and between pins"
)


def drawing_sizes(model: Model) -> list[PageItem]:
    """A table of the shop dimensions of every gear [mm]; nothing without gears."""
    rows = [row for part in model.gears for row in _rows(model, part.name, part.gear)]
    if not rows:
        return []
    headings = [Heading("size", words=True), *map(Heading, ("nominal", "thinnest", "thickest"))]
    return [*titled("tooth thickness on a drawing", Table("[mm]", headings, rows, repeated=1)), note(MEANING)]


def thickness_limits(model: Model, name: str, gear: Gear) -> tuple[float, float]:
    """The least and the largest deviation of a gear's arc at the reference circle [mm]; infinite without limits."""
    low = high = 0.0
    for contributor in model.contributors:
        effect = contributor.effect
        if isinstance(effect, ToothThickness) and effect.part == name:
            arc = 2 * (effect.turn * gear.thickness_radius + effect.offset * gear.thickness_radius / gear.section_arm)
            ends = sorted((arc * contributor.distribution.low, arc * contributor.distribution.high))
            low, high = low + ends[0], high + ends[1]
    return low, high


def _rows(model: Model, name: str, gear: Gear) -> Iterator[Row]:
    deviations = (0.0, *thickness_limits(model, name, gear))
    words = "arc s" if isinstance(gear, SpurGear | InternalGear) else "arc, mean section"
    yield _row(name, words, [gear.section_thickness + own for own in deviations])
    if isinstance(gear, SpurGear | InternalGear):
        for measure in (span_of(gear), pins_of(gear)):
            if measure is not None:
                yield _row("", _words(measure, gear), [_size(measure, gear, own) for own in deviations])


def _words(measure: ToothMeasure, gear: SpurGear | InternalGear) -> str:
    words = measure.words
    if isinstance(gear, InternalGear):
        words = words.replace(" teeth", " spaces").replace("over pins", "between pins")
    return words


def _size(measure: ToothMeasure, gear: SpurGear | InternalGear, deviation: float) -> float | None:
    """Size of a gear whose teeth are so much thicker; None where there is none."""
    if not math.isfinite(deviation):
        return None
    try:
        return measure.size(replace(gear, tooth_thickness_deviation=gear.tooth_thickness_deviation + deviation))
    except GeometryError:
        return None


def _row(label: str, words: str, sizes: list[float | None] | list[float]) -> Row:
    known = [None if own is None or not math.isfinite(own) else own for own in sizes]
    return Row(label, (words, *(value_cell(own, "mm") if own is not None else NOTHING for own in known)), unit="mm")
