"""Check that a gearing can be built: meshes and parallel load paths, with every contributor at its mean."""

from collections.abc import Iterator
from dataclasses import replace

from tol3d.gearing.methods.analytic import analytic_backlashes, analytic_play
from tol3d.gearing.model import Backlash, LostMotion, Measure, Model
from tol3d.gearing.model.measure import ParallelStage
from tol3d.gearing.play.linked import link_trials
from tol3d.study.system.stated import mean_build, nominal_build
from tol3d.study.system.system import KeyPath
from tol3d.study.system.trials import Trials

Problem = tuple[KeyPath, str]
"""Place in the scene, and the message."""

ZERO_BACKLASH = 1e-9  # mm or rad; zero nominal backlash is allowed, and closed forms round to 1e-14


def interferences(model: Model) -> Iterator[Problem]:
    """Problems of the mean build: meshes whose non-working flanks overlap, load paths that bind, and those of links."""
    nominal = nominal_build(model)
    checked: set[str] = set()
    for measure in model.measures:
        mean = mean_build(model, measure)
        for link in (model.link(name) for _, name in measure.kind.links if name not in checked):
            checked.add(link.name)
            yield from link.problems(link_trials(model, measure, link, mean))
        for backlash, values in analytic_backlashes(model, measure, mean):
            if float(values.min()) < -ZERO_BACKLASH:
                before = dict(analytic_backlashes(model, measure, nominal))[backlash]
                yield _interfering(model, measure, backlash, (float(values.min()), float(before.min())))
        if isinstance(measure.kind, LostMotion) and analytic_play(model, measure, mean).bound().any():
            yield _binding(model, measure, measure.kind, (mean, nominal))


def _interfering(model: Model, measure: Measure, backlash: Backlash, mean_and_nominal: tuple[float, float]) -> Problem:
    mesh = model.mesh(backlash.mesh)
    name = measure.name if measure.kind == backlash else f"the angular backlash of {backlash.gear}"
    reading = replace(measure, kind=backlash)
    mean, nominal = (value * reading.per_internal for value in mean_and_nominal)
    return (
        ("moves", mesh.name),
        f"the teeth interfere at the mean build: {name} is {mean:.3f} {reading.unit} there "
        f"(nominal {nominal:.3f} {reading.unit}); {mesh.pair.remedy}",
    )


def _binding(model: Model, measure: Measure, kind: LostMotion, builds: tuple[Trials, Trials]) -> Problem:
    paths = ", ".join(stage.link for stage in kind.stages if isinstance(stage, ParallelStage))
    angle = replace(measure, kind=replace(kind, quantity="lost_motion", tip=None, turned=()))
    mean, nominal = (float(analytic_play(model, angle, build).free().min()) * angle.per_internal for build in builds)
    return (
        ("moves", kind.train),
        f"the parallel load paths {paths} bind each other at the mean build: the lost motion of {kind.shaft} is "
        f"{mean:.3f} {angle.unit} there (nominal {nominal:.3f} {angle.unit}); thin the teeth, or "
        "set the gears otherwise on their shafts",
    )
