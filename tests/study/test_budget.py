"""Builds after the trials are less than those of the trials, and what they leave out is said."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES

from tol3d import Overrides, load_scene
from tol3d.statistics.distributions.normal import Normal
from tol3d.study.effects import acting_contributors
from tol3d.study.effects.high_low_mean import extents
from tol3d.study.results import attribution
from tol3d.study.results.summary import study_summary
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.runs.summary.run import Findings
from tol3d.study.system.draw import Draw, Planar, Scalar
from tol3d.study.system.measure import Measure
from tol3d.study.system.plain import PlainContributor, PlainMeasure, PlainSystem
from tol3d.study.system.stated import component_slices, mean_deviations
from tol3d.study.system.system import System
from tol3d.study.system.trials import Trials
from tol3d.study.tallies.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.trials import budget
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.evaluation import Asked, Evaluation
from tol3d.study.trials.overrides import simulation_of
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

Array = NDArray[np.float64]

CONTACTS = 10_000
LENGTHS, PLANES = 12, 20
SLOPES = np.cos(np.arange(1, LENGTHS + 2 * PLANES + 1))
"""Slope of each component, all of them different."""


@dataclass(frozen=True)
class Dear(PlainSystem):
    """A sum of lengths and of displacements in a plane, one of each measure the other way round, with a dear build.

    Args:
        wrong: slope of the first contributor on the exact method, over that on the analytic one.
    """

    wrong: float = 1.0

    def cost(self, measures: Sequence[Measure]) -> int:
        return CONTACTS * len(measures)

    def analytic(self, trials: Trials, measure: Measure) -> Array:
        slopes = SLOPES if measure.name == "one" else SLOPES[::-1]
        found: Array = trials.deviations @ slopes
        return found

    def exact(self, trials: Trials, measure: Measure) -> Array:
        other = trials.deviations.copy()
        other[:, 0] *= self.wrong
        curved = 0.02 * (trials.deviations[:, 1] ** 2 - trials.deviations[:, 2] * trials.deviations[:, 5])
        return self.analytic(Trials(other, {}), measure) + curved


def dear(wrong: float = 1.0) -> Dear:
    law = Normal(0.03, 0.2)
    draws: list[Draw] = [*(Scalar(law) for _ in range(LENGTHS)), *(Planar(law, None) for _ in range(PLANES))]
    contributors = tuple(PlainContributor(f"x{k}", "x", own, "1", 1.0) for k, own in enumerate(draws))
    measures = tuple(PlainMeasure(name, name, unit="mm", per_internal=1.0) for name in ("one", "other"))
    return Dear("dear", contributors, measures, wrong)


def found_in(simulation: Simulation) -> Findings:
    """Findings of a study, from statistics of its trials."""
    system, trials = simulation.system, simulation.study.trials
    method = method_of(simulation, materials_of(simulation))
    grids = grids_of(system, columns_of(system, method, drawn(simulation, 0, PILOT_TRIALS)))
    tally = Tally.of(simulation, grids, columns_of(system, method, drawn(simulation, 0, trials)))
    with counted(system) as spent:
        found = study_summary(simulation, method, tally)
    of_a_trial = 2 * (20 + system.cost(system.measures))
    little = 4 * len(system.contributors) + 8  # nominal and mean builds, and each mean alone
    few = 3 * 150_000 + little * of_a_trial / 6 + 400 * (20 + system.cost(system.measures[:1]))
    assert sum(spent) <= 0.95 * trials * of_a_trial + few
    return found


@contextmanager
def counted(system: System) -> Iterator[list[float]]:
    """Contacts of builds that any method is asked for; of those in which one contributor alone is off the mean, 1/6."""
    spent: list[float] = []
    slices = component_slices(system).values()
    asked = Evaluation.asked

    def counting(self: Evaluation, trials: Trials, measures: Sequence[Measure]) -> Iterator[Asked]:
        off = trials.deviations != mean_deviations(system, measures[0].positions)
        alone = sum(off[:, own].any(axis=1).astype(int) for own in slices) <= 1
        spent.append(float(np.where(alone, 1 / 6, 1.0).sum()) * (20 + system.cost(measures)))
        return asked(self, trials, measures)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Evaluation, "asked", counting)
        yield spent


def of_dear(trials: int, wrong: float = 1.0) -> Findings:
    return found_in(Simulation(dear(wrong), Study(trials=trials)))


def left_out(found: Findings) -> list[str]:
    return [words for words in found.warnings if "more trials let more builds follow them" in words]


def test_what_builds_after_a_short_dear_run_leave_out_is_said() -> None:
    """377 looks of 4 builds by both methods would take ten times as long as 150 trials."""
    found = of_dear(150)
    (words,) = left_out(found)
    assert words.startswith("why the methods differ: ")
    assert all(own.high_low_mean_percent is not None for own in found.measures["one"].contributors)


def test_high_low_mean_is_left_out_of_a_run_that_is_shorter_than_its_builds() -> None:
    """104 builds of one contributor each take as long as 17 others, three quarters of 10 trials by two methods 15."""
    found = of_dear(10)
    leading, analytic = left_out(found)
    assert leading.startswith("high–low–mean was not looked at")
    assert analytic.startswith("one, other: shares of the analytic method are of what little a regression explains")
    assert all(own.high_low_mean_percent is None for own in found.measures["one"].contributors)


def test_a_long_run_leaves_nothing_out() -> None:
    found = of_dear(4000)
    assert left_out(found) == []
    agreement = found.measures["one"].agreement
    assert agreement is not None
    assert agreement.explanation is not None
    assert agreement.explanation.undecided == ""
    assert agreement.explanation.second_order_of[0] == "x1"  # of no other contributor alone


@pytest.mark.parametrize(("trials", "told"), [(300, False), (4000, True)])
def test_a_wrong_slope_is_told_where_builds_are_enough_and_left_open_where_they_are_not(
    trials: int, told: bool
) -> None:
    found = of_dear(trials, wrong=1.1)
    agreement = found.measures["one"].agreement
    assert agreement is not None
    explanation = agreement.explanation
    assert explanation is not None
    assert any("the two methods disagree on x0:" in fault for fault in explanation.faults) is told
    assert ("it depends on x0 by more than 2 % of their own effects" in explanation.undecided) is not told


def test_measures_of_several_mean_builds_have_what_each_of_them_wants() -> None:
    """Transmission errors take a hundred times what a backlash at a random position takes."""
    system = simulation_of(load_scene(SCENES / "tooth_deviations.yaml"), Overrides()).system
    measures = [own for own in system.measures if own.take != "curve"]
    whole = extents(system, measures)
    assert len({round(own.contacts) for own in whole}) > 1
    enough = sum(own.contacts for own in whole)
    assert [own.exact for own in extents(system, measures, enough)] == [own.asking for own in whole]
    assert None in [own.exact for own in extents(system, measures, enough / 100)]


# shares ---------------------------------------------------------------------------------------------------------------


def test_uses_that_want_little_leave_the_rest_to_the_others() -> None:
    """A million let 750 000 follow, 30 to 35 to 10 parts of 75; what tells shares and what acts has the rest."""
    others = budget.OTHER_METHOD + attribution.MOST_OF_RUN + acting_contributors.SHARE
    assert sum(budget.SHARES.values()) + others == pytest.approx(1.0)
    everything: dict[budget.Use, float] = dict.fromkeys(budget.SHARES, 1e9)
    assert budget.shared(1e6, everything) == pytest.approx(
        {"high-low-mean": 3e5, "second look": 3.5e5, "second differences": 1e5}
    )
    assert budget.shared(1e6, everything | {"high-low-mean": 3e4}) == pytest.approx(
        {"high-low-mean": 3e4, "second look": 7.2e5 * 7 / 9, "second differences": 7.2e5 * 2 / 9}
    )
    little: dict[budget.Use, float] = {"high-low-mean": 3e5, "second look": 4e5, "second differences": 5e4}
    assert budget.shared(1e6, little) == pytest.approx(little)
    assert budget.shared(0.0, {"high-low-mean": 1e9}) == {"high-low-mean": budget.FREE}


@pytest.mark.slow
@pytest.mark.parametrize("scene", sorted(path.stem for path in SCENES.glob("*.yaml")))
def test_builds_after_the_trials_of_a_bundled_scene_are_less_than_the_trials(scene: str) -> None:
    trials = 40 if scene == "robot_arm" else 200
    assert found_in(simulation_of(load_scene(SCENES / f"{scene}.yaml"), Overrides(trials=trials, engine="exact")))
