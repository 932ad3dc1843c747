"""Tables of a scene's RV reducer.

Cycloid stages by formula as tables: the published formula (reconstructed) and first principles.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.gearing.cycloid.model.limits import largest_pin_radius
from tol3d.gearing.cycloid.reducer.formula import stages_by_formula
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.rv_link import RVLink
from tol3d.gearing.cycloid.summary_types import FIRST_PRINCIPLES, PAPER, CycloidOfRun, CycloidStageSummary
from tol3d.gearing.cycloid.system import RVSystem
from tol3d.gearing.reducers.shown import gear_data
from tol3d.gearing.shafts import Mesh
from tol3d.gearing.summary.types import TrainsOfRun
from tol3d.gears import RIGHT
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, Table, line, note, titled
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.shows import Computed, Shows
from tol3d.study.system.contributor import Contributor

ARC_SECONDS: Final = math.degrees(1.0) * 3.6  # that 1 um turns what is 1 mm away


def blocks(reducer: RVSystem | RVLink, contributors: Sequence[Contributor]) -> Sequence[PageItem]:
    """Ratio, profile, levers and transmission error by formula."""
    own, acts = reducer.own, reducer.acts
    first = own.first
    gears = {} if first is None else {name: first.gear(name) for name in (first.sun, first.planet)}
    meshes = [] if first is None else [Mesh(f"{first.sun}–{first.planet}", first.sun, first.planet, first.pair, RIGHT)]
    formulas = stage_blocks(stages_by_formula(own, acts, contributors))
    return (*map(line, _words(own)), *gear_data(gears, meshes, acts, contributors), _levers(own), *formulas)


def _words(rv_set: RVSet) -> list[str]:
    profile, first = rv_set.profile, rv_set.first
    stage = "the cranks are the input"
    if first is not None:
        backlash = f"normal backlash {1e3 * first.pair.normal_backlash:z.3f} µm"
        stage = f"{first.sun} {first.teeth[0]} and {first.planet} {first.teeth[1]} teeth, {backlash}"
    return [
        f"{rv_set.name}: {rv_set.carrier} is the output, {rv_set.ring} fixed; ratio {rv_set.ratio}; "
        f"{rv_set.discs} discs, {rv_set.cranks} cranks; {stage}",
        f"{profile.lobes} lobes, {profile.pins} pins of radius {profile.pin_radius:g} mm on "
        f"{profile.pin_circle_radius:g} mm, eccentricity {profile.eccentricity:g} mm: K = {profile.shortening:.6f}, "
        f"largest lever {profile.pitch_radius:.4f} mm at {math.degrees(profile.best_phase):.4f}°, pin radius below "
        f"{largest_pin_radius(profile):.4f} mm",
        f"pins work whose lever is over {rv_set.window:g} of the largest; with the input held, turns of a disc count "
        f"{1 / (1 + rv_set.rolling / profile.lobes):.5f} at the output",
    ]


@dataclass(frozen=True)
class LeverRow:
    """The turn of a disc by 1 µm, and how much of it is 1 at the output."""

    disc: Annotated[float, Shows("at the disc [″]", ".4f")]
    held: float
    output = Computed(Shows("at the output [″]", ".4f"), lambda own: own.disc / own.held)


def _levers(rv_set: RVSet) -> Table:
    radius, k = rv_set.profile.pitch_radius, rv_set.profile.shortening
    rows = {
        "disc displaced across": 1.0,
        "pin outwards": math.sqrt(1 - k**2),
        "pin round, lobe pitch": k,
        "pin radius, lobe profile": 1.0,
    }
    held = 1 + rv_set.rolling / rv_set.profile.lobes
    levers = [(name, LeverRow(ARC_SECONDS * share / radius, held)) for name, share in rows.items()]
    return declared_table("what 1 µm does at the best pin", levers)


IN_A_TRAIN: Final = "rv_reducer"
NEGATIVE: Final = (
    "negative where pins press on both sides of their lobes at once: of rigid parts the turn by which lobes and pins "
    "would have to give way, a preload and no play"
)
WHAT: Final = (
    "±3σ; first principles: a disc's turn while its best pin alone touches, through lobes times eccentricity; what "
    "the smallest of all working pins makes of it is in the simulation"
)


def link_sections(summary: RunSummary) -> Sequence[PageItem]:
    """Tables of each stage of a run, and a note to reducers of trains whose mean play is negative."""
    stages = (summary.cycloid_stages or {}) if isinstance(summary, CycloidOfRun) else {}
    trains = (summary.trains or {}).values() if isinstance(summary, TrainsOfRun) else ()
    tight = {
        stage.link
        for train in trains
        for stage in train.stages
        if stage.kind == IN_A_TRAIN
        for method in (stage.methods.analytic, stage.methods.geometric)
        if method is not None and method.mean is not None and method.mean < 0.0
    }
    notes = [note(f"{', '.join(sorted(tight))}: {NEGATIVE}; it is added to the play of other stages as it is")]
    return [*(notes if tight else ()), *stage_blocks(stages)]


def below_zero(summary: RunSummary) -> Sequence[PageItem]:
    """A note to lost motions whose mean is negative."""
    means = {
        name: [each.mean for each in (own.analytic, own.geometric) if each is not None and each.mean is not None]
        for name, own in summary.measures.items()
        if own.kind == "cycloid_lost_motion"
    }
    names = [name for name, own in means.items() if own and min(own) < 0.0]
    return [note(f"{', '.join(names)}: {NEGATIVE}")] if names else []


def stage_blocks(stages: Mapping[str, CycloidStageSummary]) -> Sequence[PageItem]:
    """The same of stages by their names: contributions, then totals."""
    return [block for name, own in stages.items() for block in _blocks(name, own)]


def _blocks(name: str, cycloid_stage_summary: CycloidStageSummary) -> Sequence[PageItem]:
    terms = declared_table("source", cycloid_stage_summary.sources.items())
    totals = declared_table("output", _totals(cycloid_stage_summary))
    return [
        *titled(f"{name}: transmission error by formula", terms),
        note(WHAT),
        *titled(f"{name}: by formula, added up", totals),
        *map(note, _notes(cycloid_stage_summary)),
    ]


@dataclass(frozen=True)
class TotalRow:
    """A sum of terms by the published formula and by first principles ["]."""

    paper: Annotated[float | str | None, Shows(PAPER, ".3f", seldom=True)]
    first_principles: Annotated[float | None, Shows(FIRST_PRINCIPLES, ".3f")]


def _totals(cycloid_stage_summary: CycloidStageSummary) -> Iterator[tuple[str, TotalRow]]:
    paper, ours = cycloid_stage_summary.by_formula, cycloid_stage_summary.first_principles
    keys = {
        "cycloid stage, ±3σ": "cycloid_arcsec",
        "carrier, ±3σ": "carrier_arcsec",
        "both added" if paper is None else "both added, as published": "added_arcsec",
        "both, root sum square": "root_sum_square_arcsec",
    }
    for words, key in keys.items():
        yield words, TotalRow(None if paper is None else paper.value(key), ours.value(key))
        if paper is not None and key == "cycloid_arcsec":
            yield "  99.73 % half-range of its law", TotalRow(paper.cycloid_half_range_arcsec, ours.cycloid_arcsec)
    if cycloid_stage_summary.sun_held is not None:
        held = cycloid_stage_summary.sun_held * ours.root_sum_square_arcsec
        yield f"  times {cycloid_stage_summary.sun_held:.5f}, sun held", TotalRow(None if paper is None else "", held)


def _notes(cycloid_stage_summary: CycloidStageSummary) -> list[str]:
    if cycloid_stage_summary.by_formula is None:
        return (
            [f"not in these sums: {', '.join(cycloid_stage_summary.left_out)}"]
            if cycloid_stage_summary.left_out
            else []
        )
    law = (
        "the paper's pin circle is a normal length times the sine of a random phase, which is not normal: ±3σ covers "
        f"{cycloid_stage_summary.by_formula.cycloid_coverage_percent:.2f} % of the cycloid stage"
    )
    return [
        law,
        *(
            [f"not in the formula: {', '.join(cycloid_stage_summary.left_out)}"]
            if cycloid_stage_summary.left_out
            else []
        ),
    ]
