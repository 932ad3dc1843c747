"""Contributors that read others, of a system outside the package: drawn in order, each trial by itself."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from toys.contributor import ToyContributor
from toys.registered import TOYS, known
from toys.rods import RODS
from toys.rods.system import RodsSystem, Scaled

from tol3d import Overrides, Run, replay, run_scene
from tol3d.analyses.response import response_of
from tol3d.simulate import load, simulation_of
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.study.effects.first_order import first_orders
from tol3d.study.execution.pools import Execution
from tol3d.study.runs.run import open_run
from tol3d.study.system.dependent import in_draw_order
from tol3d.study.system.draw import Scalar
from tol3d.study.system.faults import UnfitError
from tol3d.study.trials.draws import drawn, streams_of

SCENE = TOYS / "rods" / "rods.yaml"
COUNT = 200_000
NAMES = ("mark [um]", "tip [um]", "length [um]")
# um: length U(0, 100); tip U(±20) (1 + length / 100); mark U(±5) tip / 10
TIP_SIGMA = math.sqrt(20**2 / 3 * 7 / 3)  # E (1 + u)^2 = 7 / 3
MARK_SIGMA = math.sqrt(5**2 / 3) * TIP_SIGMA / 10
SIGMA = math.sqrt(100**2 / 12 + TIP_SIGMA**2 + MARK_SIGMA**2)


@pytest.fixture(scope="module", autouse=True)
def rods() -> Iterator[None]:
    with known(RODS):
        yield


@pytest.fixture(scope="module")
def run(rods: None, tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("rods")
    return run_scene(SCENE, overrides=Overrides(trials=COUNT), out=folder / "run")


def test_each_reads_the_trial_in_which_it_is(run: Run) -> None:
    mark, tip, length = (run.columns(name)[name] for name in NAMES)
    assert (np.abs(tip) <= 20 * (1 + length / 100) * (1 + 1e-12)).all()
    assert np.abs(tip).max() > 39.5  # beyond what any shorter rod has
    assert (np.abs(mark) <= 5 * np.abs(tip) / 10 * (1 + 1e-12)).all()
    assert (np.abs(mark) / np.abs(tip)).max() > 0.4999


@pytest.mark.parametrize("method", ["geometric", "analytic"])
def test_moments_are_those_of_the_mixed_laws(run: Run, method: str) -> None:
    found = run.summary["measures"]["reach"][method]
    assert found["mean"] == pytest.approx(100_050, abs=4 * SIGMA / math.sqrt(COUNT))
    assert found["sigma"] == pytest.approx(SIGMA, rel=4 * 1.5 / math.sqrt(2 * COUNT))


def test_the_closed_form_and_shares_have_the_sigma_over_all_that_is_read(run: Run) -> None:
    found = run.summary["measures"]["reach"]
    assert found["analytic_closed_form"]["sigma"] == pytest.approx(SIGMA, rel=1e-12)
    shares = {own["name"]: own["geometric_percent"] for own in found["contributors"]}
    expected = {"length": 100**2 / 12, "tip": TIP_SIGMA**2, "mark": MARK_SIGMA**2}
    for name, variance in expected.items():
        assert shares[name] == pytest.approx(100 * variance / SIGMA**2, abs=0.5)


def test_workers_and_blocks_change_no_bit(run: Run, tmp_path: Path) -> None:
    other = run_scene(SCENE, overrides=Overrides(trials=5_000), out=tmp_path / "two", execution=Execution(workers=2))
    for name in (*NAMES, "geometric:reach"):
        assert np.array_equal(other.columns(name)[name], run.columns(name)[name][:5_000])


def test_a_trial_alone_is_that_of_the_run(run: Run) -> None:
    for trial in (0, 17, 70_000, COUNT - 1):
        again = replay(run, trial)
        assert again.geometric["reach"] == run.columns("geometric:reach")["geometric:reach"][trial]


def test_a_kept_run_is_whole_without_the_scene(run: Run) -> None:
    assert open_run(run.path).trials == COUNT


@pytest.mark.parametrize("sampler", ["monte_carlo", "sobol", "latin_hypercube"])
def test_uniforms_are_keyed_by_name_and_in_the_scene_s_order(sampler: str) -> None:
    """Reading changes no stream: the length is drawn as alone, the dimensions of nets are in the scene's order."""
    simulation = simulation_of(load(SCENE), Overrides(sampler=sampler, trials=4096))
    names = [name for name, _ in streams_of(simulation.system)]
    assert names == ["mark", "tip", "length"]
    trials = drawn(simulation, 0, 4096).deviations
    system = simulation.system
    assert isinstance(system, RodsSystem)
    laws = [own.draw.distribution for own in system.contributors if isinstance(own.draw.distribution, Distribution)]
    alone = tuple(replace(own, draw=Scalar(law)) for own, law in zip(system.contributors, laws, strict=True))
    swapped = replace(simulation, system=replace(system, contributors=alone))
    plain = drawn(swapped, 0, 4096).deviations
    assert np.array_equal(trials[:, 2], plain[:, 2])
    assert trials[:, 1] == pytest.approx(plain[:, 1] * (1 + 10 * plain[:, 2]), rel=1e-15)
    assert trials[:, 0] == pytest.approx(plain[:, 0] * trials[:, 1] / 0.01, rel=1e-14)


def test_what_reads_a_changed_length_is_drawn_again_with_it() -> None:
    """The mark reads the tip, the tip the length: by their factors from the length's own uniforms, half as far."""
    response = response_of(simulation_of(load(SCENE)))
    kept = response.kept(500)
    other = response.with_draws({"length": Scalar(Uniform(0.0, 0.05))})
    mark, tip, length = kept.redrawn(other.draws).columns
    old_mark, old_tip, old_length = kept.columns
    assert length == pytest.approx(old_length / 2, rel=1e-12)
    assert tip == pytest.approx(old_tip * (1 + 10 * length) / (1 + 10 * old_length), rel=1e-12)
    assert mark == pytest.approx(old_mark * tip / old_tip, rel=1e-12)
    assert np.array_equal(kept.redrawn(other.draws).deviations, other.drawn(500)[0])


def test_extremes_move_what_is_read_along() -> None:
    """Highest: the longest rod, and the tip as far as that lets it stray.

    Lowest: the shortest, for 0.1 mm of length outweigh the 20 um that the tip of the longest strays further.
    """
    simulation = simulation_of(load(SCENE), Overrides())
    (measure,) = simulation.system.measures
    found = first_orders(simulation, None, [measure])[measure.name]["analytic"]
    mark = 5  # of a tip that strays by 10 um: per 10 um of tip
    assert found.ends[1] == pytest.approx(100_000 + 100 + 40 + mark * 40 / 10, rel=1e-12)
    assert found.ends[0] == pytest.approx(100_000 + 0 - 20 - mark * 20 / 10, rel=1e-12)
    assert found.sigma == pytest.approx(SIGMA, rel=1e-9)


def reading(name: str, other: str) -> ToyContributor:
    return ToyContributor(name, "rod_tip", Scaled(Uniform(-0.02, 0.02), other, 1.0, 1.0, 1.0, 1.0))


def test_order_keeps_the_scene_s_where_nothing_is_read() -> None:
    plain = [ToyContributor(name, "rod_length", Scalar(Uniform(0.0, 1.0))) for name in "bca"]
    assert in_draw_order(plain) == tuple(plain)
    third = reading("d", "a")
    assert [own.name for own in in_draw_order([third, *plain])] == ["b", "c", "a", "d"]


def test_rings_and_unknown_names_are_refused() -> None:
    with pytest.raises(UnfitError, match="contributors read each other in a ring: 'a', 'b'"):
        in_draw_order([reading("a", "b"), reading("b", "a")])
    with pytest.raises(UnfitError, match="contributor 'a' reads 'c', which is no contributor"):
        in_draw_order([reading("a", "c")])
