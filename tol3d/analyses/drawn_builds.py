"""Builds as a study draws them, as many as an analysis takes, and as if one tolerance were half as wide."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from tol3d.analyses.response import Response
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

HALF: Final = 0.5


def drawn_builds(response: Response, count: int) -> tuple[Array, Mapping[str, Array]]:
    """So many builds as the study draws them, deviations and positions, by independent draws whatever its sampler."""
    study = response.simulation.study
    if study.sampler != "monte_carlo":
        simulation = replace(response.simulation, study=replace(study, sampler="monte_carlo", replicates=1))
        response = replace(response, simulation=simulation)
    return response.drawn(count)


def halved_deviations(response: Response, name: str, deviations: Array) -> Array:
    """Deviations (n, components) with a contributor's law half as wide about its middle, and what follows it.

    Of a law that cannot be scaled the deviations themselves are halved about their mean.

    Args:
        response: whose draws.
        name: of the contributor.
        deviations: as `drawn_builds` drew them (n, components) [mm, rad, K].
    """
    try:
        other = response.scaled({name: HALF}, {name: "middle"})
    except InputError:
        found, own = np.array(deviations), response.slices[name]
        mean = np.asarray(response.draws[name].mean(turning=False))
        found[:, own] = mean + HALF * (deviations[:, own] - mean)
        return found
    return drawn_builds(other, len(deviations))[0]
