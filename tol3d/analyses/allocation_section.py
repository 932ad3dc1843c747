"""The result of an allocation, as a run keeps it.

Tolerances of a scene and their contributors: the scope of one factor, and writing it back.
"""

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from tol3d.analyses.kept_changes import scene_with
from tol3d.analyses.response import Response
from tol3d.analyses.stated_changes import Change
from tol3d.errors import InputError
from tol3d.scene import Scene
from tol3d.statistics.distributions.base import Stays
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import Count, Known, Label, NotNegative, Number, Ppm, PpmRange, Section, Sentence
from tol3d.study.trials.simulation import Line


class Allocated(Section):
    """A tolerance: its factor, its cost, and the reason for it."""

    factor: Annotated[NotNegative, Shows("factor", ".4g")]
    cost: Annotated[Number, Shows("cost", ".4g")]
    before: Annotated[Label, Shows("before", "words")]
    after: Annotated[Label, Shows("after", "words")]
    held: Annotated[Sentence, Shows("", "words")] = Field(
        description='"", or what holds it: a bound, what is physical, frozen, cannot be scaled'
    )


class TargetFound(Section):
    """Builds beyond limits [ppm], as asked for and as found."""

    measure: Label
    sides: list[Label]
    wanted: Annotated[Ppm, Shows("wanted", "ppm")]
    scene: Annotated[Ppm, Shows("scene", "ppm")]
    first_order: Annotated[Ppm, Shows("first order", "ppm")]
    ppm: Annotated[Ppm, Shows("by sampling", "ppm")]
    interval: Annotated[PpmRange, Shows("95 %", "ppm range")]


class CostAt(Section):
    """The least cost for a share out of limits [ppm], by first order as corrected; None where no factors reach it."""

    ppm: Ppm
    cost: Annotated[Known, Shows("cost", ".4g")]


class Allocation(Section):
    """Factors of least cost, and their results by simulation."""

    targets: list[TargetFound]
    tolerances: dict[Label, Allocated]
    cost: Number
    scene_cost: Number
    equal_factor: Known
    equal_cost: Known
    trade_off: list[CostAt]
    rounds: Count
    draws: Count
    evaluations: Count

    @property
    def factors(self) -> dict[str, float]:
        """By tolerance."""
        return {name: own.factor for name, own in self.tolerances.items()}


def groups_of(response: Response) -> Mapping[str, tuple[str, ...]]:
    """Contributors by the name of their tolerance: one, or one for each feature and part that it is of."""
    return {name: own.contributors for name, own in _tolerances(response).items()} or response.lines


def _tolerances(response: Response) -> dict[str, Line]:
    """The lines of a scene, those of one tolerance together: that of a pattern, and that of its motion."""
    found: dict[tuple[str, ...], list[Line]] = {}
    for line in response.simulation.lines:
        found.setdefault(line.entries or (line.name,), []).append(line)
    return {
        (name := min((own.name for own in lines), key=len)): Line(
            name, tuple(contributor for own in lines for contributor in own.contributors), lines[0].entries
        )
        for lines in found.values()
    }


def allocated_scene(scene: Scene, response: Response, found: Allocation, stays: Mapping[str, Stays]) -> Scene:
    """The scene with allocated tolerances, in its text too.

    Raises:
        InputError: one whose width the scene states in no numbers.
    """
    groups = groups_of(response)
    changes = [
        Change(line, factor=own.factor, stays=stays.get(name))
        for name, own in found.tolerances.items()
        for line, contributors in response.lines.items()
        if own.factor != 1.0 and contributors[0] in groups[name]
    ]
    try:
        return scene_with(response, scene, changes, physical=False)
    except InputError as error:
        raise InputError(f"{error}; --freeze it, or leave --out") from None
