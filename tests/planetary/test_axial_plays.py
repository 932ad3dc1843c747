"""Axial plays of a planetary set alone: a programme over turns and shifts, closed forms, searched screw flanks."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helical_places import least_placed_lag
from numpy.typing import NDArray
from scipy.optimize import linprog

from tol3d import load_scene, run_scene
from tol3d.errors import SceneError
from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.exact.flank_gaps import flank_gaps
from tol3d.gearing.planetary.exact.shown import placed_gears
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.numerics.programme import NO_ROOM

Array = NDArray[np.float64]

SAME = 1e-10  # rad; thinned teeth alone, of which gaps are linear, and what HiGHS leaves of 1e-9 in its rows
GEARS: dict[str, dict[str, tuple[int, float, float, int]]] = {  # teeth, normal module, helix angle, hand
    "simple": {"sun": (24, 1.5, 20.0, -1), "P1": (30, 1.5, 20.0, 1), "ring": (84, 1.5, 20.0, 1)},
    "stepped": {
        "sun": (24, 1.5, 20.0, -1), "P1": (30, 1.5, 20.0, 1), "P2": (24, 1.55, 13.9, 1), "ring": (78, 1.55, 13.9, 1),
    },
    "against": {
        "sun": (24, 1.5, 20.0, -1), "P1": (30, 1.5, 20.0, 1), "P2": (24, 1.55, 13.9, -1), "ring": (78, 1.55, 13.9, -1),
    },
    "3K": {
        "sun": (24, 1.5, 20.0, 1), "P1": (30, 1.5, 20.0, -1), "ring": (84, 1.5, 20.0, -1),
        "P2": (24, 1.55, 13.9, -1), "ring 2": (78, 1.55, 13.9, -1),
    },
}  # fmt: skip
ROLES = {"3K": ("ring", "sun", "ring 2"), "other 3K": ("sun", "carrier", "ring 2")}
SUN_2 = "{kind: helical_gear, teeth: 30, module: 1.55 mm, face_width: 12 mm, helix_angle: 13.9 deg, hand: right}"
PLAYS = {"sun": 70.0, "ring": 110.0, "ring 2": 90.0, "carrier": 130.0, "planet": 250.0}


def scene(kind: str, plays: str = "", measures: str = "lost: {kind: planetary_lost_motion, of: set}") -> str:
    """A set whose teeth have room; with tolerances besides those of tooth thickness."""
    gears = GEARS[kind.removeprefix("other ")]
    held, driving, driven = ROLES.get(kind, ("ring", "sun", "carrier"))
    lines = []
    for name, (teeth, module, beta, hand) in gears.items():
        own = f"kind: {'internal_gear' if 'ring' in name else 'helical_gear'}, teeth: {teeth}, module: {module} mm"
        side = "right" if hand > 0 else "left"
        lines.append(f"  {name}: {{{own}, face_width: 12 mm, helix_angle: {beta} deg, hand: {side}}}")
    planet = [name for name in gears if name.startswith("P")]
    meshes = {"sun": "P1", "ring": "P1" if kind.endswith("3K") else planet[-1]}
    if kind.endswith("3K"):
        meshes["ring 2"] = "P2"
    stated = ", ".join(f"{central}: {gear}" for central, gear in meshes.items())
    thin = [
        f"  {name} t: {{kind: tooth_thickness, of: {name}, distribution: {{kind: constant, value: -80 um}}}}"
        for name in gears
    ]
    return "\n".join(
        [
            "scene: set", "parts:", *lines,
            f"  planet: {{kind: planet, gears: [{', '.join(planet)}]}}",
            "  carrier: {kind: planet_carrier}",
            "tolerances:", *thin, plays,
            "moves:",
            f"  set: {{kind: planetary, planet: planet, planets: 3, carrier: carrier, held: {held}, input: {driving},"
            f" output: {driven}, centre_distance: 43.105 mm, meshes: {{{stated}}}}}",
            f"measures: {{{measures}}}",
            "study: {trials: 2, seed: 1}",
        ]
    )  # fmt: skip


def play_of(part: str, size: float = 0.0) -> str:
    """An axial play [um] of a part, of its own size unless one is given."""
    law = f"{{kind: constant, value: {size or PLAYS[part]} um}}"
    return f"  {part} play: {{kind: axial_play, of: {part}, distribution: {law}}}"


def system_of(text: str, folder: Path) -> PlanetarySystem:
    (path := folder / "set.yaml").write_text(text)
    return planetary_system(load_scene(path))


def by_programme(own: PlanetarySet, kind: str, deviated: Deviated, shaft: str) -> Array:
    """Free turn of a shaft (trials,) [rad], turns and shifts unknown alike: teeth of a mesh stay within half its room.

    A gear is screwed back by 2 pi/lead of its shift, whatever it meshes with; a planet shifts with its carrier and on
    its pin. Rooms are those of tooth thickness in the transverse section.
    """
    gears = GEARS[kind.removeprefix("other ")]
    shafts, planets = list(own.shafts), own.planets
    count = len(shafts)
    turn = {name: k for k, name in enumerate(shafts)}
    shift = {name: count + planets + k for k, name in enumerate(shafts)}
    size = 2 * (count + planets)
    found = []
    for trial in range(len(deviated.pins)):
        rows, rooms = [], []
        for planet in range(planets):
            for m, mesh in enumerate(own.meshes):
                row = np.zeros(size)
                teeth, module, beta, hand = gears[mesh.planet.name]
                its, _, _, its_hand = gears[mesh.central.name]
                sense = -1 if "ring" in mesh.central.name else 1
                cos = math.cos(math.radians(beta))
                base = module / cos / 2 * math.cos(math.atan(math.tan(math.radians(20.0)) / cos))
                lead = math.pi * module / cos / math.tan(math.radians(beta))  # of a tooth, in height
                for by, teeth_by, hand_by in ((base * teeth, teeth, hand), (sense * base * its, its, its_hand)):
                    screw = hand_by * 2 * math.pi / (lead * teeth_by)
                    if teeth_by == teeth:
                        row[count + planet] += by
                        row[shift["carrier"]] -= by * screw
                        row[size - planets + planet] -= by * screw
                    else:
                        row[turn[mesh.central.name]] += by
                        row[shift[mesh.central.name]] -= by * screw
                    row[turn["carrier"]] -= by
                thick = (
                    deviated.central_thickness[trial, m] + deviated.planet_thickness[trial, own.gear_of(mesh), planet]
                )
                rows.append(row)
                rooms.append(mesh.clearance - thick * base / (module / 2) / 2)
        bounds: list[Any] = [(None, None)] * (count + planets)
        for name in (own.held, own.opposite(shaft)):
            bounds[turn[name]] = (0.0, 0.0)
        bounds += [(-play / 2, play / 2) for play in (*deviated.shaft_slide[trial], *deviated.planet_slide[trial])]
        objective = np.zeros(size)
        objective[turn[shaft]] = -1.0
        solved = linprog(
            objective, A_ub=np.vstack([rows, -np.array(rows)]), b_ub=[*rooms, *rooms], bounds=bounds, method="highs"
        )
        assert solved.status == 0
        found.append(-2 * solved.fun)  # the same on both sides
    return np.array(found)


def random_plays(own: PlanetarySet, trials: int, seed: int) -> Deviated:
    """Teeth of all gears thinned unlike, and plays of all shafts and planets of some tenths of a millimetre."""
    rng, deviated = np.random.default_rng(seed), Deviated.nothing(own, trials)
    for array in (deviated.central_thickness, deviated.planet_thickness):
        array[...] = -rng.uniform(0.06, 0.09, array.shape)
    deviated.shaft_slide[...] = rng.uniform(0.0, 0.3, deviated.shaft_slide.shape)
    deviated.planet_slide[...] = rng.uniform(0.0, 0.6, deviated.planet_slide.shape)
    return deviated


@pytest.mark.parametrize("kind", ["simple", "stepped", "against", "3K", "other 3K"])
@pytest.mark.parametrize("at", ["output", "input"])
def test_free_turns_are_those_of_a_programme_over_turns_and_shifts(kind: str, at: str, tmp_path: Path) -> None:
    own = system_of(scene(kind), tmp_path).own
    deviated, shaft = random_plays(own, 12, 3), getattr(own, at)
    still = replace(deviated, shaft_slide=0 * deviated.shaft_slide, planet_slide=0 * deviated.planet_slide)
    expected = by_programme(own, kind, deviated, shaft)
    assert (expected - by_programme(own, kind, still, shaft) > 1e-4).all()
    for method in (StackUp(own), Contact(own)):
        free = method.free(deviated, np.zeros(12), shaft, own.opposite(shaft))
        assert free.play(own, deviated, shaft) == pytest.approx(expected, abs=SAME)


def test_sun_and_ring_of_a_simple_set_turn_its_carrier_by_their_shares(tmp_path: Path) -> None:
    """(c_S + c_R) |kappa_S| z_S/(z_S + z_R); carrier and planets by nothing, as their thrusts cancel."""
    texts = ["", "\n".join(map(play_of, ("sun", "ring"))), "\n".join(map(play_of, ("carrier", "planet")))]
    lost = []
    for k, plays in enumerate(texts):
        (path := tmp_path / f"{k}.yaml").write_text(scene("simple", plays))
        summary = run_scene(path, out=tmp_path / f"run {k}").found.measures["lost"]
        assert summary.geometric is not None
        assert summary.analytic is not None
        lost.append([math.radians((own.mean or 0.0) / 60) for own in (summary.geometric, summary.analytic)])
    kappa = math.sin(math.radians(20.0)) / (1.5 * 24 / 2)
    expected = (PLAYS["sun"] + PLAYS["ring"]) / 1000 * kappa * 24 / (24 + 84)
    assert np.subtract(lost[1], lost[0]) == pytest.approx([expected] * 2, abs=1e-12)
    assert lost[2] == lost[0]


def test_the_planet_with_the_least_play_limits_a_stepped_set(tmp_path: Path) -> None:
    """With gaps alike, c |kappa_1 - kappa_2| of that planet, by its teeth in the ring, at the carrier."""
    own = system_of(scene("stepped"), tmp_path).own
    deviated = Deviated.nothing(own, 1)
    deviated.central_thickness[...] = deviated.planet_thickness[...] = -0.08
    deviated.planet_slide[...] = [0.2, 0.15, 0.3]
    free = StackUp(own).free(deviated, np.zeros(1), "carrier", "sun")
    still = StackUp(own).free(replace(deviated, planet_slide=np.zeros((1, 3))), np.zeros(1), "carrier", "sun")
    first, second = (2 * math.sin(math.radians(beta)) / (m * z) for beta, m, z in ((20.0, 1.5, 30), (13.9, 1.55, 24)))
    # teeth of P1 roll on the sun at rest, those of P2 on the ring: z_P1 psi - (z_P1 + z_S) h = 0, and of P2 alike
    per_turn = (24 + 30) / 30 - (24 - 78) / 24  # turn of P1 against P2 a turn of the carrier
    assert np.ptp(free.ends) - np.ptp(still.ends) == pytest.approx(0.15 * (first - second) / per_turn, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("end", [0, 1])
def test_shifted_planets_touch_and_overlap_nowhere_by_a_search_of_their_screw_flanks(end: int, tmp_path: Path) -> None:
    """The planet that stops the carrier lies at a stop of its pin and touches sun and ring; its teeth are the limit."""
    system = system_of(scene("stepped"), tmp_path)
    own, deviated = system.own, random_plays(system.own, 1, 4)
    _, reached = Contact(own).seated(deviated, np.zeros(1), "carrier", "sun")
    gears = placed_gears(own, system.made, deviated, 0.0, reached[0, end])
    held = []
    for planet in range(own.planets):
        steps = gears[2 + 2 * planet : 4 + 2 * planet]
        apart = [[least_placed_lag(step, gears[m], side) for side in (1, -1)] for m, step in enumerate(steps)]
        assert np.min(apart) > -1e-6
        shift = steps[0].world_from_gear[2, 3]
        assert abs(shift) < deviated.planet_slide[0, planet] / 2 + 1e-12
        if abs(shift) > deviated.planet_slide[0, planet] / 2 - 1e-9:
            held.append((np.abs(apart) < 1e-6).any(axis=1).all())
    assert any(held)


def test_gaps_of_a_shifted_planet_are_those_of_a_planet_turned_by_its_screw(tmp_path: Path) -> None:
    """By kappa a length of shift, in all of its meshes."""
    system = system_of(scene("simple"), tmp_path)
    own, deviated = system.own, random_plays(system.own, 1, 5)
    gears = placed_gears(own, system.made, replace(deviated, planet_slide=np.zeros((1, 3))), 0.3, np.zeros(7))
    turned, shifted = list(gears), list(gears)
    kappa = 2 * math.sin(math.radians(20.0)) / (1.5 * 30)
    for place in range(2, 5):
        pose = gears[place].world_from_gear
        up, round_ = np.eye(4), np.eye(4)
        up[2, 3] = 0.4
        cos, sin = math.cos(-kappa * 0.4), math.sin(-kappa * 0.4)
        round_[:2, :2] = [[cos, -sin], [sin, cos]]
        shifted[place] = replace(gears[place], world_from_gear=pose @ up)
        turned[place] = replace(gears[place], world_from_gear=pose @ round_)
    found, expected = ([gap.value for gap in flank_gaps(own, each)] for each in (shifted, turned))
    assert found == pytest.approx(expected, abs=1e-12)
    assert np.ptp(np.array(found) - [gap.value for gap in flank_gaps(own, gears)]) > 0.01


@pytest.mark.slow
def test_the_witness_measures_planets_where_they_have_slid(tmp_path: Path) -> None:
    plays = "\n".join(map(play_of, ("sun", "ring", "carrier", "planet")))
    (path := tmp_path / "set.yaml").write_text(scene("stepped", plays).replace("trials: 2", "trials: 2, witness: 1"))
    run = run_scene(path, out=tmp_path / "run")
    assert run.found.witness is not None
    found = run.found.witness.measures["lost"]
    assert found.compared == 1
    assert (found.max_abs_difference or 0.0) < found.expected_at_most


def test_slopes_tell_the_plays(tmp_path: Path) -> None:
    """By differences of the programme's turns, of every shaft and planet."""
    own = system_of(scene("stepped"), tmp_path).own
    deviated = random_plays(own, 1, 6)
    slopes = StackUp(own).lost_motion_slopes(deviated, np.zeros(1), "carrier")
    for field in ("shaft_slide", "planet_slide"):
        plays = getattr(deviated, field)
        for place in range(plays.shape[1]):
            step = np.zeros_like(plays)
            step[0, place] = 1e-4
            both = [replace(deviated, **{field: plays + sense * step}) for sense in (-1.0, 1.0)]
            low, high = (by_programme(own, "stepped", each, "carrier")[0] for each in both)
            assert getattr(slopes, field)[0, place] == pytest.approx((high - low) / 2e-4, abs=1e-5)


@pytest.mark.parametrize("thick", [0.002, -0.002])
def test_teeth_too_thick_for_their_spaces_jam_wherever_planets_slide(thick: float, tmp_path: Path) -> None:
    """One planet's gear in the ring has 2 um less or more room than none, by its thickness or by its pin."""
    own = system_of(scene("stepped"), tmp_path).own
    ring = own.meshes[1]
    for by in ("thickness", "pin"):
        deviated = Deviated.nothing(own, 1)
        deviated.central_thickness[...] = deviated.planet_thickness[...] = -0.08
        deviated.planet_slide[...] = 0.4
        along = math.cos(ring.central.transverse_pressure_angle) / math.cos(math.radians(13.9))
        if by == "thickness":
            deviated.planet_thickness[0, 1, 2] += 0.16 + (2 * ring.clearance + thick) / along
        else:  # outwards, which closes a ring
            full = ring.clearance + 0.08 * along
            closed = ring.working_pressure_angle
            for _ in range(50):  # to the angle at which the involutes leave none
                inv = (
                    math.tan(ring.working_pressure_angle)
                    - ring.working_pressure_angle
                    + (full + thick) / ring.base_radii
                )
                closed -= (math.tan(closed) - closed - inv) / math.tan(closed) ** 2
            deviated.pins[0, 2, 0] = ring.base_radii / math.cos(closed) - own.centre_distance
        for method in (StackUp(own), Contact(own)):
            if by == "pin" and isinstance(method, StackUp):
                continue  # to first order pins of this size leave other gaps
            free = method.free(deviated, np.zeros(1), "carrier", "sun")
            assert (free.status[0] == NO_ROOM) == (thick > 0.0)


def warnings_of(text: str, folder: Path) -> str:
    return "\n".join(str(problem) for problem in system_of(text, folder).implausible)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (scene("simple", play_of("planet")), "planet play: acts on nothing: the thrusts of its meshes cancel on each"),
        (scene("simple", play_of("carrier")), "carrier play: acts on nothing: the thrusts of its meshes cancel on"),
        (
            scene("simple", play_of("sun"), "te: {kind: planetary_transmission_error, of: set, positions: 24}"),
            "sun play: acts on nothing: no planetary_lost_motion is measured",
        ),
    ],
)
def test_plays_that_turn_nothing_are_told(text: str, words: str, tmp_path: Path) -> None:
    assert words in warnings_of(text, tmp_path)


def test_plays_that_act_are_not_warned_of(tmp_path: Path) -> None:
    plays = "\n".join(map(play_of, ("sun", "ring", "carrier", "planet")))
    assert "acts on nothing" not in warnings_of(scene("stepped", plays), tmp_path)
    assert "acts on nothing" not in warnings_of(scene("3K", play_of("carrier")), tmp_path)


def test_no_play_turns_a_spur_set(tmp_path: Path) -> None:
    spur = scene("simple", play_of("sun")).replace("helix_angle: 20.0", "helix_angle: 0").replace("43.105", "40.5")
    words = "sun play: acts on nothing: no gear of 'set' is helical, and spur gears do not screw"
    assert words in warnings_of(spur, tmp_path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (scene("simple", play_of("P1", 9.0)), "P1 play.of: expected the planet, sun, ring or carrier, got 'P1'"),
        (
            scene("simple", play_of("sun") + "\n" + play_of("sun").replace("sun play", "again")),
            "again.of: expected one axial play of 'sun', got another draw of it beside 'sun play'",
        ),
        (
            scene("3K", play_of("planet"))
            .replace("ring 2: P2}", "ring 2: P2, sun 2: P2}")
            .replace("  P2: {", f"  sun 2: {SUN_2}\n  P2: {{"),
            "planet play.of: expected planets with one lead in all meshes but one, got 'planet' with others in ",
        ),
    ],
)
def test_plays_of_nothing_that_slides_are_refused(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError) as told:
        system_of(text, tmp_path)
    assert words in str(told.value)
