"""Trains as summary.json shows them: their stages, and the sums of the stages' ends."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tol3d.distributions import Distribution
from tol3d.gearing.breakdowns import staged_measures
from tol3d.gearing.model import Backlash, LostMotion, Measure, Model
from tol3d.gearing.model.measure import AnyStage, ParallelStage, Tip
from tol3d.gearing.stack_up import per_normal_backlash
from tol3d.gears import LEFT
from tol3d.system.outcome import ANALYTIC
from tol3d.system.pooled import PooledTerms
from tol3d.system.system import Published
from tol3d.units import ARCMIN

ENDS = ("low_3sigma", "mean", "high_3sigma")

Pooled = Mapping[str, Mapping[str, PooledTerms]]
"""By measure and road."""


def train_sections(model: Model, pooled: Pooled, published: Published) -> dict[str, Any]:
    """The trains as summary.json shows them: their shafts, ratios, stages, and the sums of the stages' ends."""
    return {
        measure.kind.train: _train(model, measure, measure.kind, pooled[measure.name], published)
        for measure in staged_measures(model)
        if isinstance(measure.kind, LostMotion)
    }


def _train(
    model: Model, measure: Measure, kind: LostMotion, roads: Mapping[str, PooledTerms], others: Published
) -> dict[str, Any]:
    train = model.train(kind.train)
    found = {road: _within_sheets(model, _of_road(kind.stages, own)) for road, own in roads.items()}
    published = _published(model, kind, found[ANALYTIC], others)
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
        return whole | {"gears": None, "teeth": None, "working_flank": None, "ways": len(stage.paths)}
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


def _of_road(stages: Sequence[AnyStage], tallied: PooledTerms) -> dict[str, Ends]:
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


def _published(
    model: Model, kind: LostMotion, ours: Mapping[str, Ends], others: Published
) -> dict[str, dict[str, Ends]]:
    """Columns of others that have every mesh of a train, by link [arcmin]; what is no single mesh is as we have it."""
    found: dict[str, dict[str, Ends]] = {}
    if not any(stage.backlash for stage in kind.stages):
        return found
    for column, measures in others.items():
        ends = {
            stage.link: ours[stage.link] if stage.backlash is None else _published_ends(model, measures, stage.backlash)
            for stage in kind.stages
        }
        if all(ends.values()):
            found[column] = ends
    return found


def _published_ends(model: Model, measures: Mapping[str, Mapping[str, Any]], backlash: Backlash) -> Ends:
    """Somebody's lost motion of a mesh's driven gear, or else his normal backlash as such a turn; empty for neither."""
    for quantity in ("angular_backlash", "normal_backlash"):
        for measure in model.measures:
            kind = measure.kind
            alike = isinstance(kind, Backlash) and (kind.quantity, kind.mesh) == (quantity, backlash.mesh)
            values = measures.get(measure.name, {})
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
