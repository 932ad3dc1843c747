"""Rare events as a section of a run: numbers alone, from which the table and the picture are made."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from pydantic import Field

from tol3d.analyses.blame import failure_shares
from tol3d.analyses.design_points import DesignPoint
from tol3d.analyses.limit_state import Side
from tol3d.analyses.rare_events import Method, RareEvent
from tol3d.analyses.response import Response
from tol3d.report.number import limit_text
from tol3d.study.runs.summary.shows import Shows, shown
from tol3d.study.runs.summary.values import Count, Known, Label, Number, Numbers, Ppm, PpmRange, Section, Sentence, made
from tol3d.study.system.trials import Trials


class WayThere(Section):
    """A contributor in a design point."""

    name: Label
    deviations: Numbers = Field(description="its components")
    unit: Label
    percent: Number = Field(description="its share of the square of the distance")


class DesignBuild(Section):
    """The most likely build beyond a limit."""

    beta: Number = Field(description="its distance from the mean build, in standard normals; below 0 if that one fails")
    positions: dict[Label, Number] = Field(description="at which it is read")
    contributors: list[WayThere] = Field(description="the largest shares first")


class LimitLeft(Section):
    """Probability of leaving a limit."""

    measure: Label
    side: Side
    limit: Number
    unit: Label
    method: Method
    ppm: Annotated[Ppm | None, Shows("ppm", "ppm")] = Field(
        description="of builds beyond the limit; null where the method does not know it"
    )
    ppm_se: Known = Field(description="one standard error")
    ppm_interval: Annotated[PpmRange | None, Shows("95 %", "ppm range")] = Field(
        description="that holds it with 95 % confidence"
    )
    first_order_ppm: Annotated[Ppm | None, Shows("first order", "ppm")]
    second_order_ppm: Annotated[Ppm | None, Shows("second order", "ppm", seldom=True)] = Field(
        description="by Hohenbichler and Rackwitz"
    )
    breitung_ppm: Ppm | None = Field(description="second order by Breitung")
    unseated_percent: Number = Field(description="share of the failing builds that cannot be assembled")
    design_points: Annotated[Count, Shows("points", "d", optional=True)] = Field(
        description="of all positions together"
    )
    design_point: DesignBuild | None = Field(description="the nearest one")
    draws: Count
    evaluations: Annotated[Count, Shows("builds", "d")] = Field(description="builds that it took")
    warnings: list[Sentence]

    @shown(Shows("β", ".3f", behind="second_order_ppm"))
    def beta(self) -> float | None:
        """Distance of its nearest design point."""
        return None if self.design_point is None else self.design_point.beta

    @shown(Shows("limit", behind=""))
    def words(self) -> str:
        """The limit as it is left: `< 15 µm`."""
        return f"{'<' if self.side == 'low' else '>'} {limit_text(self.limit, self.unit)}"


class RareEvents(Section):
    """Probabilities of leaving limits."""

    scene: Label
    seed: Count
    limits: list[LimitLeft]


def rare_section(name: str, seed: int, response: Response, events: Sequence[RareEvent]) -> RareEvents:
    """Section on limits.

    Args:
        name: of the scene.
        seed: of the draws.
        response: of all measures.
        events: of the limits.
    """
    units = {measure.name: measure.unit for measure in response.measures}
    return made(
        RareEvents,
        scene=name,
        seed=seed,
        limits=[_limit(response, event, units[event.measure]) for event in events],
    )


def _limit(response: Response, event: RareEvent, unit: str) -> LimitLeft:
    found, second = event.estimate, event.second_order
    return made(
        LimitLeft,
        measure=event.measure,
        side=event.side,
        limit=float(event.limit),
        unit=unit,
        method=event.method,
        ppm=_ppm(found.probability),
        ppm_se=_ppm(found.error),
        ppm_interval=None if found.interval is None else [1e6 * own for own in found.interval],
        first_order_ppm=_ppm(event.first_order),
        second_order_ppm=_ppm(second.hohenbichler if second else None),
        breitung_ppm=_ppm(second.breitung if second else None),
        unseated_percent=100.0 * found.unseated,
        design_points=len(event.points),
        design_point=_build(response, event.points[0]) if event.points else None,
        draws=found.draws,
        evaluations=event.evaluations,
        warnings=[*found.warnings],
    )


def _ppm(value: float | None) -> float | None:
    return None if value is None else 1e6 * value


def design_trials(response: Response, point: DesignPoint) -> Trials:
    """The trial of a design point: its deviations and its position."""
    return Trials(response.deviations(point.normals[None]), point.positions)


def _build(response: Response, point: DesignPoint) -> DesignBuild:
    trials = design_trials(response, point)
    shares = failure_shares(response, [point], np.ones(1))
    ways = [
        made(
            WayThere,
            name=contributor.name,
            deviations=(trials.deviations[0, response.slices[contributor.name]] / contributor.per_unit).tolist(),
            unit=contributor.unit,
            percent=100.0 * shares[contributor.name],
        )
        for contributor in sorted(response.contributors, key=lambda each: -shares[each.name])
    ]
    return made(DesignBuild, beta=point.beta, positions=_positions(response, trials), contributors=ways)


def _positions(response: Response, trials: Trials) -> dict[str, float]:
    columns = response.simulation.system.columns(trials)
    return {name: float(own[0]) for name, own in columns.items() if np.issubdtype(own.dtype, np.number)}
