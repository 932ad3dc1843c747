"""Seed and contributors to trials: every draw is keyed, so a trial can be replayed alone.

A system has streams of uniforms for positions, and one for each uniform that a contributor draws; the study's sampler
draws them. A trial depends on (system, seed, trial index) and on nothing else: not on blocks or workers. Contributors
that read others are drawn after them, from streams of their own. Uniforms of correlated contributors are mixed, each
trial's by themselves.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.statistics.samplers import LatinHypercube, MonteCarlo, Sampler, Sobol, Stream
from tol3d.statistics.samplers.lazy import quick_monte_carlo
from tol3d.study.system.dependent import Dependent, DrawnAs, in_draw_order
from tol3d.study.system.draw import Draw
from tol3d.study.system.stated import component_count, component_slices
from tol3d.study.system.system import StreamKey, System
from tol3d.study.system.trials import Trials
from tol3d.study.trials.simulation import Simulation

EPSILON: Final = 2.0**-53
"""Least uniform number of a turned dimension."""

Uniforms = Callable[[str, int], Sequence[Array]]
"""So many uniforms (trials,) of a contributor by its name, correlated ones mixed."""

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


def fill(columns: Array, slices: Mapping[str, slice], contributors: Sequence[DrawnAs], uniforms: Uniforms) -> None:
    """Draw contributors into their rows of columns.

    Args:
        columns: (components, trials) [mm, rad or K].
        slices: rows of each contributor.
        contributors: each after those that it reads.
        uniforms: of each.
    """
    for contributor in contributors:
        draws = uniforms(contributor.name, contributor.draw.uniforms)
        if isinstance(contributor.draw, Dependent):
            found = contributor.draw.deviations_given(
                {name: columns[slices[name]] for name in contributor.draw.reads}, *draws
            )
        else:
            found = contributor.draw.deviations(*draws)
        for column, values in zip(columns[slices[contributor.name]], found, strict=True):
            column[:] = values


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


@dataclass(frozen=True, eq=False)
class KeptDraws:
    """Deviations of trials that are drawn again when tolerances change: only of contributors whose draw differs.

    Args:
        columns: deviations (components, trials) [mm, rad or K], each component's side by side.
        uniforms: of the contributors; each is drawn once and kept from then on.
        draws: by contributor, as it was drawn.
        slices: rows of each contributor.
        positions: from the trials' uniforms (trials,) by name.
    """

    columns: Array
    uniforms: Uniforms
    draws: Mapping[str, Draw]
    slices: Mapping[str, slice]
    positions: Mapping[str, Array]

    @property
    def deviations(self) -> Array:
        """Deviations (trials, components) [mm, rad or K]; the same memory as the columns."""
        return self.columns.T

    def redrawn(self, draws: Mapping[str, Draw]) -> "KeptDraws":
        """The same trials by other draws, to the bit as if all were drawn anew.

        Contributors whose draw is not the very object that it was are drawn, and those that read them.

        Args:
            draws: by contributor, of all of them, as a response has them.

        Raises:
            InputError: draws of other contributors, or one that takes more uniforms than the system has for it.
        """
        if draws.keys() != self.draws.keys():
            raise InputError("expected draws of the same contributors, got others")
        changed = {name for name, own in draws.items() if own is not self.draws[name]}
        again = list[DrawnAs]()
        for own in in_draw_order([DrawnAs(*each) for each in draws.items()]):
            if own.name in changed or (isinstance(own.draw, Dependent) and not changed.isdisjoint(own.draw.reads)):
                changed.add(own.name)
                again.append(own)
        columns = self.columns.copy()
        fill(columns, self.slices, again, self.uniforms)
        return replace(self, columns=columns, draws=draws)


def kept_draws(simulation: Simulation, count: int, draws: Mapping[str, Draw]) -> KeptDraws:
    """The first trials of a study by other draws than its system's, such that they can be drawn again.

    Args:
        simulation: whose study draws them.
        count: of trials.
        draws: by contributor, of all of them.

    Raises:
        InputError: a draw that takes more uniforms than the system has for it.
    """
    system = simulation.system
    streams = streams_of(system)
    sampler = sampler_of(simulation, len(streams))

    most = {contributor.name: contributor.draw.uniforms for contributor in system.contributors}

    def drawn(key: StreamKey) -> Array:
        return sampler.uniforms(streams[key], 0, count)

    all_of = _uniforms_of(simulation, drawn)

    def uniforms(name: str, wanted: int) -> Sequence[Array]:
        if wanted > most[name]:
            asked = f"{most[name]} uniform{'s' if most[name] > 1 else ''}"
            raise InputError(f"{name}: expected a draw of {asked} at most, got one of {wanted}")
        return all_of(name, wanted)

    columns, slices = np.empty((component_count(system), count)), component_slices(system)
    fill(columns, slices, in_draw_order([DrawnAs(*own) for own in draws.items()]), uniforms)
    positions = system.positions({key: drawn(key) for key in system.streams})
    return KeptDraws(columns, cache(uniforms), draws, slices, positions)


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
    system = simulation.system
    columns = np.empty((component_count(system), count))
    contributors = [DrawnAs(contributor.name, contributor.draw) for contributor in system.contributors]
    fill(columns, component_slices(system), in_draw_order(contributors), _uniforms_of(simulation, uniforms))
    return columns.T


def _uniforms_of(simulation: Simulation, uniforms: Callable[[StreamKey], Array]) -> Uniforms:
    copula = simulation.copula
    mixed = copula.uniforms({name: uniforms((name, "0")) for name in copula.names})
    return lambda name, count: [mixed[name]] if name in mixed else [uniforms((name, str(k))) for k in range(count)]
