"""Settings of a study: number of trials, their draws, the engine, and when they may stop."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

from tol3d.errors import InputError
from tol3d.scene.options import Option
from tol3d.statistics.samplers.replicates import SamplerKind, balanced_trials, is_power_of_two, uneven

PpkBy = Literal["quantiles", "sigma"]


class Until(NamedTuple):
    """Standard errors [mm or rad] of a measure's mean and sigma at which a study may stop; None is not asked for."""

    measure: str
    mean: float | None
    sigma: float | None


@dataclass(frozen=True)
class Study:
    """Number of trials, their seed and sampling, and the engine.

    With `until` the number is a maximum. `replicates` of a sampler are parts of equal size, each randomised
    anew. `ppk_by` is the basis of Ppk; None takes that of the trials' law. `accept_ppk` is asked of measures;
    None asks for a share out of limits. `options` are those of the system's
    vocabulary adds, for its own use.
    """

    trials: int = 2000
    seed: int = 1
    sampler: SamplerKind = "monte_carlo"
    replicates: int = 1
    until: tuple[Until, ...] = ()
    engine: str = "exact"
    witness: int = 0
    ppk_by: PpkBy | None = None
    accept_ppk: float | None = None
    options: Mapping[str, Option] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse trials that the replicates cannot share evenly: a run's may be other than its scene's.

        Raises:
            InputError: with the nearest numbers that would do.
        """
        if problem := uneven(self.sampler, self.trials, self.replicates):
            raise InputError(f"trials: expected {problem}, got {self.trials}")

    @property
    def stated(self) -> dict[str, Any]:
        """All of it by the keys of a summary, options among them."""
        return {name: value for name, value in vars(self).items() if name != "options"} | dict(self.options)

    @property
    def replicate_trials(self) -> int:
        """Trials of one replicate."""
        return self.trials // self.replicates

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of settings that make its numbers worse than they need be."""
        if self.sampler != "sobol" or is_power_of_two(self.replicate_trials):
            return ()
        return (
            f"study: Sobol' points are even in powers of two, not in {self.replicate_trials} a replicate; "
            f"take {balanced_trials(self.trials, self.replicates)} trials",
        )
