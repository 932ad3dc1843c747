"""Seed and contributors to trials: every draw is keyed, so a trial can be replayed alone.

A system has streams of uniforms for positions, and one for each uniform that a contributor draws; the study's sampler
draws them. A trial depends on (system, seed, trial index) and on nothing else: not on blocks or workers. Contributors
that read others are drawn after them, from streams of their own. Uniforms of correlated contributors are mixed, each
trial's by themselves.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.samplers import LatinHypercube, MonteCarlo, Sampler, Sobol, Stream
from tol3d.samplers.lazy import quick_monte_carlo
from tol3d.study.simulation import Simulation
from tol3d.system.dependent import Dependent, in_draw_order
from tol3d.system.stated import component_count, component_slices
from tol3d.system.system import StreamKey, System
from tol3d.system.trials import Trials

EPSILON: Final = 2.0**-53
"""Least uniform number of a turned dimension."""

MOST_EVEN = 4096  # dimensions of Sobol' points; of more they cost more than builds
MANY_STREAMS = 256  # from here on compiling what draws them pays


def streams_of(system: System) -> Mapping[StreamKey, Stream]:
    """Every stream by name and component: those of positions, then of contributors and their uniforms, in their order.

    Positions come first, where Sobol' points are most even: they act together with all that turns, in waves of
    as many turns as the long period has (of 55 turns, a mean is three times as exact at 16 384 trials).
    """
    keys = [*system.streams]
    keys += [(c.name, str(k)) for c in system.contributors for k in range(c.draw.uniforms)]
    return {key: Stream(*key, dimension) for dimension, key in enumerate(keys)}


def sampler_of(simulation: Simulation, streams: int) -> Sampler:
    """The study's sampler, for a number of streams."""
    study = simulation.study
    if study.sampler == "sobol":
        return Sobol(study.seed, study.replicate_trials, streams)
    if study.sampler == "latin_hypercube":
        return LatinHypercube(study.seed, study.replicate_trials)
    quick = simulation.method.compiled or streams > MANY_STREAMS
    return quick_monte_carlo(study.seed) if quick else MonteCarlo(study.seed)


def drawn(simulation: Simulation, first: int, count: int) -> Trials:
    """Trials first ... first + count - 1 as the study draws them."""
    return _trials(simulation, lambda sampler, stream: sampler.uniforms(stream, first, count), count)


def drawn_ones(simulation: Simulation, trials: Sequence[int]) -> Trials:
    """Some trials as the study draws them, wherever they are."""
    numbers = np.array(trials, dtype=np.int64)
    return _trials(simulation, lambda sampler, stream: sampler.uniforms_of(stream, numbers), len(numbers))


def redrawn(simulation: Simulation, count: int, names: Collection[str]) -> Trials:
    """Trials of Sobol' points, of random ones in very many dimensions, with other draws of some contributors.

    Other draws are those without them, turned by a further dimension. By itself that has its first binary digit from
    one of count - 1 rows: of a law with two values it would often give the same ones in all trials, or none of them.

    Args:
        simulation: whose seed they have.
        count: of trials; a power of two.
        names: of contributors with other draws than without them here.
    """
    system, seed = simulation.system, simulation.study.seed
    streams = streams_of(system)
    even = 2 * len(streams) <= MOST_EVEN
    sampler = Sobol(seed, count, 2 * len(streams)) if even else MonteCarlo(seed)

    def uniforms(key: StreamKey) -> Array:
        stream, other = streams[key], key[0] in names
        if not even:
            return sampler.uniforms(stream, other * count, count)
        plain = sampler.uniforms(stream, 0, count)
        if not other:
            return plain
        turn = sampler.uniforms(replace(stream, dimension=stream.dimension + len(streams)), 0, count)
        return np.maximum((plain + turn) % 1.0, EPSILON)  # a law may have no value at 0

    positions = system.positions({key: uniforms(key) for key in system.streams})
    return Trials(_deviations(simulation, uniforms, count), positions)


def deviations(simulation: Simulation, first: int, count: int) -> Array:
    """Deviations of trials first ... first + count - 1: (count, components) [mm, rad or K]."""
    streams = streams_of(simulation.system)
    sampler = sampler_of(simulation, len(streams))
    return _deviations(simulation, lambda key: sampler.uniforms(streams[key], first, count), count)


def _trials(simulation: Simulation, draw: Callable[[Sampler, Stream], Array], count: int) -> Trials:
    system = simulation.system
    streams = streams_of(system)
    sampler = sampler_of(simulation, len(streams))
    positions = system.positions({key: draw(sampler, streams[key]) for key in system.streams})
    return Trials(_deviations(simulation, lambda key: draw(sampler, streams[key]), count), positions)


def _deviations(simulation: Simulation, uniforms: Callable[[StreamKey], Array], count: int) -> Array:
    system, copula = simulation.system, simulation.copula
    mixed = copula.uniforms({name: uniforms((name, "0")) for name in copula.names})
    columns = np.empty((component_count(system), count))
    slices = component_slices(system)
    for contributor in in_draw_order(system.contributors):
        draw, own = contributor.draw, slices[contributor.name]
        if (name := contributor.name) in mixed:
            draws = [mixed[name]]
        else:
            draws = [uniforms((name, str(k))) for k in range(draw.uniforms)]
        if isinstance(draw, Dependent):
            found = draw.deviations_given({name: columns[slices[name]] for name in draw.reads}, *draws)
        else:
            found = draw.deviations(*draws)
        for column, values in zip(columns[own], found, strict=True):
            column[:] = values
    return columns.T
