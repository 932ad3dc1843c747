"""Sections of summary.json for measures of gears, and for trains: their stages, and the sums of the stages' ends."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tol3d.gearing.grammar.published import PublishedEnds, PublishedTrain
from tol3d.gearing.model import Backlash, LostMotion, Measure, Model, TransmissionError
from tol3d.gearing.model.measure import AnyStage, ParallelStage, Tip
from tol3d.gearing.model.measure import Reading as ModelReading
from tol3d.gearing.play.linked import link_contributors
from tol3d.gearing.play.play import staged_measures
from tol3d.gearing.shafts import Mesh
from tol3d.gearing.stack_up import per_normal_backlash
from tol3d.gearing.summary.measure_words import Reading
from tol3d.gearing.summary.types import (
    BacklashWords,
    Ends,
    FreeTurn,
    StageMethods,
    StageSummary,
    Sums,
    TrainMeasureWords,
    TrainSummary,
    TransmissionErrorWords,
)
from tol3d.gears import LEFT
from tol3d.scene.published import PublishedColumn
from tol3d.study.runs.summary.values import made
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC
from tol3d.study.system.pooled import PooledTerms
from tol3d.study.system.system import Published
from tol3d.units import ARCMIN, Quantity


def description(model: Model, measure: Measure) -> Mapping[str, Any]:
    """Kind, of what, how it is read; of a normal backlash also the turn that it leaves free per um."""
    kind = measure.kind
    if isinstance(kind, Backlash):
        if kind.quantity == "rest_angle":
            raise ValueError(f"{measure.name}: an angle at rest is no measure, others are made of it")
        own = made(
            BacklashWords,
            kind=kind.quantity,
            of=kind.mesh,
            gear=kind.gear,
            reading=_reading(kind.reading),
            lost_motion=_free_turn(model, kind),
        )
        return dict(own.items())
    if isinstance(kind, TransmissionError):
        return _transmission_error(kind)
    words = made(
        TrainMeasureWords,
        kind=kind.quantity,
        of=kind.train,
        gear=None,
        reading=None,
        readings={backlash.mesh: _reading(backlash.reading) for _, backlash in kind.backlashes},
        shaft=kind.shaft,
        held=kind.held,
        arm=kind.tip.arm if kind.tip else None,
        point=kind.tip.point if kind.tip else None,
        lever_mm=kind.tip.lever if kind.tip else None,
        load_changes_deg=np.degrees(kind.changes).tolist(),
    )
    return dict(words.items())


def _transmission_error(kind: TransmissionError) -> Mapping[str, Any]:
    own = made(
        TransmissionErrorWords,
        kind="transmission_error",
        of=kind.of,
        gear=kind.gear,
        flank=kind.flank,
        reading=None,
        readings={backlash.mesh: _reading(backlash.reading) for _, backlash in kind.backlashes},
    )
    return dict(own.items())


def _reading(reading: ModelReading) -> Reading:
    return made(Reading, contact=reading.contact, gap=reading.gap, teeth=reading.teeth)


def _free_turn(model: Model, kind: Backlash) -> FreeTurn | None:
    """Lost motion by a normal backlash; None of others, and where shafts that cross their clearances add to it."""
    if kind.quantity != "normal_backlash" or model.reverses(model.mesh(kind.mesh)):
        return None
    driven = model.mesh(kind.mesh).driven
    turn = per_normal_backlash(model, Backlash("angular_backlash", kind.mesh, driven))
    return made(FreeTurn, of=driven, arcmin_per_um=turn * np.degrees(60) / 1000)


ENDS = ("low_3sigma", "mean", "high_3sigma")

UNKNOWN = made(
    Ends, low_3sigma=None, mean=None, high_3sigma=None, sigma=None, sample_min=None, sample_max=None, share_percent=None
)
ByLink = Mapping[str, Ends]

Pooled = Mapping[str, Mapping[str, PooledTerms]]
"""By measure and method."""


def train_sections(model: Model, pooled: Pooled, published: Published) -> dict[str, TrainSummary]:
    """The trains as summary.json shows them: their shafts, ratios, stages, and the sums of the stages' ends."""
    return {
        measure.kind.train: _train(model, measure, measure.kind, pooled[measure.name], published)
        for measure in staged_measures(model)
        if isinstance(measure.kind, LostMotion)
    }


def _train(
    model: Model, measure: Measure, kind: LostMotion, methods: Mapping[str, PooledTerms], others: Published
) -> TrainSummary:
    train = model.train(kind.train)
    found = {method: _within_sheets(model, _of_method(kind.stages, own)) for method, own in methods.items()}
    published = _published(model, kind, found[ANALYTIC], others)
    tip = _tip_of(model, kind)
    return made(
        TrainSummary,
        driven=train.driven,
        held=train.held,
        output=train.output,
        ratio=float(model.layout.ratio(train.driven, train.output)),
        shaft=kind.shaft,
        measure=measure.name,
        unit="arcmin",
        lever_mm=tip.lever if tip else None,
        point=f"{tip.point} of {tip.arm}" if tip else None,
        stages=[_stage(model, stage, found, published.stages) for stage in kind.stages],
        sums=made(
            Sums,
            analytic=_sums(kind, found[ANALYTIC]),
            geometric=_sums(kind, found[GEOMETRIC]) if GEOMETRIC in found else None,
            published=published.sums,
        ),
    )


def _tip_of(model: Model, kind: LostMotion) -> Tip | None:
    """The first point that the scene measures on the shaft that is read."""
    kinds = (measure.kind for measure in model.measures)
    read = (own for own in kinds if isinstance(own, LostMotion) and (own.train, own.shaft) == (kind.train, kind.shaft))
    return next((own.tip for own in read if own.tip), None)


def _stage(
    model: Model, stage: AnyStage, methods: Mapping[str, ByLink], published: Mapping[str, ByLink]
) -> StageSummary:
    """A stage: its shafts, gears and ratio, and its results."""
    mesh = model.mesh(stage.link) if stage.backlash else None
    if isinstance(stage, ParallelStage):
        driver, driven, ratio = stage.first, stage.last, float(model.layout.ratio(stage.first, stage.last))
    else:
        link = next(link for link in model.layout.links if link.name == stage.link)
        driver, driven, ratio = link.driver, link.driven, float(1 / link.rate)
    return made(
        StageSummary,
        link=stage.link,
        kind=_kind(model, stage, mesh),
        driver=driver,
        driven=driven,
        gears=[mesh.driver, mesh.driven] if mesh else None,
        teeth=[mesh.pair.pinion.teeth, mesh.pair.wheel.teeth] if mesh else None,
        ratio=ratio,
        working_flank=None if mesh is None else "left" if mesh.working_flank == LEFT else "right",
        ways=len(stage.paths) if isinstance(stage, ParallelStage) else None,
        factor=stage.factor,
        methods=made(
            StageMethods,
            analytic=methods[ANALYTIC][stage.link],
            geometric=methods[GEOMETRIC][stage.link] if GEOMETRIC in methods else None,
        ),
        published={column: own[stage.link] for column, own in published.items() if stage.link in own},
    )


def _kind(model: Model, stage: AnyStage, mesh: Mesh | None) -> str:
    if isinstance(stage, ParallelStage):
        return "parallel"
    if mesh is None:
        return model.link(stage.link).kind
    if mesh.pair.arm_spread:
        return "bevel_mesh"
    return "mesh" if mesh.driven_flank == mesh.working_flank else "internal_mesh"


def _of_method(stages: Sequence[AnyStage], tallied: PooledTerms) -> ByLink:
    """Results of a method for each stage, by link."""
    shares = tallied.shares(np.array([stage.factor for stage in stages]))
    return {
        stage.link: made(
            Ends,
            low_3sigma=moments.mean - 3 * moments.sigma,
            mean=moments.mean,
            high_3sigma=moments.mean + 3 * moments.sigma,
            sigma=moments.sigma,
            sample_min=moments.minimum,
            sample_max=moments.maximum,
            share_percent=100 * float(share) if np.isfinite(share) else None,
        )
        if moments.count > 1
        else UNKNOWN
        for stage, moments, share in zip(stages, tallied.moments, shares, strict=True)
    }


def _within_sheets(model: Model, ends: ByLink) -> ByLink:
    """Ends of a link's play, clipped to its laws, which 3 sigma may exceed."""
    known = {link.name: link.ends(link_contributors(model, link.name)) for link in model.links}
    return {link: _within(own, known.get(link)) for link, own in ends.items()}


def _within(ends: Ends, law: tuple[float, float] | None) -> Ends:
    low, high = ends.low_3sigma, ends.high_3sigma
    if law is None or low is None or high is None:
        return ends
    return ends.model_copy(update={"low_3sigma": max(low, law[0] * ARCMIN), "high_3sigma": min(high, law[1] * ARCMIN)})


@dataclass(frozen=True)
class _Others:
    """Published figures for a train [arcmin], by column: of stages, by link, and the sum of the stages' ends."""

    stages: Mapping[str, ByLink]
    sums: ByLink


def _published(model: Model, kind: LostMotion, ours: ByLink, others: Published) -> _Others:
    """Published figures for a train itself; else those that follow from all of its meshes.

    A stage that is no single mesh takes our own figures if none are published.
    """
    stages: dict[str, ByLink] = {}
    sums: dict[str, Ends] = {}
    for column, figures in others.items():
        train: PublishedTrain | None = figures.figures.get("trains", {}).get(kind.train)
        said = {link: _stated_ends(own) for link, own in train.stages.items()} if train else {}
        of_meshes = _ends_of_meshes(model, kind, figures, said)
        stages[column] = {**of_meshes, **said}
        if train and train.sums:
            sums[column] = _stated_ends(train.sums)
        elif of_meshes:
            sums[column] = _sums(kind, {**ours, **of_meshes, **said})
    return _Others(stages, sums)


def _ends_of_meshes(model: Model, kind: LostMotion, figures: PublishedColumn, said: ByLink) -> ByLink:
    """Each mesh's ends from published figures; nothing if one of them has none."""
    meshes = {stage.link: stage.backlash for stage in kind.stages if stage.backlash is not None}
    ends = {link: said.get(link) or _published_ends(model, figures, own) for link, own in meshes.items()}
    known = {link: own for link, own in ends.items() if own is not None}
    return known if len(known) == len(ends) else {}


def _stated_ends(published_ends: PublishedEnds) -> Ends:
    return Ends(
        **{key: value for key in Ends.model_fields if (value := _arcmin(getattr(published_ends, key))) is not None}
    )


def _arcmin(value: Quantity | float | None) -> float | None:
    """An angle as in summaries; a share unchanged."""
    return value.internal * ARCMIN if isinstance(value, Quantity) else value


def _published_ends(model: Model, measures: PublishedColumn, backlash: Backlash) -> Ends | None:
    """Published lost motion of a mesh's driven gear, or else published normal backlash as such a turn; else None."""
    for quantity in ("angular_backlash", "normal_backlash"):
        for measure in model.measures:
            kind = measure.kind
            alike = isinstance(kind, Backlash) and (kind.quantity, kind.mesh) == (quantity, backlash.mesh)
            values = measures[measure.name].internal if measure.name in measures else {}
            if alike and isinstance(kind, Backlash) and any(end in values for end in ENDS):
                per = per_normal_backlash(model, backlash) / per_normal_backlash(model, kind)
                low, mean, high = (values[end] * per * ARCMIN if end in values else None for end in ENDS)
                return made(Ends, low_3sigma=low, mean=mean, high_3sigma=high)
    return None


def _sums(kind: LostMotion, by_link: ByLink) -> Ends:
    """The sums of the stages' ends at the shaft that is read, all of them at theirs: no distribution of the sum."""

    def added(end: str) -> float | None:
        parts = [(stage.factor, by_link[stage.link].value(end)) for stage in kind.stages]
        known = [factor * value for factor, value in parts if value is not None]
        return sum(known) if len(known) == len(parts) else None

    low, mean, high = map(added, ENDS)
    return made(Ends, low_3sigma=low, mean=mean, high_3sigma=high)
