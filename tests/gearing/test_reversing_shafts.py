"""Shafts that cross their bearing clearances where the load changes sides, as part of lost motion.

Against closed forms of involutes at two places of their axes, against a search of screw flanks on shafts that statics
put in their bearings, and against work: where nothing leans, each load opens the sum of half of each clearance times
the load on its bearing.
"""

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gear_trials import drawn_trials, form_of, gear_columns, measure_of, model_of_scene
from oracles.reversing_shafts import Bearings, Stage
from oracles.screw_flanks import ScrewGear
from places import SCENES
from scene_texts import written

from tol3d.errors import GeometryError, SceneError
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.methods.analytic import AnalyticMethod, analytic_values
from tol3d.gearing.methods.geometric import FclMethod, GeometricMethod
from tol3d.gearing.model import AxisOffset, AxisTilt, Measure, Model, Positions
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.gearing.summary.train_sections import description
from tol3d.gearing.system import GearSystem
from tol3d.gears import InternalGear, InternalPair, SpurGear, SpurPair
from tol3d.study.system.trials import Trials

ARCMIN = 10800 / math.pi  # in a radian
ALPHA = math.radians(20.0)
CLOSED_FORM = 1e-9  # mm
SEARCH = 2e-8  # mm; grids that shrink to 4e-6 of a face leave that at a kink of the gap

AT = "over: {at: 12 deg}"
READ = f"""
  normal backlash: {{kind: normal_backlash, of: m, {AT}}}
  arc: {{kind: circumferential_backlash, of: m, {AT}}}
  free: {{kind: angular_backlash, of: m, {AT}}}
  free driver: {{kind: angular_backlash, of: m, gear: A, {AT}}}
  lost: {{kind: lost_motion, of: t, {AT}}}
  back: {{kind: transmission_error, of: m, flank: back, over: turn, take: curve, positions: 8}}
"""


def scene(folder: Path, parts: str, tolerances: str, moves: str, measures: str = READ) -> Path:
    text = f"scene: s\nparts:\n{parts}\ntolerances:\n{tolerances}\nmoves:\n{moves}\nmeasures:{measures}"
    (path := folder / "scene.yaml").write_text(text)
    return path


def clearance(name: str, of: str, size: float, direction: str = "reversing", mesh: str = "m") -> str:
    law = f"distribution: {{kind: constant, value: {size!r} mm}}"
    return f"  {name}: {{kind: bearing_clearance, of: {of}, mesh: {mesh}, direction: {direction}, {law}}}\n"


def thinner(gear: str, by: float) -> str:
    return (
        f"  thin {gear}: {{kind: tooth_thickness, of: {gear}, distribution: {{kind: constant, value: {-by!r} mm}}}}\n"
    )


def values(model: Model, name: str) -> tuple[float, float]:
    """One trial by the exact and the analytic method, in the measure's internal unit."""
    columns = gear_columns(model, exact_engine(model), drawn_trials(model, 1, 0, 1))
    per = measure_of(model, name).per_internal
    return float(columns[f"geometric:{name}"][0]) / per, float(columns[f"analytic:{name}"][0]) / per


# pairs of which each gear lies in bearings of its own -----------------------------------------------------------------


def plain_pair(folder: Path, kind: str, flank: str, sizes: tuple[float, float], **own: Any) -> Model:
    """A pair whose axes shift and stay parallel: the clearance is of the gear."""
    angle, direction = own.get("angle", 20.0), own.get("direction", "reversing")
    teeth = {"internal": ("internal_gear", 31, 94), "ring drives": ("internal_gear", 94, 31)}.get(kind, ("", 60, 97))
    ring = f"internal_gear, pressure_angle: {angle} deg, addendum: 0.8, "
    helix = {"right": "left", "left": "right"}[own.get("hand", "right")]
    names = {
        "spur": ("spur_gear", "spur_gear"),
        "helical": (
            f"helical_gear, helix_angle: 25 deg, hand: {own.get('hand', 'right')}",
            f"helical_gear, helix_angle: 25 deg, hand: {helix}",
        ),
        "internal": ("spur_gear", ring),
        "ring drives": (ring, "spur_gear"),
    }[kind]
    parts = "\n".join(
        f"  {gear}: {{kind: {name.rstrip(', ')}, teeth: {z}, module: 2 mm, face_width: 20 mm"
        f"{'' if 'internal' in name else f', pressure_angle: {angle} deg'}}}"
        for gear, name, z in zip("AB", names, teeth[1:], strict=True)
    )
    reference = 157.0 / (math.cos(math.radians(25.0)) if kind == "helical" else 1.0)
    apart = reference + 0.1 if kind in ("spur", "helical") else 63.0 - 0.1
    tolerances = "".join(clearance(f"of {gear}", gear, size, direction) for gear, size in zip("AB", sizes, strict=True))
    moves = (
        f"  m: {{kind: mesh, driver: A, driven: B, centre_distance: {apart!r} mm, working_flank: {flank}}}\n"
        "  t: {kind: train, driven: A, output: B}"
    )
    return model_of_scene(scene(folder, parts, tolerances + thinner("A", 0.05), moves))


def at_two_places(model: Model, sizes: tuple[float, float]) -> float:
    """Free turn of an external pair [rad] with its axes at two places, exact; alpha_w of the nominal distance directs.

    The axes stand e apart beyond it, along the force: further apart and turned by delta, to either side. Between flanks
    the middle turns by (1 + z1/z2) delta, and the play is that of the larger distance.
    """
    (mesh,), pair = model.meshes, model.meshes[0].pair
    assert isinstance(pair, SpurPair)
    alpha, apart, e = pair.working_pressure_angle, pair.centre_distance, sum(sizes) / 2
    bases = pair.pinion.base_radius + pair.wheel.base_radius
    thinned = 0.05 * math.cos(ALPHA) / pair.base_helix_cosine  # of the normal arc, along the transverse line of action

    def inv(angle: float) -> float:
        return math.tan(angle) - angle

    further = math.hypot(apart + e * math.sin(alpha), e * math.cos(alpha))
    delta = math.atan2(e * math.cos(alpha), apart + e * math.sin(alpha))
    play = 2 * bases * (inv(math.acos(bases / further)) - inv(alpha)) + pair.normal_backlash / pair.base_helix_cosine
    return (play + thinned) / pair.wheel.base_radius + 2 * delta * (1 + mesh.pair.pinion.teeth / mesh.pair.wheel.teeth)


@pytest.mark.parametrize("flank", ["left", "right"])
@pytest.mark.parametrize(("kind", "hand"), [("spur", "right"), ("helical", "right"), ("helical", "left")])
def test_a_free_turn_is_that_between_two_places_of_the_axes(kind: str, hand: str, flank: str, tmp_path: Path) -> None:
    sizes = (0.021, 0.034)
    model = plain_pair(tmp_path, kind, flank, sizes, hand=hand)
    pair = model.meshes[0].pair
    by_hand = at_two_places(model, sizes)
    for name, gear in (("free", pair.wheel), ("free driver", pair.pinion), ("lost", pair.wheel)):
        turn = by_hand * pair.wheel.base_radius / gear.base_radius
        exact, analytic = values(model, name)
        assert exact * gear.base_radius == pytest.approx(turn * gear.base_radius, abs=CLOSED_FORM)
        # first order: the common tangent grows along itself, so that only rounding is left of a square
        assert analytic * gear.base_radius == pytest.approx(turn * gear.base_radius, abs=CLOSED_FORM)
        assert form_of(model, name).mean == pytest.approx(analytic, rel=1e-12)


@pytest.mark.parametrize("flank", ["left", "right"])
@pytest.mark.parametrize("kind", ["spur", "helical", "internal", "ring drives"])
def test_each_clearance_opens_its_full_length_along_the_normals(kind: str, flank: str, tmp_path: Path) -> None:
    """A helical gear has cos(beta_b) of it: its shaft moves across the axis, and the force leans by beta_b."""
    none, sizes = plain_pair(tmp_path, kind, flank, (1e-9, 1e-9)), (0.02, 0.034)
    model = plain_pair(tmp_path, kind, flank, sizes)
    pair = model.meshes[0].pair
    wanted = sum(sizes) * pair.base_helix_cosine
    for method in range(2):
        opened = (values(model, "free")[method] - values(none, "free")[method]) * pair.wheel.section_arm
        assert opened == pytest.approx(wanted, abs=4e-9)
    along, once = (plain_pair(tmp_path, kind, flank, own, direction="tooth_force") for own in (sizes, (1e-9, 1e-9)))
    stays = (values(along, "free")[1] - values(once, "free")[1]) * pair.wheel.section_arm
    assert stays == pytest.approx(wanted * math.sin(pair.working_pressure_angle) ** 2, abs=4e-9)


@pytest.mark.parametrize("angle", [28.0, 20.0, 14.5, 10.0, 6.0])
def test_towards_no_pressure_angle_the_arc_is_the_clearance(angle: float, tmp_path: Path) -> None:
    """j_bt is G/cos(alpha_w): 1.13 G at 28 degrees, 1.006 G at 6, of a force that then hardly turns but flips."""
    parts = "\n".join(
        f"  {gear}: {{kind: spur_gear, teeth: 300, module: 2 mm, face_width: 20 mm, pressure_angle: {angle} deg, "
        "addendum: 0.9}"
        for gear in "AB"
    )
    moves = "  m: {kind: mesh, driver: A, driven: B, centre_distance: 600 mm}\n  t: {kind: train, driven: A, output: B}"
    thin = thinner("A", 0.05)
    model = model_of_scene(scene(tmp_path, parts, thin + clearance("of B", "B", 0.03), moves))
    for own in values(model, "free"):
        arc = own * 300.0 - 0.05
        assert arc == pytest.approx(0.03 / math.cos(math.radians(angle)), abs=1e-8)
        assert arc >= 0.03


@pytest.mark.parametrize("kind", ["spur", "helical", "internal"])
def test_what_is_no_lost_motion_is_read_under_the_load_on_the_working_flanks(kind: str, tmp_path: Path) -> None:
    sizes = (0.02, 0.034)
    model, stays = (plain_pair(tmp_path, kind, "left", sizes, direction=own) for own in ("reversing", "tooth_force"))
    names = ("normal backlash", "arc", "back")
    each = [[measure_of(own, name) for name in names] for own in (model, stays)]
    trials = drawn_trials(model, 1, 0, 1)
    for method in (AnalyticMethod, lambda own: GeometricMethod(own, exact_engine(own))):
        found, expected = (method(own).answers(trials, of).values for own, of in zip((model, stays), each, strict=True))
        for name in names:
            assert np.array_equal(found[name], expected[name])
    assert all(own.kind.backlashes[0][1].reading.reversing is False for own in stays.measures)
    said = ["lost_motion" in description(own, measure_of(own, "normal backlash")) for own in (model, stays)]
    assert said == [False, True]  # a normal backlash says nothing of lost motion where more adds to that


# pairs on shafts in two bearings each ---------------------------------------------------------------------------------


def geared(rng: np.random.Generator, *, ring: bool = False, helix: float | None = None) -> tuple[Any, Any, float]:
    """Gears that run, as the oracle has them, without their thinning and at the distance at which they have no play."""
    while True:
        module, beta = round(float(rng.uniform(1.0, 4.0)), 3), math.radians(rng.uniform(8.0, 30.0))
        beta = beta if helix is None else helix
        first = int(rng.integers(18, 40))
        last = int(rng.integers(first * 3, 130) if ring else rng.integers(18, 80))
        shift, other = (round(float(own), 3) for own in rng.uniform(0.0, 0.3, 2))
        other = -shift if ring else other
        faces = [round(float(module * own), 2) for own in rng.uniform(6.0, 14.0, 2)]
        hand = 1 if rng.random() < 0.5 else -1
        words: dict[str, Any] = {"module": module, "pressure_angle": ALPHA, "helix_angle": beta}
        try:
            pinion = SpurGear(first, face_width=faces[0], profile_shift=shift, hand=hand, **words)  # type: ignore[arg-type]
            if ring:
                rim = InternalGear(last, face_width=faces[1], profile_shift=other, hand=hand, addendum=0.85, **words)  # type: ignore[arg-type]
                tight = InternalPair(pinion, rim, rim.reference_radius - pinion.reference_radius)
                apart = tight.zero_backlash_centre_distance
                InternalPair(pinion, rim, apart - 0.01 * module).refuse_interference()
            else:
                wheel = SpurGear(last, face_width=faces[1], profile_shift=other, hand=-hand, **words)  # type: ignore[arg-type]
                far = SpurPair(pinion, wheel, 10 * (pinion.tip_radius + wheel.tip_radius))
                apart = far.zero_backlash_centre_distance
                SpurPair(pinion, wheel, apart).refuse_interference()
        except GeometryError:
            continue
        thin = 0.03 * module
        one = ScrewGear(first, module, ALPHA, beta, hand, faces[0], shift, thin)
        two = ScrewGear(
            last, module, ALPHA, beta, hand if ring else -hand, faces[1], other, thin, 0.85 if ring else 1.0, ring
        )
        return (one, two), apart, module


def random_stage(
    rng: np.random.Generator, *, ring: bool = False, helix: float | None = None, size: float = 1.0
) -> Stage:
    """Gears between their bearings or beyond both, whose clearances, play and thinning go with `size`."""
    gears, apart, module = geared(rng, ring=ring, helix=helix)
    bearings = []
    for _ in range(2):
        low = float(-rng.uniform(10.0, 50.0) if rng.random() < 0.7 else rng.uniform(12.0, 30.0))
        high = low + float(rng.uniform(20.0, 90.0)) + (60.0 if low < 0.0 else 0.0)
        heights = (low, high) if rng.random() < 0.5 else (high, low)
        first, second = (float(own) * size for own in rng.uniform(0.004, 0.03, 2))
        bearings.append(Bearings(heights, (first, second)))
    thin = [replace(gear, thinner=size * gear.thinner) for gear in gears]
    further = (-1.0 if ring else 1.0) * 0.004 * module * size
    return Stage((thin[0], thin[1]), (bearings[0], bearings[1]), apart + further)


def stage_scene(stage: Stage, folder: Path, flank: int, seed: int, direction: str = "reversing") -> Model:
    """The scene of a stage, whose shafts' frames and places along them are drawn by a seed."""
    rng = np.random.default_rng(seed)
    parts, tolerances = [], []
    for name, gear, bearings in zip("AB", stage.gears, stage.bearings, strict=True):
        kind = "internal_gear, addendum: 0.85" if gear.inside else "helical_gear" if gear.beta else "spur_gear"
        if gear.beta:
            kind += f", helix_angle: {math.degrees(gear.beta)!r} deg, hand: {'right' if gear.hand == 1 else 'left'}"
        at, sense = round(float(rng.uniform(-20.0, 20.0)), 1), 1 if rng.random() < 0.5 else -1
        sits = f"at: {at} mm, facing: {'forward' if sense == 1 else 'backward'}"
        parts += [
            f"  {name}: {{kind: {kind}, teeth: {gear.teeth}, module: {gear.module} mm, profile_shift: {gear.shift}, "
            f"face_width: {gear.face} mm}}",
            f"  shaft {name}: {{kind: shaft, carries: {{{name}: {{{sits}}}}}}}",
        ]
        for k, (height, size) in enumerate(zip(bearings.heights, bearings.clearances, strict=True)):
            parts.append(f"  bearing {name}{k}: {{kind: bearing, shaft: shaft {name}, at: {at + sense * height!r} mm}}")
            tolerances.append(clearance(f"{name}{k}", f"bearing {name}{k}", size, direction))
        tolerances.append(thinner(name, gear.thinner))
    turn, azimuth = rng.uniform(-180.0, 180.0, 2).round(2).tolist()
    moves = (
        f"  m: {{kind: mesh, driver: A, driven: B, centre_distance: {stage.apart!r} mm, azimuth: {azimuth} deg, "
        f"working_flank: {'right' if flank == 1 else 'left'}}}"
    )
    over = f"over: {{at: {turn} deg}}"
    measures = (
        f"\n  free: {{kind: angular_backlash, of: m, {over}}}\n"
        f"  back: {{kind: angular_backlash, of: m, gear: A, {over}}}\n"
    )
    return model_of_scene(scene(folder, "\n".join(parts), "".join(tolerances), moves, measures))


def turn_of(model: Model) -> float:
    """Angle of the driver at which a stage is read [rad]."""
    (angle,) = measure_of(model, "free").positions.fixed or ()
    return angle


def arm(stage: Stage) -> float:
    """Distance [mm] along the normals per turn of the driven gear."""
    gear = stage.gears[1]
    return gear.base * math.cos(math.atan(gear.twist * gear.base))


@pytest.mark.parametrize("seed", [*range(6), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(6, 50))])
def test_a_free_turn_is_that_of_a_search_on_shafts_where_statics_put_them(seed: int, tmp_path: Path) -> None:
    """Every fifth in a ring, every fourth without a helix; what it is without reversal is microns off."""
    rng, flank = np.random.default_rng(seed), 1 if seed % 3 else -1
    stage = random_stage(rng, ring=seed % 5 == 4, helix=0.0 if seed % 4 == 3 else None)
    model = stage_scene(stage, tmp_path, flank, seed)
    searched = stage.free_turn(turn_of(model), flank) * arm(stage)
    exact, analytic = (own * arm(stage) for own in values(model, "free"))
    assert exact == pytest.approx(searched, abs=SEARCH)
    # lines end where mates do that stand the play apart: f j/tan(beta_b), of at most 1.5 mrad and 0.3 mm
    assert analytic == pytest.approx(exact, abs=0.2e-3)
    stays, _ = (own * arm(stage) for own in values(stage_scene(stage, tmp_path, flank, seed, "tooth_force"), "free"))
    assert exact - stays > 0.4 * stage.pushed_open(flank)


@pytest.mark.parametrize("seed", range(4))
def test_without_a_face_to_lean_what_opens_is_the_work_of_both_loads(seed: int, tmp_path: Path) -> None:
    """Spur gears of a hundredth of a millimetre, of which no end stands off; between their bearings and beyond."""
    stage = random_stage(np.random.default_rng(seed), helix=0.0)
    thin = [replace(gear, face=0.01) for gear in stage.gears]
    stage = replace(stage, gears=(thin[0], thin[1]))
    none = replace(
        stage,
        bearings=(
            replace(stage.bearings[0], clearances=(1e-9, 1e-9)),
            replace(stage.bearings[1], clearances=(1e-9, 1e-9)),
        ),
    )
    each = [values(stage_scene(own, tmp_path, 1, seed), "free") for own in (stage, none)]
    leans = 0.02e-3 * 0.01  # of a lean of 1.5 mrad over 0.01 mm, both sides
    for opened, before in zip(*each, strict=True):
        assert (opened - before) * arm(stage) == pytest.approx(stage.pushed_open(1), abs=leans + 0.03e-3)


@pytest.mark.slow
def test_the_stack_up_differs_by_a_quarter_when_all_halves(tmp_path: Path) -> None:
    """Squares: of clearances, play and thinning together, for lines end where mates stand the play apart."""
    ratios = []
    for seed in range(24):
        apart = []
        for size in (1.0, 0.5):
            helix = 0.0 if seed % 4 == 3 else None
            stage = random_stage(np.random.default_rng(seed), ring=seed % 5 == 4, helix=helix, size=size)
            exact, analytic = values(stage_scene(stage, tmp_path, 1, seed), "free")
            apart.append((exact - analytic) * arm(stage))
        ratios.append(apart[0] / apart[1])
    of_squares = [ratio for ratio in ratios if ratio == pytest.approx(4.0, rel=0.01)]
    assert len(of_squares) >= 23  # in one, a ring, a contact line comes to an end at which the gap is less in between


@pytest.mark.parametrize("direction", ["reversing", "tooth_force"])
def test_a_helix_that_vanishes_leaves_a_spur_gear(direction: str, tmp_path: Path) -> None:
    """Between the bearings and beyond them; the couple of a thrust of tan(1e-4 deg) moves nothing that counts."""
    for seed in range(3):
        found = []
        for helix in (0.0, math.radians(1e-4)):
            stage = random_stage(np.random.default_rng(seed), helix=helix)
            model = stage_scene(stage, tmp_path, -1, seed, direction)
            found.append(np.array(values(model, "free")) * arm(stage))
        assert found[0] == pytest.approx(found[1], abs=1e-7)  # 30 um and 1.7e-6 of them, twice over r_w/L


@pytest.mark.parametrize("seed", [0, 3, 4])
@pytest.mark.parametrize("name", ["free", "back"])
def test_derivatives_are_differences_of_the_free_turn(name: str, seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    stage = random_stage(rng, ring=seed == 4, helix=0.0 if seed == 3 else None)
    model = stage_scene(stage, tmp_path, 1, seed)
    measure, trials = measure_of(model, name), drawn_trials(model, 1, 0, 1)
    rates = sensitivities(model, ExactEngine(model), trials, measure)[0]
    step = 1e-5
    for contributor in model.contributors:
        column = model.component_slices[contributor.name].start
        moved = np.repeat(trials.deviations, 2, axis=0)
        moved[:, column] += np.array([step, -step])
        both = Trials(moved, {key: np.repeat(own, 2) for key, own in trials.positions.items()})
        above, below = GeometricMethod(model, exact_engine(model)).answers(both, [measure]).values[name][:, 0]
        assert rates[column] == pytest.approx((above - below) / (2 * step), rel=2e-4, abs=1e-7)


def test_the_witness_finds_the_same_free_turn(tmp_path: Path) -> None:
    model = stage_scene(random_stage(np.random.default_rng(1)), tmp_path, -1, 1)
    system, trials = GearSystem(model), drawn_trials(model, 1, 0, 1)
    witness = system.method("fcl", system.materials("fcl"))
    assert isinstance(witness, FclMethod)
    measures = [measure_of(model, name) for name in ("free", "back")]
    found, exact = (own.answers(trials, measures).values for own in (witness, system.method("exact", None)))
    for measure in measures:
        bound = sum(witness.bounds(measure)) / measure.per_internal
        assert abs(float(found[measure.name][0, 0] - exact[measure.name][0, 0])) < bound


def test_one_bearing_lets_the_whole_shaft_of_a_spur_gear_cross(tmp_path: Path) -> None:
    """As the gear's own clearance does, wherever the bearing sits; the bearing's contact angle slides nothing spur."""
    bearing = "\n  only: {kind: bearing, shaft: B, at: 80 mm, contact_angle: 25 deg}"
    parts = "\n".join(
        f"  {gear}: {{kind: spur_gear, teeth: {z}, module: 2 mm, face_width: 20 mm}}"
        for gear, z in (("A", 31), ("B", 60))
    )
    moves = (
        "  m: {kind: mesh, driver: A, driven: B, centre_distance: 91.2 mm}\n  t: {kind: train, driven: A, output: B}"
    )
    whole = model_of_scene(scene(tmp_path, parts + bearing, clearance("play", "only", 0.02), moves))
    own = model_of_scene(scene(tmp_path, parts, clearance("play", "B", 0.02), moves))
    for name in ("free", "lost"):
        assert values(whole, name) == pytest.approx(values(own, name), abs=1e-12)


@pytest.mark.parametrize("seed", [1, 4])
def test_over_a_turn_both_methods_follow_the_contact_lines(seed: int, tmp_path: Path) -> None:
    """A leaning helical shaft: the free turn varies from position to position, by both methods alike."""
    model = stage_scene(random_stage(np.random.default_rng(seed), ring=seed == 4), tmp_path, 1, seed)
    (pair,) = (mesh.pair for mesh in model.meshes)
    at = [replace(measure_of(model, "free"), positions=Positions("turn", 1, 48), take="curve")]
    trials = drawn_trials(model, 1, 0, 1)
    exact, analytic = (
        method.answers(trials, at).values["free"][0] * pair.wheel.section_arm
        for method in (GeometricMethod(model, exact_engine(model)), AnalyticMethod(model))
    )
    assert exact.shape == (49,)
    assert np.ptp(exact) > 0.05e-3
    assert np.abs(exact - analytic).max() < 0.2e-3
    assert np.sqrt(np.mean((exact - analytic) ** 2)) < 0.2 * np.std(exact) + 0.02e-3


# trains ---------------------------------------------------------------------------------------------------------------

SHAFTS = """\
  A: {kind: helical_gear, teeth: 21, module: 1.5 mm, helix_angle: 23 deg, hand: right, face_width: 14 mm}
  B: {kind: helical_gear, teeth: 46, module: 1.5 mm, helix_angle: 23 deg, hand: left, face_width: 14 mm}
  C: {kind: helical_gear, teeth: 19, module: 2 mm, helix_angle: 14 deg, hand: left, face_width: 14 mm}
  D: {kind: helical_gear, teeth: 53, module: 2 mm, helix_angle: 14 deg, hand: right, face_width: 14 mm}
  one: {kind: shaft, carries: {A: {}}}
  two: {kind: shaft, carries: {B: {facing: backward}, C: {at: 30 mm}}}
  three: {kind: shaft, carries: {D: {}}}
  low: {kind: bearing, shaft: two, at: -17 mm}
  high: {kind: bearing, shaft: two, at: 48 mm}"""
MESHES = """\
  first: {kind: mesh, driver: A, driven: B, centre_distance: 54.7 mm, azimuth: 20 deg, working_flank: either}
  second: {kind: mesh, driver: C, driven: D, centre_distance: 74.4 mm, azimuth: 33 deg, working_flank: either}
  train: {kind: train, driven: one, output: three}"""
LOST = "\n  lost: {kind: lost_motion, of: train, over: {at: 20 deg}}\n"
LAY = clearance("low play", "low", 0.03, mesh="second") + clearance("high play", "high", 0.018, mesh="second")


def gaps(model: Model, contributor: str, reverse: bool) -> dict[str, float]:
    """Opening [mm] of the flanks that carry the load in each mesh by a deviation of 1 mm, from its shifts alone."""
    of = model.reversed if reverse else model
    own = next(each for each in of.contributors if each.name == contributor)
    found = {}
    for mesh in model.meshes:
        pair = mesh.pair
        side = -mesh.working_flank if reverse else mesh.working_flank
        alpha, lean = pair.working_pressure_angle, math.acos(pair.base_helix_cosine)
        hand = math.copysign(1.0, pair.pinion.twist)
        normal = np.array([math.sin(alpha), -side * math.cos(alpha), side * hand * math.tan(lean)]) * math.cos(lean)
        total = 0.0
        for effect in own.effect.singles:
            if not isinstance(effect, AxisOffset | AxisTilt) or effect.part not in (mesh.driver, mesh.driven):
                continue
            driver = effect.part == mesh.driver
            turn = mesh.azimuth if driver else 0.0
            if isinstance(effect, AxisOffset):
                x, y, z = effect.factor * np.array(effect.direction)
                moved = np.array([x * math.cos(turn) + y * math.sin(turn), y * math.cos(turn) - x * math.sin(turn), z])
            else:
                x, y, _ = effect.per_length * np.array(effect.axis)
                vector = np.array([x * math.cos(turn) + y * math.sin(turn), y * math.cos(turn) - x * math.sin(turn), 0])
                radius = pair.working_radii[0] if driver else -pair.working_radii[1]
                moved = np.cross(vector, [radius, 0.0, 0.0])
            total += (-1.0 if driver else 1.0) * float(normal @ moved)
        found[mesh.name] = total
    return found


def work_of_the_second_mesh(model: Model) -> float:
    """Opening [mm] by the lay shaft's clearances where its loads push it, by virtual work."""
    pair = model.mesh("second").pair
    beta = math.radians(14.0)
    gears = ScrewGear(19, 2.0, ALPHA, beta, -1, 14.0), ScrewGear(53, 2.0, ALPHA, beta, 1, 14.0)
    lay, held = Bearings((-17.0 - 30.0, 48.0 - 30.0), (0.03, 0.018)), Bearings((-10.0, 10.0), (0.0, 0.0))
    assert isinstance(pair, SpurPair)
    return Stage(gears, (lay, held), pair.centre_distance).pushed_open(1)


def test_a_lay_shaft_opens_both_of_its_meshes_at_both_of_its_places(tmp_path: Path) -> None:
    """By its motion along either normal at the pitch points, of which leaning over the faces takes a part.

    The load of the second mesh directs it; in the first one it opens as far as that happens to push it there.
    """
    thin = "".join(thinner(gear, 0.04) for gear in "AC")
    model = model_of_scene(scene(tmp_path, SHAFTS, LAY + thin, MESHES, LOST))
    none = model_of_scene(
        scene(tmp_path, SHAFTS, LAY.replace("0.03 mm", "1e-9 mm").replace("0.018 mm", "1e-9 mm") + thin, MESHES, LOST)
    )
    opened = {mesh.name: 0.0 for mesh in model.meshes}
    for reverse in (False, True):
        for name, size in (("low play", 0.03), ("high play", 0.018)):
            for mesh, own in gaps(model, name, reverse).items():
                opened[mesh] += size * own
    assert opened["second"] == pytest.approx(work_of_the_second_mesh(model), abs=1e-12)
    (exact, analytic), (exact_before, before) = values(model, "lost"), values(none, "lost")
    turn = opened["first"] / model.mesh("first").pair.wheel.section_arm * 19 / 53
    turn += opened["second"] / model.mesh("second").pair.wheel.section_arm
    leaning = 0.012 / 65 * 7 * (1 / 45 + 1 / 90)  # 2 sides of (30 - 18)/2 um over 65 mm, half a face, over the arms
    assert analytic - before == pytest.approx(turn, abs=leaning)
    assert turn - (analytic - before) > -1e-9  # leaning takes
    assert exact == pytest.approx(analytic, abs=3e-6)
    assert exact_before == pytest.approx(before, abs=1e-6)


@pytest.mark.parametrize("leans", [False, True])
def test_the_closed_form_has_the_moments_of_trials(leans: bool, tmp_path: Path) -> None:
    law = "distribution: {kind: uniform, lower: 0.004 mm, upper: 0.03 mm}"
    bearings = "\n  low: {kind: bearing, shaft: B, at: -17 mm}\n  high: {kind: bearing, shaft: B, at: 48 mm}"
    parts = "\n".join(f"  {gear}: {{kind: spur_gear, teeth: {z}, module: 2 mm, face_width: 20 mm}}" for gear, z in
                      (("A", 31), ("B", 60))) + bearings  # fmt: skip
    of = ("low", "high") if leans else ("A", "B")
    plays = "".join(
        f"  {name} play: {{kind: bearing_clearance, of: {name}, mesh: m, direction: reversing, {law}}}\n" for name in of
    )
    moves = (
        "  m: {kind: mesh, driver: A, driven: B, centre_distance: 91.2 mm}\n  t: {kind: train, driven: A, output: B}"
    )
    parts = parts if leans else parts.replace(bearings, "")
    model = model_of_scene(scene(tmp_path, parts, thinner("A", 0.03) + plays, moves))
    form, measure, count = form_of(model, "free"), measure_of(model, "free"), 40_000
    found = analytic_values(model, measure, drawn_trials(model, 1, 0, count))[:, 0]
    assert form.mean == pytest.approx(found.mean(), abs=4 * form.sigma / math.sqrt(count))
    assert form.sigma == pytest.approx(found.std(), rel=4 / math.sqrt(2 * count))
    if not leans:  # a uniform law of 26 um in each, in full, over the base circle
        assert form.sigma == pytest.approx(math.sqrt(2 / 12) * 0.026 / model.meshes[0].pair.wheel.base_radius)


SPLIT = """\
  P: {kind: spur_gear, teeth: 21, module: 2 mm, face_width: 14 mm}
  Q: {kind: spur_gear, teeth: 21, module: 2 mm, face_width: 14 mm}
  L: {kind: spur_gear, teeth: 42, module: 2 mm, face_width: 14 mm}
  R: {kind: spur_gear, teeth: 42, module: 2 mm, face_width: 14 mm}
  in: {kind: shaft, carries: {P: {}, Q: {at: 40 mm}}}
  out: {kind: shaft, carries: {L: {}, R: {at: 40 mm}}}"""
BOTH = """\
  left: {kind: mesh, driver: P, driven: L, centre_distance: 63.1 mm, working_flank: either}
  right: {kind: mesh, driver: Q, driven: R, centre_distance: 63.1 mm, working_flank: either}
  train: {kind: train, driven: in, output: out}"""


@pytest.mark.parametrize(("left", "right"), [(0.02, 0.035), (0.035, 0.012)])
def test_load_paths_in_parallel_meet_in_the_tighter_one(left: float, right: float, tmp_path: Path) -> None:
    """Each path's gear crosses its clearance; both ends of the common play are those of the smaller clearance."""
    tolerances = clearance("l", "L", left, mesh="left") + clearance("r", "R", right, mesh="right")
    model = model_of_scene(scene(tmp_path, SPLIT, tolerances, BOTH, LOST))
    pair = model.meshes[0].pair
    wanted = (pair.normal_backlash + min(left, right)) / pair.wheel.base_radius
    for own in values(model, "lost"):
        assert own == pytest.approx(wanted, abs=1e-10)


def test_single_flanks_deviate_where_either_load_puts_them(tmp_path: Path) -> None:
    """Both methods, tooth by tooth; a reversal opens eight times as much as they differ in any trial."""
    flanks = "".join(
        f"  {gear} pitch: {{kind: pitch_deviation, of: {gear}, flanks: each, limits: {{iso_class: 7}}, "
        "law: {kind: random_walk, fill: [0.71, 1]}}\n"
        f"  {gear} slope: {{kind: profile_slope, of: {gear}, flanks: each, each: tooth, limits: {{size: 9 um}}, "
        "law: {kind: normal, cpk: 1}}\n"
        for gear in "AB"
    )
    parts = SHAFTS[: SHAFTS.index("  C:")] + SHAFTS[SHAFTS.index("  one:") : SHAFTS.index("  three:")]
    parts = parts.replace(", C: {at: 30 mm}", "") + SHAFTS[SHAFTS.index("  low:") :]
    plays = clearance("low play", "low", 0.03) + clearance("high play", "high", 0.018) + thinner("A", 0.05)
    moves = "  m: {kind: mesh, driver: A, driven: B, centre_distance: 54.7 mm, azimuth: 20 deg}\n"
    measures = "\n  free: {kind: angular_backlash, of: m}\n"
    each = []
    for text in (plays, plays.replace("reversing", "tooth_force")):
        model = model_of_scene(scene(tmp_path, parts, text + flanks, moves, measures))
        columns = gear_columns(model, exact_engine(model), drawn_trials(model, 5, 0, 60))
        assert (columns["status"] == "ok").all()
        arm_of = model.meshes[0].pair.wheel.section_arm / ARCMIN
        each.append([columns[f"{method}:free"] * arm_of for method in ("geometric", "analytic")])
    (exact, analytic), (stays, _) = each
    assert np.ptp(exact - stays) < 4e-3 < 15e-3 < (exact - stays).min()
    assert np.abs(exact - analytic).max() < 0.3e-3
    assert np.sqrt(np.mean((exact - analytic) ** 2)) < 0.05e-3


# what is refused ------------------------------------------------------------------------------------------------------


def test_flanks_that_are_not_loaded_at_once_are_refused(tmp_path: Path) -> None:
    """Right flanks of both drivers: they push the shaft between them one way, and its reaction the same way."""
    moves = MESHES.replace("working_flank: either", "working_flank: right")
    words = "tolerances.low play.direction: expected working flanks that are loaded at once, got those of 'first' and"
    with pytest.raises(SceneError, match=re.escape(words)):
        model_of_scene(scene(tmp_path, SHAFTS.replace("facing: backward", ""), LAY, moves, LOST))


BEVEL = """\
  A: {kind: bevel_gear, teeth: 31, module: 3.5 mm, face_width: 9 mm}
  B: {kind: bevel_gear, teeth: 31, module: 3.5 mm, face_width: 9 mm}
  low: {kind: bearing, shaft: B, at: -20 mm}
  high: {kind: bearing, shaft: B, at: 30 mm}"""
SPUR = """\
  A: {kind: spur_gear, teeth: 31, module: 2 mm, face_width: 20 mm}
  B: {kind: spur_gear, teeth: 60, module: 2 mm, face_width: 20 mm}
  low: {kind: bearing, shaft: B, at: -20 mm}
  high: {kind: bearing, shaft: B}"""
ALONE = SHAFTS.replace("\n  high: {kind: bearing, shaft: two, at: 48 mm}", "")


@pytest.mark.parametrize(
    ("parts", "of", "mesh", "moves", "words"),
    [
        (BEVEL, "low", "m", "  m: {kind: bevel_mesh, driver: A, driven: B}", "how the thrust of the bevel gear of 'm'"),
        (SPUR, "low", "m", "  m: {kind: mesh, driver: A, driven: B, centre_distance: 91.2 mm}", "gear 'B' sits at the"),
        (ALONE, "low", "second", MESHES, "or a second bearing, got reversing: the thrust of the helical gear 'B'"),
    ],
)
def test_a_bearing_whose_load_is_not_known_is_refused(
    parts: str, of: str, mesh: str, moves: str, words: str, tmp_path: Path
) -> None:
    measure = "\n  free: {kind: angular_backlash, of: " + mesh + "}\n"
    place = r"tolerances\.play\.direction: expected apart, random, "
    with pytest.raises(SceneError, match=place + ".*" + re.escape(words)):
        model_of_scene(scene(tmp_path, parts, clearance("play", of, 0.02, mesh=mesh), moves, measure))


def test_a_shaft_with_a_part_of_a_planetary_set_is_refused(tmp_path: Path) -> None:
    text = (SCENES / "reducer_3k_train.yaml").read_text("utf-8")
    bearings = "".join(f"  {name}: {{kind: bearing, shaft: countershaft, at: {at} mm}}\n" for name, at in
                       (("low", -5), ("high", 30)))  # fmt: skip
    text = text.replace("\nparts:\n", f"\nparts:\n{bearings}", 1)
    text = text.replace("\ntolerances:\n", f"\ntolerances:\n{clearance('play', 'low', 0.01, mesh='spur stage')}", 1)
    with pytest.raises(SceneError, match=r"play: expected a shaft without parts of 'reducer', got one that carries"):
        model_of_scene(written(text, tmp_path))


def test_bevel_gears_cross_the_clearances_of_their_own(tmp_path: Path) -> None:
    """Along the radial part of the force, sin(alpha) cos(delta) and cos(alpha): of the clearance what lies along it."""
    moves = "  m: {kind: bevel_mesh, driver: A, driven: B}\n  t: {kind: train, driven: A, output: B}"
    parts = BEVEL[: BEVEL.index("  low")].rstrip()
    sizes = (0.02, 0.03)
    each = []
    for pair in (sizes, (1e-9, 1e-9)):
        plays = "".join(clearance(f"of {gear}", gear, own) for gear, own in zip("AB", pair, strict=True))
        each.append(model_of_scene(scene(tmp_path, parts, plays + thinner("A", 0.05), moves)))
    delta = math.radians(45.0)
    along = math.hypot(math.sin(ALPHA) * math.cos(delta), math.cos(ALPHA))
    arm_of = each[0].meshes[0].pair.wheel.section_arm
    (exact, analytic), (exact_before, before) = (values(own, "free") for own in each)
    assert (analytic - before) * arm_of == pytest.approx(sum(sizes) * along, abs=4e-9)
    # the pair that touches stands up to 0.2 rad off the line of centres: shifts count 2 % less there
    assert (exact - exact_before) * arm_of == pytest.approx(sum(sizes) * along, rel=0.02)


def test_measures_without_a_reversal_keep_their_reading(tmp_path: Path) -> None:
    """The second mesh alone has a shaft that reverses."""
    model = model_of_scene(scene(tmp_path, SHAFTS, clearance("d", "D", 0.02, mesh="second"), MESHES, LOST))
    reading = {backlash.mesh: backlash.reading.reversing for _, backlash in measure_of(model, "lost").kind.backlashes}
    assert reading == {"first": False, "second": True}
    assert isinstance(measure_of(model, "lost"), Measure)
