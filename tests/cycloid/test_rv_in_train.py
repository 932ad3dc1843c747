"""RV reducers as stages of trains, beside gears, planetary sets, each other, and a link from outside.

Each link is held to the scene in which it stands alone, at the same positions with the same deviations; that scene's
own numbers have oracles elsewhere. What a train makes of its links are sums written down here.
"""

import math
import re
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_texts import Edit, edited, refusal
from toys.drives.rope import ROPES
from toys.registered import known

from tol3d import Run, check_scene, compare_runs, load_scene, open_run, run_scene
from tol3d.gearing.cycloid.from_scene import rv_system
from tol3d.gearing.cycloid.reducer.resting import exact_turning, linear_turning
from tol3d.gearing.cycloid.rv_link import RVLink
from tol3d.gearing.links import FreeTurn, LinkTrials
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.play.linked import link_trials
from tol3d.gearing.presenting import PRESENTER
from tol3d.gearing.system import GearSystem, gear_system
from tol3d.report.table import run_report
from tol3d.study.results.versions import installed_versions
from tol3d.study.system.mechanism import mechanism_of, requires_of
from tol3d.study.system.method import ANALYTIC_METHOD, Answers
from tol3d.study.system.system import System
from tol3d.study.system.trials import Trials
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

Array = NDArray[np.float64]

ARCMIN = math.radians(1 / 60)
METHODS = {"analytic": ANALYTIC_METHOD, "geometric": "exact"}
COUNT = 60

PAIR = """
  pinion: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 10 mm}
  wheel: {kind: spur_gear, teeth: 40, module: 1 mm, face_width: 10 mm}"""
RV = """
  sun: {kind: spur_gear, teeth: 20, module: 0.5 mm, face_width: 5 mm}
  planet: {kind: spur_gear, teeth: 40, module: 0.5 mm, face_width: 4 mm}
  crankshaft: {kind: crankshaft, eccentricity: 1.2 mm}
  disc: {kind: cycloid_disc, lobes: 11, shift: -60 um, offset: -40 um}
  pin ring: {kind: pin_ring, pins: 12, radius: 30 mm, pin_radius: 3 mm}
  carrier: {kind: crank_carrier, radius: 15 mm}"""
SET = """
  S: {kind: spur_gear, teeth: 25, module: 1 mm, face_width: 12 mm}
  P1: {kind: spur_gear, teeth: 27, module: 1 mm, face_width: 12 mm}
  P2: {kind: spur_gear, teeth: 24, module: 1 mm, face_width: 12 mm}
  ring 1: {kind: internal_gear, teeth: 79, module: 1 mm, face_width: 12 mm}
  ring 2: {kind: internal_gear, teeth: 76, module: 1 mm, face_width: 12 mm}
  planets: {kind: planet, gears: [P1, P2]}
  cage: {kind: planet_carrier}"""
UNIFORM = "distribution: {kind: uniform, lower: -45 um, upper: -25 um}"
RAYLEIGH = "distribution: {kind: rayleigh, scale: 2 um}"
OF_PAIR = f"""
  pinion teeth: {{kind: tooth_thickness, of: pinion, {UNIFORM}}}"""
OF_RV = f"""
  sun teeth: {{kind: tooth_thickness, of: sun, {UNIFORM}}}
  pin circle: {{kind: pin_circle, of: pin ring, distribution: {{kind: normal, lower: -9 um, upper: 9 um}}}}
  disc run-out: {{kind: disc_eccentricity, of: disc, each: disc, {RAYLEIGH}}}"""
OF_SET = "".join(f"\n  {own} teeth: {{kind: tooth_thickness, of: {own}, {UNIFORM}}}" for own in ("S", "P1", "ring 2"))
IS_PAIR = """
  pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 30 mm, working_flank: right}"""
IS_RV = """
  rv: {kind: rv_reducer, sun: sun, planet: planet, crankshaft: crankshaft, disc: disc, pin_ring: pin ring,
    carrier: carrier}"""
IS_SET = """
  3K: {kind: planetary, planet: planets, planets: 4, carrier: cage, meshes: {S: P1, ring 1: P1, ring 2: P2},
    held: ring 1, input: S, output: ring 2}"""
I_SET = 1368 / 25
THREE = f"""
scene: spur pair, RV reducer and 3K set
parts:
  motor: {{kind: shaft, carries: {{pinion: {{}}}}}}
  between: {{kind: shaft, carries: {{wheel: {{}}, sun: {{at: 20 mm}}}}}}
  slow: {{kind: shaft, carries: {{carrier: {{}}, S: {{at: -40 mm}}}}}}{PAIR}{RV}{SET}
tolerances:
  between run-out: {{kind: run_out, of: between, {RAYLEIGH}}}
  slow run-out: {{kind: run_out, of: slow, {RAYLEIGH}}}{OF_PAIR}{OF_RV}{OF_SET}
moves:{IS_PAIR}{IS_RV}{IS_SET}
  train: {{kind: train, driven: motor, output: ring 2, ratio: -2736}}
measures:
  lost motion: {{kind: lost_motion, of: train}}
  at the slow shaft: {{kind: lost_motion, of: train, shaft: slow}}
  at the start: {{kind: lost_motion, of: train, over: {{at: 0 deg}}}}
study: {{trials: {COUNT}}}
"""


def written(folder: Path, text: str) -> Path:
    (folder / "scene.yaml").write_text(text, "utf-8")
    return folder / "scene.yaml"


@pytest.fixture(scope="module")
def three(tmp_path_factory: pytest.TempPathFactory) -> tuple[GearSystem, Trials]:
    """The system of the train, and trials of it."""
    simulation = simulation_of(load_scene(written(tmp_path_factory.mktemp("three"), THREE)))
    assert isinstance(simulation.system, GearSystem)
    return simulation.system, drawn(simulation, 0, COUNT)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("run")
    return run_scene(written(folder, THREE), out=folder / "kept")


# each link alone ------------------------------------------------------------------------------------------------------

PAIR_ALONE = f"""
scene: the pair
parts:{PAIR}
tolerances:
  between run-out: {{kind: run_out, of: wheel, {RAYLEIGH}}}{OF_PAIR}
moves:{IS_PAIR}
measures: {{lost: {{kind: angular_backlash, of: pair, gear: wheel}}}}
"""
RV_ALONE = f"""
scene: the reducer
parts:{RV}
tolerances:
  between run-out: {{kind: eccentricity, of: sun, {RAYLEIGH}}}
  slow run-out: {{kind: carrier_bearing, of: carrier, {RAYLEIGH}}}{OF_RV}
moves:{IS_RV}
measures: {{lost: {{kind: cycloid_lost_motion, of: rv}}}}
"""
RV_TRUE = "\n".join(row for row in RV_ALONE.splitlines() if "run-out: {kind: e" not in row and "carrier_b" not in row)
SET_ALONE = f"""
scene: the set
parts:{SET}
tolerances:
  slow run-out: {{kind: eccentricity, of: S, {RAYLEIGH}}}{OF_SET}
moves:{IS_SET}
measures: {{lost: {{kind: planetary_lost_motion, of: 3K}}}}
"""


def answered(system: System, train: tuple[GearSystem, Trials], method: str, at: Array) -> Answers:
    """Answers of a link's own scene for the trials of its train; contributors are called alike in both."""
    whole, trials = train
    slots = whole.model.component_slices
    deviations = np.concatenate([trials.deviations[:, slots[own.name]] for own in system.contributors], axis=1)
    own_trials = Trials(deviations, dict.fromkeys(system.positions(dict.fromkeys(system.streams, np.zeros(1))), at))
    return system.method(method, None).answers(own_trials, system.measures)


def alone(system: System, train: tuple[GearSystem, Trials], method: str, at: Array) -> Array:
    """The play of it [rad]."""
    return answered(system, train, method, at).values["lost"][:, 0]


def output_turns(train: tuple[GearSystem, Trials], link: str) -> Array:
    """Turns of a link's output in the trials, from where its driver stands."""
    whole, trials = train
    return np.asarray(trials.positions[link] / (2 * math.pi) * float(whole.model.link(link).rate))


@pytest.fixture(scope="module")
def plays(three: tuple[GearSystem, Trials], tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], Array]:
    """Play of each link [rad] by link and method, from its own scene."""
    folder, found = tmp_path_factory.mktemp("alone"), {}
    for own, text, made in (
        ("pair", PAIR_ALONE, gear_system),
        ("rv", RV_ALONE, rv_system),
        ("3K", SET_ALONE, planetary_system),
    ):
        system: System = made(load_scene(written(folder, text)))
        at = three[1].positions["pair"] if own == "pair" else output_turns(three, own)
        for method in METHODS.values():
            found[own, method] = alone(system, three, method, at)
    return found


@pytest.mark.parametrize("method", METHODS.values())
@pytest.mark.parametrize("link", ["rv", "3K"])
def test_a_link_leaves_bit_by_bit_what_it_leaves_alone(
    link: str, method: str, three: tuple[GearSystem, Trials], plays: dict[tuple[str, str], Array]
) -> None:
    """All of its tolerances act, run-outs of both shafts among them."""
    system, trials = three
    own, measure = system.model.link(link), system.measures[0]
    seen = link_trials(system.model, measure, own, trials)
    found = (own.analytic if method == ANALYTIC_METHOD else own.exact)(seen).play[:, 0]
    assert np.array_equal(found, plays[link, method])
    assert found.std() > 5e-6


@pytest.mark.parametrize("method", METHODS)
def test_the_train_is_the_sum_of_its_links_over_the_ratios_behind_each(
    method: str, three: tuple[GearSystem, Trials], plays: dict[tuple[str, str], Array]
) -> None:
    """The reducer has 1 + 40/20 x 12 = 25. Rounding of a sum of some 5e-3 rad."""
    system, trials = three
    found = system.method(METHODS[method], None).answers(trials, system.measures).values
    pair, rv, planets = (plays[own, METHODS[method]] for own in ("pair", "rv", "3K"))
    np.testing.assert_allclose(found["at the slow shaft"][:, 0], pair / 25 + rv, rtol=0, atol=1e-16)
    np.testing.assert_allclose(found["lost motion"][:, 0], (pair / 25 + rv) / I_SET + planets, rtol=0, atol=1e-15)
    assert min((pair / 25).std(), rv.std()) > 5e-6  # neither is lost in the other


def test_thinner_sun_teeth_free_the_carrier_by_their_arc_over_planet_and_cranks(
    three: tuple[GearSystem, Trials],
) -> None:
    """By hand: s cos(20 deg) over the planet's base radius of 10 mm cos(20 deg), over Zc + 1 + z1/z2 = 12.5."""
    own = three[0].model.link("rv")
    assert isinstance(own, RVLink)
    contributors = [each for each in three[0].contributors if each.effect.acts_on("rv")]
    widths = {each.name: len(each.draw.components) for each in contributors}

    def play(method: str, thinner: float) -> float:
        deviations = {name: np.zeros((1, width)) for name, width in widths.items()}
        deviations["sun teeth"][:] = -thinner
        seen = LinkTrials(contributors, deviations, np.full((1, 1), 0.7))
        return float((own.analytic if method == ANALYTIC_METHOD else own.exact)(seen).play[0, 0])

    for method in METHODS.values():
        assert play(method, 0.02) - play(method, 0.0) == pytest.approx(0.02 / 10 / 12.5, rel=0.01)
    seen = link_trials(three[0].model, three[0].measures[0], own, three[1])
    part = own.parts(seen, {name: np.full(width, 0.001) for name, width in widths.items()})["sun teeth"]
    np.testing.assert_allclose(part, -(seen.deviations["sun teeth"][:, 0] - 0.001) / 125, rtol=1e-12)


def test_its_rate_is_the_ratio_of_the_reducer_with_its_sign(three: tuple[GearSystem, Trials], tmp_path: Path) -> None:
    """25 by the sun, alike; 11 by the cranks, against them."""
    layout = three[0].model.layout
    assert three[0].model.link("rv").rate == Fraction(1, 25)
    assert layout.ratio("motor", "slow") == -50
    assert three[0].model.layout.ratio("between", "ring 2") == 25 * Fraction(1368, 25)
    cranks = "\n".join(row for row in RV.splitlines() if not re.match("  (sun|planet):", row))
    text = f"""
scene: cranks are the input
parts:{cranks}
tolerances:
  pin circle: {{kind: pin_circle, of: pin ring, distribution: {{kind: normal, lower: -9 um, upper: 9 um}}}}
moves:{IS_RV.replace("sun: sun, planet: planet, ", "")}
  train: {{kind: train, driven: crankshaft, output: carrier, ratio: -11}}
measures: {{lost motion: {{kind: lost_motion, of: train, over: {{at: 0 deg}}}}}}
"""
    system = gear_system(load_scene(written(tmp_path, text)))
    assert system.model.layout.ratio("crankshaft", "carrier") == -11
    measure = "measures: {lost motion: {kind: cycloid_lost_motion, of: rv, over: {at: 0 deg}}}"
    alike = text[: text.index("  train")] + measure
    own = rv_system(load_scene(written(tmp_path, alike)))
    rows = np.linspace(-0.009, 0.009, 7)[:, None]
    for method in METHODS.values():
        found, wanted = (
            each.method(method, None).answers(Trials(rows, {"rv": np.zeros(7)}), each.measures).values["lost motion"]
            for each in (system, own)
        )
        assert np.array_equal(found, wanted)


# a run ----------------------------------------------------------------------------------------------------------------


def test_every_contributor_of_every_link_has_its_share(run: Run) -> None:
    """At the slow shaft the set behind it counts for nothing; shares add up but for clearances of single pins."""
    found = run.summary["measures"]
    names = {
        name: {own["name"] for own in found[name]["contributors"]} for name in ("lost motion", "at the slow shaft")
    }
    of_set = {"S teeth", "P1 teeth", "ring 2 teeth"}
    assert names["at the slow shaft"] == {
        "between run-out", "slow run-out", "pinion teeth", "sun teeth", "pin circle", "disc run-out"
    }  # fmt: skip
    assert names["lost motion"] == names["at the slow shaft"] | of_set
    for measure in ("lost motion", "at the slow shaft"):
        assert "shares_by" not in found[measure], "a regression explains them: other shares are parts of their sum"
        for method in ("analytic_percent", "geometric_percent"):
            assert sum(own[method] for own in found[measure]["contributors"]) == pytest.approx(100, abs=6)
        assert found[measure]["agreement"]["explanation"]["faults"] == []
    stages = run.summary["trains"]["train"]["stages"]
    assert [own["kind"] for own in stages] == ["mesh", "rv_reducer", "planetary_set"]
    assert run.summary["cycloid_stages"]["rv"]["left_out"] == ["between run-out", "sun teeth"]
    maker = {"name": "gearing", "module": "tol3d.gearing.system", "beside": ["planetary", "cycloid"]}
    assert run.summary["mechanism"] == maker


def test_a_kept_run_is_read_back_compared_and_shown(run: Run, tmp_path: Path) -> None:
    again = open_run(run.path)
    assert again.columns()["geometric:lost motion"].tolist() == run.columns()["geometric:lost motion"].tolist()
    assert "at the slow shaft" in str(compare_runs([again, run]).to_csv())
    assert "rv: transmission error by formula" in str(run_report(again.found))
    said = str(check_scene(written(tmp_path, THREE)))
    for words in ("rv: carrier is the output, pin ring fixed; ratio 25", "3K: S to ring 2", "disc displaced across"):
        assert words in said


def test_a_trial_is_shown_with_all_that_is_in_its_links(run: Run) -> None:
    """Bodies stand on the axes of their shafts; the carrier has turned with its shaft."""
    (world,) = PRESENTER.display(run, 3, magnify=1.0).worlds
    poses = {body.name: body.world_from_part for body in world.bodies}
    assert {
        "pinion",
        "wheel",
        "sun",
        "planet 3",
        "disc 2",
        "pin 12 of pin ring",
        "crankshaft 1",
        "carrier",
    } <= poses.keys()
    assert {"S", "P1 of planet 4", "ring 2"} <= poses.keys()
    for name in ("sun", "carrier", "pin ring", "S"):
        np.testing.assert_allclose(poses[name][:2, 3], [30.0, 0.0], atol=0.02)
    assert poses["sun"][2, 3] == pytest.approx(20.0, abs=1e-9)
    assert poses["carrier"][2, 3] == pytest.approx(0.0 + poses["S"][2, 3] + 40.0, abs=1e-9)
    turned = math.atan2(poses["carrier"][1, 0], poses["carrier"][0, 0])
    wanted = math.radians(run.columns()["position:3K [deg]"][3])
    assert math.cos(turned - wanted) == pytest.approx(1.0, abs=1e-6)


def test_a_sign_that_is_wrong_in_a_link_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    right = RVLink.analytic

    def flipped(self: RVLink, seen: LinkTrials) -> FreeTurn:
        deviations = {**seen.deviations, "pin circle": -seen.deviations["pin circle"]}
        return right(self, LinkTrials(seen.contributors, deviations, seen.angles))

    monkeypatch.setattr(RVLink, "analytic", flipped)
    found = run_scene(written(tmp_path, THREE), out=tmp_path / "run").summary["measures"]["at the slow shaft"]
    fault, *_ = found["agreement"]["explanation"]["faults"]
    assert fault.startswith("the two methods disagree on pin circle: ")


# others beside it -----------------------------------------------------------------------------------------------------

SECOND = RV.replace("\n  ", "\n  second ")
OF_SECOND = """
  second pin circle: {kind: pin_circle, of: second pin ring, distribution: {kind: normal, lower: -9 um, upper: 9 um}}
  play: {kind: bearing_play, of: second disc, each: hole, distribution: {kind: uniform, lower: 5 um, upper: 15 um}}"""
IS_SECOND = """
  second: {kind: rv_reducer, sun: second sun, planet: second planet, crankshaft: second crankshaft, disc: second disc,
    pin_ring: second pin ring, carrier: second carrier}"""
SECOND_ALONE = f"""
scene: the second reducer
parts:{SECOND}
tolerances:{OF_SECOND}
moves:{IS_SECOND}
measures: {{lost: {{kind: cycloid_lost_motion, of: second}}}}
"""
TWO = f"""
scene: two reducers in series
parts:
  between: {{kind: shaft, carries: {{carrier: {{}}, second sun: {{at: -60 mm}}}}}}{RV}{SECOND}
tolerances:{OF_RV}{OF_SECOND}
moves:{IS_RV}{IS_SECOND}
  train: {{kind: train, driven: sun, output: second carrier, ratio: 625}}
  last alone: {{kind: train, driven: sun, output: second carrier, held: between}}
  first alone: {{kind: train, driven: sun, output: between}}
measures:
  lost motion: {{kind: lost_motion, of: train}}
  last: {{kind: lost_motion, of: last alone}}
  first: {{kind: lost_motion, of: first alone}}
study: {{trials: 30}}
"""


def test_of_two_reducers_in_series_the_first_counts_over_the_ratio_of_the_last(tmp_path: Path) -> None:
    """The last has play in its bearings and rests under a torque, the first is read at first contact."""
    simulation = simulation_of(load_scene(written(tmp_path, TWO)))
    whole, trials = simulation.system, drawn(simulation, 0, 30)
    assert isinstance(whole, GearSystem)
    (tmp_path / "alone").mkdir()
    first, second = (rv_system(load_scene(written(tmp_path / "alone", own))) for own in (RV_TRUE, SECOND_ALONE))
    for method in METHODS.values():
        answers = whole.method(method, None).answers(trials, whole.measures)
        found = {name: own[:, 0] for name, own in answers.values.items()}
        for name, own, link in (("first", first, "rv"), ("last", second, "second")):
            read = alone(own, (whole, trials), method, output_turns((whole, trials), link))
            assert np.array_equal(found[name], read)
            assert found[name].std() > 3e-6
        np.testing.assert_allclose(found["lost motion"], found["first"] / 25 + found["last"], rtol=0, atol=1e-17)


BESIDE = f"""
scene: a reducer beside a bought one
parts:{RV}
tolerances:{OF_RV}
  run-out: {{kind: carrier_bearing, of: carrier, distribution: {{kind: rayleigh, scale: 9 um}}}}
  box play: {{kind: reducer_backlash, of: box, distribution: {{kind: uniform, lower: 1 arcmin, upper: 5 arcmin}}}}
moves:{IS_RV}
  box: {{kind: reducer, driver: sun, driven: carrier, ratio: 25}}
  train: {{kind: train, driven: sun, output: carrier}}
measures: {{lost motion: {{kind: lost_motion, of: train}}}}
study: {{trials: 40}}
"""


def test_beside_another_load_path_both_leave_what_each_leaves_where_its_middle_lies(tmp_path: Path) -> None:
    """The bought reducer's free turn lies about the nominal angle; this one's ends are its turns on and back."""
    simulation = simulation_of(load_scene(written(tmp_path, BESIDE)))
    whole, trials = simulation.system, drawn(simulation, 0, 40)
    assert isinstance(whole, GearSystem)
    own = whole.model.link("rv")
    assert isinstance(own, RVLink)
    seen = link_trials(whole.model, whole.measures[0], own, trials)
    half = trials.deviations[:, whole.model.component_slices["box play"]][:, 0] / 2
    for method, turning in (("exact", exact_turning(own.own)), (ANALYTIC_METHOD, linear_turning(own.own))):
        on, back = (
            turning.turned(own.deviated(seen, own.output_turns(seen)[:, 0]), own.output_turns(seen), sense).turns[:, 0]
            for sense in (1, -1)
        )
        wanted = np.minimum(on, half) - np.maximum(back, -half)
        found = whole.method(method, None).answers(trials, whole.measures).values["lost motion"][:, 0]
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-16)
        centred = np.minimum(on - back, 2 * half)
        assert np.abs(found - centred).max() > 1e-5  # its middle counts


def test_builds_that_fail_fail_their_train_in_its_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Holes 6 um off may leave cranks that do not fit; and a build of which nothing touches gives no number."""
    law = "distribution: {kind: rayleigh, scale: 5 um}"
    holes = f"\n  holes: {{kind: disc_hole, of: second disc, each: hole, {law}}}\nmoves:"
    simulation = simulation_of(load_scene(written(tmp_path, TWO.replace("\nmoves:", holes))))
    whole, trials = simulation.system, drawn(simulation, 0, 12)
    assert isinstance(whole, GearSystem)
    (tmp_path / "alone").mkdir()
    own = rv_system(load_scene(written(tmp_path / "alone", SECOND_ALONE.replace("\nmoves:", holes))))
    read = answered(own, (whole, trials), "exact", output_turns((whole, trials), "second"))
    unfit = np.array(own.statuses.texts)[read.status["lost"]] == "cranks do not fit"
    assert 0 < unfit.sum() < 12
    found = whole.method("exact", None).answers(trials, whole.measures)
    for name in ("last", "lost motion"):
        words = np.array(whole.statuses.texts)[found.status[name]]
        assert words.tolist() == np.where(unfit, "interferes", "ok").tolist()
    assert set(found.status["first"]) == {0}

    right = RVLink.exact

    def lost(self: RVLink, seen: LinkTrials) -> FreeTurn:
        turn = right(self, seen)
        turn.play[:3] = np.nan
        return FreeTurn(turn.play, turn.middle)

    monkeypatch.setattr(RVLink, "exact", lost)
    again = whole.method("exact", None).answers(trials, whole.measures)
    assert np.array(whole.statuses.texts)[again.status["first"]].tolist() == ["no contact"] * 3 + ["ok"] * 9


MIXED = f"""
scene: a reducer and a rope
parts:
  slow: {{kind: shaft, carries: {{carrier: {{}}, drum: {{at: -30 mm}}}}}}
  drum: {{kind: drum, radius: 20 mm}}
  hoist: {{kind: drum, radius: 50 mm}}{RV}
tolerances:{OF_RV}
  slow run-out: {{kind: run_out, of: slow, {RAYLEIGH}}}
  stretch: {{kind: rope_stretch, of: drum, distribution: {{kind: uniform, lower: 10 um, upper: 30 um}}}}
moves:{IS_RV}
  rope: {{kind: rope_drive, first: drum, second: hoist}}
  train: {{kind: train, driven: sun, output: hoist, ratio: 62.5}}
measures:
  lost motion: {{kind: lost_motion, of: train}}
  of the rope: {{kind: lost_motion, of: rope alone}}
study: {{trials: 100}}
"""
MIXED = MIXED.replace("measures:\n", "  rope alone: {kind: train, driven: sun, output: hoist, held: slow}\nmeasures:\n")


@pytest.fixture
def ropes() -> Iterator[None]:
    with known(ROPES):
        yield


@pytest.mark.usefixtures("ropes")
def test_a_link_from_outside_stands_beside_it_with_the_same_rights(tmp_path: Path) -> None:
    """Its play by hand, its parts on shafts with run-out, its shares, its words in check and report, its bodies."""
    path = written(tmp_path, MIXED)
    found = run_scene(path, out=tmp_path / "run")
    columns = found.columns()
    angle = np.radians(columns["position:rope [deg]"])
    x, y = (columns[f"slow run-out.{axis} [um]"] for axis in "xy")
    rope = (columns["stretch [um]"] + x * np.cos(angle) - y * np.sin(angle)) * 1e-3 / 50 / ARCMIN
    for method in METHODS:
        np.testing.assert_allclose(columns[f"{method}:of the rope"], rope, rtol=0, atol=1e-12)
        others = columns[f"{method}:lost motion"] - rope
        np.testing.assert_allclose(others, columns[f"{method}:lost motion:rv [arcmin]"] * 20 / 50, rtol=0, atol=1e-12)
    shares = {own["name"]: own["geometric_percent"] for own in found.summary["measures"]["of the rope"]["contributors"]}
    assert shares.keys() == {"stretch", "slow run-out"}
    assert sum(shares.values()) == pytest.approx(100, abs=1e-6)
    assert "rope: a rope, slow run-out, stretch" in str(check_scene(path))
    assert "rope is a rope" in str(run_report(open_run(tmp_path / "run").found))
    display = PRESENTER.display(found, "mean", magnify=1.0)
    assert {"rope", "disc 1", "carrier"} <= {body.name for own in display.worlds for body in own.bodies}
    assert "mean: rope is a block" in display.notes
    assert {"jsonschema", "python-fcl", "cadquery"} <= set(requires_of(load_scene(path)))
    assert "jsonschema" in dict(installed_versions(requires_of(load_scene(path))))


def test_a_reducer_by_itself_is_its_own_scene_and_in_a_train_one_of_gears(tmp_path: Path) -> None:
    assert mechanism_of(load_scene(written(tmp_path, RV_ALONE))).name == "cycloid"
    assert mechanism_of(load_scene(written(tmp_path, SET_ALONE))).name == "planetary"
    assert mechanism_of(load_scene(written(tmp_path, THREE))).name == "gearing"


# what it cannot have --------------------------------------------------------------------------------------------------

REFUSED = {
    "a disc of two": (
        re.sub("\n  (second disc|play):[^\n]*", "", TWO),
        ("disc: second disc", "disc: disc"),
        "moves.second: expected parts of this move alone, got 'disc', which 'rv' has",
    ),
    "a ratio that the teeth do not give": (
        THREE,
        ("ratio: -2736", "ratio: -2700"),
        "moves.train.ratio: expected -2736 (its sign may be left out) = -2 (pair) · 25 (rv) · 54.72 (3K), got -2700",
    ),
    "a sun on no shaft": (
        THREE,
        (", sun: {at: 20 mm}}", "}"),
        "moves.train.output: the train does not connect: from 'motor' one gets to 'motor', 'between'; 'ring 2' is "
        "driven from 'sun'",
    ),
    "a planet on a shaft": (
        THREE,
        ("sun: {at: 20 mm}", "sun: {at: 20 mm}, planet: {}"),
        "parts.between.carries.planet: expected 'sun' or 'carrier' of 'rv', got 'planet', which no shaft of a train",
    ),
    "a phase": (
        THREE,
        ("sun: {at: 20 mm}", "sun: {at: 20 mm, phase: 3 deg}"),
        "parts.between.carries.sun.phase: expected no phase of 'sun': the teeth of 'rv' say how its gears stand",
    ),
    "a measure of the reducer": (
        THREE,
        (
            "at the start: {kind: lost_motion, of: train, over: {at: 0 deg}}",
            "at the start: {kind: cycloid_lost_motion, of: rv}",
        ),
        "measures.at the start.kind: expected a measure of trains, for 'rv' is a stage of one, got "
        "cycloid_lost_motion; take lost_motion of a train whose output turns with 'carrier', and of the reducer alone",
    ),
    "a transmission error": (
        THREE,
        (
            "at the start: {kind: lost_motion, of: train, over: {at: 0 deg}}",
            "at the start: {kind: transmission_error, of: train, over: turn}",
        ),
        "measures.at the start.of: expected meshes in series from 'motor' to 'ring 2', got 'rv', an RV reducer whose",
    ),
    "an idle disc": (
        THREE,
        ("  disc:", "  idle: {kind: cycloid_disc, lobes: 11}\n  disc:"),
        "parts.idle: 'idle' is used by no move; name it in an RV reducer or take it out",
    ),
    "a bearing of the carrier's shaft": (
        THREE,
        (
            "tolerances:\n",
            "  rear: {kind: bearing, shaft: slow, at: 40 mm}\ntolerances:\n  rear clearance: {kind: bearing_clearance, "
            "of: rear, direction: random, distribution: {kind: rayleigh, scale: 5 um}}\n",
        ),
        "tolerances.rear clearance: expected a shaft without parts of 'rv', got one that carries 'carrier', which",
    ),
    "teeth that interfere": (
        THREE,
        (
            "sun teeth: {kind: tooth_thickness, of: sun, distribution: {kind: uniform, lower: -45 um, upper: -25 um}}",
            "sun teeth: {kind: tooth_thickness, of: sun, distribution: {kind: uniform, lower: 15 um, upper: 25 um}}",
        ),
        "parts.sun: the teeth of sun and planet interfere at the mean build: a normal backlash of -18.794 um",
    ),
    "two reducers without a train": (
        TWO[: TWO.index("  train:")] + "measures: {lost: {kind: cycloid_lost_motion, of: rv}}\n",
        ("  between: {kind: shaft, carries: {carrier: {}, second sun: {at: -60 mm}}}\n", ""),
        "moves.second: expected one RV reducer and no other move, got 2 moves; several make a train, which a move",
    ),
    "a part with a drawing": (
        THREE.replace("\nmoves:", "\nmoves:\n  hold: {kind: fix, part: base}"),
        ("parts:\n", "parts:\n  base: {kind: solid, features: {mark: {kind: point, at: [0 mm, 0 mm, 0 mm]}}}\n"),
        "parts.base: kinds of assembly and gearing and cycloid and planetary do not go together in one scene, got "
        "'base' of assembly and 'motor' of gearing and 'crankshaft' of cycloid and 'planets' of planetary; join them "
        "by a move of kind carrier_pins or a move of kind open_chain or a move of kind shaft_in_bores, or make two "
        "scenes",
    ),
}


@pytest.mark.parametrize(("text", "change", "words"), REFUSED.values(), ids=REFUSED.keys())
def test_what_such_a_train_cannot_have_is_refused_in_one_line(
    text: str, change: Edit, words: str, tmp_path: Path
) -> None:
    said = refusal(edited(text, change), tmp_path)
    assert words in said
    assert "\n" not in said
