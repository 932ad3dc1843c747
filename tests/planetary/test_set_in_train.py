"""Planetary sets as stages of trains: what a spur stage and a set leave free together, trial by trial.

The spur stage is written down here by its first-order formula, its gap j over r_b of the driven gear; sets by their
closed form where all planets are alike, else by HiGHS on gaps at the working pitch circles (planetary_sets.py).
"""

import math
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES
from planetary_sets import ARCMIN, free_by_highs, pitch_rows, reducer_3k
from scene_texts import Edit, edited, refusal

from tol3d import Overrides, Run, load_scene, run_scene
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.presenting import PRESENTER
from tol3d.gearing.system import gear_system
from tol3d.report.motion import motion_of
from tol3d.study.system.trials import Trials

Array = NDArray[np.float64]
Columns = Mapping[str, Array]

TEXT = (SCENES / "reducer_3k_train.yaml").read_text("utf-8")
ALPHA = math.radians(20)
COS, SIN = math.cos(ALPHA), math.sin(ALPHA)
RATIO = 1368 / 25
R_WHEEL = 28.5 * COS  # mm, of the base circle
METHODS = ("analytic", "geometric")
SAME = 1e-9  # arcmin


def ran(folder: Path, text: str, trials: int) -> Run:
    (folder / "scene.yaml").write_text(text, "utf-8")
    return run_scene(folder / "scene.yaml", overrides=Overrides(trials=trials), out=folder / "run")


def alone(text: str, *kept: str) -> str:
    """The scene with the tolerances of some names, each on one line, and nothing published."""
    start, end = text.index("tolerances:"), text.index("moves:")
    lines = re.sub(r":\n    \{", ": {", text[start:end]).splitlines()
    own = [line for line in lines if line.strip().split(":")[0] in kept]
    assert len(own) == len(kept)
    return text[:start] + "tolerances:\n" + "\n".join(own) + "\n\n" + text[end : text.index("published:")]


def of_spur(columns: Columns) -> Array:
    """Free turn of the wheel [arcmin] to first order; DESIGN's formula."""
    theta = np.radians(columns["position:spur stage [deg]"])
    beyond = math.pi + math.pi / 57 - theta * 19 / 57

    def towards(name: str, angle: Array) -> Array:
        return columns[f"{name}.x [um]"] * np.cos(angle) - columns[f"{name}.y [um]"] * np.sin(angle)

    wheel = towards("wheel eccentricity", beyond) + towards("countershaft run-out", beyond)
    apart = columns["centre distance [um]"] - towards("pinion eccentricity", theta) + wheel
    thicker = columns["pinion tooth thickness [um]"] + columns["wheel tooth thickness [um]"]
    return np.asarray((2 * SIN * apart - thicker * COS) * 1e-3 / R_WHEEL / ARCMIN)


def of_set(columns: Columns, trial: int) -> float:
    """Free turn of ring 2 [arcmin], the sun held, to first order."""
    low, high = ends_of_set(columns, trial)
    return high - low


def ends_of_set(columns: Columns, trial: int) -> tuple[float, float]:
    """Both ends of it [arcmin]."""
    own, found = reducer_3k(), Deviated.nothing(reducer_3k(), 1)

    def each(name: str, unit: str, *axes: str) -> Array:
        keys = [f"{name}.planet {k + 1}{axis} [{unit}]" for k in range(4) for axis in axes or ("",)]
        return np.array([columns[key][trial] for key in keys]).reshape((4, len(axes)) if axes else (4,)) * 1e-3

    def both(name: str) -> Array:
        return np.array([columns[f"{name}.{axis} [um]"][trial] for axis in "xy"]) * 1e-3

    for m, central in enumerate(("sun", "ring 1", "ring 2")):
        found.central_thickness[0, m] = columns[f"{central} thinning [um]"][trial] * 1e-3 / COS
        x, y = both(f"{central} eccentricity")  # in its own frame, whose tooth 0 stands half a pitch off a ring's space
        lean = 0.0 if central == "sun" else math.pi / (79, 76)[m - 1]
        found.central_offset[0, m] = math.cos(lean) * x - math.sin(lean) * y, math.sin(lean) * x + math.cos(lean) * y
    found.central_offset[0, 0] += both("countershaft run-out")
    for g, gear in enumerate(("P1", "P2")):
        found.planet_thickness[0, g] = each(f"{gear} thinning", "um") / COS
        found.planet_offset[0, g] = each(f"{gear} eccentricity", "um", " x", " y")
    found.planet_clocking[0, 1] = each("clocking", "arcmin") * 1e3 * ARCMIN
    found.pins[0, :, 0], found.pins[0, :, 1] = each("pins outwards", "um"), each("pins round", "um")
    turns = columns["position:reducer [deg]"][trial] / 360 / RATIO
    low, high = free_by_highs(own, pitch_rows(own, found, 0, turns), "ring 2", "sun")
    return float(low / ARCMIN), float(high / ARCMIN)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return ran(tmp_path_factory.mktemp("train"), TEXT, 1000)


# closed forms --------------------------------------------------------------------------------------------------------


def test_with_planets_alike_the_play_is_the_closed_form_of_both_stages(tmp_path: Path) -> None:
    """n_A = r_P psi - r_S h and n_B = r_P psi + r_R1 h: h = (n_B - n_A) / (r_R1 + r_S), and so ring 2's turn.

    theta = h + (r_P2 psi - n_C) / r_R2, all r of base circles; each n goes from -c to c. Planets are nominal.
    """
    names = ("pinion tooth thickness", "wheel tooth thickness", "sun thinning", "ring 1 thinning", "ring 2 thinning")
    columns = ran(tmp_path, alone(TEXT, *names), 64).columns()
    sun, first, second = (-columns[f"{name} [um]"] * 1e-3 / 2 for name in names[2:])
    r_s, r_r1, r_r2, r_p1, r_p2 = (COS * teeth / 2 for teeth in (25, 79, 76, 27, 24))
    kappa = r_p2 / r_p1 / r_r2
    by_sun = -1 / (r_r1 + r_s) + kappa * (1 - r_s / (r_r1 + r_s))
    by_first = 1 / (r_r1 + r_s) + kappa * r_s / (r_r1 + r_s)
    reducer = 2 * (abs(by_sun) * sun + abs(by_first) * first + second / r_r2)
    spur = -(columns[f"{names[0]} [um]"] + columns[f"{names[1]} [um]"]) * 1e-3 / 28.5
    wanted = (reducer + spur / RATIO) / ARCMIN
    for method in METHODS:
        np.testing.assert_allclose(columns[f"{method}:lost motion"], wanted, rtol=0, atol=1e-6)
        np.testing.assert_allclose(columns[f"{method}:lost motion of the reducer"], reducer / ARCMIN, rtol=0, atol=SAME)


def test_the_spur_stage_contributes_its_play_over_the_ratio_of_the_set(run: Run) -> None:
    columns = run.columns()
    for method in METHODS:
        whole, reducer = (columns[f"{method}:lost motion{which}"] for which in ("", " of the reducer"))
        spur = columns[f"{method}:lost motion of the countershaft"]
        np.testing.assert_allclose(whole - reducer, spur / RATIO, rtol=0, atol=1e-12)
        assert spur.std() > 1.0


def test_the_set_is_read_where_the_countershaft_stands(run: Run) -> None:
    """The wheel's angle at the mesh, by the pinion's: pi + pi/57 - theta/3."""
    columns = run.columns()
    wheel = math.pi + math.pi / 57 - np.radians(columns["position:spur stage [deg]"]) * 19 / 57
    off = np.radians(columns["position:reducer [deg]"]) - wheel
    np.testing.assert_allclose(np.cos(off), 1.0, rtol=0, atol=1e-12)
    assert np.ptp(columns["position:reducer [deg]"]) > 1e6  # over thousands of turns of the sun


SIMPLE = """
scene: a simple set in front
parts:
  motor: {kind: shaft, carries: {sun: {at: 5 mm}}}
  between: {kind: shaft, carries: {carrier: {}, pinion: {at: 20 mm}}}
  sun: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 8 mm}
  P: {kind: spur_gear, teeth: 25, module: 1 mm, face_width: 8 mm}
  ring: {kind: internal_gear, teeth: 70, module: 1 mm, face_width: 8 mm}
  planet: {kind: planet, gears: [P]}
  carrier: {kind: planet_carrier}
  pinion: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 8 mm}
  wheel: {kind: spur_gear, teeth: 40, module: 1 mm, face_width: 8 mm}
tolerances:
  sun teeth: {kind: tooth_thickness, of: sun, distribution: {kind: uniform, lower: -60 um, upper: -20 um}}
  ring teeth: {kind: tooth_thickness, of: ring, distribution: {kind: uniform, lower: -60 um, upper: -20 um}}
  pinion teeth: {kind: tooth_thickness, of: pinion, distribution: {kind: uniform, lower: -60 um, upper: -20 um}}
moves:
  set:
    kind: planetary
    planet: planet
    planets: 3
    carrier: carrier
    meshes: {sun: P, ring: P}
    held: ring
    input: sun
    output: carrier
  pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 30 mm, working_flank: either}
  train: {kind: train, driven: motor, output: wheel, ratio: -9}
measures:
  lost motion: {kind: lost_motion, of: train}
study: {trials: 50}
"""


def test_a_carrier_drives_the_stage_behind_it(tmp_path: Path) -> None:
    """h = (n_B - n_A) / (r_R + r_S) of the carrier, over 2 at the wheel; and the pair's own play."""
    columns = ran(tmp_path, SIMPLE, 50).columns()
    lacking = {name: -columns[f"{name} teeth [um]"] * 1e-3 for name in ("sun", "ring", "pinion")}
    carrier = (lacking["sun"] + lacking["ring"]) / 45
    wanted = (carrier / 2 + lacking["pinion"] / 20) / ARCMIN
    for method in METHODS:
        np.testing.assert_allclose(columns[f"{method}:lost motion"], wanted, rtol=0, atol=1e-6)


# against other programmes --------------------------------------------------------------------------------------------


def compared(columns: Columns, trials: int) -> float:
    """Largest difference [arcmin] from the spur formula and HiGHS."""
    spur, found = of_spur(columns), columns["analytic:lost motion"]
    return max(abs(found[k] - of_set(columns, k) - spur[k] / RATIO) for k in range(trials))


def test_first_order_is_that_of_another_programme(run: Run) -> None:
    assert compared(run.columns(), 25) < 1e-8


@pytest.mark.slow
def test_first_order_is_that_of_another_programme_in_a_thousand_trials(run: Run) -> None:
    assert compared(run.columns(), 1000) < 1e-8


def test_both_methods_differ_by_what_is_of_second_order() -> None:
    """All deviations halved, thicknesses too: differences fall to a quarter. Teeth are without clearance nominally."""
    system = gear_system(load_scene(SCENES / "reducer_3k_train.yaml"))
    rng = np.random.default_rng(3)
    uniforms = {stream: rng.random(400) for stream in system.streams}
    parts = [own.draw.deviations(*rng.random((own.draw.uniforms, 400))) for own in system.contributors]
    drawn = np.stack([column for part in parts for column in part], axis=1)
    rms = []
    for size in (1.0, 0.5):
        trials = Trials(size * drawn, system.positions(uniforms))
        found = (system.method(method, None).answers(trials, system.measures) for method in ("exact", "analytic"))
        exact, first_order = (answers.values["lost motion"] for answers in found)
        rms.append(float(np.sqrt(np.mean((exact - first_order) ** 2))))
    assert rms[0] / ARCMIN == pytest.approx(0.001, rel=0.5)
    assert rms[0] / rms[1] == pytest.approx(4.0, rel=0.02)


def test_contributors_of_both_stages_have_their_shares(run: Run) -> None:
    """The wheel's turn is its teeth's; at ring 2 the spur stage has (1.3 / 54.72 / 1.06)^2 = 0.05 % of the variance."""
    (stage, reducer) = run.summary["trains"]["drive"]["stages"]
    assert [stage["kind"], reducer["kind"]] == ["mesh", "planetary_set"]
    assert [stage["ratio"], reducer["ratio"]] == pytest.approx([-3, RATIO], rel=1e-15)
    columns = run.columns()
    whole, own = columns["geometric:lost motion"], columns["geometric:lost motion of the countershaft"] / RATIO
    wanted = 100 * float(np.cov(own, whole)[0, 1] / whole.var(ddof=1))
    assert stage["methods"]["geometric"]["share_percent"] == pytest.approx(wanted, abs=1e-6)
    assert reducer["methods"]["geometric"]["share_percent"] == pytest.approx(100 - wanted, abs=1e-6)
    shares = {own["name"]: own for own in run.summary["measures"]["lost motion"]["contributors"]}
    assert len(shares) == 19
    assert sum(own["analytic_percent"] for own in shares.values()) == pytest.approx(100, abs=0.2)


@pytest.mark.slow
def test_a_set_that_jams_jams_its_train(tmp_path: Path) -> None:
    """Pins 60 um off bind planets; the play of the spur stage frees nothing."""
    columns = ran(tmp_path, TEXT.replace("lower: -6 um, upper: 6 um", "lower: -60 um, upper: 60 um"), 200)
    counts = columns.summary["measures"]["lost motion"]["status"]
    assert counts["interferes"] > 60
    assert counts["ok"] + counts["interferes"] == 200
    frame, jammed = columns.columns(), np.asarray(columns.frame()["status:lost motion"]) == "interferes"
    whole, alone = frame["geometric:lost motion"], frame["geometric:lost motion of the reducer"]
    np.testing.assert_allclose(whole[jammed], alone[jammed], rtol=1e-12)
    assert (alone[jammed] < 0.0).all()
    assert (whole[~jammed] > alone[~jammed]).all()


# what it cannot have -------------------------------------------------------------------------------------------------

REFUSED = {
    "a measure of the set": (
        (
            "lost motion of the reducer: {kind: lost_motion, of: reducer alone}",
            "lost motion of the reducer: {kind: planetary_lost_motion, of: reducer}",
        ),
        "measures.lost motion of the reducer.kind: expected a measure of trains, for 'reducer' is a stage of one, got "
        "planetary_lost_motion; take lost_motion of a train whose output turns with 'ring 2'",
    ),
    "the carrier on a shaft": (
        ("carries: {pinion: {at: 0 mm}}", "carries: {pinion: {at: 0 mm}, carrier: {}}"),
        "parts.motor.carries.carrier: expected 'sun' or 'ring 2' of 'reducer', got 'carrier', which no shaft of a "
        "train turns with",
    ),
    "a phase": (
        ("sun: {at: 24 mm}", "sun: {at: 24 mm, phase: 3 deg}"),
        "parts.countershaft.carries.sun.phase: expected no phase of 'sun': the teeth of 'reducer' say how its gears",
    ),
    "a sun in a mesh": (
        ("driver: pinion, driven: wheel", "driver: pinion, driven: sun"),
        "moves.spur stage: expected a gear that no other move has, got 'sun', which 'reducer' has; put another gear",
    ),
    "a bearing of the sun's shaft": (
        (
            "tolerances:\n",
            "  rear: {kind: bearing, shaft: countershaft, at: 40 mm}\ntolerances:\n  rear clearance: {kind: "
            "bearing_clearance, of: rear, direction: random, distribution: {kind: rayleigh, scale: 5 um}}\n",
        ),
        "tolerances.rear clearance: expected a shaft without parts of 'reducer', got one that carries 'sun'",
    ),
    "flanks of the sun": (
        ("sun eccentricity: {kind: eccentricity,", "sun eccentricity: {kind: run_out,"),
        "tolerances.sun eccentricity.kind: expected of planetary sets tooth_thickness, eccentricity, "
        "tooth_run_out, clocking, axial_play, "
        "planet_pin, bore_position, got run_out",
    ),
    "an idle carrier": (
        ("  carrier: {kind: planet_carrier}", "  carrier: {kind: planet_carrier}\n  other: {kind: planet_carrier}"),
        "parts.other: 'other' is used by no move; name it in a set or take it out",
    ),
    "thick teeth": (
        (
            "of: ring 2, measured: normal, distribution: {kind: uniform, lower: -45 um, upper: -25 um}",
            "of: ring 2, distribution: {kind: uniform, lower: 90 um, upper: 99 um}",
        ),
        "moves.reducer.meshes.ring 2: the teeth interfere at the mean build: ring 2–P2 has a normal backlash of -",
    ),
    "a transmission error": (
        (
            "lost motion of the reducer: {kind: lost_motion, of: reducer alone}",
            "lost motion of the reducer: {kind: transmission_error, of: drive, over: turn, positions: 36}",
        ),
        "measures.lost motion of the reducer.of: expected meshes in series from 'motor' to 'ring 2', got 'reducer', a "
        "planetary set whose error recurs with turns of its output, not of the motor (planetary_transmission_error "
        "reads it, in a scene of its own); measure mesh by mesh",
    ),
    "another ratio": (
        ("ratio: -164.16", "ratio: 160"),
        "moves.drive.ratio: expected -164.16 (its sign may be left out) = -3 (spur stage) · 54.72 (reducer), got 160",
    ),
}


@pytest.mark.parametrize(("change", "said"), REFUSED.values(), ids=REFUSED.keys())
def test_what_such_a_train_cannot_have_is_refused(change: Edit, said: str, tmp_path: Path) -> None:
    assert said in refusal(edited(TEXT, change), tmp_path)


# beside another load path --------------------------------------------------------------------------------------------


def beside() -> str:
    """The countershaft drives ring 2 by the set and by a reducer of the same ratio."""
    law = "distribution: {kind: uniform, lower: 6 arcmin, upper: 16 arcmin}"
    text = TEXT.replace(
        "\nmoves:\n",
        f"\n  box play: {{kind: reducer_backlash, of: box, {law}}}\n\nmoves:\n"
        "  box: {kind: reducer, driver: countershaft, driven: ring 2, ratio: 54.72}\n",
    )
    return text[: text.index("published:")]


@pytest.mark.slow
def test_a_set_beside_a_reducer_leaves_what_both_leave(tmp_path: Path) -> None:
    """The set's free turn lies aside by clocking and eccentric gears; the reducer's about the middle."""
    columns = ran(tmp_path, beside(), 60).columns()
    spur, aside = of_spur(columns), 0.0
    for trial in range(60):
        low, high = ends_of_set(columns, trial)
        half = columns["box play [arcmin]"][trial] / 2
        aside = max(aside, abs(low + high))
        wanted = min(high, half) - max(low, -half)
        found = columns["analytic:lost motion of the reducer"][trial]
        assert found == pytest.approx(wanted, rel=0, abs=1e-8)
        assert columns["analytic:lost motion"][trial] == pytest.approx(wanted + spur[trial] / RATIO, rel=0, abs=1e-8)
    assert aside > 0.1
    np.testing.assert_allclose(columns["geometric:lost motion"], columns["analytic:lost motion"], rtol=0, atol=0.02)


def test_a_set_that_goes_up_and_turns_back_drives_a_train(tmp_path: Path) -> None:
    """Driven at the carrier, the ring held: 1 turn of the carrier for 4.5 of the sun; its play there is 4.5 fold."""
    up = SIMPLE.replace("carries: {sun: {at: 5 mm}}", "carries: {carrier: {}}")
    up = up.replace("carries: {carrier: {}, pinion: {at: 20 mm}}", "carries: {sun: {at: 5 mm}, pinion: {at: 20 mm}}")
    up = up.replace("input: sun\n    output: carrier", "input: carrier\n    output: sun").replace("-9}", "-0.44444444}")
    columns = ran(tmp_path, up, 50).columns()
    lacking = {name: -columns[f"{name} teeth [um]"] * 1e-3 for name in ("sun", "ring", "pinion")}
    wanted = ((lacking["sun"] + lacking["ring"]) / 10 / 2 + lacking["pinion"] / 20) / ARCMIN
    for method in METHODS:
        np.testing.assert_allclose(columns[f"{method}:lost motion"], wanted, rtol=0, atol=1e-6)


# shown ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow  # makes the solids of all gears
def test_the_set_turns_with_its_train(tmp_path: Path) -> None:
    """Per turn of the motor: 1/3 at the sun, 25/104 of that at the pins, 25/1368 at ring 2; all against the motor."""
    run = ran(tmp_path, TEXT, 4)
    moved = motion_of(PRESENTER.display(run, "mean", magnify=1.0), "turn", 9)
    assert {"sun", "ring 2", "P1 of planet 3"} <= {body.name for body in moved.world.bodies}
    first, now = moved.frames[0].poses, moved.frames[6].poses
    sun = -(2 * math.pi * 6 / 9) / 3

    def turned(name: str) -> float:
        turn = now[name][:2, :2] @ first[name][:2, :2].T
        return math.atan2(turn[1, 0], turn[0, 0])

    assert turned("sun") == pytest.approx(sun, abs=1e-9)
    assert turned("ring 1") == pytest.approx(0.0, abs=1e-12)
    assert turned("ring 2") == pytest.approx(sun / RATIO, abs=1e-9)
    axis = now["sun"][:2, 3]
    before, after = (poses["P1 of planet 3"][:2, 3] - axis for poses in (first, now))
    angle = math.atan2(before[0] * after[1] - before[1] * after[0], before @ after)
    assert angle == pytest.approx(sun * 25 / 104, abs=1e-3)  # the carrier rests anywhere in its play, 0.001 rad


def test_a_set_lies_where_its_input_is_on_its_shaft_and_its_output_s_shaft_begins_at_the_output() -> None:
    """The sun is 24 mm up; ring 2 has a face of 12 mm beside that of ring 1, where P2 lies beside P1."""
    (link,) = gear_system(load_scene(SCENES / "reducer_3k_train.yaml")).model.links
    assert link.levels["sun"] == link.levels["ring 1"] == 24.0
    assert link.offset == pytest.approx(link.levels["ring 2"], abs=1e-12)
    assert abs(link.offset - 24.0) >= 12.0
