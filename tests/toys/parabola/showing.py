"""Springs as they are shown: bars that lift, a picture and a table of their terms."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np

from tol3d.errors import InputError
from tol3d.report.body import Body, World, built_body
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, line
from tol3d.report.presenter import Draw, FurtherRow, View, Which
from tol3d.report.system_check import system_blocks
from tol3d.simulate import Replay, replay, replayed, simulation_again
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.worst import worst_trial
from tol3d.study.system.stated import mean_build, nominal_build
from toys.parabola.bar import Bar
from toys.parabola.springs import Springs
from toys.parabola.summary import TermsOfRun
from toys.parabola.system import Lifted, ParabolaSystem

if TYPE_CHECKING:
    from tol3d.study.runs.run import Run
    from tol3d.study.runs.summary.run import RunSummary
    from tol3d.study.trials.simulation import Simulation

SIDE = 5.0  # mm
DEFLECTION = 0.01  # mm; of flat faces there is none


def bar(springs: Springs, height: float) -> Body:
    """A bar as long as the spring, lifted by a height [mm]."""
    pose = np.eye(4)
    pose[2, 3] = height
    shape = Bar(SIDE, springs.spring.length)
    return built_body(springs.spring.name, shape, pose, "#4682B4", deflection=DEFLECTION)


@dataclass(frozen=True)
class LiftedDisplay:
    """A spring of one trial."""

    label: str
    lifted: Lifted
    notes: tuple[str, ...] = ()

    @property
    def worlds(self) -> tuple[World, ...]:
        return (World("lift", (bar(self.lifted.springs, self.lifted.height),)),)

    def view(self, close_up: str | None) -> View:
        if close_up is not None:
            raise InputError(f"nothing of a spring is shown close up, not {close_up}")
        return View()


@dataclass(frozen=True)
class TermRow:
    """Sigma of a term by each method [µm]."""

    sigma: Annotated[Mapping[str, float | None], Shows("{key}", ".3f")]


class SpringPresenter:
    """Implements Presenter."""

    def pictures(self, summary: "RunSummary") -> Mapping[str, Draw]:
        return {"terms": partial(_draw, summary)} if isinstance(summary, TermsOfRun) else {}

    def sections(self, summary: "RunSummary") -> Sequence[PageItem]:
        if not isinstance(summary, TermsOfRun) or summary.terms is None:
            return ()
        methods = summary.terms["height"]
        rows = [
            (name, TermRow({method: own[name].sigma for method, own in methods.items()}))
            for name in methods["analytic"]
        ]
        return (declared_table("term: sigma [µm]", rows),)

    def measure_rows(self, measure: MeasureSummary, summary: "RunSummary") -> Sequence[FurtherRow]:
        if not isinstance(summary, TermsOfRun) or summary.terms is None or measure.kind != "height":
            return ()
        return (FurtherRow("mean of the bow", {r: t["bow"].mean for r, t in summary.terms["height"].items()}),)

    def check(self, simulation: "Simulation") -> Sequence[PageItem]:
        assert isinstance(simulation.system, ParabolaSystem)
        spring = simulation.system.springs.spring
        own = line(f"spring {spring.name}: a {spring.a:g}, b {spring.b:g}, q {spring.q:g}")
        return (own, *system_blocks(simulation))

    def display(self, run: "Run", which: Which, *, magnify: float) -> LiftedDisplay:
        trial = worst_trial(run) if which == "worst" else which
        if isinstance(trial, int):
            seen = replay(run, trial)
        else:
            simulation = simulation_again(run)
            system = simulation.system
            build = nominal_build(system) if trial == "nominal" else mean_build(system, system.measures[0])
            seen = replayed(simulation, build)
        if magnify != 1.0:
            seen = replayed(seen.simulation, seen.trials.scaled(magnify))
        return self.replayed(seen, f"trial-{trial}" if isinstance(trial, int) else trial)

    def replayed(self, replay: Replay, label: str) -> LiftedDisplay:
        lifted: Lifted = replay.build
        return LiftedDisplay(label, lifted)


def _draw(summary: TermsOfRun, path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(3, 2), dpi=50)
    terms = (summary.terms or {})["height"]["geometric"]
    figure.add_subplot().bar(list(terms), [term.sigma or 0.0 for term in terms.values()])
    figure.savefig(path)


PRESENTER = SpringPresenter()
