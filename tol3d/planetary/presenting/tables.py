"""A scene's planetary set, its efficiencies and the torques of its spring, in tables."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

from tol3d.gearing.links import StatedLink
from tol3d.planetary.model.planetary_set import PlanetarySet
from tol3d.planetary.sections import LOCKED, set_sections
from tol3d.planetary.set_link import SetLink
from tol3d.planetary.summary_types import EfficiencySummary, PlanetaryOfRun, PlanetarySetSummary
from tol3d.planetary.system import PlanetarySystem
from tol3d.report.page import Heading, PageItem, Row, Shown, Table, line, note, titled
from tol3d.report.system_check import system_blocks
from tol3d.runs.summary.run import RunSummary
from tol3d.study.simulation import Simulation

BALANCE: Final = "torques in equilibrium, pairs in contact carry alike"
FORMULA: Final = "closed form of a 3K set, published E"
NEGLECTED: Final = (
    "friction of the teeth alone, of nominal gears under a static load; without bearings, seals, churning and windage"
)


def section_blocks(summary: RunSummary) -> Sequence[PageItem]:
    """Tables of each set of a run whose friction or spring is given."""
    return set_blocks((summary.planetary_sets or {}) if isinstance(summary, PlanetaryOfRun) else {})


def set_blocks(sets: Mapping[str, PlanetarySetSummary]) -> Sequence[PageItem]:
    """The same of sets by their names."""
    return [block for name, own in sets.items() for block in (*_efficiencies(name, own), *_torques(name, own))]


def _torques(name: str, own: PlanetarySetSummary) -> Sequence[PageItem]:
    if own.spring is None:
        return ()
    spring = own.spring
    heads = [Heading(f"at {shaft}") for shaft in spring.breakaway_n_mm]
    rows = [
        Row("breakaway torque [N mm]", [Shown(f"{each:.4g}", each) for each in spring.breakaway_n_mm.values()]),
        Row(
            "stiffness from there on [N mm/′]",
            [Shown(f"{each:.4g}", each) for each in spring.low_stiffness_n_mm_per_arcmin.values()],
        ),
    ]
    given = (
        f"force {spring.force_n:g} N, stiffness {spring.stiffness_n_per_mm:g} N/mm, friction {spring.friction_n:g} N"
    )
    words = "of the mean build; it holds torques up to the breakaway, then gives way until contacts stop the planets"
    return [*titled(f"{name}: the spring of its carrier", Table("", heads, rows)), note(f"{given}; {words}")]


def _efficiencies(name: str, own: PlanetarySetSummary) -> Sequence[PageItem]:
    if own.efficiency is None:
        return ()
    rows = [Row(BALANCE, _cells(own.efficiency))]
    if own.efficiency_by_formula is not None:
        rows.append(Row(FORMULA, _cells(own.efficiency_by_formula)))
    heads = [Heading(f"driven at {own.input} [%]"), Heading(f"driven at {own.output} [%]")]
    table = Table(f"coefficient of friction {own.friction:g}", heads, rows)
    return [*titled(f"{name}: efficiency", table), note(NEGLECTED)]


def _cells(own: EfficiencySummary) -> list[Shown]:
    found = (own.forward_percent, own.backward_percent)
    return [Shown(f"{each:.2f}" if each > LOCKED else "locks itself", each) for each in found]


def check_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Ratio and meshes of the set, then what any system shows."""
    system = simulation.system
    assert isinstance(system, PlanetarySystem)
    return (*_nominal(system.own, system.summaries), *system_blocks(simulation))


def link_blocks(link: StatedLink) -> Sequence[PageItem]:
    """Ratio and meshes of a set in a train."""
    assert isinstance(link, SetLink)
    return _nominal(link.own, set_sections(link.own, link.friction))


def _nominal(own: PlanetarySet, sections: Mapping[str, PlanetarySetSummary]) -> Sequence[PageItem]:
    """Ratio, meshes and efficiencies of a set, and torques of its spring."""
    rows = [
        Row(
            mesh.name,
            [
                f"{mesh.central.teeth}",
                f"{mesh.planet.teeth}",
                f"{math.degrees(mesh.working_pressure_angle):.4f}",
                f"{2e3 * mesh.clearance:z.3f}",
                f"{mesh.tight_centre_distance:.4f}",
            ],
        )
        for mesh in own.meshes
    ]
    heads = ("teeth", "of the planet", "working pressure angle [°]", "normal backlash [µm]", "tight at a [mm]")
    ratio = f"{own.name}: {own.input} to {own.output}, {own.held} held: ratio {float(own.ratio):.6g} = {own.ratio}"
    planets = f"{own.planets} planets, centre distance {own.centre_distance:.4f} mm; all teeth meet again after "
    return (
        line(ratio),
        line(f"{planets}{own.period_planet_turns} turns of the planets"),
        Table("mesh, nominal", [Heading(head) for head in heads], rows),
        *set_blocks(sections),
    )
