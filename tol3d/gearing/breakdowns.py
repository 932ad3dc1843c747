"""Which measures of trains keep the play of each of their stages."""

from tol3d.gearing.model import LostMotion, Measure, Model
from tol3d.gearing.model.measure import AnyStage
from tol3d.system.breakdown import Breakdown, SumTerm
from tol3d.units import ARCMIN


def staged_measures(model: Model) -> tuple[Measure, ...]:
    """The measure of each train whose stages are kept: its first of one value at random positions."""
    found: dict[str, Measure] = {}
    for measure in model.measures:
        if isinstance(measure.kind, LostMotion) and measure.positions.over == "random":
            found.setdefault(measure.kind.train, measure)
    return tuple(found.values())


def breakdowns_of(model: Model) -> tuple[Breakdown, ...]:
    """The stages of each of them: lost motion [arcmin] at the shaft that each stage drives."""
    return tuple(
        Breakdown(
            measure.name, tuple(SumTerm(stage.link, stage.factor) for stage in measure.kind.stages), "arcmin", ARCMIN
        )
        for measure in staged_measures(model)
        if isinstance(measure.kind, LostMotion)
    )


def stages_of(measure: Measure) -> tuple[AnyStage, ...]:
    """The stages that a train's measure adds up, from the held shaft on."""
    if not isinstance(measure.kind, LostMotion):
        raise TypeError(f"{measure.name} has no stages")
    return measure.kind.stages
