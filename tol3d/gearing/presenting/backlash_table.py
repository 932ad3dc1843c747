"""Limits of the backlash of each mesh as a table, before a run and of one."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from tol3d.gearing.summary.types import BacklashLimits
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, Row, note, titled

MEANING: Final = (
    "j_bn normal, j_wt and j_t as arcs on the working and the reference circles, j_r radial. theoretical: by thickness "
    "and centre distance; acceptance: by all tolerances but temperature; operating: by all. least, largest: the worst "
    "of a search among builds within the tolerances; mean ∓ 3 σ: by the analytic method, no further than these"
)


def backlash_table(limits: Sequence[BacklashLimits]) -> list[PageItem]:
    """A row for each mesh, stage and word of backlash; nothing without limits."""
    if not limits:
        return []
    table = declared_table("", [(Row(own.mesh, (), unit="um"), own) for own in limits])
    return [*titled("backlash as drawings state it", replace(table, repeated=1)), note(MEANING)]
