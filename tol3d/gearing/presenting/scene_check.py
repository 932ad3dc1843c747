"""Tables of a scene of gears: gears, meshes, measures, contributors and their coefficients."""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import singledispatch

from tol3d.gearing.model import Backlash, Contributor, LostMotion, Measure, Model, Planar, Train, TransmissionError
from tol3d.gearing.model.links import LoadPath, Parallel, links_of
from tol3d.gearing.model.trains import gravity_torque
from tol3d.gearing.presenting.coefficient_tables import coefficients_tables
from tol3d.gearing.presenting.drawing_sizes import drawing_sizes
from tol3d.gearing.presenting.shown_train import link_blocks
from tol3d.gearing.summary.measure_words import QUANTITY_WORDS, TAKE_WORDS, Reading, readings_words
from tol3d.gearing.system import gear_model
from tol3d.gears import (
    LEFT,
    RIGHT,
    BevelGear,
    BevelPair,
    Gear,
    GearPair,
    InternalGear,
    InternalPair,
    SpurGear,
    SpurPair,
)
from tol3d.numerics.arrays import Array
from tol3d.report.number import NOTHING, UNIT_SIGNS, degrees_text, limits_text, unsigned_zero, value_text
from tol3d.report.page import Heading, Line, PageItem, Row, Table, line, title, titled
from tol3d.report.system_check import law_name, sample_notes, system_blocks
from tol3d.report.worst_found import worst_blocks
from tol3d.study.simulation import Simulation
from tol3d.system.draw import JointDraw
from tol3d.units import angle_text


def train_blocks(model: Model) -> list[PageItem]:
    """Shafts of a scene, if any of them carries or drives more than one gear; else nothing."""
    if len(model.layout.links) == len(model.layout.drives) and not model.trains:
        return []
    words = [Heading(word, words=True) for word in ("driven by", "carries", "axis through [mm]", "along")]
    table = Table("", [*words, Heading("turns")], list(_shaft_rows(model)))
    note = line(" turns per turn of the first shaft; below 0: they turn opposite, each about its own axis", "dim")
    return [title("shafts"), table, note, *(_train_line(model, train) for train in model.trains)]


def _shaft_rows(model: Model) -> Iterator[Row]:
    layout = model.layout
    for shaft, turning in layout.shaft_turn.items():
        pose = layout.world_from_shaft[shaft]
        link = layout.driving.get(shaft)
        carried = [gear for gear, (carrier, _) in layout.carrying.items() if carrier == shaft and gear != shaft]
        cells = (
            link.name if link else NOTHING,
            ", ".join(carried) or NOTHING,
            _vector_text(pose[:3, 3], 2),
            _vector_text(pose[:3, 2], 3),
            str(turning.rate),
        )
        yield Row(shaft, cells)


def _train_line(model: Model, train: Train) -> Line:
    layout = model.layout
    path = layout.load_path(train.driven, train.output)
    ratio = layout.ratio(train.driven, train.output)
    sense = "opposite" if ratio < 0 else "alike"
    pieces = [(f"\n{train.name}: ", "bold"), (" → ".join(dict.fromkeys(_path(train.driven, path))), "")]
    pieces.append((f" · i = {abs(float(ratio)):.6g}, they turn {sense} · {train.held} held", ""))
    on_the_path = {link.name for link in links_of(path)}
    meshes = [mesh for mesh in model.meshes if mesh.name in on_the_path]
    flanks = ", ".join(f"{mesh.name} {'left' if mesh.working_flank == LEFT else 'right'}" for mesh in meshes)
    pieces.append((f"\n working flanks of the drivers{_load(model, train)}: {flanks or NOTHING}", "dim"))
    for link in (link for link in model.links if link.remark and link.name in on_the_path):
        pieces.append((f"\n {link.name}: {link.remark}", "dim"))
    return Line(tuple(pieces))


def _load(model: Model, train: Train) -> str:
    torque = gravity_torque(train, model.layout, model.arms, 0.0)
    return " at 0° of the output under gravity" if torque else ""


def _path(first: str, path: LoadPath) -> Iterator[str]:
    yield first
    at = first
    for element in path:
        if isinstance(element, Parallel):
            yield f"({element.name})"
        if at not in (element.driver, element.driven):  # a carrier: its path has ended, that of its gears begins
            at = element.driver
            yield at
        at = element.driven if at == element.driver else element.driver
        yield at


def _vector_text(vector: Array, digits: int) -> str:
    """Coordinates, without a sign of what is 0 in print.

    >>> import numpy
    >>> _vector_text(numpy.array([172.5, -1e-17, 1.0]), 2)
    '172.5, 0, 1'
    """
    return ", ".join(f"{round(float(value), digits) + 0.0:g}" for value in vector)


UM = 1000.0  # um in a mm


def check_blocks(simulation: Simulation) -> list[PageItem]:
    """Gears, meshes, trains, measures and contributors of a scene, with what follows from them.

    Links that compare load paths have no coefficients; a scene with such links is shown as any system is.
    """
    model = gear_model(simulation.system)
    if any(link.compares for link in model.links):
        return [*link_blocks(model), *mechanics_blocks(model), *system_blocks(simulation)]
    blocks = [*link_blocks(model), *mechanics_blocks(model), *measures_table(model)]
    return [*blocks, *(contributors_table(model) if model.contributors else ()), *worst_blocks(simulation)]


def mechanics_blocks(model: Model) -> list[PageItem]:
    """Gears, their shop dimensions, meshes and trains."""
    housings = [housings_line(model)] if model.housings else []
    return [*gears_table(model), *housings, *drawing_sizes(model), *meshes_table(model), *train_blocks(model)]


def _side_by_side(title: str, names: Sequence[str], rows: Mapping[str, Sequence[str]]) -> list[PageItem]:
    """A column for each name."""
    headings = [Heading(name) for name in names]
    return titled(title, Table("", headings, [Row(label, cells) for label, cells in rows.items()]))


def gears_table(model: Model) -> list[PageItem]:
    """The gears side by side, lengths in mm."""
    rows = [gear_rows(part.gear) for part in model.gears]
    expansions = [f"{1e6 * part.expansion:g}" if part.expansion else NOTHING for part in model.gears]
    return _side_by_side(
        "parts", [part.name for part in model.gears], _merged(rows) | {"expansion [10⁻⁶/K]": expansions}
    )


def _merged(columns: Sequence[Mapping[str, str]]) -> dict[str, list[str]]:
    """Rows that some column has, in the columns' order; NOTHING where another kind has none."""
    labels = dict.fromkeys(label for column in columns for label in column)
    return {label: [column.get(label, NOTHING) for column in columns] for label in labels}


@singledispatch
def gear_rows(gear: Gear) -> dict[str, str]:
    """Data of a gear, by label; each kind of gear registers its own."""
    raise TypeError(f"there are no rows of {type(gear).__name__}")


@gear_rows.register
def _(gear: SpurGear) -> dict[str, str]:
    bore = f"{gear.bore:g}" if gear.bore else NOTHING
    return {"teeth z": str(gear.teeth), **_cylindrical_rows(gear), "bore [mm]": bore}


@gear_rows.register
def _(gear: InternalGear) -> dict[str, str]:
    outer = f"{gear.rim_diameter:.4f}"
    return {"teeth z": f"{gear.teeth}, inside", **_cylindrical_rows(gear), "outer diameter [mm]": outer}


def _cylindrical_rows(gear: SpurGear | InternalGear) -> dict[str, str]:
    """Rows common to external and internal gears, except the number of teeth."""
    return {
        "module m [mm]": f"{gear.module:g}",
        "pressure angle α [°]": degrees_text(gear.pressure_angle),
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
    }


@gear_rows.register
def _(gear: BevelGear) -> dict[str, str]:
    cones = {"pitch": gear.pitch_angle, "tip": gear.tip_angle, "base": gear.base_angle, "root": gear.root_angle}
    distances = (gear.outer_cone_distance, gear.mean_cone_distance, gear.inner_cone_distance)
    return {
        "teeth z": str(gear.teeth),
        "module m [mm]": f"{gear.module:g}",
        "pressure angle α [°]": degrees_text(gear.pressure_angle),
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


def housings_line(model: Model) -> Line:
    """Housings and their expansion."""
    words = [f"{part.name} ({1e6 * part.expansion:g}·10⁻⁶/K)" for part in model.housings]
    return line(f"housing: {', '.join(words)}")


def meshes_table(model: Model) -> list[PageItem]:
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
    """Data of a nominal pair, by label; each kind of pair registers its own."""
    raise TypeError(f"there are no rows of {type(pair).__name__}")


@pair_rows.register(SpurPair)
@pair_rows.register(InternalPair)
def _(pair: SpurPair | InternalPair) -> dict[str, str]:
    driver, driven = pair.angular_backlash
    return {
        "centre distance a [mm]": f"{pair.centre_distance:.4f}",
        "without backlash at [mm]": f"{pair.zero_backlash_centre_distance:.4f}",
        "working pressure angle α_w [°]": degrees_text(pair.working_pressure_angle),
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
        "shaft angle Σ [°]": degrees_text(pair.shaft_angle),
        "mean cone distance R_m [mm]": f"{pair.mean_cone_distance:.4f}",
        "contact ratio ε_α": f"{pair.contact_ratio:.4f}",
        "same teeth meet after [turns]": str(pair.long_period_turns),
        "nominal normal backlash [µm]": value_text(pair.normal_backlash * UM, "um"),
    }


def measures_table(model: Model) -> list[PageItem]:
    """The measures with limits and positions."""
    rows = []
    for measure in model.measures:
        rows.append(Row(measure.name, (_what(measure), _positions(measure), _limits(measure))))
    return titled("measures", Table("", [Heading(word, words=True) for word in ("what", "positions", "limits")], rows))


def _what(measure: Measure) -> str:
    kind = measure.kind
    curve = " (curve)" if measure.take == "curve" else ""
    if isinstance(kind, TransmissionError):
        read = {backlash.mesh: _reading(backlash) for _, backlash in kind.backlashes}
        meshes = f": {' + '.join(kind.meshes)}" if kind.train else ""
        what = (
            f"{TAKE_WORDS[measure.take]}transmission error of {kind.gear} on the {kind.flank} flank, {kind.of}{meshes}"
        )
        return what + curve + readings_words(read)
    if isinstance(kind, LostMotion):
        stages = " + ".join(stage.link for stage in kind.stages)
        moves = f"{kind.tip.point} of {kind.tip.arm} ({kind.tip.lever:g} mm from the axis) by the " if kind.tip else ""
        read = {backlash.mesh: _reading(backlash) for _, backlash in kind.backlashes}
        return f"{moves}lost motion of {kind.shaft}, {kind.held} held, without load: {stages}{readings_words(read)}"
    gear = f" of {kind.gear}" if kind.is_angle else ""
    what = f"{TAKE_WORDS[measure.take]}{QUANTITY_WORDS[kind.quantity]}{gear}, {kind.mesh}"
    return what + curve + _reading(kind).words


def _reading(backlash: Backlash) -> Reading:
    own = backlash.reading
    return Reading.model_validate({"contact": own.contact, "gap": own.gap, "teeth": own.teeth})


def _positions(measure: Measure) -> str:
    positions = measure.positions
    if positions.over == "swing":
        first, last = (degrees_text(angle) for angle in (positions.shown[0], positions.shown[-1]))
        return f"{positions.count} from {first}° to {last}° of the output"
    if positions.over == "at" and not isinstance(measure.kind, Backlash):
        return f"first shaft at {degrees_text(positions.angle)}°"
    if positions.over == "at":
        return f"driver at {degrees_text(positions.angle)}°"
    if positions.over == "random":
        return "random"
    turns = f"{positions.turns} turn{'' if positions.turns == 1 else 's'}"
    return f"{positions.count} in {turns} of the driver"


def _limits(measure: Measure) -> str:
    limits = (measure.lower_limit, measure.upper_limit)
    lower, upper = (None if limit is None else limit * measure.per_internal for limit in limits)
    return limits_text(lower, upper, measure.unit)


def contributors_table(model: Model) -> list[PageItem]:
    """The contributors: law and limits, and their coefficients in each measure.

    Low and high of one with a direction are lengths, its sigma is that along any one axis.
    """
    rows = []
    for contributor in model.contributors:
        law, per = contributor.distribution, contributor.per_unit
        numbers = (f"{law.low / per:.4g}", f"{law.high / per:.4g}", f"{contributor.draw.sigma / per:.3g}")
        cells = (*map(unsigned_zero, numbers), UNIT_SIGNS[contributor.unit])
        rows.append(Row(contributor.name, (distribution_words(contributor), *cells)))
    table = Table("", [Heading("law", words=True), *map(Heading, ("low", "high", "sigma", "unit"))], rows)
    notes = sample_notes((own.name, own.distribution, own.per_unit, own.unit) for own in model.contributors)
    return [*titled("contributors", table), *notes, *coefficients_tables(model)]


def distribution_words(contributor: Contributor) -> str:
    """The law of a contributor and the direction of its deviation."""
    if isinstance(contributor.draw, JointDraw):
        return contributor.draw.words
    law = law_name(contributor.distribution)
    if not isinstance(contributor.draw, Planar):
        return law
    direction = contributor.draw.direction
    return f"{law}, random direction" if direction is None else f"{law}, at {degrees_text(direction)}°"
