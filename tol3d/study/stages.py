"""What each stage of a train leaves free, and its part in the sum: gathered block by block, shown in summary.json."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.distributions import Distribution
from tol3d.gearing.model import Backlash, LostMotion, Measure, Model
from tol3d.gearing.model.measure import AnyStage, ParallelStage, Tip
from tol3d.gearing.stack_up import per_normal_backlash
from tol3d.gears import LEFT
from tol3d.runs.outcome import told
from tol3d.statistics import FeatureSums, Moments
from tol3d.study.block import Columns, stage_column, staged_measures
from tol3d.units import ARCMIN

Array = NDArray[np.float64]

ENDS = ("low_3sigma", "mean", "high_3sigma")


@dataclass(frozen=True)
class Stages:
    """One road's stages of a train, in the order of the measure's; trials that did not seat are left out.

    Args:
        moments: of each stage's own lost motion, at the shaft that it drives [arcmin].
        sums: their co-moments; the last stage is the target.
    """

    moments: tuple[Moments, ...]
    sums: FeatureSums

    @classmethod
    def of(cls, road: str, measure: Measure, columns: Columns) -> "Stages | None":
        """The stages of one block; None where that road was not gone."""
        names = [stage_column(road, measure, stage.link) for stage in stages_of(measure)]
        if names[0] not in columns:
            return None
        rows = np.stack([np.asarray(columns[name], dtype=np.float64) for name in names])
        whole = np.asarray(told(columns, road, measure.name).values, dtype=np.float64)
        rows = rows[:, ~np.isnan(rows.sum(axis=0) + whole)]
        return cls(tuple(Moments.of(row) for row in rows), FeatureSums.of_each(rows[:-1], rows[-1:])[0])

    def merge(self, other: "Stages") -> "Stages":
        """Both blocks as one."""
        moments = zip(self.moments, other.moments, strict=True)
        return Stages(tuple(mine.merge(its) for mine, its in moments), self.sums.merge(other.sums))

    def shares(self, factors: Array) -> Array:
        """Each stage's part of the variance of the sum of factor times stage, (stages,); nan where nothing varies."""
        with np.errstate(invalid="ignore"):
            parts = factors * (self.sums.comoments @ factors)
            return np.asarray(parts / parts.sum())


StageTallies = Mapping[str, Mapping[str, Stages]]
"""By measure and road."""


def stages_of(measure: Measure) -> tuple[AnyStage, ...]:
    """The stages that a train's measure adds up, from the held shaft on."""
    if not isinstance(measure.kind, LostMotion):
        raise TypeError(f"{measure.name} has no stages")
    return measure.kind.stages


def stage_tallies(model: Model, columns: Columns) -> StageTallies:
    """The stages of every train of a model, of one block."""
    return {
        measure.name: {
            road: stages for road in ("analytic", "geometric") if (stages := Stages.of(road, measure, columns))
        }
        for measure in staged_measures(model)
    }


def merged(mine: StageTallies, its: StageTallies) -> StageTallies:
    """Both as one."""
    return {
        name: {road: stages.merge(its[name][road]) for road, stages in roads.items()} for name, roads in mine.items()
    }


# as summary.json shows them -------------------------------------------------------------------------


def train_summaries(model: Model, tallies: StageTallies) -> dict[str, Any]:
    """The trains as summary.json shows them: their shafts, ratios, stages, and the sums of the stages' ends."""
    return {
        measure.kind.train: _train(model, measure, measure.kind, tallies[measure.name])
        for measure in staged_measures(model)
        if isinstance(measure.kind, LostMotion)
    }


def _train(model: Model, measure: Measure, kind: LostMotion, roads: Mapping[str, Stages]) -> dict[str, Any]:
    train = model.train(kind.train)
    tallied = stages_of(measure)
    found = {road: _within_sheets(model, _of_road(tallied, own)) for road, own in roads.items()}
    published = _published(model, kind, found["analytic"])
    tip = _tip_of(model, kind)
    return {
        "driven": train.driven,
        "held": train.held,
        "output": train.output,
        "ratio": float(model.layout.ratio(train.driven, train.output)),
        "shaft": kind.shaft,
        "measure": measure.name,
        "unit": "arcmin",
        "lever_mm": tip.lever if tip else None,
        "point": f"{tip.point} of {tip.arm}" if tip else None,
        "stages": [
            {
                **_link(model, stage),
                "factor": stage.factor,
                "roads": {road: own[stage.link] for road, own in found.items()},
                "published": {
                    column: own[stage.link] for column, own in published.items() if stage.backlash is not None
                },
            }
            for stage in kind.stages
        ],
        "sums": {
            **{road: _sums(kind, own) for road, own in found.items()},
            "published": {column: _sums(kind, own) for column, own in published.items()},
        },
    }


def _tip_of(model: Model, kind: LostMotion) -> Tip | None:
    """The first point that the scene measures on the shaft that is read."""
    kinds = (measure.kind for measure in model.measures)
    read = (own for own in kinds if isinstance(own, LostMotion) and (own.train, own.shaft) == (kind.train, kind.shaft))
    return next((own.tip for own in read if own.tip), None)


def _link(model: Model, stage: AnyStage) -> dict[str, Any]:
    """What a stage is: its shafts, gears and ratio."""
    if isinstance(stage, ParallelStage):
        ratio = float(model.layout.ratio(stage.first, stage.last))
        whole = {"link": stage.link, "kind": "parallel", "driver": stage.first, "driven": stage.last, "ratio": ratio}
        return whole | {"gears": None, "teeth": None, "working_flank": None, "ways": len(stage.ways)}
    link = next(link for link in model.layout.links if link.name == stage.link)
    own: dict[str, Any] = {"link": link.name, "kind": "reducer", "driver": link.driver, "driven": link.driven}
    own |= {"gears": None, "teeth": None, "ratio": float(1 / link.rate), "working_flank": None}
    if stage.backlash:
        mesh = model.mesh(stage.link)
        pair = mesh.pair
        own["kind"] = "bevel_mesh" if pair.arm_spread else "mesh"
        own |= {"gears": [mesh.driver, mesh.driven], "teeth": [pair.pinion.teeth, pair.wheel.teeth]}
        own["working_flank"] = "left" if mesh.working_flank == LEFT else "right"
    return own


Ends = Mapping[str, float | None]


def _of_road(stages: Sequence[AnyStage], tallied: Stages) -> dict[str, Ends]:
    """What a road found of each stage, by link."""
    shares = tallied.shares(np.array([stage.factor for stage in stages]))
    return {
        stage.link: {
            "low_3sigma": moments.mean - 3 * moments.sigma,
            "mean": moments.mean,
            "high_3sigma": moments.mean + 3 * moments.sigma,
            "sigma": moments.sigma,
            "sample_min": moments.minimum,
            "sample_max": moments.maximum,
            "share_percent": 100 * float(share) if np.isfinite(share) else None,
        }
        if moments.count > 1
        else dict.fromkeys((*ENDS, "sigma", "sample_min", "sample_max", "share_percent"))
        for stage, moments, share in zip(stages, tallied.moments, shares, strict=True)
    }


def _within_sheets(model: Model, ends: Mapping[str, Ends]) -> dict[str, Ends]:
    """Ends of a reducer's play no further than its law goes, which 3 sigma may."""
    laws = {
        link: contributor.distribution
        for link in ends
        for contributor in model.contributors
        if contributor.effect.play_of(link)
    }
    return {link: _within(own, laws[link]) if link in laws else own for link, own in ends.items()}


def _within(ends: Ends, law: Distribution) -> Ends:
    low, high = ends["low_3sigma"], ends["high_3sigma"]
    if low is None or high is None:
        return ends
    return {**ends, "low_3sigma": max(low, law.low * ARCMIN), "high_3sigma": min(high, law.high * ARCMIN)}


def _published(model: Model, kind: LostMotion, ours: Mapping[str, Ends]) -> dict[str, dict[str, Ends]]:
    """Columns of others that tell every mesh of a train, by link [arcmin]; what is no single mesh is as we have it."""
    found: dict[str, dict[str, Ends]] = {}
    if not any(stage.backlash for stage in kind.stages):
        return found
    for column in model.published:
        ends = {
            stage.link: ours[stage.link] if stage.backlash is None else _published_ends(model, column, stage.backlash)
            for stage in kind.stages
        }
        if all(ends.values()):
            found[column] = ends
    return found


def _published_ends(model: Model, column: str, backlash: Backlash) -> Ends:
    """Somebody's lost motion of a mesh's driven gear, or else his normal backlash as such a turn; empty for neither."""
    for quantity in ("angular_backlash", "normal_backlash"):
        for measure in model.measures:
            kind = measure.kind
            alike = isinstance(kind, Backlash) and (kind.quantity, kind.mesh) == (quantity, backlash.mesh)
            values = model.published[column].get(measure.name, {})
            if alike and isinstance(kind, Backlash) and any(end in values for end in ENDS):
                per = per_normal_backlash(model, backlash) / per_normal_backlash(model, kind)
                return {end: values[end] * per * ARCMIN if end in values else None for end in ENDS}
    return {}


def _sums(kind: LostMotion, by_link: Mapping[str, Ends]) -> dict[str, float | None]:
    """The sums of the stages' ends at the shaft that is read: the worst case, not the distribution of the sum."""
    sums: dict[str, float | None] = {}
    for end in ENDS:
        parts = [(stage.factor, by_link[stage.link].get(end)) for stage in kind.stages]
        known = [factor * value for factor, value in parts if value is not None]
        sums[end] = sum(known) if len(known) == len(parts) else None
    return sums
