"""A mechanism that solves several parts together: a minimum over 40 contacts, and load paths by a programme."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from printing import printed, row_of
from scipy import integrate, stats
from toys.pins import PINS
from toys.pins.programme import gaps_of, slide_of
from toys.pins.system import STEEPEST
from toys.registered import TOYS, known

from tol3d import InputError, Overrides, Run, SceneError, replay, run_scene
from tol3d.report.heading import worst_words
from tol3d.report.table import run_report
from tol3d.study.execution.pools import Execution
from tol3d.study.results import task
from tol3d.study.runs.worst import worst_trial
from tol3d.study.system.outcome import Statuses

SCENE = TOYS / "pins" / "pins.yaml"
TRIALS = 40_000
PINS_ROUND, RADIUS = 40, 20.0
ROOM, ROOM_SIGMA, PIN_SIGMA = 45.0, 4.0, 6.0  # um
SURE = 5.0


@pytest.fixture(scope="module", autouse=True)
def pins() -> Iterator[None]:
    with known(PINS):
        yield


@pytest.fixture(scope="module")
def run(pins: None, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run_scene(SCENE, overrides=Overrides(trials=TRIALS), out=tmp_path_factory.mktemp("pins") / "run")


def columns_of_pins(run: Run) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Room (trials,), pins (trials, pins), off centre (trials, 2) [um]."""
    names = [f"pins.{pin:02d} [um]" for pin in range(PINS_ROUND)]
    own = run.columns("room [um]", *names, "off centre.x [um]", "off centre.y [um]")
    off = np.stack([own["off centre.x [um]"], own["off centre.y [um]"]], axis=-1)
    return own["room [um]"], np.stack([own[name] for name in names], axis=-1), off


def test_each_trial_is_that_of_the_slow_reference(run: Run) -> None:
    room, each, off = columns_of_pins(run)
    values = run.columns("geometric:least gap", "geometric:slide", "nearest pin")
    for k in range(0, TRIALS, 400):
        gaps = gaps_of(RADIUS, 1e-3 * room[k], (1e-3 * each[k]).tolist(), (1e-3 * off[k, 0], 1e-3 * off[k, 1]))
        assert values["geometric:least gap"][k] == pytest.approx(1e3 * min(gaps), abs=1e-9)
        assert values["nearest pin"][k] == gaps.index(min(gaps))
        assert values["geometric:slide"][k] == pytest.approx(1e3 * slide_of(gaps, STEEPEST), abs=1e-6)


def test_the_minimum_over_forty_contacts_has_its_closed_form(pins: None, tmp_path: Path) -> None:
    """A centred disc: room plus the smallest of 40 independent normals."""
    text = SCENE.read_text("utf-8")
    line = next(line for line in text.splitlines(keepends=True) if "off_centre" in line)
    scene = tmp_path / "centred.yaml"
    scene.write_text(text.replace(line, ""), "utf-8")
    run = run_scene(scene, overrides=Overrides(trials=TRIALS), out=tmp_path / "run")

    def density(z: float) -> float:
        return float(PINS_ROUND * stats.norm.pdf(z) * stats.norm.sf(z) ** (PINS_ROUND - 1))

    first, second = (integrate.quad(lambda z, n=n: z**n * density(z), -9.0, 9.0)[0] for n in (1, 2))
    mean = ROOM + PIN_SIGMA * first
    sigma = math.hypot(ROOM_SIGMA, PIN_SIGMA * math.sqrt(second - first**2))
    for method in ("analytic", "geometric"):
        own = run.summary["measures"]["least gap"][method]
        assert abs(own["mean"] - mean) < SURE * sigma / math.sqrt(TRIALS)
        assert abs(own["sigma"] - sigma) < SURE * sigma / math.sqrt(2 * TRIALS) * 1.2
    agreement = run.summary["measures"]["least gap"]["agreement"]
    assert agreement["max_abs_difference"] < 1e-9


def test_off_centre_the_sample_is_that_of_an_independent_one(run: Run) -> None:
    rng = np.random.default_rng(5)
    count = 40_000
    angles = 2 * np.pi * (np.arange(PINS_ROUND) + 0.25) / PINS_ROUND
    off = rng.normal(0.0, 8.0, (count, 2))
    gaps = rng.normal(ROOM, ROOM_SIGMA, (count, 1)) + rng.normal(0.0, PIN_SIGMA, (count, PINS_ROUND))
    gaps -= off[:, :1] * np.cos(angles) + off[:, 1:] * np.sin(angles)
    seen = run.columns("geometric:least gap")["geometric:least gap"]
    assert stats.ks_2samp(gaps.min(axis=1), seen).pvalue > 1e-4


def test_both_methods_agree_to_second_order_and_that_is_explained(run: Run) -> None:
    for name in ("least gap", "slide"):
        own = run.summary["measures"][name]["agreement"]
        assert own["max_abs_difference"] < 40.0**2 / (2 * 1e3 * RADIUS) / STEEPEST  # um: off^2/2R, off up to 40
        assert own["explanation"]["faults"] == []


def test_a_clash_is_a_failure_with_its_depth(run: Run, tmp_path: Path) -> None:
    own = run.columns("geometric:least gap", "status:least gap", "geometric:slide")
    values, status = own["geometric:least gap"], own["status:least gap"]
    assert set(status[values < 0.0]) == {"clashes"}
    assert set(status[values >= 0.0]) == {"ok"}
    counted = run.summary["measures"]["least gap"]
    assert counted["status"] == {"ok": np.count_nonzero(values >= 0.0), "clashes": np.count_nonzero(values < 0.0)}
    assert counted["geometric"]["deepest_overlap"] == values.min()
    assert counted["geometric"]["out_ppm"] == pytest.approx(1e6 * np.mean(values < 5.0))
    assert worst_trial(run) == int(values.argmin())


def test_tables_call_failures_by_the_mechanism_s_own_words(run: Run) -> None:
    counted = run.summary["measures"]["least gap"]["status"]
    assert run.summary["status_words"] == {"clashes": "clashing"}
    text = printed(run_report(run.found), 160)
    assert row_of(text, "trials clashing")[-1] == str(counted["clashes"])
    assert f"{counted['ok']} assembled, {counted['clashes']} could not be assembled (" in text
    assert "a build that is clashing is below every lower limit" in " ".join(text.split())
    assert worst_words(run.found) == "clashing, the deepest by least gap or slide"


def test_a_trial_is_replayed_and_bits_do_not_depend_on_workers_or_blocks(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(task, "BLOCK_TRIALS", 3000)
    several = run_scene(SCENE, overrides=Overrides(trials=TRIALS), out=tmp_path / "run", execution=Execution(workers=2))
    for name in ("geometric:least gap", "analytic:slide", "nearest pin", "pins.17 [um]"):
        assert np.array_equal(run.columns(name)[name], several.columns(name)[name])
    assert replay(run, 4321).geometric["slide"] == run.columns("geometric:slide")["geometric:slide"][4321]


def test_a_mechanism_without_a_class_of_summaries_is_read_back_as_it_is(run: Run) -> None:
    own = run.found.measures["least gap"]
    assert (own.kind, own.words) == ("least_gap", "least gap")
    assert [share.name for share in own.contributors] == ["room", "pins", "off centre"]


def test_a_witness_where_there_is_none_is_refused(tmp_path: Path) -> None:
    scene = tmp_path / "pins.yaml"
    scene.write_text(SCENE.read_text("utf-8").replace("trials: 20000", "trials: 20000, witness: 5"), "utf-8")
    with pytest.raises(SceneError, match=r"study.witness: expected none, for this scene has no witness, got 5"):
        run_scene(scene, out=tmp_path / "run")


@pytest.mark.parametrize(
    ("texts", "lacking", "said"),
    [
        (("fits", "lost"), (), "expected 'ok' first"),
        (("ok", "lost"), ("too long",), "expected some of ok, lost, got too long"),
    ],
)
def test_statuses_that_no_run_could_keep_are_refused(
    texts: tuple[str, ...], lacking: tuple[str, ...], said: str
) -> None:
    with pytest.raises(InputError, match=said):
        Statuses(texts, frozenset(lacking))


def test_an_analytic_run_is_replayed_by_the_first_engine_with_its_own_materials(run: Run, tmp_path: Path) -> None:
    analytic = run_scene(SCENE, overrides=Overrides(trials=50, engine="analytic"), out=tmp_path / "run")
    values = run.columns("geometric:least gap")["geometric:least gap"]
    for trial in (0, 49):
        again = replay(analytic, trial)
        assert again.geometric["least gap"] == pytest.approx(values[trial])
