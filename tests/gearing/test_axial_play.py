"""Helical trains: shafts that slide through their axial play, and gears that lie elsewhere along their axes.

Against linear programmes over turns and shifts (`oracles.screw_chain`), against builds of the exact engine at both ends
of their plays, and against numbers that follow by hand.
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from gear_trials import drawn_trials, form_of, gear_columns, measure_of, model_of_scene
from guides import quoted
from of_kind import of_kind
from oracles.screw_chain import Helical, Meshing, turn_between

from tol3d.errors import SceneError
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.methods.analytic import AnalyticMethod, analytic_play
from tol3d.gearing.methods.geometric import GeometricMethod
from tol3d.gearing.model import AxisOffset, LostMotion, Model, Reading, model_from_scene
from tol3d.gearing.model import slides as model_slides
from tol3d.gearing.model.measure import ParallelStage, Stage
from tol3d.gearing.raceways import DeepGroove, ObliqueContact
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.gearing.stack_up import closed_form, stack_of
from tol3d.simulate import load
from tol3d.study.system.trials import Trials

ARCMIN = 10800 / math.pi  # in a radian
SAME_TURN = 1e-9  # rad; where the exact engine's steps end, 1e-8 mm, at 20 mm and twice
SOLVED = 2e-9  # rad; of the linear programmes: HiGHS keeps bounds within 1e-7 of the rows, which are in um of arcs

OF_HAND = {1: "right", -1: "left"}
FACING = {1: "forward", -1: "backward"}


def helical(gear: Helical, width: float = 14.0) -> str:
    beta = math.degrees(gear.helix)
    kind = f"helical_gear, helix_angle: {beta!r} deg, hand: {OF_HAND[gear.hand]}" if gear.helix else "spur_gear"
    return f"{{kind: {kind}, teeth: {gear.teeth}, module: {gear.module} mm, face_width: {width} mm}}"


def chain(
    gears: Mapping[str, Helical],
    meshes: Mapping[str, tuple[str, str]],
    tolerances: str,
    folder: Path,
    measures: str = "",
    azimuths: Mapping[str, float] | None = None,
) -> Model:
    """A train of gears from the first mesh's driver shaft to the last one's driven shaft."""
    lines = scene_lines(gears, meshes, tolerances, measures, azimuths or {})
    (path := folder / "chain.yaml").write_text("\n".join(line for line in lines if line))
    return model_of_scene(path)


def scene_lines(
    gears: Mapping[str, Helical],
    meshes: Mapping[str, tuple[str, str]],
    tolerances: str,
    measures: str = "",
    azimuths: Mapping[str, float | str] = MappingProxyType({}),
) -> list[str]:
    """Lines of such a scene."""
    shafts = dict.fromkeys(gear.shaft for gear in gears.values())
    lines = ["scene: chain", "parts:", *(f"  {name}: {helical(gear)}" for name, gear in gears.items())]
    at = {"C": 30.0, "E": 60.0, "F": 60.0, "X": 30.0, "Y": 30.0}  # along their shafts; a mesh puts faces side by side
    for shaft in shafts:
        own = (
            f"{name}: {{facing: {FACING[gear.sense]}, at: {at.get(name, 0.0)} mm}}"
            for name, gear in gears.items()
            if gear.shaft == shaft
        )
        lines.append(f"  {shaft}: {{kind: shaft, carries: {{{', '.join(own)}}}}}")
    lines += ["tolerances:", tolerances, "moves:"]
    for name, (driver, driven) in meshes.items():
        apart = gears[driver].radius + gears[driven].radius + 0.15
        where = f"centre_distance: {apart!r} mm, azimuth: {azimuths.get(name, 33.0)} deg"
        lines.append(f"  {name}: {{kind: mesh, driver: {driver}, driven: {driven}, {where}}}")
    first, last = (list(shafts)[k] for k in (0, -1))
    lines += [f"  train: {{kind: train, driven: {first}, output: {last}}}", "measures:"]
    return [
        *lines,
        "  lost: {kind: lost_motion, of: train, over: {at: 20 deg}}",
        measures,
        "study: {trials: 10, seed: 3}",
    ]


def two_stages(hands: tuple[int, int], senses: tuple[int, int] = (1, -1)) -> dict[str, Helical]:
    """A on one, B and C on two, D on three; other modules, helix angles and numbers of teeth."""
    beta, gamma = math.radians(23.0), math.radians(14.0)
    return {
        "A": Helical("one", 21, 1.5, beta, hands[0]),
        "B": Helical("two", 46, 1.5, beta, -hands[0], senses[0]),
        "C": Helical("two", 19, 2.0, gamma, hands[1], senses[1]),
        "D": Helical("three", 53, 2.0, gamma, -hands[1]),
    }


TWO = {"first": ("A", "B"), "second": ("C", "D")}


def plays(**lengths: float) -> str:
    """Axial plays of shafts [um], and thinner teeth."""
    lines = [
        f"  {shaft} play: {{kind: axial_play, of: {shaft}, distribution: {{kind: constant, value: {size} um}}}}"
        for shaft, size in lengths.items()
    ]
    return "\n".join([*lines, "  thin: {kind: tooth_thickness, of: A, distribution: {kind: constant, value: -30 um}}"])


def arcs(model: Model, gears: Mapping[str, Helical], thinner: float = 0.030) -> list[Meshing]:
    """The meshes of a chain with the plays of their teeth, as arcs of the reference circles [mm]."""
    found = []
    for mesh in model.meshes:
        driver, driven = gears[mesh.driver], gears[mesh.driven]
        alpha_t = math.atan(math.tan(math.radians(20.0)) / math.cos(driver.helix))
        apart = driver.radius + driven.radius + 0.15
        working = math.acos((driver.radius + driven.radius) * math.cos(alpha_t) / apart)
        involute = (math.tan(working) - working) - (math.tan(alpha_t) - alpha_t)
        play = 2 * (driver.radius + driven.radius) * involute
        thin = thinner / math.cos(driver.helix) if mesh.driver == "A" else 0.0
        found.append(Meshing(driver, driven, play + thin))
    return found


def lost(model: Model) -> tuple[float, float]:
    """Lost motion by the exact and the analytic method [rad]."""
    columns = gear_columns(model, exact_engine(model), drawn_trials(model, 1, 0, 1))
    return float(columns["geometric:lost"][0]) / ARCMIN, float(columns["analytic:lost"][0]) / ARCMIN


# shafts that slide --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("hands", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
@pytest.mark.parametrize("senses", [(1, 1), (1, -1)])
def test_a_train_of_two_meshes_turns_as_far_as_a_linear_programme(
    hands: tuple[int, int], senses: tuple[int, int], tmp_path: Path
) -> None:
    gears, sizes = two_stages(hands, senses), {"one": 70.0, "two": 110.0, "three": 50.0}
    model = chain(gears, TWO, plays(**sizes), tmp_path)
    axial = {shaft: (-size / 2000, size / 2000) for shaft, size in sizes.items()}
    low, high = turn_between(arcs(model, gears), "one", "three", axial)
    least, most = turn_between(arcs(model, gears), "one", "three", {})
    by_method = lost(model)
    assert by_method == pytest.approx((high - low, high - low), abs=SOLVED)
    assert high - low > most - least + 5e-4  # the plays turn the output by minutes


def random_chain(rng: np.random.Generator) -> tuple[dict[str, Helical], dict[str, tuple[str, str]]]:
    """Up to four meshes in series, idlers among them, with a branch that carries nothing; some stages are spur."""
    gears: dict[str, Helical] = {}
    meshes: dict[str, tuple[str, str]] = {}
    driver, count = "", int(rng.integers(1, 5))
    for k in range(count + 1):
        idles = bool(meshes) and k < count and rng.random() < 0.3
        if not idles:
            driver = f"d{k}"
            helix = math.radians(rng.uniform(8.0, 30.0)) if rng.random() < 0.8 else 0.0
            hand, sense = rng.choice([1, -1], 2).tolist()
            module = float(rng.choice([1.0, 1.5, 2.0]))
            on = f"s{k if k < count else int(rng.integers(0, count + 1))}"  # the last one drives a branch
            gears[driver] = Helical(on, int(rng.integers(20, 40)), module, helix, hand, sense)
        own, driven = gears[driver], f"w{k}"
        gears[driven] = replace(
            own, shaft=f"s{k + 1}", teeth=int(rng.integers(22, 70)), hand=-own.hand, sense=int(rng.choice([1, -1]))
        )
        meshes[f"m{k}"] = (driver, driven)
        driver = driven
    return gears, meshes


@pytest.mark.slow
def test_random_trains_held_and_read_anywhere_turn_as_far_as_linear_programmes(tmp_path: Path) -> None:
    """Two hundred trains, by the analytic method; faces lie side by side, for nothing leans."""
    rng, tried = np.random.default_rng(11), 0
    while tried < 200:
        gears, meshes = random_chain(rng)
        shafts = list(dict.fromkeys(gear.shaft for gear in gears.values()))
        sizes = {shaft: float(rng.uniform(20.0, 120.0)) for shaft in shafts if rng.random() < 0.7}
        held, read = rng.choice(shafts, 2, replace=False).tolist()
        thin = "\n".join(
            f"  thin {name}: {{kind: tooth_thickness, of: {name}, distribution: {{kind: constant, value: -50 um}}}}"
            for name in gears
        )
        text = "\n".join([plays(**sizes).rpartition("\n")[0], thin])
        apart = {name: f"{rng.uniform(0.0, 360.0):.3f}" for name in meshes}
        lines = scene_lines(gears, meshes, text, azimuths=apart)
        lines = [line.replace("output:", f"held: {held}, output:") for line in lines]
        lines = [line.replace("of: train, over", f"of: train, shaft: {read}, over") for line in lines]
        (path := tmp_path / "random.yaml").write_text("\n".join(line for line in lines if line))
        try:
            model = model_of_scene(path)
        except SceneError:
            continue  # teeth that are pointed or undercut
        tried += 1
        own = [replace(mesh, play=mesh.play) for mesh in arcs(model, gears, 0.0)]
        own = [replace(m, play=m.play + sum(0.05 / math.cos(g.helix) for g in (m.driver, m.driven))) for m in own]
        axial = {shaft: (0.0, size / 1000) for shaft, size in sizes.items()}
        low, high = turn_between(own, held, read, axial)
        columns = gear_columns(model, None, drawn_trials(model, 1, 0, 1))
        assert columns["analytic:lost"][0] / ARCMIN == pytest.approx(high - low, rel=1e-7, abs=SOLVED), path.read_text()


@pytest.mark.parametrize(
    ("shaft", "by_hand"),
    [
        ("one", math.tan(math.radians(23.0)) / (1.5 * 46 / math.cos(math.radians(23.0)) / 2) * 19 / 53),
        ("three", math.tan(math.radians(14.0)) / (2.0 * 53 / math.cos(math.radians(14.0)) / 2)),
    ],
)
def test_an_end_shaft_turns_its_mate_by_tan_beta_over_r(shaft: str, by_hand: float, tmp_path: Path) -> None:
    still, sliding = (
        lost(chain(two_stages((1, 1)), TWO, plays(**own), tmp_path)) for own in ({shaft: 0.0}, {shaft: 80.0})
    )
    assert np.subtract(sliding, still) == pytest.approx([0.08 * by_hand] * 2, abs=1e-12)


@pytest.mark.parametrize(("hand", "sense"), [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_gears_on_one_shaft_add_or_cancel_their_thrust_by_their_hands(hand: int, sense: int, tmp_path: Path) -> None:
    """B is left on a shaft that C shares; a gear that looks backward keeps its hand."""
    gears = two_stages((1, hand), (1, sense))
    still, sliding = (lost(chain(gears, TWO, plays(two=size), tmp_path)) for size in (0.0, 80.0))
    kappa = {name: gear.hand * math.tan(gear.helix) / gear.radius for name, gear in gears.items()}
    turned = 0.08 * abs(kappa["B"] - kappa["C"]) * 19 / 53
    assert np.subtract(sliding, still) == pytest.approx([turned] * 2, abs=1e-12)


def test_equal_leads_and_hands_on_one_shaft_leave_no_thrust(tmp_path: Path) -> None:
    """sin(beta)/(m z) of both equal."""
    gears = two_stages((1, -1))
    beta = math.asin(math.sin(gears["B"].helix) * 2.0 * 19 / (1.5 * 46))
    gears |= {name: replace(gears[name], helix=beta) for name in ("C", "D")}
    assert gears["B"].lead == pytest.approx(gears["C"].lead)
    model = chain(gears, TWO, plays(two=80.0), tmp_path)
    assert lost(model) == pytest.approx(lost(chain(gears, TWO, plays(two=0.0), tmp_path)), abs=1e-15)
    assert [line for line in model.warnings if "two play" in line and "acts on nothing" in line]


def test_an_idler_slides_and_turns_nothing(tmp_path: Path) -> None:
    beta = math.radians(20.0)
    gears = {
        "A": Helical("one", 21, 1.5, beta, 1),
        "B": Helical("two", 33, 1.5, beta, -1),
        "F": Helical("three", 40, 1.5, beta, 1),
    }
    meshes = {"first": ("A", "B"), "second": ("B", "F")}
    sizes = {"one": 40.0, "two": 110.0, "three": 60.0}
    model = chain(gears, meshes, plays(**sizes), tmp_path)
    axial = {shaft: (0.0, size / 1000) for shaft, size in sizes.items()}
    low, high = turn_between(arcs(model, gears), "one", "three", axial)
    assert lost(model) == pytest.approx((high - low,) * 2, abs=SOLVED)
    assert "two" not in measure_of(model, "lost").kind.sliding
    assert measure_of(model, "lost").kind.sliding == {"one", "three"}


def test_held_elsewhere_and_read_in_the_middle_each_end_has_one_twist(tmp_path: Path) -> None:
    sizes = {"one": 70.0, "two": 110.0, "three": 50.0}
    middle = "  middle: {kind: lost_motion, of: train, shaft: two, over: {at: 0 deg}}"
    gears = two_stages((1, 1))
    model = chain(gears, TWO, plays(**sizes), tmp_path, middle)
    axial = {shaft: (0.0, size / 1000) for shaft, size in sizes.items()}
    low, high = turn_between(arcs(model, gears), "one", "two", axial)
    columns = gear_columns(model, exact_engine(model), drawn_trials(model, 1, 0, 1))
    for method in ("geometric", "analytic"):
        assert columns[f"{method}:middle"][0] / ARCMIN == pytest.approx(high - low, abs=SOLVED)


# with all that deviates ---------------------------------------------------------------------------------------------

DEVIATING = """\
  thin: {kind: tooth_thickness, of: A, distribution: {kind: normal, lower: -40 um, upper: -20 um}}
  A off: {kind: eccentricity, of: A, distribution: {kind: rayleigh, scale: 5 um}}
  B off: {kind: eccentricity, of: B, distribution: {kind: rayleigh, scale: 6 um}}
  D off: {kind: eccentricity, of: D, distribution: {kind: rayleigh, scale: 7 um}}
  lean: {kind: axis_out_of_plane, of: second, distribution: {kind: normal, lower: -0.2 mrad, upper: 0.2 mrad}}
"""
SHIFTS = "\n".join(
    f"  {shaft} shift: {{kind: axial_shift, of: {shaft}, distribution: {{kind: constant, value: 0 um}}}}"
    for shaft in ("one", "two", "three")
)
DRAWN_PLAYS = "\n".join(
    f"  {shaft} play: {{kind: axial_play, of: {shaft}, distribution: {{kind: uniform, lower: 20 um, upper: 120 um}}}}"
    for shaft in ("one", "two", "three")
)


def seated_turn(model: Model, trials: Trials, side: int) -> np.ndarray:
    """Rest of the output on one side [rad], counted from the middle: rests of both meshes, the shafts as shifted.

    Right flanks of A push B counter-clockwise, whose mate C then pushes with its left ones.
    """
    engine = ExactEngine(model)
    made, total = engine.build(trials.deviations), np.zeros(len(trials))
    for mesh, rate, flank in zip(model.meshes, (-19 / 53, 1.0), (side, -side), strict=True):
        reading = Reading(flank="drive" if flank == mesh.working_flank else "back")
        found = engine.read(made, mesh, reading, trials.positions[mesh.name])
        turned = found.driven_angle - mesh.pair.driven_angle(trials.positions[mesh.name])
        total += rate * turned
    return total


def test_of_built_gears_the_lost_motion_is_the_longest_way_between_the_ends_of_all_plays(tmp_path: Path) -> None:
    """Every combination of ends of three shafts is built and seated on both sides; both methods find the longest way.

    C faces forward, so that the turn of B is that of C. The methods take the play of teeth in the middle of the axial
    plays: a lean and 0.1 mm of play change it by 0.02 um.
    """
    gears = two_stages((1, 1), (1, 1))
    model = chain(gears, TWO, "\n".join([DEVIATING, SHIFTS, DRAWN_PLAYS]), tmp_path)
    trials = drawn_trials(model, 1, 0, 40)
    columns = gear_columns(model, exact_engine(model), trials)
    turns = {mesh.name: model.layout.mesh_turn[mesh.name] for mesh in model.meshes}
    positions = {name: np.full(40, turning.at(math.radians(20.0))) for name, turning in turns.items()}
    slices = model.component_slices
    ends: dict[int, list[np.ndarray]] = {1: [], -1: []}
    for signs in np.stack(np.meshgrid(*3 * [[-0.5, 0.5]]), axis=-1).reshape(-1, 3):
        deviations = trials.deviations.copy()
        for shaft, sign in zip(("one", "two", "three"), signs, strict=True):
            deviations[:, slices[f"{shaft} shift"]] = sign * deviations[:, slices[f"{shaft} play"]]
        for side, rests in ends.items():
            rests.append(seated_turn(model, Trials(deviations, positions), side))
    right, left = np.array(ends[1]), np.array(ends[-1])
    longest = np.maximum((right[:, None] - left).max(axis=(0, 1)), (left[:, None] - right).max(axis=(0, 1)))
    assert columns["geometric:lost"] / ARCMIN == pytest.approx(longest, abs=1e-6)  # rad; 0.05 um at 53 mm
    assert columns["analytic:lost"] / ARCMIN == pytest.approx(longest, abs=3e-6)  # squares of deviations too


# measures -----------------------------------------------------------------------------------------------------------

PAIR = """\
  free: {kind: angular_backlash, of: second, over: {at: 10 deg}}
  free driver: {kind: angular_backlash, of: second, gear: C, over: {at: 10 deg}}
  arc: {kind: circumferential_backlash, of: second, over: {at: 10 deg}}
  normal: {kind: normal_backlash, of: second, over: {at: 10 deg}}
"""


def test_an_angular_backlash_grows_by_the_plays_of_both_shafts_and_what_is_of_teeth_stays(tmp_path: Path) -> None:
    gears = two_stages((1, 1))
    columns = []
    for sizes in ({"two": 0.0, "three": 0.0}, {"two": 110.0, "three": 50.0}):
        model = chain(gears, TWO, plays(**sizes), tmp_path, PAIR)
        columns.append(gear_columns(model, exact_engine(model), drawn_trials(model, 1, 0, 1)))
    for method in ("geometric", "analytic"):
        by = {
            name: float(columns[1][f"{method}:{name}"][0] - columns[0][f"{method}:{name}"][0])
            for name in ("free", "free driver", "arc", "normal")
        }
        assert by["normal"] == by["arc"] == 0.0
        for name, gear in (("free", gears["D"]), ("free driver", gears["C"])):
            assert by[name] / ARCMIN == pytest.approx(0.160 * math.tan(gear.helix) / gear.radius, abs=1e-12)


def test_worked_numbers_of_one_mesh_are_c_sin_beta_b_along_the_normals_and_c_tan_beta_as_an_arc(tmp_path: Path) -> None:
    """23 right with 67 left, m_n 1, 30 deg: 0.1 mm turn the wheel by 1.4925 mrad, 46.985 um along the normals."""
    gears = {"A": Helical("one", 23, 1.0, math.radians(30.0), 1), "B": Helical("two", 67, 1.0, math.radians(30.0), -1)}
    still, sliding = (lost(chain(gears, {"first": ("A", "B")}, plays(two=size), tmp_path)) for size in (0.0, 100.0))
    model = chain(gears, {"first": ("A", "B")}, plays(two=100.0), tmp_path)
    turned = np.subtract(sliding, still)
    assert turned == pytest.approx([1.492537e-3] * 2, abs=1e-9)
    sin_b = math.sin(math.radians(30.0)) * math.cos(math.radians(20.0))  # of the base helix
    assert turned * model.meshes[0].pair.wheel.section_arm == pytest.approx([0.1 * sin_b] * 2, abs=1e-12)
    assert turned * gears["B"].radius == pytest.approx([0.1 * math.tan(math.radians(30.0))] * 2, abs=1e-12)


def test_closed_form_shares_and_slopes_know_axial_play(tmp_path: Path) -> None:
    gears = two_stages((1, -1))
    free = "  free: {kind: angular_backlash, of: second}"
    model = chain(gears, TWO, "\n".join([DEVIATING.replace("_out_of_plane", "_in_plane"), DRAWN_PLAYS]), tmp_path, free)
    kappa = {name: gear.hand * math.tan(gear.helix) / gear.radius for name, gear in gears.items()}
    per = {
        "one play": abs(kappa["A"]) * 21 / 46 * 19 / 53,
        "two play": abs(kappa["B"] - kappa["C"]) * 19 / 53,
        "three play": abs(kappa["D"]),
    }
    form = form_of(model, "lost")
    known = {share.name: share for share in form.shares}
    for name, slope in per.items():
        assert known[name].coefficient == pytest.approx(slope, rel=1e-12)
        assert known[name].mean == pytest.approx(slope * 0.07, rel=1e-12)
        assert known[name].variance == pytest.approx(slope**2 * 0.1**2 / 12, rel=1e-12)
    trials = drawn_trials(model, 1, 0, 3)
    for measure, wanted in (
        ("lost", per),
        ("free", {"one play": 0.0, "two play": abs(kappa["D"]), "three play": abs(kappa["D"])}),
    ):
        rates = sensitivities(model, ExactEngine(model), trials, measure_of(model, measure))
        for name, slope in wanted.items():
            assert rates[:, model.component_slices[name]] == pytest.approx(slope, rel=1e-12, abs=1e-15)
    free_form = {share.name: share.coefficient for share in form_of(model, "free").shares}
    assert "one play" not in free_form
    assert free_form["two play"] == pytest.approx(abs(kappa["D"]))


def test_stages_of_a_breakdown_contain_the_shafts_that_they_drive(tmp_path: Path) -> None:
    """The held shaft is the first stage's; stages times their factors are the lost motion."""
    gears = two_stages((1, 1))
    kappa = {name: gear.hand * math.tan(gear.helix) / gear.radius for name, gear in gears.items()}
    stages = []
    for sizes in ({"one": 0.0, "two": 0.0, "three": 0.0}, {"one": 70.0, "two": 110.0, "three": 50.0}):
        model = chain(gears, TWO, plays(**sizes), tmp_path)
        measure = measure_of(model, "lost")
        model = replace(model, measures=(replace(measure, positions=replace(measure.positions, over="random")),))
        columns = gear_columns(model, exact_engine(model), drawn_trials(model, 1, 0, 1))
        own = [float(columns[f"geometric:lost:{name} [arcmin]"][0]) / ARCMIN for name in ("first", "second")]
        assert float(columns["geometric:lost"][0]) / ARCMIN == pytest.approx(own[0] * 19 / 53 + own[1], rel=1e-12)
        stages.append(own)
    wanted = 0.070 * abs(kappa["A"]) * 21 / 46 + 0.110 * abs(kappa["B"] - kappa["C"]), 0.050 * abs(kappa["D"])
    assert np.subtract(stages[1], stages[0]) == pytest.approx(wanted, abs=2e-9)


def test_a_tip_moves_by_what_the_shafts_slide_over_a_swing_too(tmp_path: Path) -> None:
    """At 200 mm from the axis; the error of a swing is 0 where the load is on its first side."""
    gears = {"A": Helical("one", 21, 1.5, math.radians(23.0), 1), "B": Helical("two", 46, 1.5, math.radians(23.0), -1)}
    path, found = tmp_path / "chain.yaml", []
    for size in (0.0, 80.0):
        chain(gears, {"first": ("A", "B")}, plays(two=size), tmp_path)
        text = path.read_text().replace(
            "tolerances:", "  arm: {kind: arm, shaft: two, points: {tip: [0 mm, 200 mm, 0 mm]}}\ntolerances:"
        )
        text = text.replace("output: two}", "output: two, gravity: [0, -1, 0]}")
        tip = "of: train, arm: arm, point: tip"
        swing = f"error: {{kind: tip_error, {tip}, start: -40 deg, end: 40 deg, positions: 5}}"
        path.write_text(text.replace("study:", f"  tip: {{kind: tip_displacement, {tip}}}\n  {swing}\nstudy:"))
        model = model_of_scene(path)
        trials = drawn_trials(model, 1, 0, 1)
        answers = GeometricMethod(model, exact_engine(model)).answers(trials, model.measures)
        found.append(answers.values)
    turned = 0.08 * math.tan(gears["B"].helix) / gears["B"].radius
    assert found[1]["tip"][0, 0] - found[0]["tip"][0, 0] == pytest.approx(200 * turned, rel=1e-5)  # the chord's
    jumps = found[1]["error"][0] - found[0]["error"][0]
    assert sorted(set(np.round(jumps / (200 * turned), 4))) == [0.0, 1.0]


def test_a_reducer_takes_no_thrust(tmp_path: Path) -> None:
    """A shaft between a mesh and a bought reducer slides as an end shaft does."""
    gears = {"A": Helical("one", 21, 1.5, math.radians(23.0), 1), "B": Helical("two", 46, 1.5, math.radians(23.0), -1)}
    path = tmp_path / "reducer.yaml"
    chain(gears, {"first": ("A", "B")}, plays(two=80.0), tmp_path)
    text = (tmp_path / "chain.yaml").read_text()
    text = text.replace("  two: {kind: shaft", "  three: {kind: shaft}\n  two: {kind: shaft")
    text = text.replace(
        "  train: {kind: train, driven: one, output: two}",
        "  bought: {kind: reducer, driver: two, driven: three, ratio: -50}\n"
        "  train: {kind: train, driven: one, output: three}",
    )
    path.write_text(text)
    found = lost(model_of_scene(path))
    path.write_text(text.replace("value: 80.0 um", "value: 0.0 um"))
    still = lost(model_of_scene(path))
    wanted = 0.08 * math.tan(gears["B"].helix) / gears["B"].radius / 50
    assert np.subtract(found, still) == pytest.approx([wanted] * 2, abs=1e-12)


# what is refused, and what acts on nothing ----------------------------------------------------------------------------


def test_axial_play_of_spur_shafts_acts_on_nothing_and_check_says_so(tmp_path: Path) -> None:
    gears = {name: replace(gear, helix=0.0) for name, gear in two_stages((1, 1)).items()}
    model = chain(gears, TWO, plays(two=80.0), tmp_path)
    (warning,) = (line for line in model.warnings if "two play" in line)
    assert "tolerances.two play: acts on nothing: no gear on 'two' is helical" in warning
    assert lost(model) == lost(chain(gears, TWO, plays(two=0.0), tmp_path))
    assert not measure_of(model, "lost").kind.sliding


def test_axial_play_that_nothing_measures_is_told(tmp_path: Path) -> None:
    model = chain(two_stages((1, 1)), TWO, plays(two=80.0), tmp_path)
    path = tmp_path / "chain.yaml"
    path.write_text(
        path.read_text().replace("lost: {kind: lost_motion, of: train", "n: {kind: normal_backlash, of: first")
    )
    warnings = model_of_scene(path).warnings
    assert [line for line in warnings if "two play: acts on nothing: no angular backlash, lost motion" in line]
    assert not [line for line in model.warnings if "two play" in line]


def test_a_second_axial_play_of_a_shaft_is_refused(tmp_path: Path) -> None:
    chain(two_stages((1, 1)), TWO, plays(two=80.0), tmp_path)
    path = tmp_path / "chain.yaml"
    text = path.read_text().replace("tolerances:", "  left: {kind: bearing, shaft: two}\ntolerances:")
    path.write_text(text.replace("of: two,", "of: left,"))
    assert measure_of(model_of_scene(path), "lost").kind.sliding == {"two"}
    second = "  again: {kind: axial_play, of: left, distribution: {kind: constant, value: 10 um}}\nmoves:"
    path.write_text(text.replace("moves:", second))
    with pytest.raises(SceneError, match="expected one axial play of 'two', got another draw of it beside 'two play'"):
        model_of_scene(path)


@pytest.mark.parametrize(
    ("of", "words"),
    [
        ("nowhere", "a shaft, of a gear that none carries, of a planet or of a bearing"),
        ("A", "which 'one' carries"),
        ("first", "a shaft, of a gear that none carries, of a planet or of a bearing"),
        ("bare", "expected a shaft with a gear on it, or a bearing of one, got 'bare'"),
    ],
)
def test_axial_play_is_of_shafts(of: str, words: str, tmp_path: Path) -> None:
    chain(two_stages((1, 1)), TWO, plays(two=80.0), tmp_path)
    path = tmp_path / "chain.yaml"
    text = path.read_text().replace("tolerances:", "  bare: {kind: shaft}\ntolerances:")
    path.write_text(text.replace("kind: axial_play, of: two", f"kind: axial_play, of: {of}"))
    with pytest.raises(SceneError, match=re.escape(words)):
        model_of_scene(path)


def test_a_gear_without_a_shaft_slides_as_its_own(tmp_path: Path) -> None:
    text = """\
scene: pair
parts:
  a: {kind: helical_gear, teeth: 24, module: 2 mm, helix_angle: 15 deg, hand: right, face_width: 20 mm}
  b: {kind: helical_gear, teeth: 47, module: 2 mm, helix_angle: 15 deg, hand: left, face_width: 20 mm}
  bearing: {kind: bearing, shaft: a}
tolerances:
  play: {kind: axial_play, of: bearing, distribution: {kind: constant, value: 50 um}}
  other: {kind: axial_play, of: b, distribution: {kind: constant, value: 30 um}}
moves:
  m: {kind: mesh, driver: a, driven: b, centre_distance: 73.6 mm}
measures:
  lost: {kind: angular_backlash, of: m, over: {at: 0 deg}}
study: {trials: 10, seed: 1}
"""
    (path := tmp_path / "pair.yaml").write_text(text)
    sliding = lost(model_of_scene(path))
    path.write_text(text.replace("50 um", "0 um").replace("30 um", "0 um"))
    still = lost(model_of_scene(path))
    beta = math.radians(15.0)
    wanted = 0.08 * math.tan(beta) / (47 / math.cos(beta))
    assert np.subtract(sliding, still) == pytest.approx([wanted] * 2, abs=1e-12)


def test_axial_play_of_bevel_gears_is_refused(tmp_path: Path) -> None:
    text = """\
scene: bevel
parts:
  a: {kind: bevel_gear, teeth: 20, module: 2 mm, face_width: 8 mm}
  b: {kind: bevel_gear, teeth: 30, module: 2 mm, face_width: 8 mm}
tolerances:
  play: {kind: axial_play, of: a, distribution: {kind: constant, value: 10 um}}
moves:
  m: {kind: bevel_mesh, driver: a, driven: b}
measures:
  n: {kind: normal_backlash, of: m}
study: {trials: 10, seed: 1}
"""
    (path := tmp_path / "bevel.yaml").write_text(text)
    with pytest.raises(SceneError, match=r"tolerances\.play\.of: expected a shaft without bevel gears"):
        model_of_scene(path)


# one clearance of a bearing, across its axis and along it -------------------------------------------------------------


def longest_way(fits: Callable[[float], bool], most: float) -> float:
    """Largest shift from the middle that still fits [mm], by halving."""
    low, high = 0.0, most
    for _ in range(60):
        low, high = ((low + high) / 2, high) if fits((low + high) / 2) else (low, (low + high) / 2)
    return low


def test_balls_in_deep_grooves_touch_where_two_circles_hold_one() -> None:
    """A ball fits where its centre lies within both grooves' circles less its radius: tried at 2000 places."""
    ball, inner, outer, radial = 7.938, 0.515 * 7.938, 0.53 * 7.938, 0.014
    across = inner + outer - ball - radial / 2  # of the centres of curvature, the rings centred

    def fits(shift: float) -> bool:
        """The ball's centre between the grooves' centres, at the best share of the way."""
        way = math.hypot(across, shift)
        shares = np.linspace(0.0, 1.0, 20001)
        return bool(np.any((shares * way <= inner - ball / 2) & ((1 - shares) * way <= outer - ball / 2)))

    axial = 2 * longest_way(fits, 1.0)
    grooves = DeepGroove((0.515 + 0.53 - 1.0) * ball)
    found = float(grooves.axial(np.array([radial]))[0])
    assert found == pytest.approx(axial, rel=5e-3)  # the best share is met within 1/20000 of 0.36 mm, of slack 7 um
    assert found == pytest.approx(2 * math.sqrt(0.35721**2 - 0.35021**2), abs=1e-6)
    back = np.array([-0.01, 0.0, 0.004, 0.05])
    assert grooves.measured(grooves.deviation(back)) == pytest.approx(back, abs=1e-15)
    step = 1e-7
    slope = (grooves.axial(np.array([radial + step])) - grooves.axial(np.array([radial - step]))) / (2 * step)
    assert grooves.slope(np.array([radial])) == pytest.approx(slope, rel=1e-6)
    assert grooves.slope(np.array([-0.01])) == grooves.axial(np.array([-0.01])) == 0.0


def test_oblique_rows_touch_where_their_gap_is_closed() -> None:
    """Two rows facing each other: every one of four contacts keeps r cos(alpha) + a sin(alpha) below the gap."""
    alpha, gap = math.radians(15.0), 0.003

    def fits(across: float, along: float) -> bool:
        signs = product((1.0, -1.0), repeat=2)
        return all(s * across * math.cos(alpha) + t * along * math.sin(alpha) <= gap for s, t in signs)

    radial, axial = 2 * longest_way(lambda r: fits(r, 0.0), 1.0), 2 * longest_way(lambda a: fits(0.0, a), 1.0)
    bearing = ObliqueContact(alpha)
    assert bearing.axial(np.array([radial])) == pytest.approx([axial], rel=1e-12)
    assert bearing.deviation(np.array([axial])) == pytest.approx([radial], rel=1e-12)
    assert bearing.slope(np.array([radial])) == pytest.approx([axial / radial], rel=1e-12)


TAPER, GROOVES = "contact_angle: 15 deg", "grooves: {ball: 7.938 mm, radii: 1.045}"
AXIAL_OF = {TAPER: 0.014 / math.tan(math.radians(15.0)), GROOVES: 2 * math.sqrt(0.35721**2 - 0.35021**2)}


def per_axial(gears: Mapping[str, Helical]) -> float:
    """Turn of the output [rad] per mm of play of the middle shaft."""
    left, right = (gears[name].hand * math.tan(gears[name].helix) / gears[name].radius for name in ("B", "C"))
    return abs(left - right) * 19 / 53


def with_bearing(raceways: str, clearance: str, folder: Path, beside: str = "") -> Model:
    """A chain whose middle shaft lies in a bearing, and in another one that holds it still."""
    path = folder / "chain.yaml"
    chain(two_stages((1, -1)), TWO, plays(), folder)
    at = ", ".join(own for own in ("kind: bearing", "shaft: two", "at: -20 mm", raceways) if own)
    bearings = (
        f"  fixed: {{{at}}}\n  loose: {{kind: bearing, shaft: two, at: 50 mm}}\ntolerances:\n{clearance}\n{beside}"
    )
    path.write_text(path.read_text().replace("tolerances:", bearings))
    return model_of_scene(path)


def sliding(of: str, play: str) -> str:
    return f"  along: {{kind: axial_play, of: {of}, distribution: {{kind: constant, value: {play}}}}}"


def clearance(direction: str, law: str, measured: str = "radial") -> str:
    words = f"measured: {measured}, distribution: {{kind: {law}}}"
    mesh = "mesh: first, " if direction == "apart" else ""
    return f"  play: {{kind: bearing_clearance, of: fixed, direction: {direction}, {mesh}{words}}}"


@pytest.mark.parametrize("raceways", [TAPER, GROOVES])
@pytest.mark.parametrize("direction", ["apart", "{at: 70 deg}"])
def test_one_clearance_of_a_bearing_is_radial_and_axial_at_once(raceways: str, direction: str, tmp_path: Path) -> None:
    """As a radial clearance and an axial play that are typed apart, of that size."""
    one = with_bearing(raceways, clearance(direction, "constant, value: 14 um"), tmp_path)
    play = sliding("fixed", f"{AXIAL_OF[raceways]!r} mm")
    two = with_bearing("", clearance(direction, "constant, value: 14 um"), tmp_path, play)
    axial = f"constant, value: {AXIAL_OF[raceways]!r} mm"
    measured = with_bearing(raceways, clearance(direction, axial, "axial"), tmp_path)
    radial = with_bearing("", clearance(direction, "constant, value: 14 um"), tmp_path)
    assert lost(one) == pytest.approx(lost(two), abs=1e-9)
    assert lost(measured) == pytest.approx(lost(one), abs=1e-9)
    turned = AXIAL_OF[raceways] * per_axial(two_stages((1, -1)))
    assert np.subtract(lost(one), lost(radial)) == pytest.approx([turned] * 2, abs=1e-9)


@pytest.mark.parametrize("raceways", [TAPER, GROOVES])
def test_of_a_random_direction_the_length_of_a_clearance_lets_the_shaft_slide(raceways: str, tmp_path: Path) -> None:
    law = "uniform, lower: 4 um, upper: 20 um"
    model = with_bearing(raceways, clearance("random", law), tmp_path)
    plain = with_bearing("", clearance("random", law), tmp_path)
    trials, same = (drawn_trials(own, 1, 0, 20) for own in (model, plain))
    assert np.array_equal(trials.deviations, same.deviations)
    ours, theirs = (gear_columns(own, exact_engine(own), trials) for own in (model, plain))
    per, columns = per_axial(two_stages((1, -1))), model.component_slices["play"]

    def turned(deviations: np.ndarray) -> np.ndarray:
        length = np.hypot(*deviations.T)
        if raceways == TAPER:
            return np.asarray(per * length / math.tan(math.radians(15.0)))
        return np.asarray(per * np.sqrt(length * (4 * 0.35721 - length)))

    own = trials.deviations[:, columns]
    for method in ("geometric:lost", "analytic:lost"):
        assert (ours[method] - theirs[method]) / ARCMIN == pytest.approx(turned(own), abs=1e-12)
    assert closed_form(model, measure_of(model, "lost")) is None
    rates, still = (
        sensitivities(each, ExactEngine(each), trials, measure_of(each, "lost"))[:, columns] for each in (model, plain)
    )
    for k, step in enumerate(1e-7 * np.eye(2)):
        slope = (turned(own + step) - turned(own - step)) / 2e-7
        assert (rates - still)[:, k] == pytest.approx(slope, rel=1e-5, abs=1e-9)


def test_the_closed_form_of_a_taper_bearing_has_its_shift_its_lean_and_its_slide(tmp_path: Path) -> None:
    """Its moments are those of many trials by the analytic method."""
    law, count = "normal, lower: 4 um, upper: 20 um", 20_000
    model = with_bearing(TAPER, clearance("apart", law), tmp_path)
    form, trials = form_of(model, "lost"), drawn_trials(model, 7, 0, count)
    values = gear_columns(model, None, trials)["analytic:lost"] / ARCMIN
    assert "play" in form.leaning
    assert values.mean() == pytest.approx(form.mean, abs=5 * form.sigma / math.sqrt(count))
    assert values.std() == pytest.approx(form.sigma, rel=5 / math.sqrt(2 * count))
    plain = form_of(with_bearing("", clearance("apart", law), tmp_path), "lost")
    assert form.mean - plain.mean > 20 * form.sigma / math.sqrt(count)


@pytest.mark.parametrize(
    ("raceways", "measured", "beside", "words"),
    [
        (TAPER, "radial", "two", "a clearance of a bearing with contact_angle or grooves is radial and axial at once"),
        (GROOVES, "axial", "fixed", "expected one axial play of 'two', got another draw of it beside 'play'"),
        ("", "axial", "", "tolerances.play.measured: expected radial, or a bearing with contact_angle or grooves"),
        (f"{TAPER}, {GROOVES}", "radial", "", "expected contact_angle or grooves, got both"),
        ("contact_angle: 90 deg", "radial", "", "expected an angle between 0 and 90 deg"),
    ],
)
def test_a_second_draw_of_one_clearance_is_refused(
    raceways: str, measured: str, beside: str, words: str, tmp_path: Path
) -> None:
    play = (
        f"  along: {{kind: axial_play, of: {beside}, distribution: {{kind: constant, value: 9 um}}}}" if beside else ""
    )
    with pytest.raises(SceneError, match=re.escape(words)):
        with_bearing(raceways, clearance("apart", "constant, value: 14 um", measured), tmp_path, play)


def test_the_numbers_of_the_guide_are_those_of_its_scene(tmp_path: Path) -> None:
    """0.1 mm at the output 1'54", twists on the lay shaft -0.0149 and -0.0108, 14 um across 141 um along."""
    _, text = quoted("trains")
    (path := tmp_path / "guide.yaml").write_text(text)
    model = model_of_scene(path)
    assert not [line for line in model.warnings if "acts on nothing" in line]
    twists = [next(part.gear for part in model.gears if part.name == name).twist for name in ("wheel", "second pinion")]
    assert [round(twist, 4) for twist in twists] == [-0.0149, -0.0108]
    stages = {stage.link: stage for stage in of_kind(LostMotion, measure_of(model, "lost motion").kind).stages}
    slides = {slide.shaft: slide for stage in stages.values() for slide in of_kind(Stage, stage).slides}
    assert slides["lay shaft"].factor == pytest.approx(0.0041, abs=5e-5)
    assert round(math.degrees(0.1 * slides["output"].factor) * 3600) == 114
    assert round(1000 * float(DeepGroove(0.357).axial(np.array([0.014]))[0])) == 141
    assert set(slides) == {"input", "lay shaft", "output"}


# parallel load paths ------------------------------------------------------------------------------------------------


def herringbone(shift: str, folder: Path, other: int = 1) -> tuple[Model, dict[str, Helical]]:
    """Two meshes of opposite hands between two shafts, the second looser; one shaft lies elsewhere along its axis."""
    beta = math.radians(25.0)
    gears = {
        "A": Helical("one", 24, 2.0, beta, 1),
        "B": Helical("two", 47, 2.0, beta, -1),
        "E": Helical("one", 24, 2.0, beta, -other),
        "F": Helical("two", 47, 2.0, beta, other),
    }
    meshes = {"upper": ("A", "B"), "lower": ("E", "F")}
    model = chain(gears, meshes, f"{shift}\n{plays()}", folder)
    return model, gears


def test_load_paths_of_a_herringbone_shift_against_each_other_as_a_shaft_does(tmp_path: Path) -> None:
    """At a fixed place along its axis: the linear programme with that shift, by both methods."""
    shift = "  shift: {kind: axial_shift, of: two, distribution: {kind: constant, value: 40 um}}"
    for of, um in (("two", 40.0), ("two", -30.0), ("one", 40.0)):
        text = shift.replace("of: two", f"of: {of}").replace("40 um", f"{um} um")
        model, gears = herringbone(text, tmp_path)
        low, high = turn_between(arcs(model, gears), "one", "two", {of: (um / 1000, um / 1000)})
        assert lost(model) == pytest.approx((high - low,) * 2, abs=SOLVED)
    still = lost(herringbone("", tmp_path)[0])
    assert lost(herringbone(shift, tmp_path)[0])[0] < still[0] - 1e-5


def test_one_gear_of_a_shaft_that_lies_elsewhere_closes_by_its_screw(tmp_path: Path) -> None:
    """A shim behind F alone shifts the play of its path by kappa of its thickness; of equal hands likewise."""
    for other in (1, -1):
        shim = "  shim: {kind: shim, of: F, distribution: {kind: constant, value: 30 um}}"
        model, gears = herringbone(shim, tmp_path, other)
        own = arcs(model, gears)
        separate = {**gears, "F": replace(gears["F"], shaft="F"), "B": gears["B"]}
        kappa = separate["F"].hand * math.tan(separate["F"].helix) / separate["F"].radius
        half = [mesh.play / 2 / mesh.driven.radius for mesh in own]
        middle = kappa * -0.030  # behind: it moves against its z
        wanted = min(half[0], half[1] + middle) - max(-half[0], -half[1] + middle)
        assert lost(model) == pytest.approx((wanted, wanted), abs=SAME_TURN)


@pytest.mark.parametrize("senses", [(1, 1), (1, -1), (-1, 1)])
def test_a_shaft_takes_gears_that_face_either_way_along(senses: tuple[int, int], tmp_path: Path) -> None:
    """The output turns by c (kappa_B - kappa_C) 19/53 of a shift c: both meshes' rests by hand, by both methods."""
    gears, shift = two_stages((1, 1), senses), 0.05
    text = f"  shift: {{kind: mounting_face, of: two, distribution: {{kind: constant, value: {shift} mm}}}}"
    model = chain(gears, TWO, f"{text}\n{plays()}", tmp_path)
    trials = drawn_trials(model, 1, 0, 1)
    rows = np.concatenate([trials.deviations, trials.deviations])
    rows[1, model.component_slices["shift"]] = 0.0
    for mesh, gear, role in ((model.meshes[0], gears["B"], 1), (model.meshes[1], gears["D"], -1)):
        carried = gear if role == 1 else gears["C"]
        wanted = role * gear.hand * math.tan(gear.helix) / gear.radius * shift * carried.sense
        found = ExactEngine(model).read(ExactEngine(model).build(rows), mesh, Reading(), np.full(2, 0.3))
        assert found.driven_angle[0] - found.driven_angle[1] == pytest.approx(wanted, abs=1e-12)
        stack = stack_of(model, mesh, Reading())
        aside = stack.aside(rows, np.full(2, 0.3)) / mesh.pair.wheel.section_arm
        assert aside[0] - aside[1] == pytest.approx(wanted, abs=1e-15)


def sliding_text(sizes: Mapping[str, float]) -> str:
    """Axial plays of shafts [mm]."""
    return "\n".join(sliding(shaft, f"{size} mm").replace("along", f"{shaft} along") for shaft, size in sizes.items())


def test_a_floating_herringbone_turns_by_the_mean_of_its_halves_and_a_blocked_one_by_their_intersection(
    tmp_path: Path,
) -> None:
    """Halves of 26.0 and 24.4 um on the lead; a small float lies between both."""
    for size in (0.0, 0.01, 1.0):
        model, gears = herringbone(sliding_text({"two": size} if size else {}), tmp_path)
        first, second = (mesh.play / mesh.driven.radius for mesh in arcs(model, gears))
        low, high = turn_between(arcs(model, gears), "one", "two", {"two": (-size / 2, size / 2)})
        assert lost(model) == pytest.approx((high - low,) * 2, abs=SOLVED)
        if size == 1.0:
            assert high - low == pytest.approx((first + second) / 2, abs=SOLVED)
        elif not size:
            assert high - low == pytest.approx(min(first, second), abs=SOLVED)
        else:
            assert min(first, second) + 1e-5 < high - low < (first + second) / 2 - 1e-5


@pytest.mark.parametrize("other", [1, -1])
@pytest.mark.parametrize("shift", [0.0, 0.03])
def test_halves_that_lie_apart_float_to_where_both_let_them_turn(other: int, shift: float, tmp_path: Path) -> None:
    """Both shafts slide, one of them lies elsewhere; equal hands leave the float what one mesh does of it."""
    sizes = {"one": 0.012, "two": 0.02}
    place = f"  shift: {{kind: axial_shift, of: one, distribution: {{kind: constant, value: {shift} mm}}}}"
    model, gears = herringbone(f"{place}\n{sliding_text(sizes)}", tmp_path, other)
    axial = {"one": (shift - 0.006, shift + 0.006), "two": (-0.01, 0.01)}
    low, high = turn_between(arcs(model, gears), "one", "two", axial)
    assert lost(model) == pytest.approx((high - low,) * 2, abs=SOLVED)


def split(
    sizes: Mapping[str, float], hands: tuple[int, int], folder: Path, extra: str = ""
) -> tuple[Model, dict[str, Helical]]:
    """A stage before and one behind a split: a sun drives two lay shafts, whose pinions drive a bull gear.

    The pinions look backward; left and right differ by the thickness of their teeth.
    """
    beta, gamma = math.radians(20.0), math.radians(12.0)
    gears = {
        "P": Helical("motor", 23, 1.5, beta, 1),
        "Q": Helical("sun", 41, 1.5, beta, -1),
        "S": Helical("sun", 20, 2.0, gamma, hands[0]),
        "U": Helical("left", 44, 2.0, gamma, -hands[0]),
        "V": Helical("right", 44, 2.0, gamma, -hands[0]),
        "X": Helical("left", 20, 2.0, gamma, hands[1], -1),
        "Y": Helical("right", 20, 2.0, gamma, hands[1], -1),
        "Z": Helical("bull", 44, 2.0, gamma, -hands[1]),
        "R": Helical("bull", 25, 1.5, beta, -1),
        "T": Helical("end", 36, 1.5, beta, 1),
    }
    meshes = {
        "first": ("P", "Q"), "left fast": ("S", "U"), "right fast": ("S", "V"), "left slow": ("X", "Z"),
        "right slow": ("Y", "Z"), "last": ("R", "T"),
    }  # fmt: skip
    turns = {"right fast": 180.0, "left fast": 0.0, "left slow": 180.0, "right slow": 180.0}
    thin = [
        f"  thin {name}: {{kind: tooth_thickness, of: {name}, distribution: {{kind: constant, value: {-by} um}}}}"
        for name, by in THINNER.items()
    ]
    lines = scene_lines(gears, meshes, "\n".join([sliding_text(sizes), *thin, extra]), azimuths=turns)
    (path := folder / "split.yaml").write_text("\n".join(line for line in lines if line))
    return model_from_scene(load(path)), gears  # such as bind at their means, too


THINNER = {"P": 20.0, "U": 30.0, "V": 45.0, "X": 40.0, "Y": 25.0, "T": 30.0}  # um, of the arcs


def split_arcs(model: Model, gears: Mapping[str, Helical]) -> list[Meshing]:
    """The meshes of a split train with the plays of their teeth."""
    of = {(gears[mesh.driver], gears[mesh.driven]): (mesh.driver, mesh.driven) for mesh in model.meshes}
    found = []
    for mesh in arcs(model, gears, 0.0):
        thinner = sum(THINNER.get(name, 0.0) for name in of[mesh.driver, mesh.driven]) / 1000
        found.append(replace(mesh, play=mesh.play + thinner / math.cos(mesh.driver.helix)))
    return found


SPLIT = {"motor": 0.02, "sun": 0.05, "left": 0.03, "right": 0.07, "bull": 0.04, "end": 0.06}


@pytest.mark.parametrize("hands", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
@pytest.mark.parametrize("sliding_shafts", [("left",), ("sun",), ("bull",), ("left", "right"), tuple(SPLIT)])
def test_a_split_train_turns_as_far_as_a_linear_programme(
    hands: tuple[int, int], sliding_shafts: tuple[str, ...], tmp_path: Path
) -> None:
    sizes = {shaft: SPLIT[shaft] for shaft in sliding_shafts}
    model, gears = split(sizes, hands, tmp_path)
    axial = {shaft: (-size / 2, size / 2) for shaft, size in sizes.items()}
    low, high = turn_between(split_arcs(model, gears), "motor", "end", axial)
    assert lost(model) == pytest.approx((high - low,) * 2, abs=5 * SOLVED)  # five meshes


@pytest.mark.slow
def test_split_trains_that_lie_apart_turn_or_bind_as_linear_programmes_do(tmp_path: Path) -> None:
    """Random plays, and a lay shaft up to 2 mm off its place: a third of the trains cannot be assembled."""
    rng, bound = np.random.default_rng(4), 0
    for _ in range(150):
        sizes = {shaft: float(rng.uniform(0.0, 0.15)) for shaft in SPLIT if rng.random() < 0.5}
        off, hands = float(rng.uniform(-2.0, 2.0)), tuple(rng.choice([1, -1], 2).tolist())
        place = f"  place: {{kind: mounting_face, of: right, distribution: {{kind: constant, value: {off} mm}}}}"
        model, gears = split(sizes, (hands[0], hands[1]), tmp_path, place)
        axial = {"right": (off, off)} | {shaft: (-size / 2, size / 2) for shaft, size in sizes.items()}
        if "right" in sizes:
            axial["right"] = (off - sizes["right"] / 2, off + sizes["right"] / 2)
        play = analytic_play(model, measure_of(model, "lost"), drawn_trials(model, 1, 0, 1))
        try:
            low, high = turn_between(split_arcs(model, gears), "motor", "end", axial)
        except AssertionError:
            bound += 1
            assert play.bound().all()
            continue
        assert not play.bound().any()
        assert play.free()[0, 0] == pytest.approx(high - low, abs=5 * SOLVED)
    assert 25 < bound < 90


def test_slopes_of_shafts_that_float_between_load_paths_are_differences(tmp_path: Path) -> None:
    sizes = {"one": 0.012, "two": 0.02}
    model, _ = herringbone(sliding_text(sizes), tmp_path)
    measure, trials = measure_of(model, "lost"), drawn_trials(model, 1, 0, 1)
    rates = sensitivities(model, ExactEngine(model), trials, measure)[0]
    assert closed_form(model, measure) is None
    step = 1e-5
    for name in ("one along", "two along", "thin"):
        column = model.component_slices[name]
        moved = np.repeat(trials.deviations, 2, axis=0)
        moved[:, column] += np.array([[step], [-step]])
        both = Trials(moved, {key: np.repeat(own, 2) for key, own in trials.positions.items()})
        above, below = analytic_play(model, measure, both).free()[:, 0]
        assert rates[column] == pytest.approx((above - below) / (2 * step), rel=1e-4, abs=1e-9)
    kappa = math.tan(math.radians(25.0)) / (47 / math.cos(math.radians(25.0)))
    assert rates[model.component_slices["one along"]] == pytest.approx(kappa)  # of the tighter half
    assert measure.kind.sliding == {"one", "two"}


def test_axial_play_where_load_paths_meet_in_a_network_is_refused(tmp_path: Path) -> None:
    """Read at a lay shaft, which the other one holds too."""
    split({}, (1, 1), tmp_path)
    path = tmp_path / "split.yaml"
    text = path.read_text().replace("output: end", "output: left")
    path.write_text(text.replace("tolerances:", f"tolerances:\n{sliding('left', '30 um')}"))
    with pytest.raises(SceneError, match=r"along\.of: expected a shaft in one load path, or in simple parallel ones"):
        model_of_scene(path)


def test_more_load_paths_and_shafts_than_can_be_compared_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two paths and two shafts have four bounds: either path, and both where a slide vanishes, here the same ones."""
    monkeypatch.setattr(model_slides, "MOST_MIXES", 4)
    model, _ = split({"left": 0.03, "right": 0.07}, (1, 1), tmp_path)
    (stage,) = (
        own for own in of_kind(LostMotion, measure_of(model, "lost").kind).stages if isinstance(own, ParallelStage)
    )
    assert [mix.weights for mix in stage.mixes] == [(1.0, 0.0), (0.0, 1.0)]
    monkeypatch.setattr(model_slides, "MOST_MIXES", 3)
    with pytest.raises(SceneError, match="expected a shaft in one load path, or in simple parallel ones, got 'left'"):
        split({"left": 0.03, "right": 0.07}, (1, 1), tmp_path)


# transmission error of trains ----------------------------------------------------------------------------------------

RUNNING = """\
  A off: {kind: eccentricity, of: A, direction: {at: 20 deg}, distribution: {kind: constant, value: 5 um}}
  B off: {kind: eccentricity, of: B, direction: {at: 75 deg}, distribution: {kind: constant, value: 8 um}}
  C off: {kind: eccentricity, of: C, direction: {at: 130 deg}, distribution: {kind: constant, value: 6 um}}
  D off: {kind: eccentricity, of: D, direction: {at: -40 deg}, distribution: {kind: constant, value: 9 um}}
  shift: {kind: axial_shift, of: two, distribution: {kind: constant, value: 60 um}}
"""
CURVES = """\
  drive: {kind: transmission_error, of: train, over: turn, take: curve, positions: 30}
  back: {kind: transmission_error, of: train, over: turn, take: curve, positions: 30, flank: back}
  range: {kind: transmission_error, of: train, over: turn, take: range, positions: 30}
"""


def wave(gears: Mapping[str, Helical], model: Model, flank: int) -> np.ndarray:
    """Transmission error of the train [rad] by the transverse sections, first order; flank 1 drives, -1 is behind.

    Of a mesh (e1 sin(psi1 + alpha) + e2 sin(psi2 - alpha))/r_b2, psi from +x in each gear's sense of rotation, and of
    the back side with the angle's sign changed: as of spur gears, with the transverse working angle. A driver's centre
    at e moves e . n along the normal n = (sin(alpha), cos(alpha)) on the driven gear, a driven one takes that back.
    """
    off = {"A": (0.005, 20.0), "B": (0.008, 75.0), "C": (0.006, 130.0), "D": (0.009, -40.0)}
    total = np.zeros(31)
    for mesh, rate in zip(model.meshes, (19 / 53, 1.0), strict=True):
        turning = model.layout.mesh_turn[mesh.name]
        theta = np.array([turning.at(2 * math.pi * k / 30) for k in range(31)])
        pair, pushes = mesh.pair, -mesh.working_flank  # the sense in which the driver turns, about its z
        driven = pair.driven_angle(theta)
        alpha = flank * pair.working_pressure_angle
        (e1, phi1), (e2, phi2) = ((size, math.radians(angle)) for size, angle in (off[mesh.driver], off[mesh.driven]))
        psi1, psi2 = pushes * (phi1 + theta), -pushes * (phi2 + driven)
        lead = (e1 * np.sin(psi1 + alpha) + e2 * np.sin(psi2 - alpha)) / pair.wheel.base_radius
        total += rate * (lead - lead[0])
    return total


def test_the_transmission_error_of_a_helical_train_is_that_of_its_transverse_sections(tmp_path: Path) -> None:
    """Either flank side; what rests, such as the shaft's place along its axis, drops out."""
    gears = two_stages((1, 1), (1, 1))
    chain(gears, TWO, f"{RUNNING}{plays()}", tmp_path)
    path = tmp_path / "chain.yaml"
    text = path.read_text().replace("driver: C,", "driver: C, working_flank: left,")
    path.write_text(text.replace("study:", f"{CURVES}study:"))
    model = model_of_scene(path)
    trials = drawn_trials(model, 1, 0, 1)
    squares = 7e-7  # (17 um)²/(20 mm)²
    method = GeometricMethod(model, exact_engine(model))
    measures = [measure_of(model, name) for name in ("drive", "back")]
    by_method = method.answers(trials, measures).values, AnalyticMethod(model).answers(trials, measures).values
    for name, flank in (("drive", 1), ("back", -1)):
        by_hand = wave(gears, model, flank)
        assert np.ptp(by_hand) > 1e-4
        geometric, analytic = (own[name][0] for own in by_method)
        assert analytic == pytest.approx(by_hand, abs=1e-12)
        assert geometric == pytest.approx(by_hand, abs=squares)
        if name == "drive":
            between = gear_columns(model, exact_engine(model), trials)["geometric:range"][0] / ARCMIN
            assert np.ptp(geometric) <= between < 1.005 * np.ptp(geometric)  # a parabola over 30 positions a turn


# bearings that follow the tooth force ---------------------------------------------------------------------------------


def loads_of(gear: Helical, teeth: tuple[float, float, float], places: tuple[float, float], ccw: bool) -> np.ndarray:
    """Loads (2, 3) of a driver on two bearings by equilibrium in space, in units of the tangential force.

    Args:
        gear: that drives.
        teeth: its place along the shaft [mm], the azimuth of the mesh in the shaft's frame, the working pressure angle.
        places: of the bearings [mm]; the first one takes the thrust.
        ccw: whether the gear turns counter-clockwise about its own z.

    Its mate holds it back, pushes it away, and pushes a right hand that turns counter-clockwise along +z.
    """
    at, azimuth, alpha = teeth
    outwards = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    z = np.array([0.0, 0.0, float(gear.sense)])
    sense = 1.0 if ccw else -1.0
    radius = gear.radius * math.cos(math.atan(math.tan(math.radians(20.0)) / math.cos(gear.helix))) / math.cos(alpha)
    tan_w = math.tan(gear.helix) * radius / gear.radius
    force = -sense * np.cross(z, outwards) - math.tan(alpha) * outwards + gear.hand * sense * tan_w * z
    point = radius * outwards + np.array([0.0, 0.0, at])
    rows = np.zeros((6, 5))  # of x, y of both and z of the first
    for k, (bearing, axis) in enumerate(((0, 0), (0, 1), (1, 0), (1, 1), (0, 2))):
        unit = np.eye(3)[axis]
        rows[:3, k], rows[3:, k] = unit, np.cross([0.0, 0.0, places[bearing]], unit)
    moment = np.cross(point, force)
    moment[2] = 0.0  # the motor's
    found, *_ = np.linalg.lstsq(rows, np.concatenate([force, moment]), rcond=None)
    assert rows @ found == pytest.approx(np.concatenate([force, moment]), abs=1e-9)
    return np.array([[found[0], found[1], found[4]], [found[2], found[3], 0.0]])


@pytest.mark.parametrize("flank", ["left", "right"])
@pytest.mark.parametrize("hand", [1, -1])
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("places", [(0.0, 70.0), (48.0, 90.0)])
def test_bearings_of_a_helical_gear_move_where_statics_push_them(
    flank: str, hand: int, sense: int, places: tuple[float, float], tmp_path: Path
) -> None:
    """The gear C at 30 mm, between its bearings and beyond both; a driver's left flank works where it turns ccw."""
    gears = two_stages((1, hand), (1, sense))
    chain(gears, TWO, plays(), tmp_path)
    path = tmp_path / "chain.yaml"
    clearances = "".join(
        f"  {name} play: {{kind: bearing_clearance, of: {name}, mesh: second, direction: tooth_force, "
        "distribution: {kind: constant, value: 10 um}}\n"
        for name in ("low", "high")
    )
    bearings = "".join(
        f"  {name}: {{kind: bearing, shaft: two, at: {at} mm}}\n"
        for name, at in zip(("low", "high"), places, strict=True)
    )
    text = path.read_text().replace("tolerances:\n", f"{bearings}tolerances:\n{clearances}")
    path.write_text(text.replace("driver: C,", f"driver: C, working_flank: {flank},"))
    model = model_of_scene(path)
    pair = model.mesh("second").pair
    azimuth = sense * math.radians(33.0)  # counted in the gear's frame, which is turned about x
    loads = loads_of(gears["C"], (30.0, azimuth, pair.working_pressure_angle), places, flank == "left")
    for name, pushed in zip(("low", "high"), loads, strict=True):
        effect = next(own for own in model.contributors if own.name == f"{name} play").effect
        moved = next(one for one in effect.singles if isinstance(one, AxisOffset) and one.part == "C")
        x, y, _ = moved.direction
        lever = moved.factor * np.array([x, sense * y])  # in the shaft's frame
        at, other = places if name == "low" else reversed(places)
        own = lever / ((30.0 - other) / (at - other)) / 0.5
        assert own == pytest.approx(pushed[:2] / np.hypot(*pushed[:2]), abs=1e-12)


def test_the_tooth_force_of_a_helical_gear_needs_two_bearings(tmp_path: Path) -> None:
    chain(two_stages((1, 1)), TWO, plays(), tmp_path)
    path = tmp_path / "chain.yaml"
    force = "direction: tooth_force, distribution: {kind: constant, value: 9 um}"
    play = f"  play: {{kind: bearing_clearance, of: only, mesh: second, {force}}}"
    bearing = "  only: {kind: bearing, shaft: two}"
    path.write_text(path.read_text().replace("tolerances:", f"{bearing}\ntolerances:\n{play}"))
    with pytest.raises(SceneError, match=r"play\.direction: expected apart, random, .* or a second bearing, got"):
        model_of_scene(path)
