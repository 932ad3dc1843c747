"""Recommended changes below the verdict of a run: as `tol3d changes` simulates them, with fewer builds.

They take a tenth of what the run took at most, by the stated cost of a build, or half a second; where that is too
little for builds that can judge a change, nothing is proposed.
"""

from dataclasses import replace
from typing import Final

from tol3d.analyses.compared_builds import limits_of
from tol3d.analyses.response import response_of
from tol3d.analyses.what_to_change import AIM, Changes, ChangesQuestion, Effort, changes_of
from tol3d.report.heading import badness
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.judged import Accepted, AcceptedPpk, JudgedMeasure, demand_of
from tol3d.study.runs.summary.values import made
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.trials.simulation import Simulation

MOST_MEASURES: Final = 3
MOST_BUILDS: Final = 1000
"""For each change."""
SHARE: Final = 0.1
"""Part of the time that the run took."""
SECONDS: Final = 0.5
"""For all measures, of a run that took less than five; by the method's stated cost of a build."""


def not_ok(run: Run, accepted: Accepted | None = None) -> list[str]:
    """Measures whose verdict is NOT OK, the worst first; by default by what the study asks."""
    found, asked = run.found.measures, demand_of(run.found.study.accept_ppk, accepted)
    names = [name for name, own in found.items() if JudgedMeasure.of(own, asked).verdict == "NOT OK"]
    return sorted(names, key=lambda name: badness(found[name].shares.out_ppm, found[name].shares.ppk))


def changes_of_run(run: Run, simulation: Simulation, accepted: Accepted | None = None) -> Changes | None:
    """Recommended changes to the scene of a run, for the worst measures; None if none leaves its limits.

    Where simulating them takes too long, no measure is looked at.
    """
    asked = demand_of(run.found.study.accept_ppk, accepted)
    accepted_ppm, ppk = (asked.beyond_one_ppm, asked.ppk) if isinstance(asked, AcceptedPpk) else (asked, AIM)
    bad = [name for name in not_ok(run, asked) if run.found.measures[name].has_limits]
    if not bad:
        return None
    response, shown = response_of(_by_the_quickest_method(simulation)), bad[:MOST_MEASURES]
    took = SHARE * simulation.study.trials * 60.0 * response.minutes
    question = ChangesQuestion(
        accepted_ppm=accepted_ppm, ppk=ppk, seconds=max(took, SECONDS) / len(shown), most_builds=MOST_BUILDS
    )
    limited = [measure.name for measure in response.measures if limits_of(measure) != (None, None)]
    if Effort.of(response.of(*limited), question).enough:
        found = changes_of(response, question, bad=shown)
        return found.model_copy(update={"further": bad[MOST_MEASURES:]})
    return made(Changes, accepted_ppm=accepted_ppm, ppk=ppk, measures={}, further=bad, evaluations=0)


def _by_the_quickest_method(simulation: Simulation) -> Simulation:
    """By the 3D simulation that takes least."""
    methods = {name: own for name, own in simulation.system.methods.items() if name != ANALYTIC_METHOD}
    if not simulation.has_geometry or not methods:
        return simulation
    quickest = max(methods, key=lambda name: (methods[name].contacts_per_minute, name == simulation.study.engine))
    return replace(simulation, study=replace(simulation.study, engine=quickest))
