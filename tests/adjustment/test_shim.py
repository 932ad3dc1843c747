"""The thickness of shims for a wanted minimum: the paper's, other cones, the stock, the scene that is written.

Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, section 4: the low of 70 um is to become 24 um; two shims of
0.048 mm behind the bevel gears.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from fixtures import Command
from gear_trials import model_of_scene
from hypothesis import given
from hypothesis import strategies as st
from of_kind import known
from places import SCENES
from scene_texts import scene_of

from tol3d import Overrides, Scene, load_scene, run_scene
from tol3d.apps.adjustment import Pieces, ShimPlan, ShimQuestion, Step, Stock, shim_plan, stock_of
from tol3d.apps.adjustment.shim import closing_of, formula_thickness
from tol3d.apps.adjustment.shim_choice import MINIMUM_XTOL, shims_of
from tol3d.apps.adjustment.stock import nearest
from tol3d.errors import InputError
from tol3d.scene.edit import with_tolerances, write_scene

BEVEL, SHIMMED, EVERY, SPUR = (
    str(SCENES / f"{name}.yaml") for name in ("bevel_pair", "bevel_pair_shimmed", "every_bevel_field", "spur_pair")
)
SIN = math.sin(math.radians(20.0))
PAPERS = 2 * math.sqrt(2) * SIN  # of both shims together, equal gears at 90 deg
UM = 1e-3  # mm
PROMISED = 0.01 * UM  # "each to 0.01 um"

CONES = """\
scene: 17 to 43
parts:
  pinion: {kind: bevel_gear, teeth: 17, module: 2 mm, pressure_angle: 20 deg, face_width: 8 mm}
  wheel: {kind: bevel_gear, teeth: 43, module: 2 mm, pressure_angle: 20 deg, face_width: 8 mm}
tolerances:
  pinion teeth: {kind: tooth_thickness, of: pinion, distribution: {kind: normal, lower: -60 um, upper: -40 um}}
  wheel teeth: {kind: tooth_thickness, of: wheel, distribution: {kind: normal, lower: -60 um, upper: -40 um}}
moves:
  pair: {kind: bevel_mesh, driver: pinion, driven: wheel}
measures:
  play: {kind: normal_backlash, of: pair, tooth: driven}
study: {trials: 2000, seed: 4}
"""


@cache
def plan(scene: str = BEVEL, target: float = 24.0, **asked: Any) -> ShimPlan:
    """The plan for a target [um]."""
    return shim_plan(load_scene(Path(scene)), ShimQuestion(target * UM, **asked))


def written(folder: Path, text: str) -> Scene:
    return scene_of(text, folder)


def low_of(scene: Scene, folder: Path, measure: str = "normal backlash") -> float:
    """Mean - 3 sigma on the geometric method [mm], as a run of the scene says it."""
    run = run_scene(scene, overrides=Overrides(witness=0), out=folder / "run")
    return UM * run.summary["measures"][measure]["geometric"]["low_3sigma"]


# the paper ----------------------------------------------------------------------------------------


def test_46_um_take_two_shims_of_47_55_um() -> None:
    scene = load_scene(Path(BEVEL))
    shims = shims_of(scene, model_of_scene(scene).mesh("bevel pair"), ())
    assert [(shim.spec.of, shim.spec.side, shim.mean, shim.is_new) for shim in shims] == [
        ("driver", "behind", 0.0, True),
        ("driven", "behind", 0.0, True),
    ]
    assert closing_of(shims) == pytest.approx(PAPERS, rel=1e-12)
    thickness = formula_thickness(70 * UM - 24 * UM, shims)
    assert thickness == pytest.approx(47.551 * UM, abs=0.001 * UM)
    assert (nearest(Step(0.001), thickness), Step(0.001).below(thickness)) == (
        0.048,
        0.047,
    )  # the paper rounds to nearest


def test_what_shims_take_that_are_on_is_counted() -> None:
    scene = load_scene(Path(SHIMMED))
    shims = shims_of(scene, model_of_scene(scene).mesh("bevel pair"), ())
    # 48 um are on, and 10 um too much is left
    assert formula_thickness(10 * UM, shims) == pytest.approx(48 * UM + 10 * UM / PAPERS, rel=1e-12)


def test_the_paper_shim_takes_46_um_of_the_low() -> None:
    own = plan(rounding="nearest")
    form = own.before.measure.analytic_closed_form
    assert form
    assert (form.mean, form.sigma) == pytest.approx((89.5, 6.7), abs=0.05)
    assert own.chosen.thickness == 0.048
    # 46.33 um: tests/gearing/test_bevel_agreement.py, at one position and without deviations; where in its pitch a
    # trial stands adds a tenth of a um (46.43 to first order, at the pitch point)
    assert own.before.minimum - own.chosen.minimum == pytest.approx(46.33 * UM, abs=0.1 * UM)
    # mean 89.55, sigma 6.66 less the offset of the axes, of 2000 trials: 3 standard errors are 1.05 um
    assert own.before.minimum == pytest.approx(70.0 * UM, abs=1.1 * UM)


@pytest.mark.slow
def test_by_formula_is_the_excess_over_the_papers_factor() -> None:
    own = plan()
    assert own.by_formula.thickness == pytest.approx((own.before.minimum - 24 * UM) / PAPERS, abs=1e-9)


# the geometry -------------------------------------------------------------------------------------

ASKED: Mapping[str, tuple[str, float, Mapping[str, str]]] = {
    "low": (BEVEL, 24.0, {}),
    "quantile": (BEVEL, 24.0, {"minimum": "p0.135"}),
    "smallest": (BEVEL, 24.0, {"minimum": "sample_min"}),
    "smallest, at nothing": (BEVEL, 0.0, {"minimum": "sample_min"}),
    "there already": (SHIMMED, 40.0, {}),
}


@pytest.mark.slow
@pytest.mark.parametrize("what", ASKED)
def test_the_geometrys_thickness_meets_the_target(what: str) -> None:
    scene, target, asked = ASKED[what]
    found = plan(scene, target, **asked).by_geometry
    assert found.minimum == pytest.approx(target * UM, abs=PROMISED)
    assert found.failed == 0


def test_the_chosen_thickness_is_verified_by_a_run_of_the_scene_with_it(tmp_path: Path) -> None:
    own = plan()
    write_scene(own.scene, tmp_path / "shimmed.yaml")
    assert low_of(load_scene(tmp_path / "shimmed.yaml"), tmp_path) == pytest.approx(own.chosen.minimum, abs=1e-12)
    assert own.chosen.minimum >= own.question.target
    assert own.other is not None
    assert own.other.minimum < own.question.target


def test_the_minimum_falls_as_shims_grow() -> None:
    own = plan()
    assert own.other is not None
    studies = sorted((own.by_formula, own.by_geometry, own.chosen, own.other), key=lambda study: known(study.thickness))
    lows = [own.before.minimum, *(study.minimum for study in studies)]
    assert lows == sorted(lows, reverse=True)
    assert len({round(low, 6) for low in lows}) == len(lows)


@pytest.mark.slow
def test_shims_that_are_there_are_found_again() -> None:
    """The same trials, from 48 um on instead of from none: the same thickness."""
    new, there = plan(), plan(SHIMMED)
    assert [shim.mean for shim in there.shims] == [0.048, 0.048]
    assert there.by_geometry.thickness == pytest.approx(new.by_geometry.thickness, abs=2 * MINIMUM_XTOL / PAPERS)
    assert list(there.tolerances) == ["driver shim", "driven shim"] == list(new.tolerances)


CONE = math.atan(17 / 43)
BESIDE = math.cos(math.radians(20.0)) * math.cos(CONE) * math.pi / (2 * 43)
"""Contact azimuth of a driven tooth in the middle of its space, from the pitch line [rad]: its half angle
pi / (2 z2) times the sine of its base cone. A shift of an apex along its axis acts there by cos(delta) of that, more or
less: see BevelPair.touching_angle."""

BY_CONES = {
    ("pinion", "wheel"): 2 * SIN * (math.sin(CONE) + math.cos(CONE)) + 2 * BESIDE * (math.sin(CONE) - math.cos(CONE)),
    ("pinion",): 2 * SIN * math.sin(CONE) - 2 * BESIDE * math.cos(CONE),
    ("wheel",): 2 * SIN * math.cos(CONE) + 2 * BESIDE * math.sin(CONE),
}


@pytest.mark.parametrize("gears", BY_CONES)
def test_other_cones_take_2_sin_alpha_sin_delta_each(tmp_path: Path, gears: tuple[str, ...]) -> None:
    own = shim_plan(written(tmp_path, CONES), ShimQuestion(40 * UM, shims=gears))
    sines = {"pinion": math.sin(CONE), "wheel": math.cos(CONE)}
    assert closing_of(own.shims) == pytest.approx(sum(2 * SIN * sines[gear] for gear in gears), rel=1e-12)
    assert own.by_geometry.minimum == pytest.approx(40 * UM, abs=PROMISED)
    taken = own.before.minimum - own.by_geometry.minimum
    # 0.5 %: squares of shims of up to 0.2 mm, and where in its pitch a trial stands
    assert taken / known(own.by_geometry.thickness) == pytest.approx(BY_CONES[gears], rel=0.005)
    # the formula is for the pitch point: both shims within 5 %, the small gear's alone is a quarter off
    assert taken / known(own.by_geometry.thickness) == pytest.approx(
        closing_of(own.shims), rel=0.25 if gears == ("pinion",) else 0.05
    )


@pytest.mark.slow
def test_one_shim_alone_takes_about_half() -> None:
    one = plan(shims=("driver",))
    assert list(one.tolerances) == ["driver shim"]
    assert closing_of(one.shims) == pytest.approx(PAPERS / 2, rel=1e-12)
    # 0.4358, tests/gearing/test_bevel_agreement.py, of one driven tooth in its space; squares of 0.1 mm as above
    taken = one.before.minimum - one.by_geometry.minimum
    assert taken / known(one.by_geometry.thickness) == pytest.approx(0.4358, rel=0.005)


@pytest.mark.slow
def test_shims_that_open_are_rounded_up() -> None:
    asked = ShimQuestion(100 * UM, measure="normal backlash", shims=("wheel shim",))
    own = shim_plan(load_scene(Path(EVERY)), asked, Overrides(engine="exact"))
    assert closing_of(own.shims) < 0.0
    assert own.other is not None
    other, by_geometry, chosen = (known(s.thickness) for s in (own.other, own.by_geometry, own.chosen))
    assert other < by_geometry < chosen
    assert own.other.minimum < own.question.target <= own.chosen.minimum
    assert own.by_geometry.minimum == pytest.approx(100 * UM, abs=PROMISED)


# the stock ----------------------------------------------------------------------------------------

THICKNESSES = st.floats(0.0, 1.0)
STOCKS = st.one_of(
    st.integers(1, 500).map(lambda um: Step(um * UM)),
    st.lists(st.integers(5, 400), min_size=1, max_size=4).map(lambda ums: Pieces(tuple(um * UM for um in ums))),
)


@given(STOCKS, THICKNESSES)
def test_a_thickness_lies_between_its_neighbours_in_the_stock(stock: Stock, thickness: float) -> None:
    below, above = stock.below(thickness), stock.above(thickness)
    assert below <= thickness + 1e-9
    assert above is None or above > thickness
    assert stock.below(below) == below  # it can be had
    assert above is None or stock.above(below) == above  # nothing lies between
    assert abs(nearest(stock, thickness) - thickness) <= min(thickness - below, (above or math.inf) - thickness) + 1e-9


def test_stacks_are_of_three_pieces_at_most() -> None:
    pieces = stock_of("0.05 mm, 0.1 mm,200 um")
    assert (pieces.below(0.6), pieces.below(9.0), pieces.above(0.6)) == (0.6, 0.6, None)
    assert (pieces.below(0.049), pieces.below(0.24), pieces.above(0.25)) == (0.0, 0.2, 0.3)
    assert pieces.words(0.25) == "0.05 mm + 0.2 mm"


def test_a_plan_keeps_to_its_stock() -> None:
    own = plan(stock=stock_of("0.02 mm, 0.03 mm"))
    assert own.other is not None
    assert (own.chosen.thickness, own.other.thickness) == (0.04, 0.05)  # of 48.3 um


# the scene ----------------------------------------------------------------------------------------

LAWS = {
    "{kind: constant, value: 20 um}": "{kind: constant, value: 35 um}",
    "{kind: uniform, lower: 18 um, upper: 22 um}": "{kind: uniform, lower: 33 um, upper: 37 um}",
    "{kind: normal, lower: 17 um, upper: 23 um}": "{kind: normal, lower: 32 um, upper: 38 um}",
    "{kind: normal, mean: 0.02 mm, sigma: 1 um}": "{kind: normal, mean: 0.035 mm, sigma: 1 um}",
    "{kind: triangular, lower: 18 um, mode: 20 um, upper: 22 um}": (
        "{kind: triangular, lower: 33 um, mode: 35 um, upper: 37 um}"
    ),
    "{kind: truncated_normal, mean: 20 um, sigma: 2 um, lower: 17 um, upper: 23 um}": (
        "{kind: truncated_normal, mean: 35 um, sigma: 2 um, lower: 32 um, upper: 38 um}"
    ),
}


def with_law(law: str) -> str:
    shim = f"  # ground\n  pinion shim: {{kind: shim, of: pinion, distribution: {law}}}  # by hand\n"
    return CONES.replace("moves:", f"{shim}moves:")


@pytest.mark.parametrize("law", LAWS)
def test_a_thickness_moves_its_mean_and_keeps_its_spread(tmp_path: Path, law: str) -> None:
    scene = written(tmp_path, with_law(law))
    (shim,) = shims_of(scene, model_of_scene(scene).mesh("pair"), ())
    edited = with_tolerances(scene, {shim.name: shim.of_thickness(0.035)})
    assert re.sub(" +#", " #", edited.text) == re.sub(" +#", " #", with_law(LAWS[law]))  # comments too
    write_scene(edited, tmp_path / "edited.yaml")


def test_a_thickness_of_another_law_is_refused(tmp_path: Path) -> None:
    scene = written(tmp_path, with_law("{kind: rayleigh, scale: 20 um}"))
    with pytest.raises(InputError, match=r"scene\.yaml:9: .*its mean: expected one of constant, .*, got rayleigh"):
        shim_plan(scene, ShimQuestion(40 * UM))


def test_a_scene_without_tolerances_gets_some(tmp_path: Path) -> None:
    bare = CONES[: CONES.index("tolerances:")] + CONES[CONES.index("moves:") :]
    scene = written(tmp_path, with_law("{kind: constant, value: 20 um}"))
    spec = scene.distributed["pinion shim"]
    edited = with_tolerances(written(tmp_path, bare), {"pinion shim": spec})
    write_scene(edited, tmp_path / "edited.yaml")
    assert list(load_scene(tmp_path / "edited.yaml").tolerances) == ["pinion shim"]


def test_what_another_entry_is_an_alias_of_stays(tmp_path: Path) -> None:
    law = "{kind: constant, value: 20 um}"
    text = with_law(f"&thin {law}").replace(
        "moves:", "  wheel shim: {kind: shim, of: wheel, distribution: *thin}\nmoves:"
    )
    scene = written(tmp_path, text)
    (pinions,) = shims_of(scene, model_of_scene(scene).mesh("pair"), ("pinion shim",))
    edited = with_tolerances(scene, {"pinion shim": pinions.of_thickness(0.035)})
    write_scene(edited, tmp_path / "edited.yaml")
    found = load_scene(tmp_path / "edited.yaml").distributed
    assert [str(found[name].distribution.quantities()["value"]) for name in ("pinion shim", "wheel shim")] == [
        "35 um",
        "20 um",
    ]


def test_new_shims_take_names_that_are_free(tmp_path: Path) -> None:
    scene = written(tmp_path, with_law("{kind: constant, value: 20 um}"))
    shims = shims_of(scene, model_of_scene(scene).mesh("pair"), ("pinion", "wheel"))
    assert [shim.name for shim in shims] == ["pinion shim 2", "wheel shim"]


# the command --------------------------------------------------------------------------------------


@pytest.fixture
def shim_command(tol3d: Command) -> Command:
    """Runs `tol3d shim ARGUMENTS`, as `tol3d` does, blanks in stderr as one."""

    def command(*arguments: str) -> tuple[int, str, str]:
        code, out, err = tol3d("shim", *arguments)
        return code, out, " ".join(err.split())

    return command


def test_the_command_prints_lines_that_make_the_scene_it_writes(shim_command: Command, tmp_path: Path) -> None:
    path = tmp_path / "shimmed.yaml"
    code, out, _ = shim_command(BEVEL, "--target-min", "24 um", "--round", "nearest", "--out", str(path))
    assert code == 0
    lines = [line for line in out.splitlines() if "kind: shim" in line]
    assert lines == [
        f"  {gear} shim: {{kind: shim, of: {gear}, side: behind, distribution: {{kind: constant, value: 0.048 mm}}}}"
        for gear in ("driver", "driven")
    ]
    before, after = Path(BEVEL).read_text("utf-8"), path.read_text("utf-8")
    assert [line for line in after.splitlines() if line not in lines] == before.splitlines()
    own = load_scene(path)
    assert (
        own.tolerances.items() >= {name: load_scene(Path(SHIMMED)).tolerances[name] for name in own.tolerances}.items()
    )


@pytest.mark.parametrize(("rounding", "taken"), [("down", "0.04 mm"), ("nearest", "0.05 mm")])
def test_a_thickness_is_rounded_as_it_was_asked(shim_command: Command, rounding: str, taken: str) -> None:
    """48.3 um by the geometry, 48.2 by the formula: of steps of 10 um 40 lie below them, and 50 nearest."""
    code, out, _ = shim_command(BEVEL, "--target-min", "24 um", "--stock", "0.01 mm", "--round", rounding)
    assert code == 0
    values = [found[1] for line in out.splitlines() if (found := re.search(r"kind: shim, .*value: (\S+ mm)", line))]
    assert values == [taken, taken]


REFUSED = {
    "too tight": (
        BEVEL,
        ("80 um",),
        r"at most 70\.599 µm, .* too tight by 9\.401 µm, .*; 0\.00972 mm in front of each",
    ),
    "too tight with the shims off": (SHIMMED, ("80 um",), r"at most 70\.599 µm, .* without shims"),
    "less than nothing": (BEVEL, ("-3 um",), r"a backlash of 0 or more, got -3\.000 µm"),
    "no unit": (BEVEL, ("24",), "--target-min: expected a length .* a bare number"),
    "an angle": (BEVEL, ("24 deg",), "--target-min: expected a length .* got '24 deg'"),
    "a spur scene": (SPUR, ("24 um",), "of a bevel mesh, got none; .* nothing of a spur pair"),
    "a spur measure": (SPUR, ("24 um", "--measure", "normal backlash"), "of 'gear pair'; .* nothing of a spur pair"),
    "an angle's measure": (BEVEL, ("24 um", "--measure", "lost motion"), "of the kind angular_backlash"),
    "no such measure": (BEVEL, ("24 um", "--measure", "normal backlsh"), 'did you mean "normal backlash"'),
    "several": (EVERY, ("24 um",), "'normal backlash', 'over the face', 'contact over the face'"),
    "no such shim": (BEVEL, ("24 um", "--shims", "drivn"), 'did you mean "driven"'),
    "no geometry": (BEVEL, ("24 um", "--engine", "analytic"), "expected exact or fcl"),
    "no stock": (BEVEL, ("24 um", "--stock", "0 mm"), "thicknesses of more than zero"),
    "a stock that interferes": (
        BEVEL,
        ("0 um", "--stock", "0.1 mm", "--round", "nearest"),
        r"with shims of 0\.1 mm: .* the teeth interfere at the mean build",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_answered_gets_one_message_and_exit_code_2(shim_command: Command, what: str) -> None:
    scene, options, words = REFUSED[what]
    code, out, err = shim_command(scene, "--target-min", *options)
    assert (code, out) == (2, "")
    assert re.search(words, err), err


def test_a_file_is_never_written_over(shim_command: Command, tmp_path: Path) -> None:
    path = tmp_path / "there.yaml"
    path.write_text("mine", "utf-8")
    code, _, err = shim_command(BEVEL, "--target-min", "24 um", "--out", str(path))
    assert code == 2
    assert "there is one already" in err
    assert path.read_text("utf-8") == "mine"


def test_shims_that_undo_each_other_are_refused() -> None:
    scene = load_scene(Path(SHIMMED))
    front = scene.distributed["driven shim"].model_copy(update={"side": "in_front"})
    with pytest.raises(InputError, match="which cancel"):
        shim_plan(with_tolerances(scene, {"driven shim": front}), ShimQuestion(24 * UM))


def test_builds_that_interfere_are_told_of(shim_command: Command) -> None:
    """Mean - 3 sigma at nothing: 1.35 of 1000 builds of a normal backlash lie below it."""
    code, out, _ = shim_command(BEVEL, "--target-min", "0 um")
    assert code == 0
    assert "of 2000 builds with the chosen shims" in out
    own = plan(target=0.0)
    assert 0 < own.chosen.failed < 2.7 + 4 * math.sqrt(2.7)
    assert replace(own.chosen, called="sample_min").sampling_error is None
