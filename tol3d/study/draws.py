"""Seed and contributors to deviations: every draw is keyed, so a trial can be replayed alone.

A model has a stream of uniforms for each component of a contributor and for the position of each tree of shafts; the
study's sampler draws them. A trial depends on (model, seed, trial index) and on nothing else: not on blocks or workers.
"""

import math
from collections.abc import Mapping
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Model, Planar, Positions
from tol3d.gearing.model.layout import Drive
from tol3d.samplers import LatinHypercube, MonteCarlo, Sampler, Sobol, Stream
from tol3d.samplers.lazy import quick_monte_carlo

Array = NDArray[np.float64]

DRIVER_POSITION = "driver position"
MOST_PERIODS = Fraction(2**30)  # of 52 bits of a draw 22 are left to say where in one of them a mesh stands


def streams_of(model: Model) -> Mapping[tuple[str, str], Stream]:
    """Every stream by name and component: trees of shafts, then contributors, their components, in the scene's order.

    Driver positions come first, where Sobol' points are most even: they act together with all that turns, in waves of
    as many turns as the long period has (of the spur pair 55: its mean is three times as exact at 16 384 trials).
    """
    keys = [(drive.name, DRIVER_POSITION) for drive in model.layout.drives]
    keys += [(c.name, str(k)) for c in model.contributors for k in range(c.draw.uniforms)]
    return {key: Stream(*key, dimension) for dimension, key in enumerate(keys)}


def sampler_of(model: Model, seed: int) -> Sampler:
    """The study's sampler."""
    study = model.study
    if study.sampler == "sobol":
        return Sobol(seed, study.replicate_trials, len(streams_of(model)))
    if study.sampler == "latin_hypercube":
        return LatinHypercube(seed, study.replicate_trials)
    return quick_monte_carlo(seed) if study.engine == "exact" else MonteCarlo(seed)


def deviations(model: Model, seed: int, first: int, count: int) -> Array:
    """Deviations of trials first ... first + count - 1: (count, components) [mm, rad or K].

    Columns follow `model.component_slices`.
    """
    sampler, streams = sampler_of(model, seed), streams_of(model)
    columns = np.empty((model.component_count, count))
    for contributor in model.contributors:
        draws = [
            sampler.uniforms(streams[contributor.name, str(k)], first, count) for k in range(contributor.draw.uniforms)
        ]
        for column, values in zip(
            columns[model.component_slices[contributor.name]], contributor.draw.deviations(*draws), strict=True
        ):
            column[:] = values
    return columns.T


def mean_deviations(model: Model, positions: Positions) -> Array:
    """Every contributor at its mean, shape (1, components).

    A random direction averages to zero, and so does an offset that turns with its gear at random positions.
    """
    row = np.zeros((1, model.component_count))
    for contributor in model.contributors:
        columns = model.component_slices[contributor.name]
        mean = contributor.distribution.mean
        if not isinstance(contributor.draw, Planar):
            row[:, columns] = mean
        elif contributor.draw.direction is not None and not (
            positions.over == "random" and contributor.effect.turns_with is not None
        ):
            angle = contributor.draw.direction
            row[:, columns] = (mean * math.cos(angle), mean * math.sin(angle))
    return row


def driver_angles(model: Model, seed: int, first: int, count: int) -> Mapping[str, Array]:
    """Driver position of each trial [rad] (count,) by mesh.

    The first shaft of a tree stands uniform over its long period, so that each mesh stands uniform over its own.
    """
    sampler, streams = sampler_of(model, seed), streams_of(model)
    angles: dict[str, Array] = {}
    for drive in model.layout.drives:
        uniforms = sampler.uniforms(streams[drive.name, DRIVER_POSITION], first, count)
        periods = _periods(model, drive)
        angles |= {mesh: _of_long_period(model, mesh, own, uniforms) for mesh, own in periods.items()}
    return angles


def _periods(model: Model, drive: Drive) -> Mapping[str, Fraction]:
    """How many long periods of its own each mesh goes through in that of its tree, or in its first MOST_PERIODS."""
    periods = {
        mesh: drive.turns * abs(model.layout.mesh_turn[mesh].rate) / model.mesh(mesh).pair.long_period_turns
        for mesh in drive.meshes
    }
    share = min(Fraction(1), MOST_PERIODS / max(periods.values()))
    return {mesh: own * share for mesh, own in periods.items()}


def _of_long_period(model: Model, mesh: str, periods: Fraction, uniforms: Array) -> Array:
    """The driver's angle of a mesh where its tree stands at a share (count,) of so many of its long periods."""
    turning, turns = model.layout.mesh_turn[mesh], model.mesh(mesh).pair.long_period_turns
    share = uniforms if periods == 1 else np.mod(float(periods) * uniforms, 1.0)
    return turning.offset + math.copysign(2 * math.pi * turns, turning.rate) * share
