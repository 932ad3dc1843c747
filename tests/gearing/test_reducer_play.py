"""A reducer's play as the sums of a train's stages count it: no further than its data sheet goes."""

import pytest
from places import SCENES

from tol3d import Overrides, Run, run_scene

THREE_STAGES = SCENES / "three_stage_train.yaml"
LOW, MODE, HIGH = 2.0, 4.0, 9.0  # arcmin; the gearbox's triangular law
MEAN = (LOW + MODE + HIGH) / 3
SIGMA = ((LOW**2 + MODE**2 + HIGH**2 - LOW * MODE - LOW * HIGH - MODE * HIGH) / 18) ** 0.5
TRIALS = 2000


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    study = Overrides(trials=TRIALS, witness=0)
    return run_scene(THREE_STAGES, overrides=study, out=tmp_path_factory.mktemp("runs") / "run")


def test_three_sigma_of_its_law_reach_beyond_its_ends() -> None:
    """Else nothing would have to be cut below."""
    assert MEAN - 3 * SIGMA < LOW - 1
    assert MEAN + 3 * SIGMA > HIGH + 0.4


@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_a_reducer_s_low_and_high_are_the_ends_of_its_law(run: Run, method: str) -> None:
    (train,) = run.summary["trains"].values()
    (own,) = (stage["methods"][method] for stage in train["stages"] if stage["link"] == "gearbox")
    assert own["low_3sigma"] == pytest.approx(LOW, abs=1e-9)
    assert own["high_3sigma"] == pytest.approx(HIGH, abs=1e-9)
    assert own["mean"] == pytest.approx(MEAN, abs=4 * SIGMA / TRIALS**0.5)  # four standard errors
    assert own["sigma"] == pytest.approx(SIGMA, rel=4 / (2 * TRIALS) ** 0.5)  # at most those of a normal's sigma


@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_the_sum_of_highs_counts_the_reducer_s_ends(run: Run, method: str) -> None:
    (train,) = run.summary["trains"].values()
    for key, end in (("low_3sigma", LOW), ("high_3sigma", HIGH)):
        others = [s["factor"] * s["methods"][method][key] for s in train["stages"] if s["link"] != "gearbox"]
        (factor,) = (stage["factor"] for stage in train["stages"] if stage["link"] == "gearbox")
        assert len(others) >= 2
        assert train["sums"][method][key] == pytest.approx(sum(others) + factor * end, rel=1e-9)
