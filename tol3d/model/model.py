"""The whole model: frozen, in mm and rad, ready for trials."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, NamedTuple

from tol3d.errors import InputError
from tol3d.gears import Flank, Gear, GearPair
from tol3d.model.contributor import Contributor
from tol3d.model.measure import Measure
from tol3d.samplers.replicates import SamplerKind, balanced_trials, is_power_of_two, uneven


@dataclass(frozen=True)
class GearPart:
    """A gear: its nominal geometry and its coefficient of expansion [1/K]."""

    name: str
    gear: Gear
    expansion: float = 0.0


@dataclass(frozen=True)
class Housing:
    """What holds the axes apart: it gives the centre distance its coefficient of expansion [1/K]."""

    name: str
    expansion: float


@dataclass(frozen=True)
class Mesh:
    """The move that turns the driven gear until the working flanks touch.

    World of the mesh: the frame of the driver at rest; the pair knows where the driven gear's lies in it.
    `working_flank` is the driver's.
    """

    name: str
    driver: str
    driven: str
    pair: GearPair
    working_flank: Flank
    housing: str | None = None

    def gear(self, name: str) -> Gear:
        """The driver or the driven gear, by its name."""
        return self.pair.pinion if name == self.driver else self.pair.wheel


class Until(NamedTuple):
    """Standard errors [mm or rad] of a measure's mean and sigma at which a study may stop; None is not asked for."""

    measure: str
    mean: float | None
    sigma: float | None


@dataclass(frozen=True)
class Study:
    """How many trials, drawn from which seed and how, by which engine, with how many profile steps a flank.

    With `until` the trials are those at most. `replicates` of a sampler are parts of equal size, each randomised
    anew.
    """

    trials: int = 2000
    seed: int = 1
    sampler: SamplerKind = "monte_carlo"
    replicates: int = 1
    until: tuple[Until, ...] = ()
    engine: Literal["exact", "fcl", "analytic"] = "exact"
    witness: int = 0
    profile_steps: int = 120

    def __post_init__(self) -> None:
        """Refuse trials that the replicates cannot share evenly: a run's may be other than its scene's.

        Raises:
            InputError: with the nearest numbers that would do.
        """
        if problem := uneven(self.sampler, self.trials, self.replicates):
            raise InputError(f"trials: expected {problem}, got {self.trials}")

    @property
    def replicate_trials(self) -> int:
        """Trials of one replicate."""
        return self.trials // self.replicates

    @property
    def warnings(self) -> tuple[str, ...]:
        """What makes its numbers worse than they need be."""
        if self.sampler != "sobol" or is_power_of_two(self.replicate_trials):
            return ()
        return (
            f"study: Sobol' points are even in powers of two, not in {self.replicate_trials} a replicate; "
            f"take {balanced_trials(self.trials, self.replicates)} trials",
        )


@dataclass(frozen=True)
class Model:
    """Everything that a trial needs. Parts, contributors and measures keep the scene's order.

    `gear_warnings` are what the gears' geometry may spoil.
    """

    name: str
    gears: tuple[GearPart, ...]
    housings: tuple[Housing, ...]
    contributors: tuple[Contributor, ...]
    meshes: tuple[Mesh, ...]
    measures: tuple[Measure, ...]
    study: Study
    published: Mapping[str, Mapping[str, Mapping[str, Any]]] = field(default_factory=dict)
    gear_warnings: tuple[str, ...] = ()

    @property
    def warnings(self) -> tuple[str, ...]:
        """What may spoil the numbers of this study."""
        return (*self.gear_warnings, *self.study.warnings)

    def gear(self, name: str) -> GearPart:
        """The gear of that name."""
        return self.gears[self.gear_index[name]]

    def mesh(self, name: str) -> Mesh:
        """The mesh of that name."""
        return next(mesh for mesh in self.meshes if mesh.name == name)

    @cached_property
    def gear_index(self) -> Mapping[str, int]:
        """Position of each gear in arrays over gears."""
        return {part.name: index for index, part in enumerate(self.gears)}

    @cached_property
    def expansions(self) -> Mapping[str, float]:
        """Coefficient of expansion [1/K] of every part."""
        gears = {part.name: part.expansion for part in self.gears}
        return gears | {part.name: part.expansion for part in self.housings}

    @cached_property
    def component_slices(self) -> Mapping[str, slice]:
        """Which columns of the deviations belong to each contributor."""
        slices, start = {}, 0
        for contributor in self.contributors:
            width = len(contributor.draw.components)
            slices[contributor.name] = slice(start, start + width)
            start += width
        return slices

    @property
    def component_count(self) -> int:
        """Columns of the deviations."""
        return sum(len(contributor.draw.components) for contributor in self.contributors)
