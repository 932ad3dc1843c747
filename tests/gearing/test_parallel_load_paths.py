"""Load paths from one shaft to another, against hand formulas and a mechanism that is turned to its ends.

The mechanism, `oracles.split`, knows one world, true angles and involutes; it has no frames of meshes, no working
flanks and no stack-up. Drawings are made here, of gears of 20 deg; scenes and mechanisms follow from them.
"""

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from expected import PRINTED, assert_met, expected, measures_of
from gear_trials import drawn_trials, gear_columns
from of_kind import of_kind
from oracles import split
from oracles.split import Gear, Reducer
from places import SCENES
from scene_texts import scene_of
from scipy.stats import norm

from tol3d import Overrides, Run, load_scene, run_scene
from tol3d.cli import main
from tol3d.errors import SceneError
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.meshing.seats import measure_backlash, seated
from tol3d.gearing.model import Backlash, Model, model_from_scene
from tol3d.gearing.play.play import seat_key
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.gearing.stack_up import analytic_backlash
from tol3d.study.system.trials import Trials

ARCMIN = 10800 / np.pi  # in a radian
SIN, COS = math.sin(split.ALPHA), math.cos(split.ALPHA)
SAME_TURN = 1e-9  # rad; where the exact engine's steps end, 1e-8 mm, at 20 mm and twice
AGREES = 1e-8  # rad; some of those, added up over ratios

LAWS = {
    "thickness": "kind: tooth_thickness, of: {}, distribution: {{kind: normal, lower: -60 um, upper: -40 um}}",
    "eccentricity": "kind: eccentricity, of: {}, distribution: {{kind: rayleigh, scale: 4 um}}",
    "axis": "kind: bearing_clearance, of: {}, direction: random, "
    "distribution: {{kind: uniform, lower: 4 um, upper: 20 um}}",
    "clocking": "kind: clocking, of: {}, distribution: {{kind: normal, lower: -2 arcmin, upper: 2 arcmin}}",
}  # fmt: skip


FACING = {1: "forward", -1: "backward"}


@dataclass(frozen=True)
class Drawing:
    """Drawing of a train, for a scene and for a mechanism; the input turns, the output is read.

    Args:
        gears: by name, without deviations.
        links: by name; reducers have no play yet.
        ratio: turns of the input per turn of the output.
        flanks: that work, if not all right ones.
    """

    gears: Mapping[str, Gear]
    links: Mapping[str, split.Mesh | Reducer]
    ratio: float
    flanks: Mapping[str, str] = field(default_factory=dict)

    def text(self, tolerances: Sequence[str], over: str = "random", held: str = "input", shaft: str = "output") -> str:
        """The scene; its measure is named lost motion."""
        shafts = dict.fromkeys([*(gear.shaft for gear in self.gears.values()), "input", "output"])
        lines = ["scene: load paths", "parts:"]
        for shaft_name in shafts:
            carried = ", ".join(
                f"{name}: {{facing: {FACING[gear.sense]}, phase: {math.degrees(gear.phase)!r} deg}}"
                for name, gear in self.gears.items()
                if gear.shaft == shaft_name
            )  # fmt: skip
            lines.append(f"  {shaft_name}: {{kind: shaft, carries: {{{carried}}}}}")
        lines.append("  output bearing: {kind: bearing, shaft: output}")
        for name, gear in self.gears.items():
            lines.append(
                f"  {name}: {{kind: spur_gear, teeth: {gear.teeth}, module: {gear.module} mm, face_width: 9 mm}}"
            )
        lines += ["tolerances:", *tolerances, "moves:"]
        for name, link in self.links.items():
            if isinstance(link, Reducer):
                lines.append(
                    f"  {name}: {{kind: reducer, driver: {link.driver}, driven: {link.driven}, ratio: {link.ratio}}}"
                )
                continue
            lines.append(
                f"  {name}: {{kind: mesh, driver: {link.driver}, driven: {link.driven}, centre_distance: "
                f"{link.distance} mm, azimuth: {math.degrees(link.azimuth)!r} deg, "
                f"working_flank: {self.flanks.get(name, 'right')}}}"
            )  # fmt: skip
        lines.append(f"  train: {{kind: train, driven: input, output: output, held: {held}}}")
        lines += ["measures:", f"  lost motion: {{kind: lost_motion, of: train, shaft: {shaft}, over: {over}}}"]
        return "\n".join(lines) + "\n"

    def mechanism(self, model: Model, block: Trials, degrees: float) -> split.Mechanism:
        """The builds of a block with the input at an angle [deg]."""

        def drawn(name: str, width: int) -> np.ndarray:
            known = model.component_slices.get(name)
            return np.zeros((len(block), width)) if known is None else block.deviations[:, known]

        gears = {
            name: replace(
                gear,
                thickness=drawn(f"{name} thickness", 1)[:, 0],
                centre=drawn(f"{name} eccentricity", 2),
                axis=drawn(f"{name} axis", 2) / 2 + drawn(f"{gear.shaft} clearance", 2) / 2 * [1.0, gear.sense],
                clocking=drawn(f"{name} clocking", 1)[:, 0],
                run_out=drawn(f"{gear.shaft} run-out", 2),
            )
            for name, gear in self.gears.items()
        }
        links = [
            replace(link, play=drawn(f"{name} play", 1)[:, 0]) if isinstance(link, Reducer) else link
            for name, link in self.links.items()
        ]
        return split.assembled(gears, links, "input", math.radians(degrees))


def tolerances(kind: str, *gears: str) -> list[str]:
    """A tolerance of that kind for each gear, named after both."""
    return [f"  {gear} {kind}: {{{LAWS[kind].format(gear)}}}" for gear in gears]


def mesh(driver: str, driven: str, degrees: float, distance: float) -> split.Mesh:
    return split.Mesh(driver, driven, math.radians(degrees), distance)


def model_of(folder: Path, text: str) -> Model:
    return model_from_scene(scene_of(text, folder))


def lost_motion(model: Model, block: Trials) -> np.ndarray:
    """By the exact engine [rad], (n,)."""
    return gear_columns(model, exact_engine(model), block)["geometric:lost motion"] / ARCMIN


def split_stage(teeth: Sequence[int] = (24, 56, 19, 41), azimuths: Sequence[float] = (0.0, 180.0)) -> Drawing:
    """One pinion, lay shafts around it, one bull gear; modules 1.5 and 2 mm, all coaxial at 60 mm."""
    sun, wheel, pinion, bull = teeth
    gears = {"sun": Gear("input", sun, 120 / (sun + wheel)), "bull": Gear("output", bull, 120 / (pinion + bull))}
    links: dict[str, split.Mesh] = {}
    for azimuth, side in zip(azimuths, SIDES, strict=False):
        gears[f"{side} wheel"] = Gear(side, wheel, 120 / (sun + wheel))
        gears[f"{side} pinion"] = Gear(side, pinion, 120 / (pinion + bull))
        links[f"{side} fast"] = mesh("sun", f"{side} wheel", azimuth, 60.0)
        links[f"{side} slow"] = mesh(f"{side} pinion", "bull", 180.0, 60.0)
    return Drawing(gears, links, wheel * bull / (sun * pinion))


SIDES = ("left", "right", "third")
LAY = tuple(f"{side} {gear}" for side in SIDES[:2] for gear in ("wheel", "pinion"))
ALL = ("sun", "bull", *LAY)
FAST, SLOW = 24 / 56, 19 / 41
ARMS = {"wheel": 42 * COS, "bull": 41 * COS}  # mm, of a turn that closes the backlash


def two_output_gears() -> Drawing:
    """The left lay shaft's pinion looks back, to a bull gear that does so too; the right one has a bull of its own."""
    plain = split_stage()
    gears = dict(plain.gears) | {
        "left pinion": Gear("left", 19, 2.0, sense=-1, phase=math.radians(20)),
        "bull": Gear("output", 41, 2.0, sense=-1, phase=math.radians(-33)),
        "right pinion": Gear("right", 19, 2.0, phase=math.radians(7)),
        "other bull": Gear("output", 41, 2.0),
    }
    links = dict(plain.links) | {"right slow": mesh("right pinion", "other bull", 180.0, 60.0)}
    return replace(plain, gears=gears, links=links)


def nested() -> Drawing:
    """A reducer from input to output, and beside it shafts of which two run side by side, one looking back.

    Input 20:40 k, k 20:20 l and m, these 20:20 n, n 40:20 output: once round, as the reducer.
    """
    gears = {
        "i": Gear("input", 20), "k": Gear("first", 40), "kk": Gear("first", 20),
        "l": Gear("l shaft", 20), "m": Gear("m shaft", 20),
        "ll": Gear("l shaft", 25, 1.6, sense=-1), "mm": Gear("m shaft", 20),
        "nl": Gear("second", 25, 1.6, sense=-1), "nm": Gear("second", 20), "nn": Gear("second", 40),
        "o": Gear("output", 20),
    }  # fmt: skip
    links: dict[str, split.Mesh | split.Reducer] = {
        "beside": Reducer("input", "output", 1.0, np.zeros(1)),
        "begin": mesh("i", "k", 30, 60.0),
        "l in": mesh("kk", "l", 90, 40.0),
        "m in": mesh("kk", "m", -60, 40.0),
        "l out": mesh("ll", "nl", 180, 40.0),
        "m out": mesh("mm", "nm", 180, 40.0),
        "end": mesh("nn", "o", 270.0, 60.0),
    }
    return Drawing(gears, links, 1.0)


# thickness and clocking by hand ---------------------------------------------------------------------------------


def told(model: Model, block: Trials, name: str) -> np.ndarray:
    """A contributor of one component [mm or rad], (n,)."""
    return block.deviations[:, model.component_slices[name]][:, 0]


def plays(model: Model, block: Trials, side: str) -> np.ndarray:
    """Free turn of the bull gear on one path by thicknesses alone [rad]: what both teeth lack, over the driven arm."""
    fast = told(model, block, "sun thickness") + told(model, block, f"{side} wheel thickness")
    slow = told(model, block, "bull thickness") + told(model, block, f"{side} pinion thickness")
    return -fast * COS / ARMS["wheel"] * SLOW - slow * COS / ARMS["bull"]


def both_methods(model: Model, block: Trials) -> Mapping[str, np.ndarray]:
    found = gear_columns(model, exact_engine(model), block)
    return {method: found[f"{method}:lost motion"] / ARCMIN for method in ("analytic", "geometric")} | dict(found)


def test_by_thickness_alone_the_tighter_load_path_decides(tmp_path: Path) -> None:
    model = model_of(tmp_path, split_stage().text(tolerances("thickness", *ALL)))
    block = drawn_trials(model, 1, 0, 500)
    left, right = (plays(model, block, side) for side in SIDES[:2])
    assert 0.3 < (left < right).mean() < 0.7
    found = both_methods(model, block)
    for method in ("analytic", "geometric"):
        assert np.abs(found[method] - np.minimum(left, right)).max() < AGREES, method


def test_clocking_shifts_what_each_load_path_leaves_free(tmp_path: Path) -> None:
    """Gears that sit ahead: a wheel leaves its shaft behind, and the bull gear goes on by 19/41 of that; a pinion
    takes it back by as much. What sun and bull gear do they do to both load paths alike."""
    lines = [*tolerances("thickness", *ALL), *tolerances("clocking", *ALL)]
    model = model_of(tmp_path, split_stage().text(lines))
    block = drawn_trials(model, 2, 0, 500)
    shifts = {
        side: SLOW * (told(model, block, f"{side} wheel clocking") - told(model, block, f"{side} pinion clocking"))
        for side in SIDES[:2]
    }  # fmt: skip
    halves = {side: plays(model, block, side) / 2 for side in SIDES[:2]}
    low = np.max([shifts[side] - halves[side] for side in SIDES[:2]], axis=0)
    high = np.min([shifts[side] + halves[side] for side in SIDES[:2]], axis=0)
    found = both_methods(model, block)
    for method in ("analytic", "geometric"):
        assert np.abs(found[method] - (high - low)).max() < AGREES, method
    shifted = np.minimum(halves["left"], halves["right"]) * 2 - (high - low)
    assert (shifted > 1e-5).mean() > 0.5  # in the others one interval lies within the other


THICKNESS = 0.05  # mm that each gear lacks
FREE = 2 * THICKNESS * COS * (SLOW / ARMS["wheel"] + 1 / ARMS["bull"])
"""Play of either load path [rad], where each gear lacks that."""


def constants(*gears: str) -> list[str]:
    law = f"distribution: {{kind: constant, value: {-1e3 * THICKNESS} um}}"
    return [f"  {gear} thickness: {{kind: tooth_thickness, of: {gear}, {law}}}" for gear in gears]


def test_ways_bind_as_often_as_one_pinion_sits_beyond_the_play(tmp_path: Path) -> None:
    """Both paths free alike; the pinion's clocking, normal, shifts one by 19/41 of it: they bind beyond the play."""
    trials, sigma = 100_000, FREE / SLOW / 2.2
    clocking = f"  right pinion clocking: {{kind: clocking, of: right pinion, distribution: {{kind: normal, mean: 0 rad, sigma: {sigma!r} rad}}}}"  # noqa: E501
    model = model_of(tmp_path, split_stage().text([*constants(*ALL), clocking]))
    block = drawn_trials(model, 3, 0, trials)
    found = both_methods(model, block)
    share = 2 * norm.sf(2.2)
    assert set(found["status"]) == {"ok", "interferes"}
    tight = found["status"] == "interferes"
    assert abs(tight.sum() - trials * share) <= 4 * math.sqrt(trials * share * (1 - share))
    wanted = FREE - SLOW * np.abs(told(model, block, "right pinion clocking"))
    beside = np.abs(wanted) > AGREES  # of a trial that is on the edge either may be said
    assert np.array_equal(tight[beside], wanted[beside] < 0)
    for method in ("geometric", "analytic"):  # what binds is less than nothing by what the load paths lack
        assert np.abs(found[method] - wanted).max() < AGREES


# the mechanism, turned to its ends -------------------------------------------------------------------------------

POSITIONS = (0.0, 37.0, 222.0, 1000.0)
OUTPUT = [
    "  output clearance: {kind: bearing_clearance, of: output bearing, direction: random, "
    "distribution: {kind: uniform, lower: 4 um, upper: 20 um}}"
]
RUN_OUT = ["  {0} run-out: {{kind: run_out, of: {0}, distribution: {{kind: rayleigh, scale: 4 um}}}}"]


def against_mechanism(
    drawing: Drawing, lines: Sequence[str], folder: Path, seed: int, *, as_meshes: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Results of tol3d and play of the mechanism [rad], 50 random builds at each of four positions."""
    each = []
    for degrees in POSITIONS:
        model = model_of(folder, drawing.text(lines, over=f"{{at: {degrees} deg}}"))
        block = drawn_trials(model, seed, 0, 50)
        low, high = drawing.mechanism(model, block, degrees).reach("output", as_meshes=as_meshes)
        each.append((lost_motion(model, block), high - low))
    found, wanted = (np.concatenate(own) for own in zip(*each, strict=True))
    assert wanted.min() > 1e-4
    return found, wanted


def with_idlers(azimuth: float) -> Drawing:
    """A pinion, an idler on either side, and their mate beyond: no gear can be turned on its shaft.

    Round the four mesh points the pinion and its mate count 2 azimuth forward, the idlers 180 deg - 2 azimuth back:
    20 and 30 teeth come out whole where 200/360 of the azimuth is.
    """
    gears = {"sun": Gear("input", 20), "bull": Gear("output", 20)}
    links = {}
    for side, sign in zip(SIDES[:2], (1, -1), strict=True):
        gears[f"{side} idler"] = Gear(side, 30)
        links[f"{side} fast"] = mesh("sun", f"{side} idler", sign * azimuth, 50.0)
        links[f"{side} slow"] = mesh(f"{side} idler", "bull", -2 * sign * azimuth, 50.0)
    return Drawing(gears, links, 1.0)


STAGES = {
    "even teeth": split_stage((20, 40, 20, 40)),
    "no teeth alike": split_stage((24, 56, 19, 41)),
    "not opposite": split_stage((24, 56, 19, 41), (-35.0, 77.0)),
    "bull gears that look both ways": two_output_gears(),
}


@pytest.mark.parametrize("stage", STAGES)
def test_lost_motion_is_what_the_mechanism_leaves_free(stage: str, tmp_path: Path) -> None:
    """Axes anywhere, the held sun off its centre, gears turned on their shafts: there it is exact."""
    drawing = STAGES[stage]
    lay = [name for name, gear in drawing.gears.items() if gear.shaft in SIDES]
    lines = [*tolerances("thickness", *drawing.gears), *tolerances("clocking", *lay), *tolerances("axis", *lay)]
    lines += [*tolerances("eccentricity", "sun"), *OUTPUT]
    found, wanted = against_mechanism(drawing, lines, tmp_path, 4, as_meshes=False)
    assert np.abs(found - wanted).max() < AGREES


@pytest.mark.slow
@pytest.mark.parametrize("stage", [*STAGES, "idlers"])
def test_eccentric_gears_are_seen_alike_by_both_load_paths(stage: str, tmp_path: Path) -> None:
    """The bull gear's centre and its shaft's, one vector that both meshes see from their own side."""
    drawing = with_idlers(50.4) if stage == "idlers" else STAGES[stage]
    lines = [*tolerances("thickness", *drawing.gears), *tolerances("eccentricity", *drawing.gears)]
    lines += [*OUTPUT, *(line.format(shaft) for line in RUN_OUT for shaft in ("left", "output"))]
    found, wanted = against_mechanism(drawing, lines, tmp_path, 5, as_meshes=True)
    assert np.abs(found - wanted).max() < AGREES
    # a mesh is seated with its driver where it would be without deviations: off by what has turned, less than 6 mrad
    # of a lay shaft, times what turns with the shafts off their centres, up to 20 um on each
    found, wanted = against_mechanism(drawing, lines, tmp_path, 5, as_meshes=False)
    assert np.abs(found - wanted).max() < 2 * 6e-3 * 0.02 * (1 / 18.0 + 1 / 28.0)  # of no drawing the arms are less


@pytest.mark.slow
@pytest.mark.parametrize("flanks", list(product(("right", "left"), repeat=4)))
def test_it_does_not_matter_which_flanks_work(flanks: tuple[str, ...], tmp_path: Path) -> None:
    drawing = replace(split_stage(), flanks=dict(zip(split_stage().links, flanks, strict=True)))
    lines = [*tolerances("thickness", *ALL), *tolerances("clocking", *LAY), *tolerances("axis", *LAY)]
    model = model_of(tmp_path, drawing.text([*lines, *tolerances("eccentricity", "sun"), *OUTPUT]))
    block = drawn_trials(model, 6, 0, 20)
    plain = model_of(tmp_path, split_stage().text([*lines, *tolerances("eccentricity", "sun"), *OUTPUT]))
    assert np.abs(lost_motion(model, block) - lost_motion(plain, block)).max() < AGREES


def test_ways_that_are_alike_leave_what_one_of_them_does(tmp_path: Path) -> None:
    lines = tolerances("thickness", "sun", "bull")
    found = []
    for azimuths in ((0.0,), (0.0, 180.0), (0.0, 180.0, 75.0)):
        drawing = split_stage(azimuths=azimuths)
        lay = [name for name, gear in drawing.gears.items() if gear.shaft in SIDES]
        model = model_of(tmp_path, drawing.text([*lines, *constants(*lay)]))
        found.append(lost_motion(model, drawn_trials(model, 7, 0, 200)))
    assert found[0].std() > 1e-5
    assert np.abs(found[1] - found[0]).max() < SAME_TURN
    assert np.abs(found[2] - found[0]).max() < SAME_TURN


# load paths within load paths --------------------------------------------------------------------------------------


def nested_lines(play: str = "lower: 4 arcmin, upper: 12 arcmin", clocking: float = 1.0) -> list[str]:
    gears = list(nested().gears)
    law = f"{{kind: normal, mean: 0 arcmin, sigma: {clocking} arcmin}}"
    return [
        *tolerances("thickness", *gears), *tolerances("axis", "l", "ll", "m", "mm"), *tolerances("eccentricity", "i"),
        f"  mm clocking: {{kind: clocking, of: mm, distribution: {law}}}",
        f"  beside play: {{kind: reducer_backlash, of: beside, distribution: {{kind: uniform, {play}}}}}",
    ]  # fmt: skip


@pytest.mark.parametrize("play", ["lower: 4 arcmin, upper: 12 arcmin", "lower: 80 arcmin, upper: 90 arcmin"])
def test_a_load_path_may_part_again_and_may_be_a_reducer(play: str, tmp_path: Path) -> None:
    found, wanted = against_mechanism(nested(), nested_lines(play), tmp_path, 8, as_meshes=False)
    assert np.abs(found - wanted).max() < AGREES


def test_ways_within_ways_may_bind_though_the_outer_ones_are_free(tmp_path: Path) -> None:
    drawing = nested()
    lines = nested_lines("lower: 80 arcmin, upper: 90 arcmin", clocking=45.0)
    model = model_of(tmp_path, drawing.text(lines, over="{at: 0 deg}"))
    block = drawn_trials(model, 9, 0, 300)
    mechanism = drawing.mechanism(model, block, 0.0)
    before, inner, outer = (
        high - low for low, high in (mechanism.reach(shaft) for shaft in ("first", "second", "output"))
    )
    inner = inner - before  # what is free of the first shaft the second has at least, turn for turn
    assert ((inner < -AGREES) & (outer > AGREES)).sum() > 10
    status = gear_columns(model, exact_engine(model), block)["status"]
    assert np.array_equal(status == "interferes", (inner < 0) | (outer < 0))


def test_the_input_goes_by_the_ratio_further_while_the_output_is_held(tmp_path: Path) -> None:
    lines = [*tolerances("thickness", *ALL), *tolerances("clocking", *LAY), *tolerances("eccentricity", *ALL)]
    down = model_of(tmp_path, split_stage().text(lines))
    up = model_of(tmp_path, split_stage().text(lines, held="output", shaft="input"))
    block = drawn_trials(down, 10, 0, 200)
    ratio = split_stage().ratio
    assert lost_motion(up, block) == pytest.approx(ratio * lost_motion(down, block), rel=1e-12)


# first order -------------------------------------------------------------------------------------------------------


def test_the_stack_up_is_off_by_squares_only(tmp_path: Path) -> None:
    """Centres aside by s at a mesh of distance a: j and the rest bend by s^2/(a sin(alpha)) each at most, and a gear
    off its centre by e that turns from flank to flank by g adds e g. Either end of either path may be off by that."""
    lines = [line for kind in ("thickness", "eccentricity", "clocking") for line in tolerances(kind, *ALL)]
    model = model_of(tmp_path, split_stage().text([*lines, *tolerances("axis", *LAY), *OUTPUT]))
    block = drawn_trials(model, 11, 0, 2000)
    found = both_methods(model, block)

    def length(name: str) -> np.ndarray:
        return np.hypot(*block.deviations[:, model.component_slices[name]].T)

    bound = np.zeros(len(block))
    for side, (driver, driven, arm, factor) in product(
        SIDES[:2], (("sun", "wheel", ARMS["wheel"], SLOW), ("pinion", "bull", ARMS["bull"], 1.0))
    ):
        first, last = (name if name in ("sun", "bull") else f"{side} {name}" for name in (driver, driven))
        own, shifts = (length(f"{name} eccentricity") for name in (first, last)), f"{side} {driver} axis"
        eccentric = sum(own)
        aside = eccentric + length(f"{last} axis" if last in LAY else "output clearance") / 2
        aside = aside + (length(shifts) / 2 if first in LAY else 0.0)
        free = 2 * 0.08 / arm  # rad; teeth lack some 0.1 mm, and axes open by less than 0.06 mm
        bound += factor / arm * 2 * (aside**2 / (60.0 * SIN) + eccentric * free)
    error = np.abs(found["geometric"] - found["analytic"])
    assert (error <= bound).all()
    assert error.max() > 1e-8  # and there is such an error
    assert np.median(bound) < 0.01 * np.median(found["geometric"])


PAIR = """
scene: a pair
parts:
  driver: {{kind: {kind}_gear, teeth: 20, module: 3 mm, face_width: 10 mm}}
  driven: {{kind: {kind}_gear, teeth: 33, module: 3 mm, face_width: 10 mm}}
tolerances:
  thickness: {{kind: tooth_thickness, of: driver, distribution: {{kind: constant, value: -100 um}}}}
  driver centre: {{kind: eccentricity, of: driver, distribution: {{kind: rayleigh, scale: 1 um}}}}
  driven centre: {{kind: eccentricity, of: driven, distribution: {{kind: rayleigh, scale: 1 um}}}}
  driver axis: {{kind: bearing_clearance, of: driver, direction: random, distribution: {{kind: rayleigh, scale: 1 um}}}}
  driven axis: {{kind: bearing_clearance, of: driven, direction: random, distribution: {{kind: rayleigh, scale: 1 um}}}}
{more}
moves:
  pair: {{kind: {kind_of_mesh}, driver: driver, driven: driven, azimuth: 25 deg, working_flank: {flank}{where}}}
measures:
  play: {{kind: angular_backlash, of: pair}}
"""
SPUR = {
    "kind": "spur", "kind_of_mesh": "mesh", "where": ", centre_distance: 79.6 mm",
    "more": """
  in plane: {kind: axis_in_plane, of: pair, distribution: {kind: normal, mean: 0 um, sigma: 1 um}}
  across: {kind: axis_out_of_plane, of: pair, distribution: {kind: normal, mean: 0 um, sigma: 1 um}}
""",
}  # fmt: skip
BEVEL = {
    "kind": "bevel", "kind_of_mesh": "bevel_mesh", "where": ", shaft_angle: 80 deg",
    "more": "  past: {kind: axes_offset, of: pair, distribution: {kind: normal, mean: 0 um, sigma: 1 um}}",
}  # fmt: skip
STEP = 0.01  # mm


def middles(model: Model, moved: Mapping[str, tuple[float, ...]]) -> tuple[np.ndarray, np.ndarray]:
    """Offset of the middle of the driven gear's play [mm], (positions,), by the contact and by the stack-up."""
    (own,), (measure,), positions = model.meshes, model.measures, 40
    row = np.zeros(model.component_count)
    for name, values in {"thickness": (-0.2,), **moved}.items():
        row[model.component_slices[name]] = values
    block = Trials(np.tile(row, (positions, 1)), {own.name: 0.3 + np.arange(positions) * 2 * np.pi / 150})
    kind = of_kind(Backlash, measure.kind)
    seats, key = seated(model, exact_engine(model), block), seat_key(model, measure, kind)
    resting = replace(kind, quantity="rest_angle")
    rest, play = (measure_backlash(each, seats.meshings[key], seats.seats[key]) for each in (resting, kind))
    stacked = analytic_backlash(model, resting, block.deviations, block.positions[own.name])
    arm = own.pair.wheel.section_arm
    return (rest + own.working_flank * play / 2) * arm, stacked * arm


@pytest.mark.slow
@pytest.mark.parametrize("flank", ["right", "left"])
@pytest.mark.parametrize(
    ("pair", "name", "values"),
    [
        (pair, f"{gear} {what}", values)
        for pair in ("spur", "bevel")
        for gear in ("driver", "driven")
        for what in ("centre", "axis")
        for values in ((STEP, 0.0), (0.0, STEP))
    ]
    + [("bevel", "past", (STEP,))],
)
def test_both_rests_go_aside_as_the_stack_up_says(
    pair: str, name: str, values: tuple[float, ...], flank: str, tmp_path: Path
) -> None:
    """A spur pair's to first order; a bevel pair's normals differ within a pitch, by up to 10 % of a shift."""
    numbers = {"spur": SPUR, "bevel": BEVEL}[pair]
    seen, said = middles(model_of(tmp_path, PAIR.format(**numbers, flank=flank)), {name: values})
    reach = STEP if "centre" in name or name == "past" else STEP / 2
    assert np.abs(said).max() <= reach
    allowed = reach**2 / (79.6 * SIN) + reach * 0.2 / 30 if pair == "spur" else 0.1 * reach
    assert np.abs(seen - said).max() < allowed
    moved = {"centre": COS * STEP / math.sqrt(2), "past": COS * STEP}.get(name.split()[-1], 0.0)
    assert math.sqrt((seen**2).mean()) == pytest.approx(moved, rel=0.35) if moved else True


@pytest.mark.parametrize(("in_plane", "across"), [(STEP, STEP), (STEP, -STEP), (-STEP / 3, STEP), (0.0, STEP)])
def test_a_gear_that_leans_both_ways_rests_aside(in_plane: float, across: float, tmp_path: Path) -> None:
    """On one flank side half a face loses both leans, on the other their difference; a length counts over the face."""
    model = model_of(tmp_path, PAIR.format(**SPUR, flank="right"))
    seen, said = middles(model, {"in plane": (in_plane,), "across": (across,)})
    cos = 79.5 * COS / 79.6
    a, b = math.sqrt(1 - cos**2) * in_plane / 2, cos * across / 2
    wanted = (abs(a + b) - abs(a - b)) / 2
    assert said == pytest.approx(wanted, abs=1e-12)
    assert np.abs(seen - wanted).max() < 2e-5  # mm; squares: a lean of 1 mrad, and the play that it leaves


def test_gears_that_lean_alike_lose_nothing_of_their_backlash(tmp_path: Path) -> None:
    shafts = """
  upright: {kind: shaft, carries: {driver: {}}}
  other: {kind: shaft, carries: {driven: {}}}
  low: {kind: bearing, shaft: upright, at: -20 mm}
  high: {kind: bearing, shaft: upright, at: 20 mm}
  other low: {kind: bearing, shaft: other, at: -20 mm}
  other high: {kind: bearing, shaft: other, at: 20 mm}
tolerances:
"""
    law = "direction: {{at: {at} deg}}, distribution: {{kind: constant, value: 40 um}}"
    lines = "".join(
        f"  {name} clearance: {{kind: bearing_clearance, of: {name}, {law.format(at=at)}}}\n"
        for name, at in (("low", 225), ("high", 45), ("other low", 200), ("other high", 20))
    )  # fmt: skip
    text = PAIR.format(**SPUR, flank="right").replace("tolerances:\n", shafts[1:] + lines)
    model = model_of(tmp_path, text)
    block = drawn_trials(model, 1, 0, 5)
    block = replace(block, deviations=np.where(np.abs(block.deviations) < 0.03, 0.0, block.deviations))
    found = gear_columns(model, exact_engine(model), block)
    assert np.abs(found["geometric:play"] - found["analytic:play"]).max() < 0.02  # arcmin; a lean of 20 um takes 0.5


# derivatives -------------------------------------------------------------------------------------------------------

DEVIATION = 1e-6  # mm or rad; 1 nm, over which kinks are rare; contacts that differ by so little end their steps alike


@pytest.mark.parametrize("drawing", ["split", "nested"])
def test_derivatives_are_those_of_two_simulations(drawing: str, tmp_path: Path) -> None:
    if drawing == "split":
        kinds = ("thickness", "eccentricity", "clocking")
        lines = [*(line for kind in kinds for line in tolerances(kind, *ALL)), *tolerances("axis", *LAY), *OUTPUT]
        model = model_of(tmp_path, split_stage().text(lines))
    else:
        model = model_of(tmp_path, nested().text(nested_lines()))
    (measure,), block, engine = model.measures, drawn_trials(model, 12, 0, 6), exact_engine(model)
    rates, count = sensitivities(model, engine, block, measure), model.component_count

    def taken(sign: float) -> np.ndarray:
        rows = (block.deviations[:, None] + sign * DEVIATION * np.eye(count)).reshape(-1, count)
        angles = {name: np.repeat(angle, count) for name, angle in block.positions.items()}
        return lost_motion(model, Trials(rows, angles)).reshape(len(block), count)

    differences = (taken(1.0) - taken(-1.0)) / (2 * DEVIATION)
    largest = np.abs(differences).max(axis=1, keepdims=True)
    assert (largest > 0).all()
    assert np.abs(rates - differences).max() < 1e-4 * largest.max()


# what does not fit -------------------------------------------------------------------------------------------------


# what does not fit -------------------------------------------------------------------------------------------------

STAGE = (SCENES / "split_train.yaml").read_text(encoding="utf-8")
SKEW = "driver: right pinion, driven: bull, centre_distance: 60 mm, azimuth: 170"
BAD = {
    "load paths of other ratios": (
        {
            "right wheel: {kind: spur_gear, teeth: 56": "right wheel: {kind: spur_gear, teeth: 58",
            "driven: right wheel, centre_distance: 60 mm": "driven: right wheel, centre_distance: 61.5 mm",
        },
        "  right slow:",
        "moves.right slow: a loop of shafts that locks: 'output' turns 0.191758 times with 'input' here and 0.198606 "
        "times by 'left slow'; give both load paths one ratio, or take out one",
    ),
    "a load path that ends elsewhere": (
        {"driver: right pinion, driven: bull, centre_distance: 60 mm, azimuth: 180": SKEW},
        "  right slow:",
        f"moves.right slow: the load paths to 'output' do not fit: here it lies "
        f"{120 * math.sin(math.radians(5)):.3f} mm and 0.000 deg from where "
        "'left slow' puts it; check azimuths, centre distances and places on the shafts",
    ),
    "two motors": (
        {
            "  output bearing:": "  other motor: {kind: shaft}\n  output bearing:",
            "moves:\n": "moves:\n  other drive: {kind: reducer, driver: other motor, driven: output, ratio: 5}\n",
        },
        "  left slow:",
        "moves.left slow: two drivers: 'output' is driven by 'left' here and by 'other motor' in 'other drive', "
        "and these are not driven together; turn driver and driven round, or take out one",
    ),
    "a ring of three shafts": (
        {"moves:\n": "moves:\n  back: {kind: reducer, driver: output, driven: input, ratio: 5}\n"},
        "  back:",
        "moves.back: a loop of shafts: 'input' → 'left' → 'output' → 'input'; no motor can turn them: take out a link",
    ),
}


def said_of(
    text: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> tuple[int, str]:
    """Output of `tol3d run` for a scene, and its exit code."""
    scene = folder / "bad.yaml"
    scene.write_text(text, encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["tol3d", "run", str(scene), "--out", str(folder / "run")])
    with pytest.raises(SystemExit) as stop:
        main()
    out, err = capfd.readouterr()
    assert out == ""
    return int(stop.value.code or 0), err.removeprefix(f"{scene}:")


@pytest.mark.parametrize("what", BAD)
def test_ways_that_do_not_fit_get_one_message_with_its_line(
    what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    changes, place, words = BAD[what]
    text = STAGE
    for old, new in changes.items():
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    code, said = said_of(text, tmp_path, monkeypatch, capfd)
    assert code == 2
    (message,) = said.splitlines()
    assert message == f"{text[: text.index(place)].count(chr(10)) + 1}: {words}"


@pytest.mark.parametrize(("azimuth", "gap"), [(50.4, 0.0), (51.3, math.pi), (50.85, math.pi / 2)])
def test_idlers_whose_teeth_miss_their_mates_are_refused(azimuth: float, gap: float, tmp_path: Path) -> None:
    """Half a pitch of module 2 mm where 200/360 of the azimuth is a half beyond a whole number."""
    text = with_idlers(azimuth).text(tolerances("thickness", "sun"))
    if not gap:
        assert model_of(tmp_path, text).layout.ratio("input", "output") == 1
        return
    with pytest.raises(SceneError, match=r"moves.right slow: the teeth of 'right idler' and 'bull' do not fit") as said:
        model_of(tmp_path, text)
    assert f"miss each other by {gap:.3f} mm" in str(said.value)


# the scene that ships -----------------------------------------------------------------------------------------------

EXPECTED, MEASURES = expected("split_train"), measures_of("split_train")
SEEN = 2e-5  # um; where the exact engine's steps end, 1e-8 mm, and another machine's bits


@pytest.fixture(scope="module")
def split_run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    overrides = Overrides(trials=EXPECTED["trials"], witness=0)
    return run_scene(SCENES / "split_train.yaml", overrides=overrides, out=tmp_path_factory.mktemp("runs") / "split")


def test_the_split_trains_expected_mean_and_closed_form_follow_by_hand() -> None:
    """Thicknesses in um: half of sums of limits; the pinions sit 5 arcmin apart, else the paths are alike."""
    slow, fast = (46 + 56) * COS, (42 + 49) * COS
    squares = COS**2 * (2**2 + (16 / 6) ** 2) + (2 * SIN) ** 2 * (2**2 + 3**2)
    squares += (SIN * COS_OF_RANDOM) ** 2 * (100 + 20 + 4) / 3
    for side in SIDES[:2]:
        own = MEASURES[f"{side} normal backlash"]
        assert own["mean_build"]["analytic"] == pytest.approx(slow, abs=PRINTED)
        assert own["closed_form"]["mean"] == pytest.approx(slow, abs=PRINTED)
        assert own["closed_form"]["sigma"] == pytest.approx(math.sqrt(squares), abs=PRINTED)
    free = (fast / ARMS["wheel"] * SLOW + slow / ARMS["bull"]) * 1e-3 * ARCMIN - 5 * SLOW
    assert MEASURES["lost motion"]["mean_build"]["analytic"] == pytest.approx(free, abs=PRINTED)


COS_OF_RANDOM = math.sqrt(0.5)  # root of the mean square of the cosine


def test_the_split_train_meets_its_expected_numbers(split_run: Run) -> None:
    summary = split_run.summary
    trials = EXPECTED["trials"]
    assert summary["status"] == {"ok": trials, "interferes": 0, "no contact": 0, "out of range": 0}
    assert summary["warnings"] == []
    assert list(MEASURES) == list(summary["measures"])
    for name, own in MEASURES.items():
        found = summary["measures"][name]
        assert_met(found, own, PRINTED + SEEN)
        assert ("analytic_closed_form" in found) == ("closed_form" in own)
    shares = [row["name"] for row in summary["measures"]["lost motion"]["contributors"]]
    assert {"left clocking", "right clocking"} <= set(shares)


def test_how_pinions_sit_on_lay_shafts_matters_most_in_the_split_train(split_run: Run) -> None:
    """Either one's share within four standard errors of its part in the variance by hand: 4'/3 of 19/41, squared."""
    measure = split_run.summary["measures"]["lost motion"]
    wanted = (4 / 3 * SLOW) ** 2 / measure["geometric"]["sigma"] ** 2
    shares = {row["name"]: row["geometric_percent"] / 100 for row in measure["contributors"]}
    first, second, *_ = sorted(shares.values(), reverse=True)
    assert {shares["left clocking"], shares["right clocking"]} == {first, second}
    trials = EXPECTED["trials"]
    # of a share, and of the sample's variance that it is a part of
    allowed = 4 * (math.sqrt(wanted * (1 - wanted) / trials) + wanted * math.sqrt(2 / trials))
    assert abs(first - wanted) <= allowed
    assert abs(second - wanted) <= allowed


@pytest.mark.slow
def test_fcl_finds_the_split_trains_lost_motion_as_well(tmp_path: Path) -> None:
    run = run_scene(SCENES / "split_train.yaml", overrides=Overrides(trials=EXPECTED["trials"]), out=tmp_path / "run")
    witness = run.summary["witness"]
    assert run.summary["warnings"] == []
    assert witness["status_differences"] == 0
    assert witness["trials"] == load_scene(SCENES / "split_train.yaml").study.witness
    for name, own in witness["measures"].items():
        assert own["compared"] == witness["trials"]
        assert own["max_abs_difference"] <= own["expected_at_most"] + own["allowance"], name
        assert own["mean_difference"] > 0, name  # chords lie inside of teeth
