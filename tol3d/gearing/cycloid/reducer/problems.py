"""Reasons why an RV reducer cannot be studied: parts interfere at the mean build, or a bearing has negative play."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from tol3d.gearing.cycloid.model.limits import LEAST_GAP, least_gap
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.reducers.deviations import Acts
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.system import KeyPath


def problems_at(
    rv_set: RVSet, acts: Mapping[str, Acts], contributors: Sequence[Contributor], deviated: RVDeviated
) -> Iterator[tuple[KeyPath, str]]:
    """Lobes and pins that overlap with every contributor at its mean, and first stages without backlash there.

    Args:
        acts: effect of each contributor, by its name.
    """
    for contributor in contributors:
        mean = contributor.draw.mean(turning=False)[0]
        if acts[contributor.name].least is not None and mean < 0.0:
            yield (
                ("tolerances", contributor.name, "distribution"),
                f"expected a mean clearance of at least 0 um, got {1e3 * mean:g} um: a preloaded "
                "bearing has no clearance, '{kind: constant, value: 0 um}'",
            )
    stage = deviated.stage
    circle, radius = float(stage.pins[..., 0].mean()), float(stage.pin_radii.mean())
    material = float(np.max(stage.lobe_profile.mean(axis=2)))
    least = least_gap(rv_set.profile, circle, radius + material)
    if least < -LEAST_GAP:
        enough = rv_set.profile.modification.offset - least
        yield (
            ("parts", rv_set.disc, "offset"),
            f"lobes and pins interfere at the mean build by {-1e3 * least:.3f} um: expected an offset of at least "
            f"{1e3 * enough:.3f} um with these means, got {1e3 * rv_set.profile.modification.offset:g} um",
        )
    if rv_set.first is not None:
        pair = rv_set.first.pair
        thicker = float(deviated.sun_thickness[0] + deviated.planet_thickness[0].max())
        backlash = pair.normal_backlash - thicker * np.cos(pair.pinion.pressure_angle)
        if backlash < -ROUNDING:
            yield (
                ("parts", rv_set.first.sun),
                f"the teeth of {rv_set.first.sun} and {rv_set.first.planet} interfere at the mean build: a normal "
                f"backlash of {1e3 * backlash:.3f} um at a centre distance of {pair.centre_distance:.4f} mm, the "
                f"radius of the circle of crankshafts; thin the teeth or shift the profiles ({pair.remedy})",
            )


ROUNDING: Final = 1e-9  # mm; no backlash is legal, and rounds to 1e-14
