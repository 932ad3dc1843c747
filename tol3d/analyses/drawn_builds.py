"""Builds as a study draws them, as many as an analysis takes."""

from collections.abc import Mapping
from dataclasses import replace

from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array


def drawn_builds(response: Response, count: int) -> tuple[Array, Mapping[str, Array]]:
    """So many builds as the study draws them, deviations and positions, by independent draws whatever its sampler."""
    study = response.simulation.study
    if study.sampler != "monte_carlo":
        simulation = replace(response.simulation, study=replace(study, sampler="monte_carlo", replicates=1))
        response = replace(response, simulation=simulation)
    return response.drawn(count)
