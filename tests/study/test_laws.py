"""A law that a mechanism registers: read, described, drawn, carried through both methods of gears and of a toy, shown.

Oracle: scipy's powerlaw, which shares nothing with the toy, and the closed form of the spur pair of ISO 21771: j falls
by cos(alpha) of what the teeth grow.
"""

import json
import math
import pickle
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import jsonschema
import numpy as np
import pytest
from printing import printed
from ruamel.yaml import YAML
from schemas import validate
from scipy import stats
from toys.laws import LAWS
from toys.laws.power import PowerSpec
from toys.pins import PINS
from toys.registered import TOYS, known

import tol3d
from tol3d import InputError, Overrides, Run, SceneError, load_scene, open_run, run_scene
from tol3d.files import Files
from tol3d.gearing.grammar.measures import GearStudyOptions
from tol3d.report.check import check_report
from tol3d.scene.options import StudyOptions
from tol3d.simulate import simulation_of
from tol3d.statistics.distributions import DistributionSpec
from tol3d.study.system.mechanism import Mechanism

TRIALS = 20_000
LOWER, UPPER, K = -40.0, -10.0, 3.0  # um
LAW = stats.powerlaw(K, loc=LOWER, scale=UPPER - LOWER)
SURE = 5.0
NO_FILES: Files = {}
PAIR = """\
scene: pair
parts:
  pinion: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 10 mm}
  wheel: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 10 mm}
tolerances:
  teeth: {kind: tooth_thickness, of: pinion, distribution: {kind: power, lower: -40 um, upper: -10 um, k: 3.0}}
  others: {kind: tooth_thickness, of: wheel, distribution: {kind: uniform, lower: -60 um, upper: -30 um}}
moves:
  mesh: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 50 mm, working_flank: right}
measures:
  play: {kind: normal_backlash, of: mesh}
study: {trials: 20000, seed: 5}
"""


@pytest.fixture(scope="module", autouse=True)
def laws() -> Iterator[None]:
    with known(PINS, LAWS):
        yield


@pytest.fixture(scope="module")
def run(laws: None, tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("laws")
    return run_scene(written(folder, PAIR), out=folder / "run")


def written(folder: Path, text: str) -> Path:
    path = folder / "pair.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def said_of(folder: Path, old: str, new: str) -> str:
    assert old in PAIR
    with pytest.raises(SceneError) as caught:
        load_scene(written(folder, PAIR.replace(old, new)))
    return str(caught.value)


def test_its_moments_are_those_of_scipy() -> None:
    law = load_law("lower: -40 um, upper: -10 um, k: 3.0").resolve(NO_FILES)
    assert (1e3 * law.mean, 1e3 * law.sigma) == pytest.approx((LAW.mean(), LAW.std()))
    u = np.array([1e-9, 0.1, 0.5, 0.99])
    assert 1e3 * law.ppf(u) == pytest.approx(LAW.ppf(u))


def load_law(keys: str) -> PowerSpec:
    spec = PowerSpec.model_validate({"kind": "power", **YAML(typ="safe", pure=True).load(f"{{{keys}}}")})
    assert isinstance(spec, PowerSpec)
    return spec


def test_deviations_are_drawn_by_it(run: Run) -> None:
    """sup |F_n - F| stays under sqrt(ln(2/p) / 2n) but for a chance of p: Dvoretzky, Kiefer, Wolfowitz, Massart."""
    drawn = run.columns("teeth [um]")["teeth [um]"]
    assert len(drawn) == TRIALS
    assert stats.kstest(drawn, LAW.cdf).statistic < math.sqrt(math.log(2 / 1e-6) / (2 * TRIALS))


def test_both_methods_and_the_closed_form_have_its_mean_and_sigma(run: Run) -> None:
    own = run.found.measures["play"]
    cos = math.cos(math.radians(20.0))
    other = stats.uniform(-60.0, 30.0)
    mean, sigma = -cos * (LAW.mean() + other.mean()), cos * math.hypot(LAW.std(), other.std())
    assert own.analytic_closed_form is not None
    assert own.analytic is not None
    assert own.geometric is not None
    assert (own.analytic_closed_form.mean, own.analytic_closed_form.sigma) == pytest.approx((mean, sigma), rel=1e-9)
    fourth = (LAW.var() ** 2 * (LAW.stats("k") + 3) + other.var() ** 2 * 1.8 + 6 * LAW.var() * other.var()) * cos**4
    sigma_error = math.sqrt((fourth - sigma**4) / TRIALS) / (2 * sigma)
    for sample in (own.analytic, own.geometric):
        assert sample.mean == pytest.approx(mean, abs=SURE * sigma / math.sqrt(TRIALS))
        assert sample.sigma == pytest.approx(sigma, abs=SURE * sigma_error)
    share = {each.name: each.analytic_percent for each in own.contributors}
    assert share["teeth"] == pytest.approx(100 * LAW.var() / (LAW.var() + other.var()))


def test_the_toy_of_pins_states_it_too(tmp_path: Path) -> None:
    text = (TOYS / "pins" / "pins.yaml").read_text("utf-8")
    was = "{kind: normal, mean: 45 um, sigma: 4 um}"
    assert was in text
    path = written(tmp_path, text.replace(was, "{kind: power, lower: 30 um, upper: 60 um, k: 2.0}"))
    run = run_scene(path, overrides=Overrides(trials=4000), out=tmp_path / "run")
    room = run.columns("room [um]")["room [um]"]
    assert stats.kstest(room, stats.powerlaw(2.0, 30.0, 30.0).cdf).statistic < math.sqrt(math.log(2e6) / 8000)


def test_it_is_kept_by_runs_pickles_and_json(run: Run, tmp_path: Path) -> None:
    scene = load_scene(written(tmp_path, PAIR))
    again = pickle.loads(pickle.dumps(scene))
    assert again.tolerances == scene.tolerances
    law = json.loads(scene.model_dump_json(exclude_unset=True))["tolerances"]["teeth"]["distribution"]
    assert law == {"kind": "power", "lower": "-40 um", "upper": "-10 um", "k": 3.0}
    assert (
        open_run(run.path).columns("teeth [um]")["teeth [um]"].tolist()
        == run.columns("teeth [um]")["teeth [um]"].tolist()
    )


def test_check_shows_it(tmp_path: Path) -> None:
    assert "power" in printed(check_report(simulation_of(load_scene(written(tmp_path, PAIR)))), 160)


@pytest.mark.parametrize(
    ("draws", "sigma", "tails"),
    [
        ("", 9.690, "smoothed to sigma 9.69 µm; tails end at -19 µm and 27 µm, by the sample alone"),
        (
            ", draws: as_measured",
            9.494,
            "each drawn as often: sigma 9.49 µm (n); no tails beyond -15.64 µm and 23.64 µm",
        ),
    ],
)
def test_a_measured_sample_states_its_number_and_its_tails(
    draws: str, sigma: float, tails: str, tmp_path: Path
) -> None:
    """25 normal scores of sigma 10 um about 4 um, spread by sqrt(3/25) s: s is 9.690, with n 9.494 um."""
    scores = 4 + 10 * stats.norm.ppf((np.arange(25) + 0.625) / 25.25)
    assert np.std(scores, ddof=1) == pytest.approx(9.690, abs=5e-3)
    (tmp_path / "sample.csv").write_text("v\n" + "\n".join(f"{own:.6f}" for own in scores), "utf-8")
    law = f"{{kind: empirical, file: sample.csv, column: v, unit: um{draws}}}"
    scene = f"""\
scene: sample
parts: {{p: {{kind: solid, features: {{
  A: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [60 mm, 60 mm]}},
  h: {{kind: point, at: [10 mm, 0 mm, 5 mm], normal: [0, 0, 1]}}}}}}}}
tolerances: {{x: {{kind: plus_minus, of: p.h, along: [1, 0, 0], distribution: {law}}}}}
moves: {{a: {{kind: fix, part: p}}}}
measures: {{g: {{kind: gap, from: p.A, to: p.h, along: [1, 0, 0]}}}}
study: {{trials: 4000, seed: 3}}
"""
    path = written(tmp_path, scene)
    words = " ".join(printed(check_report(simulation_of(load_scene(path)))).split())
    assert f"x: 25 measured values, s 9.69 µm (n − 1), {tails}" in words
    found = run_scene(path, out=tmp_path / "run").summary["measures"]["g"]["geometric"]
    assert abs(found["mean"] - 1e4 - 4) < 4 * sigma / math.sqrt(4000)
    assert found["sigma"] == pytest.approx(sigma, rel=4 / math.sqrt(2 * 4000))


def test_what_its_package_requires_is_in_the_fingerprint_of_scenes_that_state_it(tmp_path: Path) -> None:
    assert "jsonschema" in simulation_of(load_scene(written(tmp_path, PAIR))).requires
    plain = PAIR.replace("{kind: power, lower: -40 um, upper: -10 um, k: 3.0}", "{kind: constant, value: 0 um}")
    assert "jsonschema" not in simulation_of(load_scene(written(tmp_path, plain))).requires


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("k: 3.0", "k: 0.0"), "6: tolerances.teeth.distribution.k: expected a number of more than 0, got 0.0"),
        (("k: 3.0", "kk: 3.0"), '6: tolerances.teeth.distribution.kk: unknown key "kk"; did you mean "k"?'),
        (("kind: power", "kind: powr"), "empirical, power, got 'powr'; did you mean \"power\"?"),
        (("upper: -10 um", "upper: -10 deg"), "quantities of one dimension"),
        (("lower: -40 um", "lower: -4 um"), "distribution.lower: expected less than upper"),
    ],
)
def test_what_is_wrong_with_it_is_said_as_of_any(change: tuple[str, str], said: str, tmp_path: Path) -> None:
    assert said in said_of(tmp_path, *change)


def test_without_its_mechanism_it_is_unknown(tmp_path: Path) -> None:
    with known(PINS), pytest.raises(SceneError, match=r"expected one of normal, .*, empirical, got 'power'"):
        load_scene(written(tmp_path, PAIR))


def test_the_json_schema_has_it_beside_the_shipped_ones_and_only_where_it_is_registered(tmp_path: Path) -> None:
    data = YAML(typ="safe", pure=True).load(PAIR)
    schema: dict[str, Any] = tol3d.Scene.model_json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    validate(data, schema)
    with pytest.raises(jsonschema.ValidationError):
        validate(YAML(typ="safe", pure=True).load(PAIR.replace("k: 3.0", "k: 0.0")), schema)
    with known(PINS), pytest.raises(jsonschema.ValidationError):
        validate(data, tol3d.Scene.model_json_schema())


class Normal(PowerSpec):
    """A law by a word that is shipped."""

    kind: Literal["normal"]  # type: ignore[assignment]  # a word of its own


@pytest.mark.parametrize(
    ("laws", "said"),
    [
        ((Normal,), "others: expected a kind of its own in distributions, got 'normal', which tol3d registers"),
        ((PowerSpec,), "others: expected a kind of its own in distributions, got 'power', which laws registers"),
        ((DistributionSpec,), "others.distributions: expected subclasses of DistributionSpec whose kind is a literal"),
    ],
)
def test_a_law_that_scenes_could_not_tell_from_others_is_refused(
    laws: tuple[type[DistributionSpec], ...], said: str
) -> None:
    with pytest.raises(InputError, match=said):
        tol3d.register(Mechanism(name="others", distributions=laws))


# options of a study -------------------------------------------------------------------------------


class Fine(StudyOptions):
    """An option of two vocabularies."""

    profile_steps: int = 3


class Endless(StudyOptions):
    """An option that every study would have to state."""

    turns: int


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (Fine, "others: expected an option of its own in study, got 'profile_steps', which gearing registers"),
        (Endless, "others.options: expected a default of turns, found none"),
    ],
)
def test_options_that_studies_could_not_have_are_refused(options: type[StudyOptions], said: str) -> None:
    with pytest.raises(InputError, match=said):
        tol3d.register(Mechanism(name="others", options=options))


def test_an_option_belongs_to_the_scenes_of_its_vocabulary(run: Run, tmp_path: Path) -> None:
    assert run.summary["study"]["profile_steps"] == 120
    finer = load_scene(written(tmp_path, PAIR.replace("seed: 5", "seed: 5, profile_steps: 60")))
    assert simulation_of(finer).study.options == {"profile_steps": 60}
    pins = (TOYS / "pins" / "pins.yaml").read_text("utf-8")
    path = written(tmp_path, pins.replace("seed: 11", "seed: 11, profile_steps: 60"))
    assert "profile_steps" not in simulation_of(load_scene(TOYS / "pins" / "pins.yaml")).study.stated
    with pytest.raises(SceneError, match=r"study.profile_steps: no kind of gearing is in the scene"):
        simulation_of(load_scene(path))
    with pytest.raises(SceneError, match="at least 8"):
        load_scene(written(tmp_path, PAIR.replace("seed: 5", "seed: 5, profile_steps: 7")))
    assert pickle.loads(pickle.dumps(finer)).options(GearStudyOptions).profile_steps == 60
