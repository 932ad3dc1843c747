"""The whole model: frozen, in mm and rad, ready for trials."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from tol3d.gears import Flank, Gear, GearPair
from tol3d.model.contributor import Contributor
from tol3d.model.measure import Measure


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


@dataclass(frozen=True)
class Study:
    """How many trials, from which seed, by which engine, with how many profile steps a flank."""

    trials: int = 2000
    seed: int = 1
    sampler: Literal["monte_carlo"] = "monte_carlo"
    engine: Literal["exact", "fcl", "analytic"] = "fcl"
    witness: int = 0
    profile_steps: int = 120


@dataclass(frozen=True)
class Model:
    """Everything that a trial needs. Parts, contributors and measures keep the scene's order."""

    name: str
    gears: tuple[GearPart, ...]
    housings: tuple[Housing, ...]
    contributors: tuple[Contributor, ...]
    meshes: tuple[Mesh, ...]
    measures: tuple[Measure, ...]
    study: Study
    published: Mapping[str, Mapping[str, Mapping[str, Any]]] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

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
