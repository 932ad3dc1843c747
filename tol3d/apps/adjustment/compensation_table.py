"""The motor's correction as tables: its size, the remaining error, sums of the stages' highs, working flanks."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.apps.adjustment.compensation import Compensation, Correction, Swing, Unit
from tol3d.apps.adjustment.robots import STATES, State
from tol3d.gearing import CLOSED_FORM
from tol3d.gears import LEFT, Flank
from tol3d.numerics.arrays import Array
from tol3d.report import NOTHING, given_text, tip_mm, value_text
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Table, line, note, page
from tol3d.statistics.distributions import HIGH_PROBABILITY, LOW_PROBABILITY
from tol3d.statistics.estimates import Moments


@dataclass(frozen=True, eq=False)
class Spread:
    """A sample's values, (n,), in any unit; a number that it has none of is nan."""

    values: Array

    @cached_property
    def moments(self) -> Moments:
        """Count, mean, sigma, extremes and standard errors."""
        return Moments.of(self.values)

    @property
    def low(self) -> float:
        """Mean - 3 sigma."""
        return self.moments.mean - 3 * self.moments.sigma

    @property
    def high(self) -> float:
        """Mean + 3 sigma."""
        return self.moments.mean + 3 * self.moments.sigma

    @property
    def ends_se(self) -> float:
        """Standard error of low and of high, as of independent mean and sigma."""
        return math.hypot(self.moments.mean_se, 3 * self.moments.sigma_se)

    @cached_property
    def quantiles(self) -> tuple[float, float, float]:
        """The 0.135 %, 50 % and 99.865 % quantiles of the sample, between its neighbours."""
        if not len(self.values):
            return math.nan, math.nan, math.nan
        low, middle, high = np.quantile(self.values, (LOW_PROBABILITY, 0.5, HIGH_PROBABILITY))
        return float(low), float(middle), float(high)

    @property
    def largest_error(self) -> float:
        """The largest of the values without their sign."""
        return max(abs(self.moments.minimum), abs(self.moments.maximum)) if len(self.values) else math.nan


COLUMN_WORDS: Final[Mapping[str, str]] = {"analytic": "analytic, same trials", "geometric": "3D simulation"}
STATE_WORDS: Final[Mapping[State, str]] = {
    "before": "not compensated",
    "batch": "less the batch's mean",
    "robot": "less the robot's own mean",
}
TOLD_OF_TIPS: Final[Mapping[str, str]] = {"mean": "mean", "low_3sigma": "low", "high_3sigma": "high"}
UNIT_WORDS: Final[Mapping[Unit, str]] = {"mm": "at the tip", "arcmin": "at the output"}
HIGHS: Final[Mapping[str, Callable[[Correction], float | None]]] = {
    "not compensated": lambda correction: correction.before,
    "compensated": lambda correction: correction.left,
}
TAKEN: Final[Mapping[str, tuple[Callable[[Spread], float], Callable[[Spread], float | None]]]] = {
    "mean": (lambda spread: spread.moments.mean, lambda spread: spread.moments.mean_se),
    "sigma": (lambda spread: spread.moments.sigma, lambda spread: spread.moments.sigma_se),
    "mean − 3 sigma": (lambda spread: spread.low, lambda spread: spread.ends_se),
    "mean + 3 sigma": (lambda spread: spread.high, lambda spread: spread.ends_se),
    "0.135 % quantile": (lambda spread: spread.quantiles[0], lambda spread: None),
    "50 % quantile": (lambda spread: spread.quantiles[1], lambda spread: None),
    "99.865 % quantile": (lambda spread: spread.quantiles[2], lambda spread: None),
    "smallest": (lambda spread: spread.moments.minimum, lambda spread: None),
    "largest": (lambda spread: spread.moments.maximum, lambda spread: None),
    "largest, without its sign": (lambda spread: spread.largest_error, lambda spread: None),
}
"""Statistic shown of a sample, and its standard error."""

LEFT_NOTES: Final = (
    "positive where the motor has turned too little; ±: one standard error, of robots that are drawn anew",
    "closed form of the last: what turns with gears, and the error of a mean of so many positions",
)
SWING_MEANS: Final = "mean error at the first position behind it; a flank of the driver pushes the driven gear"
ARCMIN_PER_DEG: Final = 60.0


def compensation_report(found: Sequence[Compensation]) -> Page:
    """All of it, a column a scene."""
    blocks: list[PageItem] = []
    for own in found:
        blocks += [_title(own), line(_words(own), "dim")]
    blocks += [*_section("Δφ_c, the turn of the motor that makes good for the lost motion"), corrections_table(found)]
    blocks += [note(text) for text in _correction_notes(found)]
    for unit, words in UNIT_WORDS.items():
        shown = [own for own in found if unit in own.units]
        if shown:
            blocks += [
                *_section(f"what is left {words} at a random position, {_methods(shown)}"),
                left_table(shown, unit),
            ]
    blocks += [note(text) for text in LEFT_NOTES]
    blocks += [*_section("sum of highs: every stage at its mean + 3 sigma, less its mean where that is compensated")]
    blocks += [highs_table(found), *(note(text) for text in _highs_notes(found))]
    swings = [own for own in found if own.swing]
    if swings:
        blocks += [*_section("where the load changes side over the swing"), swing_table(swings), note(SWING_MEANS)]
    return page(*blocks)


def _title(compensation: Compensation) -> Line:
    text = f" · {compensation.play.train.name}: the motor's compensation when the load changes side"
    return Line(((compensation.name, "bold"), (text, "")))


def _words(compensation: Compensation) -> str:
    failed = f", {compensation.failed} of them could not be assembled and are left out" if compensation.failed else ""
    return (
        f"{compensation.robots} robots{failed}, seed {compensation.play.simulation.study.seed}; "
        f"each robot's own mean at {compensation.positions} positions "
        "of its long period, its error at another one"
    )


def _section(text: str) -> tuple[Line, Line]:
    return BLANK, line(text, "bold cyan")


def _methods(found: Sequence[Compensation]) -> str:
    return " and ".join(dict.fromkeys(COLUMN_WORDS[own.method] for own in found))


def _columns(found: Sequence[Compensation]) -> list[str]:
    """Every source of a correction: closed form, methods, and who published."""
    first = [CLOSED_FORM, *COLUMN_WORDS]
    known = dict.fromkeys(column for own in found for column in own.corrections)
    return [*(column for column in first if column in known), *(column for column in known if column not in first)]


def _headings(found: Sequence[Compensation]) -> list[Heading]:
    return [Heading(own.name, "bold") for own in found]


# the motor's correction ---------------------------------------------------------------------------


def corrections_table(found: Sequence[Compensation]) -> Table:
    """A block of rows for each method and publisher: the motor's turn, and from which means."""
    rows = []
    for column in _columns(found):
        known = [own.corrections.get(column) for own in found]
        rows.append(Row(COLUMN_WORDS.get(column, column), [_degrees(own) for own in known], "bold"))
        for link in dict.fromkeys(link for own in known if own for link in own.means):
            rows.append(Row(f"  from {link}", [_angle(own.means.get(link) if own else None) for own in known]))
    return Table("Δφ_c", _headings(found), rows)


def _degrees(own: Correction | None) -> str:
    return NOTHING if own is None or own.motor is None else f"{own.motor / ARCMIN_PER_DEG:.2f}°"


def _angle(arcmin: float | None) -> str:
    return value_text(arcmin, "arcmin")


def _correction_notes(found: Sequence[Compensation]) -> Iterator[str]:
    yield "from: a stage's own mean at its driven shaft, which counts by the turns of the motor to one of that shaft"
    left_out = dict.fromkeys(stage.link for own in found for stage in own.left_out)
    if left_out:
        yield f"left out, for only their maximum is known: {', '.join(left_out)}"
    drawn = dict.fromkeys(stage.link for own in found for stage in own.compensated if stage.backlash is None)
    if drawn:
        yield f"reducers with a distribution, compensated like meshes: {', '.join(drawn)}"


# what is left -------------------------------------------------------------------------------------


def left_table(found: Sequence[Compensation], unit: Unit) -> Table:
    """A block of rows each: without the correction, less the batch's mean, less the robot's own."""
    rows = []
    for state in STATES:
        spreads = [Spread(own.remaining[own.method].in_unit(unit)[state]) for own in found]
        rows.append(Row(STATE_WORDS[state], [""] * len(found), "bold"))
        for label, (value, error) in TAKEN.items():
            rows.append(Row(f"  {label}", [_with_error(value(spread), error(spread), unit) for spread in spreads]))
        rows.append(Row("  sigma, closed form", [value_text(_form_sigma(own, state, unit), unit) for own in found]))
    return Table("[mm]" if unit == "mm" else "[′, ″ of arc]", _headings(found), rows)


def _with_error(value: float, error: float | None, unit: Unit) -> str:
    text = value_text(None if math.isnan(value) else value, unit)
    return text if error is None or math.isnan(error) else f"{text} ±{value_text(error, unit)}"


def _form_sigma(compensation: Compensation, state: State, unit: Unit) -> float | None:
    sigma = compensation.form_sigmas.get(state)
    return tip_mm(sigma, compensation.lever) if unit == "mm" else sigma


# sums of highs ------------------------------------------------------------------------------------


def highs_table(found: Sequence[Compensation]) -> Table:
    """A block of rows for each method and publisher: sums of the stages' highs, before and after."""
    rows = []
    for column in _columns(found):
        known = [own.corrections.get(column) for own in found]
        rows.append(Row(COLUMN_WORDS.get(column, column), [""] * len(found), "bold"))
        for word, take in HIGHS.items():
            values = [take(own) if own else None for own in known]
            tips = [tip_mm(value, own.lever) for value, own in zip(values, found, strict=True)]
            rows.append(Row(f"  {word}", [_angle(value) for value in values]))
            if any(tip is not None for tip in tips):
                rows.append(Row("  – of the tip [mm]", [value_text(tip, "mm") for tip in tips]))
        for link in dict.fromkeys(link for own in known if own for link in own.left_of):
            left = [own.left_of.get(link) if own else None for own in known]
            rows.append(Row(f"  – of {link}, at its driven shaft", [_angle(value) for value in left]))
    rows += _published_rows(found)
    return Table("sum at the output", _headings(found), rows)


def _published_rows(found: Sequence[Compensation]) -> Iterator[Row]:
    tips = [own.play.published_tips for own in found]
    for column in dict.fromkeys(column for tip in tips for column in tip):
        for key, word in TOLD_OF_TIPS.items():
            values = [tip.get(column, {}).get(key) for tip in tips]
            if any(value is not None for value in values):
                cells = [given_text(value, "mm") if value is not None else NOTHING for value in values]
                yield Row(f"{column}: {word} of the tip, not compensated [mm]", cells, "green")


def _highs_notes(found: Sequence[Compensation]) -> Iterator[str]:
    yield (
        "a sum of highs is no distribution: nearly no robot is as bad at all of its stages at once; and no worst case: "
        "a robot with every deviation at its limit may exceed it"
    )
    left_out = dict.fromkeys(stage.link for own in found for stage in own.left_out)
    if left_out:
        yield f"what is left holds the whole maximum of {', '.join(left_out)}"


# the swing ----------------------------------------------------------------------------------------


def swing_table(found: Sequence[Compensation]) -> Table:
    """Positions where the load changes side, the working flanks before and after, and the tip's jump there."""
    rows = [Row("at the output's angle", [_jumps(own.swing) for own in found if own.swing])]
    for link in dict.fromkeys(link for own in found if own.swing for link in own.swing.flanks):
        flanks = [own.swing.flanks.get(link) for own in found if own.swing]
        rows.append(
            Row(f"{link}: flank of the driver{_which_change(found)}", [_flanks_text(flank) for flank in flanks])
        )
    for state in STATES:
        jumps = [_jump(own.swing, own.method, state) for own in found if own.swing]
        rows.append(Row(f"jump, {STATE_WORDS[state]} [mm]", [value_text(jump, "mm") for jump in jumps]))
    return Table("", _headings(found), rows)


def _which_change(found: Sequence[Compensation]) -> str:
    """Change of side at which the flanks are listed, if a swing has several."""
    counts = {len(own.swing.jumps) for own in found if own.swing}
    if max(counts) == 1:
        return ""
    return f" at the first of {counts.pop()} changes" if len(counts) == 1 else " at the first change"


def _jumps(swing: Swing) -> str:
    return ", ".join(f"{math.degrees(angle):.2f}°" for angle in swing.jumps)


def _flanks_text(flanks: tuple[Flank, Flank] | None) -> str:
    return NOTHING if flanks is None else " → ".join("left" if flank == LEFT else "right" for flank in flanks)


def _jump(swing: Swing, method: str, state: State) -> float | None:
    curve = swing.curves[method][state]
    return float(curve[:, swing.first_turned].mean()) if len(curve) else None
