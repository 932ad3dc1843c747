"""Tables of a scene's RV reducer."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.cycloid.model.limits import largest_pin_radius
from tol3d.cycloid.presenting.formulas import stage_blocks
from tol3d.cycloid.reducer.formula import stages_by_formula
from tol3d.cycloid.reducer.rv_set import RVSet
from tol3d.cycloid.rv_link import RVLink
from tol3d.cycloid.system import RVSystem
from tol3d.reducers.shown import gear_sizes
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, Table, line
from tol3d.runs.summary.shows import Computed, Shows
from tol3d.system.contributor import Contributor

ARC_SECONDS: Final = math.degrees(1.0) * 3.6  # that 1 um turns what is 1 mm away


def blocks(reducer: RVSystem | RVLink, contributors: Sequence[Contributor]) -> Sequence[PageItem]:
    """Ratio, profile, levers and transmission error by formula."""
    own, acts = reducer.own, reducer.acts
    first = own.first
    gears = {} if first is None else {name: first.gear(name) for name in (first.sun, first.planet)}
    formulas = stage_blocks(stages_by_formula(own, acts, contributors))
    return (*map(line, _words(own)), *gear_sizes(gears, acts, contributors), _levers(own), *formulas)


def _words(own: RVSet) -> list[str]:
    profile, first = own.profile, own.first
    stage = "the cranks are the input"
    if first is not None:
        backlash = f"normal backlash {1e3 * first.pair.normal_backlash:z.3f} µm"
        stage = f"{first.sun} {first.teeth[0]} and {first.planet} {first.teeth[1]} teeth, {backlash}"
    return [
        f"{own.name}: {own.carrier} is the output, {own.ring} fixed; ratio {own.ratio}; {own.discs} discs, "
        f"{own.cranks} cranks; {stage}",
        f"{profile.lobes} lobes, {profile.pins} pins of radius {profile.pin_radius:g} mm on "
        f"{profile.pin_circle_radius:g} mm, eccentricity {profile.eccentricity:g} mm: K = {profile.shortening:.6f}, "
        f"largest lever {profile.pitch_radius:.4f} mm at {math.degrees(profile.best_phase):.4f}°, pin radius below "
        f"{largest_pin_radius(profile):.4f} mm",
        f"pins work whose lever is over {own.window:g} of the largest; with the input held, turns of a disc count "
        f"{1 / (1 + own.rolling / profile.lobes):.5f} at the output",
    ]


@dataclass(frozen=True)
class LeverRow:
    """The turn of a disc by 1 µm, and how much of it is 1 at the output."""

    disc: Annotated[float, Shows("at the disc [″]", ".4f")]
    held: float
    output = Computed(Shows("at the output [″]", ".4f"), lambda own: own.disc / own.held)


def _levers(own: RVSet) -> Table:
    radius, k = own.profile.pitch_radius, own.profile.shortening
    rows = {
        "disc displaced across": 1.0,
        "pin outwards": math.sqrt(1 - k**2),
        "pin round, lobe pitch": k,
        "pin radius, lobe profile": 1.0,
    }
    held = 1 + own.rolling / own.profile.lobes
    levers = [(name, LeverRow(ARC_SECONDS * share / radius, held)) for name, share in rows.items()]
    return declared_table("what 1 µm does at the best pin", levers)
