"""What a scene means, as tables: gears, meshes, measures, contributors and their coefficients, before any trial."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from rich.console import Group, RenderableType
from rich.text import Text

from tol3d.analytic import ClosedForm, reference_form
from tol3d.engines import Engine
from tol3d.engines.exact import ExactEngine
from tol3d.gears import RIGHT, BevelGear, BevelPair, Gear, GearPair, SpurGear, SpurPair
from tol3d.model import Backlash, Contributor, Measure, Model, Planar, Positions
from tol3d.model.measure import at_one_position
from tol3d.report.heading import QUANTITY_WORDS, TAKE_WORDS, reading_words
from tol3d.report.number import NOTHING, UNIT_SIGNS, given_text, percent_text, unsigned_zero, value_text
from tol3d.report.sheet import Heading, Row, Sheet
from tol3d.report.trains.check import train_blocks
from tol3d.sensitivity import STEP_ASIDE, mean_slopes
from tol3d.units import angle_text

UM = 1000.0  # um in a mm
ARCSEC = 648000 / math.pi  # arcsec in a rad
ONE_SIDED = ("axis_in_plane", "axis_out_of_plane")  # kinds whose coefficient acts by absolute value
LEAST_SLOPE = 5e-4  # um or arcsec per unit; what rounds to 0.000 is nothing
DISAGREES = 0.05  # of the largest slope; beyond that a coefficient of the geometry is marked
OTHER = "≠"
NO_SUM = (
    "not a sum (the tighter way counts, or a tilted face touches at one end); run tells the analytic values trial by "
    "trial"
)
KINK = 0.01  # of the larger slope; two sides that differ by less are one


def check_report(model: Model) -> Group:
    """Everything that a scene says, with what follows from it; nothing is drawn at random."""
    blocks: list[RenderableType] = [Text(model.name, style="bold"), gears_table(model)]
    if model.housings:
        blocks.append(housings_line(model))
    blocks += [meshes_table(model), *train_blocks(model), measures_table(model)]
    if model.contributors:
        blocks.append(contributors_table(model))
    study = model.study
    blocks.append(
        Text(
            f"\nstudy: {study.trials} trials, seed {study.seed}, {study.sampler}, engine {study.engine}, "
            f"{study.profile_steps} profile steps a flank"
        )
    )
    blocks += [Text(f"warning: {warning}", style="yellow") for warning in model.warnings]
    return Group(*blocks)


def _titled(title: str, sheet: Sheet) -> Group:
    return Group(Text(f"\n{title}", style="bold cyan"), sheet)


def _side_by_side(title: str, names: Sequence[str], rows: Mapping[str, Sequence[str]]) -> Group:
    """A column for each name."""
    headings = [Heading(name) for name in names]
    return _titled(title, Sheet("", headings, [Row(label, cells) for label, cells in rows.items()]))


def gears_table(model: Model) -> Group:
    """The gears side by side, lengths in mm."""
    rows = [gear_rows(part.gear) for part in model.gears]
    expansions = [f"{1e6 * part.expansion:g}" if part.expansion else NOTHING for part in model.gears]
    return _side_by_side(
        "parts", [part.name for part in model.gears], _merged(rows) | {"expansion [10⁻⁶/K]": expansions}
    )


def _merged(columns: Sequence[Mapping[str, str]]) -> dict[str, list[str]]:
    """Rows that some column has, in the columns' order; what another kind does not have is NOTHING."""
    labels = dict.fromkeys(label for column in columns for label in column)
    return {label: [column.get(label, NOTHING) for column in columns] for label in labels}


@singledispatch
def gear_rows(gear: Gear) -> dict[str, str]:
    """What a gear is, by label; one function a kind."""
    raise TypeError(f"check.py has no function for {type(gear).__name__}")


@gear_rows.register
def _(gear: SpurGear) -> dict[str, str]:
    return {
        "teeth z": str(gear.teeth),
        "module m [mm]": f"{gear.module:g}",
        "pressure angle α [°]": _degrees(gear.pressure_angle),
        "face width b [mm]": f"{gear.face_width:g}",
        "profile shift x": f"{gear.profile_shift:g}",
        "addendum, dedendum [m]": f"{gear.addendum:g}, {gear.dedendum:g}",
        "reference diameter d [mm]": f"{gear.reference_diameter:.4f}",
        "tip diameter d_a [mm]": f"{gear.tip_diameter:.4f}",
        "base diameter d_b [mm]": f"{gear.base_diameter:.4f}",
        "root diameter d_f [mm]": f"{gear.root_diameter:.4f}",
        "involute from diameter [mm]": f"{2 * gear.form_radius:.4f}",
        "root fillet [mm]": f"{gear.fillet_radius:.4f}",
        "tooth thickness s [mm]": f"{gear.tooth_thickness:.4f}",
        "thickness at the tip s_a [mm]": f"{gear.tip_thickness:.4f}",
        "bore [mm]": f"{gear.bore:g}" if gear.bore else NOTHING,
    }


@gear_rows.register
def _(gear: BevelGear) -> dict[str, str]:
    cones = {"pitch": gear.pitch_angle, "tip": gear.tip_angle, "base": gear.base_angle, "root": gear.root_angle}
    distances = (gear.outer_cone_distance, gear.mean_cone_distance, gear.inner_cone_distance)
    return {
        "teeth z": str(gear.teeth),
        "module m [mm]": f"{gear.module:g}",
        "pressure angle α [°]": _degrees(gear.pressure_angle),
        "face width b [mm]": f"{gear.face_width:g}",
        "profile shift x": f"{gear.profile_shift:g}",
        "addendum, dedendum [m]": f"{gear.addendum:g}, {gear.dedendum:g}",
        **{f"{name} angle [°]": f"{math.degrees(angle):.4f}" for name, angle in cones.items()},
        "cone distance, outer, mean, inner [mm]": ", ".join(f"{distance:.4f}" for distance in distances),
        "reference diameter, outer d_e [mm]": f"{gear.reference_diameter:.4f}",
        "reference diameter, mean d_m [mm]": f"{2 * gear.mean_radius:.4f}",
        "tip diameter, outer d_ae [mm]": f"{gear.tip_diameter:.4f}",
        "tooth thickness, outer s [mm]": f"{gear.tooth_thickness:.4f}",
        "tooth thickness, mean s_m [mm]": f"{gear.mean_tooth_thickness:.4f}",
        "thickness at the tip, outer [mm]": f"{gear.tip_thickness:.4f}",
        "bore [mm]": f"{gear.bore:g}" if gear.bore else NOTHING,
    }


def housings_line(model: Model) -> Text:
    """Housings and their expansion."""
    words = [f"{part.name} ({1e6 * part.expansion:g}·10⁻⁶/K)" for part in model.housings]
    return Text(f"housing: {', '.join(words)}")


def meshes_table(model: Model) -> Group:
    """The moves, with what the nominal pair gives."""
    rows: Mapping[str, list[str]] = {
        "driver → driven": [f"{mesh.driver} → {mesh.driven}" for mesh in model.meshes],
        "driver's working flank": ["right" if mesh.working_flank == RIGHT else "left" for mesh in model.meshes],
        "housing": [mesh.housing or NOTHING for mesh in model.meshes],
    }
    pairs = _merged([pair_rows(mesh.pair) for mesh in model.meshes])
    return _side_by_side("moves", [mesh.name for mesh in model.meshes], {**rows, **pairs})


@singledispatch
def pair_rows(pair: GearPair) -> dict[str, str]:
    """What a nominal pair gives, by label; one function a kind."""
    raise TypeError(f"check.py has no function for {type(pair).__name__}")


@pair_rows.register
def _(pair: SpurPair) -> dict[str, str]:
    driver, driven = pair.angular_backlash
    return {
        "centre distance a [mm]": f"{pair.centre_distance:.4f}",
        "without backlash at [mm]": f"{pair.zero_backlash_centre_distance:.4f}",
        "working pressure angle α_w [°]": _degrees(pair.working_pressure_angle),
        "contact ratio ε_α": f"{pair.contact_ratio:.4f}",
        "same teeth meet after [turns]": str(pair.long_period_turns),
        "nominal normal backlash [µm]": value_text(pair.normal_backlash * UM, "um"),
        "nominal circumferential [µm]": value_text(pair.circumferential_backlash * UM, "um"),
        "nominal radial [µm]": value_text(pair.radial_backlash * UM, "um"),
        "nominal angular, driver / driven": f"{angle_text(driver)} / {angle_text(driven)}",
    }


@pair_rows.register
def _(pair: BevelPair) -> dict[str, str]:
    return {
        "shaft angle Σ [°]": _degrees(pair.shaft_angle),
        "mean cone distance R_m [mm]": f"{pair.mean_cone_distance:.4f}",
        "contact ratio ε_α": f"{pair.contact_ratio:.4f}",
        "same teeth meet after [turns]": str(pair.long_period_turns),
        "nominal normal backlash [µm]": value_text(pair.normal_backlash * UM, "um"),
    }


def measures_table(model: Model) -> Group:
    """The measures with limits and positions."""
    rows = []
    for measure in model.measures:
        rows.append(Row(measure.name, (_what(measure), _positions(measure), _limits(measure))))
    return _titled("measures", Sheet("", [Heading(word, words=True) for word in ("what", "positions", "limits")], rows))


def _what(measure: Measure) -> str:
    kind = measure.kind
    if not isinstance(kind, Backlash):
        stages = " + ".join(stage.link for stage in kind.stages)
        moves = f"{kind.tip.point} of {kind.tip.arm} ({kind.tip.lever:g} mm from the axis) by the " if kind.tip else ""
        return f"{moves}lost motion of {kind.shaft}, {kind.held} held: {stages}"
    gear = f" of {kind.gear}" if kind.is_angle else ""
    curve = " (curve)" if measure.take == "curve" else ""
    what = f"{TAKE_WORDS[measure.take]}{QUANTITY_WORDS[kind.quantity]}{gear}, {kind.mesh}"
    return what + curve + reading_words(vars(kind.reading))


def _positions(measure: Measure) -> str:
    positions = measure.positions
    if positions.over == "swing":
        first, last = (_degrees(angle) for angle in (positions.shown[0], positions.shown[-1]))
        return f"{positions.count} from {first}° to {last}° of the output"
    if positions.over == "at" and not isinstance(measure.kind, Backlash):
        return f"first shaft at {_degrees(positions.angle)}°"
    if positions.over == "at":
        return f"driver at {_degrees(positions.angle)}°"
    if positions.over == "random":
        return "random"
    turns = f"{positions.turns} turn{'' if positions.turns == 1 else 's'}"
    return f"{positions.count} in {turns} of the driver"


def _limits(measure: Measure) -> str:
    limits = ((sign, limit) for sign, limit in (("≥", measure.lower_limit), ("≤", measure.upper_limit)))
    per, unit = measure.per_internal, measure.unit
    sign_of_unit = "" if measure.kind.is_angle else f" {UNIT_SIGNS[unit]}"
    given = [f"{sign} {given_text(limit * per, unit)}{sign_of_unit}" for sign, limit in limits if limit is not None]
    return ", ".join(given) or NOTHING


def contributors_table(model: Model) -> Group:
    """The contributors: law and limits, and what each measure makes of them.

    Low and high of one with a direction are lengths, its sigma is that along any one axis.
    """
    rows = []
    for contributor in model.contributors:
        law, per = contributor.distribution, contributor.per_unit
        numbers = (f"{law.low / per:.4g}", f"{law.high / per:.4g}", f"{contributor.draw.sigma / per:.3g}")
        cells = (*map(unsigned_zero, numbers), UNIT_SIGNS[contributor.unit])
        rows.append(Row(contributor.name, (distribution_words(contributor), *cells)))
    table = Sheet("", [Heading("law", words=True), *map(Heading, ("low", "high", "sigma", "unit"))], rows)
    return Group(_titled("contributors", table), *coefficients_tables(model))


def distribution_words(contributor: Contributor) -> str:
    """The law of a contributor and the direction of its deviation."""
    law = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(contributor.distribution).__name__).lower()
    if not isinstance(contributor.draw, Planar):
        return law
    direction = contributor.draw.direction
    return f"{law}, random direction" if direction is None else f"{law}, at {_degrees(direction)}°"


# coefficients of both roads ------------------------------------------------------------------------


@dataclass(frozen=True)
class _Coefficient:
    """Change of a measure per unit of a contributor, in the units that are shown; two slopes where there is a kink."""

    below: float
    above: float

    def __str__(self) -> str:
        if math.isnan(self.below + self.above):
            return NOTHING
        if self.differs(_Coefficient(self.above, self.below), KINK):
            return f"{_slope_text(self.below)}/{_slope_text(self.above)}"
        return _slope_text((self.below + self.above) / 2)

    def differs(self, other: "_Coefficient", share: float) -> bool:
        """Whether either slope is off by more than a share of the largest of all."""
        slopes = (self.below, self.above, other.below, other.above)
        off = max(abs(self.below - other.below), abs(self.above - other.above))
        return off > max(share * max(map(abs, slopes)), LEAST_SLOPE)


def coefficients_tables(model: Model) -> list[RenderableType]:
    """For each measure the coefficients of both roads at the mean build, and the stack-up's shares of the variance.

    Of a measure that takes an extreme or a curve those of its value at a random position, the driver at 0.
    """
    names: dict[Measure, list[str]] = {}
    for measure in model.measures:
        names.setdefault(_of_one_value(measure), []).append(measure.name)
    engine = ExactEngine(model)
    forms = {measure: reference_form(model, measure) for measure in names}
    headings = [Heading(word) for word in ("unit", "stack-up", "3D", "share [%]")]
    tables = [
        _titled(f"{', '.join(of)}: change by each deviation, {_where(model, measure)}", sheet)
        for measure, of in names.items()
        if (sheet := Sheet("", headings, list(_coefficient_rows(model, engine, measure, forms[measure])))).rows
    ]
    formless = [name for measure, of in names.items() if forms[measure] is None for name in of]
    return [*tables, *(Text(f" {note}", style="dim") for note in _notes(model, formless))]


def _where(model: Model, measure: Measure) -> str:
    """At which position coefficients are told."""
    of_driver = measure.positions.over == "at" and isinstance(measure.kind, Backlash)
    alone = len(model.layout.links) == len(model.layout.drives)
    what = "driver" if of_driver or alone else "first shaft"
    return f"{what} at {_degrees(measure.positions.angle)}°"


def _of_one_value(measure: Measure) -> Measure:
    """What coefficients are told of: measures that are equal here have the same."""
    at = measure.take == "value" and measure.positions.over == "at"
    positions = measure.positions if at else Positions("random", 1, 1)
    return Measure("", at_one_position(measure.kind), positions, "value")


def _coefficient_rows(model: Model, engine: Engine, measure: Measure, form: ClosedForm | None) -> Iterator[Row]:
    """A row for each contributor that acts on the measure."""
    shares = {share.name: share for share in form.shares} if form else {}
    for contributor, slope in zip(model.contributors, mean_slopes(model, engine, measure), strict=True):
        per = (ARCSEC if measure.kind.is_angle else UM) * contributor.per_unit
        unit = f"{'″' if measure.kind.is_angle else 'µm'}/{UNIT_SIGNS[contributor.unit]}"
        found = _Coefficient(slope.below * per, slope.above * per)
        share = shares.get(contributor.name)
        if form and share:
            expected = _by_stack_up(contributor, share.coefficient * per)
            percent = percent_text(form.percent(contributor.name))
            yield Row(contributor.name, (unit, str(expected), _beside(found, expected), percent))
        elif found.differs(_Coefficient(0.0, 0.0), 0.0):
            yield Row(contributor.name, (unit, NOTHING, str(found), NOTHING))


def _by_stack_up(contributor: Contributor, coefficient: float) -> _Coefficient:
    """A tilt acts by its absolute value: away from 0 one slope, at 0 two."""
    if contributor.kind not in ONE_SIDED:
        return _Coefficient(coefficient, coefficient)
    sides = np.sign(contributor.distribution.mean + STEP_ASIDE[contributor.unit] * np.array([-1.0, 1.0]))
    return _Coefficient(*(coefficient * sides).tolist())


def _beside(found: _Coefficient, expected: _Coefficient) -> str:
    """The coefficient of the geometry, marked where it is another one."""
    return f"{OTHER} {found}" if found.differs(expected, DISAGREES) else str(found)


def _slope_text(slope: float) -> str:
    """A slope with three digits, or three decimals where it is small; 0 has no sign."""
    if abs(slope) < LEAST_SLOPE:
        return "0.000"
    return f"{slope:+.3f}" if abs(slope) < 1 else f"{slope:+#.3g}".rstrip(".")


def _notes(model: Model, formless: Sequence[str]) -> list[str]:
    notes = [
        "stack-up and 3D: at the mean build, per unit of the deviation; of one with a direction per length in its "
        "worst direction; a/b: below and above the mean, where they differ; "
        f"{OTHER}: the geometry disagrees by more than {100 * DISAGREES:g} %"
    ]
    tilts = [c.name for c in model.contributors if c.kind in ONE_SIDED]
    if tilts:
        more = "; of two that cross only the larger counts" if len(tilts) > 1 else ""
        notes.append(f"{', '.join(tilts)}: a tilt closes the gap whichever way it goes{more}")
    if formless:
        notes.append(f"no closed form of {', '.join(formless)}: {NO_SUM}")
    return notes


def _degrees(angle: float) -> str:
    return f"{round(math.degrees(angle), 4):g}"
