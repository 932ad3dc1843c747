"""Tables of a scene of gears: gears, meshes, measures, contributors and their coefficients."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, Any

from tol3d.gearing.model import (
    Backlash,
    Contributor,
    LostMotion,
    Measure,
    Model,
    Planar,
    Train,
    TransmissionError,
)
from tol3d.gearing.model.links import LoadPath, Parallel, links_of
from tol3d.gearing.model.trains import gravity_torque
from tol3d.gearing.presenting.coefficient_tables import coefficients_tables
from tol3d.gearing.presenting.drawing_sizes import backlash_table, drawing_sizes
from tol3d.gearing.presenting.gear_tables import gear_column, mesh_column
from tol3d.gearing.presenting.shown_train import link_blocks
from tol3d.gearing.summary.measure_words import QUANTITY_WORDS, TAKE_WORDS, Reading, readings_words
from tol3d.gearing.system import EXACT, GearSystem, gear_model
from tol3d.gears import (
    LEFT,
)
from tol3d.numerics.arrays import Array
from tol3d.report.declared import declared_table, side_by_side
from tol3d.report.number import NOTHING, UNIT_SIGNS, degrees_text, limits_text
from tol3d.report.page import Line, PageItem, line, title, titled
from tol3d.report.system_check import law_name, sample_notes, system_blocks
from tol3d.report.worst_found import worst_blocks
from tol3d.study.runs.summary.shows import Computed, RowOf, Shows
from tol3d.study.system.draw import JointDraw
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.trials.simulation import Simulation


@dataclass(frozen=True)
class ShaftRow:
    """A shaft: what drives it, the gears on it, and its axis."""

    driven_by: Annotated[str, Shows("driven by", "words")]
    carries: Annotated[str, Shows("carries", "words")]
    axis: Annotated[str, Shows("axis through [mm]", "words")]
    along: Annotated[str, Shows("along", "words")]
    turns: Annotated[str, Shows("turns")]


def train_blocks(model: Model) -> list[PageItem]:
    """Shafts of a scene, if any of them carries or drives more than one gear; else nothing."""
    if len(model.layout.links) == len(model.layout.drives) and not model.trains:
        return []
    table = declared_table("", _shaft_rows(model))
    note = line(" turns per turn of the first shaft; below 0: they turn opposite, each about its own axis", "dim")
    return [title("shafts"), table, note, *(_train_line(model, train) for train in model.trains)]


def _shaft_rows(model: Model) -> Iterator[tuple[str, ShaftRow]]:
    layout = model.layout
    for shaft, turning in layout.shaft_turn.items():
        pose = layout.world_from_shaft[shaft]
        link = layout.driving.get(shaft)
        carried = [gear for gear, (carrier, _) in layout.carrying.items() if carrier == shaft and gear != shaft]
        yield (
            shaft,
            ShaftRow(
                link.name if link else NOTHING,
                ", ".join(carried) or NOTHING,
                _vector_text(pose[:3, 3], 2),
                _vector_text(pose[:3, 2], 3),
                str(turning.rate),
            ),
        )


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


def check_blocks(simulation: Simulation) -> list[PageItem]:
    """Gears, meshes, trains, measures and contributors of a scene, with what follows from them.

    Links that compare load paths have no coefficients; a scene with such links is shown as any system is.
    """
    model = gear_model(simulation.system)
    engine = ANALYTIC_METHOD if simulation.study.engine == ANALYTIC_METHOD else EXACT
    backlash = backlash_table(GearSystem(model).backlash_limits(engine, simulation.copula))
    if any(link.compares for link in model.links):
        return [*link_blocks(model), *mechanics_blocks(model), *backlash, *system_blocks(simulation)]
    blocks = [*link_blocks(model), *mechanics_blocks(model), *backlash, *measures_table(model)]
    return [*blocks, *(contributors_table(model) if model.contributors else ()), *worst_blocks(simulation)]


def mechanics_blocks(model: Model) -> list[PageItem]:
    """Gears, their shop dimensions, meshes and trains."""
    housings = [housings_line(model)] if model.housings else []
    return [*gears_table(model), *housings, *drawing_sizes(model), *meshes_table(model), *train_blocks(model)]


class PartColumn(RowOf[Any]):
    """Numbers that gears have as parts."""

    expansion = Computed(Shows("expansion", "g", "10⁻⁶/K"), lambda own: own.of.expansion or None)


def gears_table(model: Model) -> list[PageItem]:
    """The gears side by side, lengths in mm."""
    gears = side_by_side("", [(gear.name, gear_column(gear.gear)) for gear in model.gears])
    parts = side_by_side("", [(gear.name, PartColumn(gear)) for gear in model.gears])
    return titled("parts", replace(gears, rows=[*gears.rows, *parts.rows]))


def housings_line(model: Model) -> Line:
    """Housings and their expansion."""
    words = [f"{part.name} ({1e6 * part.expansion:g}·10⁻⁶/K)" for part in model.housings]
    return line(f"housing: {', '.join(words)}")


def meshes_table(model: Model) -> list[PageItem]:
    """The moves, with what the nominal pair gives."""
    return titled("moves", side_by_side("", [(mesh.name, mesh_column(mesh)) for mesh in model.meshes]))


class MeasureRow(RowOf[Measure]):
    """A measure: what of which mesh or train, where, and its limits."""

    what = Computed(Shows("what", "words"), lambda own: _what(own.of))
    positions = Computed(Shows("positions", "words"), lambda own: _positions(own.of))
    limits = Computed(Shows("limits", "words"), lambda own: _limits(own.of))


def measures_table(model: Model) -> list[PageItem]:
    """The measures with limits and positions."""
    return titled("measures", declared_table("", [(measure.name, MeasureRow(measure)) for measure in model.measures]))


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


class ContributorRow(RowOf[Contributor]):
    """A contributor; low and high of one with a direction are lengths, its sigma is that along any one axis."""

    law = Computed(Shows("law", "words"), lambda own: distribution_words(own.of))
    low = Computed(Shows("low", ".4g"), lambda own: own.of.distribution.low / own.of.per_unit)
    high = Computed(Shows("high", ".4g"), lambda own: own.of.distribution.high / own.of.per_unit)
    sigma = Computed(Shows("sigma", ".3g"), lambda own: own.of.draw.sigma / own.of.per_unit)
    unit_sign = Computed(Shows("unit"), lambda own: UNIT_SIGNS[own.of.unit])


def contributors_table(model: Model) -> list[PageItem]:
    """The contributors: law and limits, and their coefficients in each measure."""
    table = declared_table("", [(contributor.name, ContributorRow(contributor)) for contributor in model.contributors])
    notes = sample_notes(
        (contributor.name, contributor.distribution, contributor.per_unit, contributor.unit)
        for contributor in model.contributors
    )
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
