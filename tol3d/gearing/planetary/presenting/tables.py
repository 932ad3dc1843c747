"""Tables of a scene's planetary set.

Efficiencies of planetary sets and torques of their springs, as tables.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.gearing.planetary.backlash import pair_meshes
from tol3d.gearing.planetary.set_link import SetLink
from tol3d.gearing.planetary.summary_types import PlanetaryOfRun, PlanetarySetSummary
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.gearing.presenting.drawing_sizes import backlash_table
from tol3d.gearing.reducers.shown import gear_data
from tol3d.report.declared import declared_table, side_by_side
from tol3d.report.page import PageItem, Shown, line, note, titled
from tol3d.report.system_check import system_blocks
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.system.contributor import Contributor
from tol3d.study.trials.simulation import Simulation


def blocks(reducer: PlanetarySystem | SetLink, contributors: Sequence[Contributor]) -> Sequence[PageItem]:
    """Ratio, meshes and efficiencies of a set, torques of its spring, and what shops measure of its gears."""
    own = reducer.own
    ratio = f"{own.name}: {own.input} to {own.output}, {own.held} held: ratio {float(own.ratio):.6g} = {own.ratio}"
    planets = f"{own.planets} planets, centre distance {own.centre_distance:.4f} mm; all teeth meet again after "
    return (
        line(ratio),
        line(f"{planets}{own.period_planet_turns} turns of the planets"),
        *gear_data(reducer.made, pair_meshes(own, reducer.made), reducer.acts, contributors),
        *set_blocks(reducer.summaries),
    )


def check_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Data of a set alone, the backlash of its meshes, then the items of any system."""
    system = simulation.system
    assert isinstance(system, PlanetarySystem)
    backlash = backlash_table(system.backlash_limits(simulation.copula))
    return (*blocks(system, system.contributors), *backlash, *system_blocks(simulation))


BALANCE: Final = "torques in equilibrium, pairs in contact carry alike"
FORMULA: Final = "closed form of a 3K set, published E"
LOCKED: Final = 0.0  # of an efficiency: at most so much where the set cannot be driven in that sense
NEGLECTED: Final = (
    "friction of the teeth alone, of nominal gears under a static load; without bearings, seals, churning and windage"
)


def link_sections(summary: RunSummary) -> Sequence[PageItem]:
    """Tables of each set of a run whose friction or spring is given."""
    return set_blocks((summary.planetary_sets or {}) if isinstance(summary, PlanetaryOfRun) else {})


def set_blocks(sets: Mapping[str, PlanetarySetSummary]) -> Sequence[PageItem]:
    """The same of sets by their names."""
    return [block for name, own in sets.items() for block in (*_efficiencies(name, own), *_torques(name, own))]


@dataclass(frozen=True)
class SpringTorques:
    """Torques of a carrier's spring at a shaft."""

    breakaway: Annotated[float, Shows("breakaway torque [N mm]", ".4g")]
    stiffness: Annotated[float, Shows("stiffness from there on [N mm/′]", ".4g")]


@dataclass(frozen=True)
class EfficiencyRow:
    """Efficiencies of a set by the shaft that drives it [%]."""

    driven_at: Annotated[Mapping[str, Shown], Shows("driven at {key} [%]")]


def _torques(name: str, own: PlanetarySetSummary) -> Sequence[PageItem]:
    if own.spring is None:
        return ()
    spring = own.spring
    stiffness = spring.low_stiffness_n_mm_per_arcmin
    torques = [(f"at {shaft}", SpringTorques(own, stiffness[shaft])) for shaft, own in spring.breakaway_n_mm.items()]
    given = (
        f"force {spring.force_n:g} N, stiffness {spring.stiffness_n_per_mm:g} N/mm, friction {spring.friction_n:g} N"
    )
    words = "of the mean build; it holds torques up to the breakaway, then gives way until contacts stop the planets"
    return [*titled(f"{name}: the spring of its carrier", side_by_side("", torques)), note(f"{given}; {words}")]


def _efficiencies(name: str, planetary_set_summary: PlanetarySetSummary) -> Sequence[PageItem]:
    if planetary_set_summary.efficiency is None:
        return ()
    found = {BALANCE: planetary_set_summary.efficiency, FORMULA: planetary_set_summary.efficiency_by_formula}
    rows = [
        (
            label,
            EfficiencyRow(
                {
                    planetary_set_summary.input: _percent(each.forward_percent),
                    planetary_set_summary.output: _percent(each.backward_percent),
                }
            ),
        )
        for label, each in found.items()
        if each is not None
    ]
    table = declared_table(f"coefficient of friction {planetary_set_summary.friction:g}", rows)
    return [*titled(f"{name}: efficiency", table), note(NEGLECTED)]


def _percent(value: float) -> Shown:
    return Shown(f"{value:.2f}" if value > LOCKED else "locks itself", value)
