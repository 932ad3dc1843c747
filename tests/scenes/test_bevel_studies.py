"""Studies of the published bevel pair: mean and sigma of each way of reading it, worked out beforehand.

They come from an exact solver that shares no code with this program, for the pair of Jiang et al. (z 31/31, b 9).
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from gear_trials import drawn_trials, gear_columns
from places import SCENES

from tol3d import load_scene
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.model import Backlash, Model, Reading, ToothThickness, model_from_scene

ALPHA = math.radians(20.0)
GIVEN = 0.01  # um; the means are told to so much


@dataclass(frozen=True)
class Case:
    """A scene, how it is read, and what was worked out: mean and sigma [um].

    `constant` takes the thickness deviations as the same normal offset along the face.
    """

    scene: str
    reading: Reading | None
    mean: float
    sigma: float
    constant: bool = False


CASES = {
    "one tooth in the middle of the face": Case("bevel_pair", None, 89.54, 6.506),
    "as 3DCS may see it": Case("bevel_pair_3dcs", None, 90.04, 5.962),
    "the whole face, thinned alike along it": Case(
        "bevel_pair", Reading("face", "face", "all"), 83.84, 6.180, constant=True
    ),
    "all teeth in the middle of the face": Case("bevel_pair", Reading("section", "section", "all"), 89.05, 6.512),
    "contact over the face": Case("bevel_pair", Reading("face", "section", "all"), 88.64, 6.488),
    "the whole face": Case("bevel_pair", Reading("face", "face", "all"), 83.41, 6.186),
}


def model_of(case: Case) -> Model:
    model = model_from_scene(load_scene(SCENES / f"{case.scene}.yaml"))
    measure = model.measures[0]
    if case.reading is not None:
        assert isinstance(measure.kind, Backlash)
        measure = replace(measure, kind=replace(measure.kind, reading=case.reading))
    contributors = model.contributors
    if case.constant:
        offset = 0.5 * math.cos(ALPHA)
        contributors = tuple(
            replace(c, effect=replace(c.effect, turn=0.0, offset=offset)) if isinstance(c.effect, ToothThickness) else c
            for c in contributors
        )
    return replace(model, measures=(measure,), contributors=contributors)


def closed_mean(model: Model) -> float:
    """Means times coefficients, by hand: 42.5 um off each gear and half of 20 um of each bearing across its axis."""
    means = {c.name: 1000 * c.distribution.mean for c in model.contributors if "eccentricity" not in c.name}
    bearings = sum(mean for name, mean in means.items() if "bearing" in name)
    thickness = -sum(mean for name, mean in means.items() if "thickness" in name)
    along_normals = 1.0 if "axes offset" not in {c.name for c in model.contributors} else math.cos(ALPHA)
    assert bearings + thickness == pytest.approx(sum(abs(mean) for mean in means.values()))
    return along_normals * thickness + math.sin(ALPHA) * math.sqrt(0.5) * bearings


def check(name: str, trials: int) -> None:
    """The methods' difference is sampled, and the closed form's mean is known: so few trials tell the mean closely."""
    case = CASES[name]
    model = model_of(case)
    columns = gear_columns(model, exact_engine(model), drawn_trials(model, 1, 0, trials))
    assert set(columns["status"]) == {"ok"}
    geometric, analytic = (
        np.asarray(columns[f"{own}:{model.measures[0].name}"], dtype=np.float64) for own in ("geometric", "analytic")
    )
    difference = geometric - analytic
    by_chance = difference.std() / math.sqrt(trials)
    assert closed_mean(model) + difference.mean() == pytest.approx(case.mean, abs=4 * by_chance + GIVEN)
    assert np.std(geometric, ddof=1) == pytest.approx(case.sigma, abs=4 * case.sigma / math.sqrt(2 * trials) + GIVEN)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_two_hundred_thousand_trials_meet_what_was_worked_out(name: str) -> None:
    check(name, 200_000)
