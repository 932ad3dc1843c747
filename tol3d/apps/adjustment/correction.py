"""The turn of the motor that makes good for the mean lost motion of a train, and the sum of highs that it leaves.

Angles are in minutes of arc, as in columns and in summary.json.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from tol3d.apps.adjustment.robots import Robots
from tol3d.gearing.engines.gaps import STATUSES
from tol3d.gearing.model import Backlash, LostMotion, Measure, Model, Train
from tol3d.gearing.model.measure import AnyStage, ParallelStage
from tol3d.gearing.play.play import breakdowns_of, stages_of
from tol3d.gearing.stack_up import closed_form
from tol3d.gearing.summary.train_sections import train_sections
from tol3d.gearing.summary.types import Ends
from tol3d.gearing.system import gear_model
from tol3d.runs.summary.values import made
from tol3d.study import Simulation
from tol3d.study.breakdowns import pooled_terms
from tol3d.units import ARCMIN

CLOSED_FORM: Final = "closed form"


@dataclass(frozen=True)
class Correction:
    """The motor's correction by one column: a method, the closed form or a publication; None for missing values.

    Args:
        means: each compensated link's own lost motion, at its driven shaft [arcmin].
        motor: turn of the motor that makes good for them together [arcmin].
        before: sum of all stages' highs at the shaft that is read [arcmin].
        left: sum of the excess of their highs over their means, and of the uncompensated highs [arcmin].
        left_of: excess of each compensated link's own high over its mean, at its driven shaft [arcmin].
    """

    means: Mapping[str, float | None]
    motor: float | None
    before: float | None
    left: float | None
    left_of: Mapping[str, float | None]


def corrections_of(
    simulation: Simulation, train: Train, measure: Measure, compensated: Sequence[AnyStage], robots: Robots
) -> Iterator[tuple[str, Correction]]:
    """Corrections by the closed form, by each method, and by every publication of all meshes of the train."""
    model = gear_model(simulation.system)
    of_meshes = [own for own in model.measures if isinstance(own.kind, Backlash)]  # what others published of them
    known_of = replace(model, measures=(measure, *of_meshes))
    breakdowns = breakdowns_of(replace(model, measures=(measure,)))
    pooled = pooled_terms(breakdowns, STATUSES, robots.columns)
    summary = train_sections(known_of, pooled, simulation.published)[train.name]
    forms = {stage.link: _form(model, measure, stage) for stage in stages_of(measure)}
    known_forms = {link: form for link, form in forms.items() if form is not None}
    if len(known_forms) == len(forms):
        yield CLOSED_FORM, _correction(model, train, measure, compensated, known_forms)
    for method in robots.lost:
        own = {stage.link: stage.methods.by(method) for stage in summary.stages}
        yield method, _correction(model, train, measure, compensated, own)
    meshes = [stage for stage in summary.stages if stage.gears]
    for column in summary.sums.published:
        if not all(column in stage.published for stage in meshes):
            continue
        known = {stage.link: stage.published.get(column, stage.methods.analytic) for stage in summary.stages}
        yield column, _correction(model, train, measure, compensated, known)


def _form(model: Model, measure: Measure, stage: AnyStage) -> Ends | None:
    """A stage's own lost motion by the closed form [arcmin]; None where it has none."""
    form = closed_form(model, _alone(measure, stage))
    if form is None:
        return None
    return made(Ends, mean=form.mean * ARCMIN, high_3sigma=(form.mean + 3 * form.sigma) * ARCMIN)


def _alone(measure: Measure, stage: AnyStage) -> Measure:
    if not isinstance(measure.kind, LostMotion):
        raise TypeError(f"{measure.name} has no stages")
    return replace(measure, kind=replace(measure.kind, stages=(replace(stage, factor=1.0),)))


def _correction(
    model: Model, train: Train, measure: Measure, compensated: Sequence[AnyStage], ends: Mapping[str, Ends]
) -> Correction:
    means = {stage.link: ends[stage.link].mean for stage in compensated}
    turns = {stage.link: abs(float(model.layout.ratio(train.driven, _driven(model, stage)))) for stage in compensated}
    highs = [(stage.factor, ends[stage.link].high_3sigma) for stage in stages_of(measure)]
    kept = [(stage.factor, 0.0 if stage not in compensated else means[stage.link]) for stage in stages_of(measure)]
    before, known = _total(highs), _total(kept)
    return Correction(
        means=means,
        motor=_total([(turns[link], mean) for link, mean in means.items()]),
        before=before,
        left=None if before is None or known is None else before - known,
        left_of={link: _total([(1.0, ends[link].high_3sigma), (-1.0, mean)]) for link, mean in means.items()},
    )


def _driven(model: Model, stage: AnyStage) -> str:
    if isinstance(stage, ParallelStage):
        return stage.last
    return next(link.driven for link in model.layout.links if link.name == stage.link)


def _total(parts: Sequence[tuple[float, float | None]]) -> float | None:
    """The sum of factor times value; None where a value is missing."""
    known = [factor * value for factor, value in parts if value is not None]
    return sum(known) if len(known) == len(parts) else None


def at_shaft(compensated: Sequence[AnyStage], correction: Correction) -> float:
    """Turn of the output shaft due to the motor's correction [arcmin]."""
    return _total([(stage.factor, correction.means[stage.link]) for stage in compensated]) or 0.0
