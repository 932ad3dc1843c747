"""Which trial is the worst: of pairs, of trains, with limits on either side and without any."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures import Command
from loose_summaries import typed_run
from numpy.typing import NDArray

from tol3d import Run, run_scene
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.worst import worst_trial

TRAIN = """
scene: one stage and an arm
parts:
  motor: {{kind: shaft, carries: {{a: {{}}}}}}
  out: {{kind: shaft, carries: {{b: {{}}}}}}
  arm: {{kind: arm, shaft: out, points: {{tip: [200 mm, 0 mm, 0 mm]}}}}
  a: {{kind: spur_gear, teeth: 20, module: 1 mm, face_width: 8 mm}}
  b: {{kind: spur_gear, teeth: 40, module: 1 mm, face_width: 8 mm}}
tolerances:
  ta: {{kind: tooth_thickness, of: a, distribution: {{kind: normal, lower: -50 um, upper: -20 um}}}}
moves:
  pair: {{kind: mesh, driver: a, driven: b, centre_distance: 30.02 mm}}
  t: {{kind: train, driven: motor, output: out}}
measures:
  asked: {{{measure}}}
  other: {{kind: normal_backlash, of: pair, over: turn, take: min}}
study: {{trials: 40, seed: 3, witness: 0}}
"""
PLAY = "kind: normal_backlash, of: pair"
LOST = "kind: lost_motion, of: t"
TIP = "kind: tip_displacement, of: t, arm: arm, point: tip"

LARGEST, SMALLEST = np.argmax, np.argmin
ASKED: dict[str, tuple[str, Callable[[NDArray[np.float64]], np.intp]]] = {
    "a backlash": (PLAY, SMALLEST),
    "a lost motion": (LOST, LARGEST),
    "a tip's way": (TIP, LARGEST),
    "a backlash with an upper limit": (f"{PLAY}, upper_limit: 60 um", LARGEST),
    "a lost motion with an upper limit": (f"{LOST}, upper_limit: 9 arcmin", LARGEST),
    "a lost motion with a lower limit": (f"{LOST}, lower_limit: 3 arcmin", SMALLEST),
    "a backlash between two limits": (
        f"{PLAY}, lower_limit: 20 um, upper_limit: 80 um",
        lambda values: np.argmin(np.minimum(values - 20, 80 - values)),
    ),
}


def run_of(folder: Path, measure: str) -> Run:
    (folder / "scene.yaml").write_text(TRAIN.format(measure=measure), "utf-8")
    return run_scene(folder / "scene.yaml", out=folder / "run")


@pytest.mark.parametrize("what", ASKED)
def test_the_worst_trial_is_the_one_that_its_words_say(what: str, tmp_path: Path) -> None:
    measure, worst = ASKED[what]
    run = run_of(tmp_path, measure)
    values = run.columns("geometric:asked")["geometric:asked"]
    assert LARGEST(values) != SMALLEST(values) != 0
    assert worst_trial(run) == worst(values)


@pytest.mark.slow
def test_export_of_a_train_takes_its_worst_trial_and_says_which(tol3d: Command, tmp_path: Path) -> None:
    run = run_of(tmp_path, LOST)
    values = run.columns("geometric:asked")["geometric:asked"]
    code, out, err = tol3d("export", str(run.path), "--worst", "--format", "ply", "--out", str(tmp_path / "parts"))
    assert code == 0
    said = re.search(r"trial (\d+), the worst: the largest asked", err)
    assert said is not None, err
    assert int(said[1]) == values.argmax()
    assert all(f"{values.argmax()}" in Path(line).name for line in out.split())


@dataclass(frozen=True)
class Kept:
    """A run of made-up trials: a length in um and an angle in arc minutes."""

    found: RunSummary
    kept: Mapping[str, NDArray[np.float64]]
    path: Path = Path("made up")

    @property
    def trials(self) -> int:
        return len(next(iter(self.kept.values())))

    @property
    def column_names(self) -> tuple[str, ...]:
        return tuple(self.kept)

    def columns(self, *names: str) -> dict[str, NDArray[Any]]:
        return {name: self.kept[name] for name in names}


def test_nearness_to_limits_of_different_units_is_counted_in_sigmas() -> None:
    """90 um at a sigma of 32 um are nearer than 1 arc minute at one of 0.2; as numbers they are ninety times as far."""
    values = {
        "analytic:gap": np.array([100.0, 120.0, 140.0, 160.0, 180.0, 90.0]),
        "analytic:angle": np.array([1.0, 1.2, 1.3, 1.4, 1.5, 1.6]),
    }
    nearest = {name: int(np.argmin(own)) for name, own in values.items()}
    sigmas = {name: own.min() / own.std() for name, own in values.items()}
    assert sigmas["analytic:gap"] < sigmas["analytic:angle"]
    limited = {"take": "value", "lower_limit": 0.0, "upper_limit": None, "analytic": {}}
    measures = {"gap": limited | {"unit": "um"}, "angle": limited | {"unit": "arcmin"}}
    run = Kept(typed_run({"trials": 6, "engine": "analytic", "measures": measures}), values)
    assert worst_trial(run) == nearest["analytic:gap"] != nearest["analytic:angle"]
