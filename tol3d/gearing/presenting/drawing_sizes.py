"""Tooth thickness and backlash as drawings state them: arc, span and size over pins; j_bn, j_wt, j_t and j_r."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Final

from tol3d.errors import GeometryError
from tol3d.gearing.effects import ToothThickness
from tol3d.gearing.model import Model
from tol3d.gearing.summary.types import BacklashLimits
from tol3d.gears import Gear, InternalGear, SpurGear
from tol3d.gears.tooth_measures import OverBalls, Span, ToothMeasure, pins_of, span_of
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, Row, note, titled
from tol3d.statistics.distributions import DeviationLaw
from tol3d.study.runs.summary.shows import Shows

MEANING = (
    "E_sni and E_sns (A_sni and A_sne of DIN 3967): allowances of the arc, the sum of its tolerances; span and pins "
    "are those of the scene, or chosen to touch near the reference circle shifted by x m; their limits follow from the "
    "allowances, without errors of measurement; for an internal gear over spaces and between pins"
)
ALLOWANCES: Final = "E_sni, E_sns (A_sni, A_sne)"
BACKLASH_MEANING: Final = (
    "j_bn normal, j_wt and j_t as arcs on the working circles (of the nominal centre distance) and the reference "
    "circles, j_r radial. theoretical: by thickness and centre distance; acceptance: by all tolerances but "
    "temperature; operating: by all. least, largest: the worst of a search among builds within the tolerances, at "
    "rest, of gears in a housing by the analytic method; mean ∓ 3 σ: by the analytic method at any position, with "
    "stated correlations, no further than these; of a planetary set one planet's meshes as pairs, at the distance of "
    "its pin"
)


@dataclass(frozen=True)
class Thickness:
    """A tolerance of a gear's thickness.

    Args:
        law: of its deviation.
        arc: what that counts for at the reference circle.
        over: how the teeth are measured, where the scene says so.
    """

    law: DeviationLaw
    arc: float = 1.0
    over: ToothMeasure | None = None

    @property
    def limits(self) -> tuple[float, float]:
        """Limits of the arc [mm]."""
        low, high = sorted((self.arc * self.law.low, self.arc * self.law.high))
        return low, high


def drawing_sizes(model: Model) -> list[PageItem]:
    """A table of what shops measure of every gear [mm]; nothing where there are no gears."""
    return sizes_table({gear.name: gear.gear for gear in model.gears}, _thicknesses(model))


def _thicknesses(model: Model) -> Iterator[tuple[str, Thickness]]:
    for contributor in model.contributors:
        effect = contributor.effect
        if isinstance(effect, ToothThickness):
            gear = model.gear(effect.part).gear
            arc = 2 * (effect.turn * gear.thickness_radius + effect.offset * gear.thickness_radius / gear.section_arm)
            yield effect.part, Thickness(contributor.distribution, arc, effect.over)


@dataclass(frozen=True)
class SizeRow:
    """A size of a gear's teeth as shops measure it, nominal and at the limits of their thickness [mm]."""

    size: Annotated[str, Shows("size", "words")]
    nominal: Annotated[float | None, Shows("nominal", "mm")]
    thinnest: Annotated[float | None, Shows("thinnest", "mm")]
    thickest: Annotated[float | None, Shows("thickest", "mm")]


def sizes_table(gears: Mapping[str, Gear], tolerances: Iterable[tuple[str, Thickness]]) -> list[PageItem]:
    """A table of what shops measure of gears [mm].

    Args:
        gears: nominal, by name.
        tolerances: of their thickness, each with the name of its gear.
    """
    stated = list(tolerances)
    rows = [row for name, gear in gears.items() for row in _rows(name, gear, [own for of, own in stated if of == name])]
    if not rows:
        return []
    table = replace(declared_table("[mm]", rows), repeated=1)
    return [*titled("tooth thickness on a drawing", table), note(MEANING)]


def _rows(name: str, gear: Gear, stated: Sequence[Thickness]) -> Iterator[tuple[Row, SizeRow]]:
    limits = [own.limits for own in stated]
    deviations = (0.0, sum(low for low, _ in limits), sum(high for _, high in limits))
    words = "arc s" if isinstance(gear, SpurGear | InternalGear) else "arc, mean section"
    if isinstance(gear, SpurGear | InternalGear) and gear.helix_angle:
        words = "arc s_n, normal section"
    yield _row(name, words, [gear.section_thickness + deviation for deviation in deviations])
    if isinstance(gear, SpurGear | InternalGear):
        yield _row("", ALLOWANCES, deviations)
        for measure in _measures(gear, [own.over for own in stated if own.over is not None]):
            yield _row("", _words(measure, gear), [_size(measure, gear, deviation) for deviation in deviations])


def _measures(gear: SpurGear | InternalGear, stated: Sequence[ToothMeasure]) -> Iterable[ToothMeasure]:
    """Spans, then pins: those of the scene, or what would do."""
    spans: list[ToothMeasure | None] = [own for own in stated if isinstance(own, Span)]
    pins: list[ToothMeasure | None] = [own for own in stated if not isinstance(own, Span)]
    found = [*(spans or [span_of(gear)]), *(pins or _chosen_pins(gear))]
    return dict.fromkeys(own for own in found if own is not None)


def _chosen_pins(gear: SpurGear | InternalGear) -> Iterator[ToothMeasure | None]:
    """Pins, and balls where they give another size, over an odd number of helical teeth, or pins need a wider face."""
    yield (pins := pins_of(gear))
    balls = pins_of(gear, OverBalls) if pins is None else OverBalls(pins.diameter)
    if balls is not None and (pins is None or balls.opposite(gear) != pins.opposite(gear)):
        yield balls


def _words(measure: ToothMeasure, gear: SpurGear | InternalGear) -> str:
    words = measure.words.replace("span", "span W_k").replace("size", "size M_dK")
    if isinstance(gear, InternalGear):
        words = (
            words.replace(" teeth", " spaces")
            .replace("over pins", "between pins")
            .replace("over balls", "between balls")
        )
    return words


def _size(measure: ToothMeasure, gear: SpurGear | InternalGear, deviation: float) -> float | None:
    """Size of a gear whose teeth are so much thicker; None where there is none."""
    if not math.isfinite(deviation):
        return None
    try:
        return measure.size(replace(gear, tooth_thickness_deviation=gear.tooth_thickness_deviation + deviation))
    except GeometryError:
        return None


def _row(label: str, words: str, sizes: Iterable[float | None]) -> tuple[Row, SizeRow]:
    return Row(label, (), unit="mm"), SizeRow(words, *(size if math.isfinite(size or 0.0) else None for size in sizes))


def backlash_table(limits: Sequence[BacklashLimits]) -> list[PageItem]:
    """A row for each mesh, stage and word of backlash; nothing without limits."""
    if not limits:
        return []
    table = declared_table("", [(Row(own.mesh, (), unit="um"), own) for own in limits])
    return [*titled("backlash as drawings state it", replace(table, repeated=1)), note(BACKLASH_MEANING)]
