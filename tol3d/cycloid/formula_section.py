"""A cycloid stage by formula, as summary.json has it."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

from tol3d.cycloid.formula_summary import CycloidStageSummary, FormulaTotals, SourceByFormula, StageTotals
from tol3d.cycloid.paper_formula import Term, first_principles_totals, paper_totals, sun_held_factor, terms
from tol3d.cycloid.paper_sources import PaperSources
from tol3d.cycloid.profile import DiscProfile
from tol3d.cycloid.rv_deviated import Acts
from tol3d.cycloid.rv_set import RVSet
from tol3d.runs.summary.values import made
from tol3d.system.contributor import Contributor

THREE_SIGMA: Final = 3.0 * math.degrees(1.0) * 3600.0  # arc seconds a radian of standard deviation


def stages_by_formula(
    own: RVSet, acts: Mapping[str, Acts], contributors: Sequence[Contributor]
) -> Mapping[str, CycloidStageSummary]:
    """That of a reducer by its name; nothing where the formula knows none of its contributors."""
    first = own.first
    drawn = ((each.name, acts[each.name].effect, each.draw.sigma) for each in contributors)
    sources = PaperSources.of(drawn)
    if not sources.tolerances:
        return {}
    held = None if first is None else sun_held_factor(own.profile.lobes, *first.teeth)
    return {own.name: stage_by_formula(own.profile, sources, held)}


def stage_by_formula(profile: DiscProfile, sources: PaperSources, sun_held: float | None) -> CycloidStageSummary:
    """Each source by both, and totals.

    Args:
        profile: of the discs.
        sources: of the scene, see PaperSources.
        sun_held: see paper_formula.sun_held_factor; None where the cranks are the input.
    """
    own = terms(profile, sources.tolerances)
    cycloid, carrier = first_principles_totals(own)
    return made(
        CycloidStageSummary,
        sources={term.source: _source(term) for term in own},
        by_formula=_formula_totals(own),
        first_principles=made(
            StageTotals,
            cycloid_arcsec=THREE_SIGMA * cycloid,
            carrier_arcsec=THREE_SIGMA * carrier,
            added_arcsec=THREE_SIGMA * (cycloid + carrier),
            root_sum_square_arcsec=THREE_SIGMA * math.hypot(cycloid, carrier),
        ),
        sun_held=sun_held,
        left_out=list(sources.left_out),
    )


def _source(term: Term) -> SourceByFormula:
    return made(
        SourceByFormula,
        tolerance_um=1e3 * term.tolerance,
        by_formula_arcsec=THREE_SIGMA * term.paper,
        first_principles_arcsec=THREE_SIGMA * term.first_principles,
        arcsec_per_um=THREE_SIGMA / 3.0 * term.lever / 1e3,
    )


def _formula_totals(own: tuple[Term, ...]) -> FormulaTotals:
    found = paper_totals(own)
    law = found.cycloid_law
    return made(
        FormulaTotals,
        cycloid_arcsec=THREE_SIGMA * found.cycloid,
        carrier_arcsec=THREE_SIGMA * found.carrier,
        added_arcsec=THREE_SIGMA / 3.0 * found.arithmetic,
        root_sum_square_arcsec=THREE_SIGMA / 3.0 * found.root_sum_square,
        cycloid_half_range_arcsec=THREE_SIGMA / 3.0 * law.half_range(),
        cycloid_coverage_percent=100.0 * law.coverage(3.0 * found.cycloid) if found.cycloid > 0.0 else 100.0,
    )
