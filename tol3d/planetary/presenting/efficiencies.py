"""Efficiencies of planetary sets and torques of their springs, as tables."""

from collections.abc import Mapping, Sequence
from typing import Final

from tol3d.planetary.summary_types import EfficiencySummary, PlanetaryOfRun, PlanetarySetSummary
from tol3d.report.page import Heading, PageItem, Row, Shown, Table, note, titled
from tol3d.runs.summary.run import RunSummary

BALANCE: Final = "torques in equilibrium, pairs in contact carry alike"
FORMULA: Final = "closed form of a 3K set, published E"
LOCKED: Final = 0.0  # of an efficiency: at most so much where the set cannot be driven in that sense
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
