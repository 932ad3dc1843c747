"""Gears inside rings whose flanks deviate tooth by tooth, of helical teeth: see deviated_helical.py.

Along a flank counts its roll times the gear's sense, from the root to the tip of a ring's too; the offset of a ring's
flank shortens the string of the space's involute by as much as that of an external gear is lengthened.
"""

from typing import NamedTuple

from tol3d.gearing.engines.exact.deviated import offsets_in
from tol3d.gearing.engines.exact.deviated_helical import (
    deviated_screw_begun,
    deviated_screw_flank,
    deviated_screw_foot,
    deviated_screw_grown,
    deviated_screw_leaning,
    deviated_screw_line_of_action,
    deviated_screw_section,
    deviated_screw_turn,
    of_screw,
    plain_screw,
)
from tol3d.gearing.engines.exact.foot import (
    begun,
    first_face,
    flank_of,
    flanks_in,
    foot,
    grown,
    internal,
    leaning,
    line_of_action,
    middle_face,
    never_quickly,
    no_promise,
    promise,
    quick_turn,
    section,
    turn_to,
)
from tol3d.gearing.engines.exact.helical import InternalHelicalTooth
from tol3d.numerics.compiled import variant


class DeviatedInternalHelicalTooth(NamedTuple):
    """Flanks of one gear of an internal helical pair, and the offset of one of them.

    Args:
        base ... sense: as of InternalHelicalTooth.
        scale ... helix: as of DeviatedTooth, rolls times the sense.
    """

    base: float
    per_arm: float
    cosine: float
    rise: float
    twist: float
    half: float
    begin: float
    end: float
    low: float
    high: float
    sense: float
    scale: float
    middle: float
    per_length: float
    per_face: float
    waves: float
    level: float
    slope: float
    form: float
    helix: float


internal(DeviatedInternalHelicalTooth)
for shared, own in (
    (begun, deviated_screw_begun),
    (first_face, middle_face),
    (flank_of, deviated_screw_flank),
    (flanks_in, offsets_in),
    (foot, deviated_screw_foot),
    (grown, deviated_screw_grown),
    (leaning, deviated_screw_leaning),
    (line_of_action, deviated_screw_line_of_action),
    (promise, no_promise),
    (quick_turn, never_quickly),
    (section, deviated_screw_section),
    (turn_to, deviated_screw_turn),
):
    variant(shared, DeviatedInternalHelicalTooth)(own)


@variant(plain_screw, DeviatedInternalHelicalTooth)
def ring_screw(tooth: DeviatedInternalHelicalTooth) -> InternalHelicalTooth:
    """Without the offsets."""
    t = tooth
    profile = (t.half, t.begin, t.end)
    return InternalHelicalTooth(t.base, t.per_arm, t.cosine, t.rise, t.twist, *profile, t.low, t.high, t.sense)


@variant(of_screw, DeviatedInternalHelicalTooth)
def deviated_ring_screw(
    tooth: DeviatedInternalHelicalTooth,
    screw: InternalHelicalTooth,
    scale: float,
    flank: tuple[float, float, float, float],
) -> DeviatedInternalHelicalTooth:
    """With the offsets."""
    s, t = screw, tooth
    place = (s.base, s.per_arm, s.cosine, s.rise, s.twist, s.half, s.begin, s.end, s.low, s.high, s.sense)
    shape = (t.scale * scale, t.middle, t.per_length, t.per_face / scale, t.waves)
    return DeviatedInternalHelicalTooth(*place, *shape, *flank)
