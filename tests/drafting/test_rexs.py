"""REXS files: the drafted scene has the numbers of the gear program, and asks for what that does not say."""

import builtins
import re
import socket
from collections.abc import Callable, Mapping
from dataclasses import replace
from math import acos, atan, cos, pi, radians, sin, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from fixtures import Command
from places import SCENES
from rexs_texts import Attributes, Rexs, Writer, pair, planetary, two_stages, zipped
from scipy.optimize import brentq

from tol3d.apps.drafting.rexs import gearbox_scene_from, is_rexs
from tol3d.apps.drafting.rexs.container import LARGEST_TEXT, MOST_MEMBERS, read_document
from tol3d.apps.drafting.rexs.document import MOST_COMPONENTS
from tol3d.apps.drafting.rexs.gearbox import Gearbox
from tol3d.apps.drafting.rexs.reading import gearbox_of
from tol3d.apps.drafting.rexs.scene import gearbox_draft
from tol3d.errors import InputError
from tol3d.files import FileContent, read_file
from tol3d.gearing.system import GearSystem
from tol3d.simulate import Overrides, load_text, simulation_of
from tol3d.study import Simulation
from tol3d.study.system.stated import component_slices, stated

SPUR_STAGE = Path(__file__).with_name("spur_stage.rexs")


def scene_of(content: Rexs | FileContent) -> tuple[str, dict[str, Any]]:
    """The text of a drafted scene, and its content."""
    text, _ = gearbox_scene_from(content.file() if isinstance(content, Rexs) else content)
    return text, yaml.safe_load(text)


def filled_in(text: str) -> str:
    """A drafted scene in which every line to fill in stands as it is offered."""
    return re.sub(r"^(  )# (.*to fill in: )", r"\1\2", text, flags=re.MULTILINE)


def simulated(text: str) -> Simulation:
    return simulation_of(load_text(text, Path("scene.yaml")), Overrides())


def gearbox(rexs: Rexs) -> Gearbox:
    return gearbox_of(read_document(rexs.file()))


def refusal(content: Rexs | FileContent) -> str:
    with pytest.raises(InputError) as caught:
        gearbox_scene_from(content.file() if isinstance(content, Rexs) else content)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def extremes(simulation: Simulation, measure: str, varied: Mapping[str, int]) -> list[float]:
    """Values of a measure by 3D, contributors at one limit (1: upper) and all at the other; those not named at 0."""
    system = simulation.system
    slices = component_slices(system)
    ends = np.zeros((2, max(own.stop for own in slices.values())))
    for name, sign in varied.items():
        law = next(own.distribution for own in system.contributors if own.name == name)
        ends[0, slices[name]], ends[1, slices[name]] = (law.high, law.low) if sign > 0 else (law.low, law.high)
    method = system.method("exact", system.materials("exact"))
    answers = method.answers(stated(system, ends), system.measures)
    return [float(own) for own in np.ravel(answers.values[measure])]


def involute(angle: float) -> float:
    return tan(angle) - angle


def test_a_spur_stage_is_drafted_with_its_numbers() -> None:
    text, read = scene_of(read_file(SPUR_STAGE))
    gears = {name: own for name, own in read["parts"].items() if own["kind"] == "spur_gear"}
    assert gears == {
        name: {"kind": "spur_gear", "teeth": teeth, "module": "2 mm", "pressure_angle": "20 deg",
               "face_width": width, "profile_shift": shift}
        for name, teeth, width, shift in (("pinion", 20, "22 mm", 0.3), ("wheel", 41, "20 mm", 0.1))
    }  # fmt: skip
    assert read["moves"]["stage"] == {
        "kind": "mesh", "driver": "pinion", "driven": "wheel", "centre_distance": "61.8 mm", "working_flank": "either",
    }  # fmt: skip
    laws = {name: own.get("distribution", own.get("limits")) for name, own in read["tolerances"].items()}
    clearance = {"kind": "constant", "value": "10 um"}
    assert laws == {
        "pinion tooth thickness": {"din_3967": "cd25"},
        "wheel tooth thickness": {"din_3967": "cd25"},
        "stage centre distance": {"din_3964": "js7"},
        "pinion pitch": {"iso_class": 7},
        "pinion profile slope": {"iso_class": 7},
        "pinion helix slope": {"iso_class": 7},
        **{f"{shaft} {side} clearance": clearance for shaft in ("input", "output") for side in ("left", "right")},
    }
    assert {name: (own["shaft"], own["at"]) for name, own in read["parts"].items() if own["kind"] == "bearing"} == {
        "input left": ("input shaft", "0 mm"),
        "input right": ("input shaft", "60 mm"),
        "output left": ("output shaft", "0 mm"),
        "output right": ("output shaft", "60 mm"),
    }
    assert read["parts"]["input shaft"]["carries"] == {"pinion": {"at": "41 mm"}}  # 30 mm and half of 22 mm
    assert re.findall(r"^  # (.*?):", text, re.MULTILINE) == ["wheel pitch"]


def test_backlash_of_a_drafted_spur_stage_has_the_limits_of_its_series_and_field() -> None:
    """Oracle: j = (|E1| + |E2|) cos 20° + 2 a cos α_w (inv α_w - inv α_w0), worked out by hand [µm]."""
    simulation = simulated(scene_of(read_file(SPUR_STAGE))[0])
    teeth = {"pinion tooth thickness": 1, "wheel tooth thickness": 1}
    at_nominal = extremes(simulation, "stage normal backlash", teeth)
    assert [1e3 * own for own in at_nominal] == pytest.approx([142.449, 208.227], abs=6e-4)
    over_all = extremes(simulation, "stage normal backlash", teeth | {"stage centre distance": -1})
    assert [1e3 * own for own in over_all] == pytest.approx([131.244, 219.448], abs=6e-4)


def test_the_lines_to_fill_in_are_scenes_as_they_stand() -> None:
    writer = Writer("1.7")
    first, second = writer.shaft("in", (0.0, 0.0, 0.0)), writer.shaft("out", (0.0, 0.0, 60.7))
    gears = [writer.gear("a", first, 23, 2.0, 0.2), writer.gear("b", second, 37, 2.0, 0.15)]
    writer.stage("mesh", gears[0], gears[1], 60.7)
    writer.bearing("front", first, 0.0)
    text, read = scene_of(writer.rexs())
    assert "tolerances" not in read
    simulation = simulated(filled_in(text.replace("# tolerances:", "tolerances:")))
    names = {own.name for own in simulation.system.contributors}
    assert names == {
        "a tooth thickness", "b tooth thickness", "mesh centre distance", "a pitch", "b pitch", "front clearance",
    }  # fmt: skip


@pytest.mark.parametrize("version", ["1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0.0"])
@pytest.mark.parametrize("name", ["box.rexs", "box.rexsj", "box.rexsz"])
def test_every_form_and_version_of_a_gearbox_gives_one_scene(version: str, name: str) -> None:
    wanted = gearbox_draft(pair("1.7").file()).scene()[0]
    rexs = pair(version)
    if version == "1.0":
        old = {
            "tooth_thickness_deviation_tolerance_series_din_3967_1978": "din_3967_deviation_tolerance_series",
            "center_distance_tolerance_field_din_3964_1980": "din_3964_center_distance_tolerance_field",
            "minimum_radial_bearing_clearance": "minimum_bearing_clearance",
            "maximum_radial_bearing_clearance": "maximum_bearing_clearance",
        }
        components = {
            number: (kind, own, {old.get(key, key): value for key, value in attributes.items()})
            for number, (kind, own, attributes) in rexs.components.items()
        }
        rexs = replace(rexs, components=components)
    text = gearbox_draft(rexs.file(name)).scene()[0]
    assert "c25" in wanted
    assert text.replace(name, "box.rexs") == wanted


@pytest.mark.parametrize("name", ["box.rexsj", "box.rexsz", "box.rexs.zip"])
def test_every_form_of_a_planetary_stage_gives_one_scene(name: str) -> None:
    wanted = gearbox_draft(planetary().file()).scene()[0]
    assert gearbox_draft(planetary().file(name)).scene()[0].replace(name, "box.rexs") == wanted


def test_nothing_is_fetched_and_no_file_that_is_named_is_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither by names in the file nor by entities, which are refused."""
    path = tmp_path / "box.rexs"
    named = pair().having(
        5, material_file=("http://127.0.0.1:9/steel.xml", "none"), shape=("file:///etc/passwd", "none")
    )
    path.write_bytes(named.xml())
    content = read_file(path)

    def refuse(*words: object, **more: object) -> object:
        raise AssertionError(f"opened {words}")

    monkeypatch.setattr(socket, "socket", refuse)
    monkeypatch.setattr(socket, "create_connection", refuse)
    monkeypatch.setattr(builtins, "open", refuse)
    monkeypatch.setattr(Path, "open", refuse)
    assert gearbox_draft(content).scene()[0] == gearbox_draft(pair().file()).scene()[0]
    for declared in (
        b'<!DOCTYPE m SYSTEM "http://127.0.0.1:9/a.dtd"><model',
        b'<!DOCTYPE m [<!ENTITY x SYSTEM "file:///etc/passwd">]><model',
        b'<!DOCTYPE m [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]><model',
    ):
        told = refusal(FileContent(path, pair().xml().replace(b"<model", declared, 1)))
        assert "expected no DOCTYPE and no entities; nothing is fetched" in told


def test_a_diameter_beyond_the_tables_leaves_a_series_out_by_name() -> None:
    """z 23 and m 500 mm have d 11.5 m; the tables end at 10 m."""
    big = {"normal_module": (500.0, "mm"), "face_width": (100.0, "mm")}
    rexs = pair().having(11, center_distance=(15_200.0, "mm"), center_distance_tolerance_field_din_3964_1980=None)
    drafted = gearbox_scene_from(rexs.having(5, **big).having(8, **big).file())[1]
    told = [own for own in drafted.notes() if "reference diameter" in own]
    assert len(told) == 2
    assert told[0].startswith("left out: cylindrical_gear 5: tooth thickness: ")
    assert "expected a reference diameter of at most 10000 mm, got 11500 mm" in told[0]


def test_the_bundled_planetary_stage_has_the_limits_of_its_page() -> None:
    """8′09.2″ and 11′54.0″ with c25 at the ring, which the file does not state."""
    text, drafted = gearbox_scene_from(read_file(SCENES / "planetary_stage.rexs"))
    assert "Not in the file, to fill in: ring tooth thickness." in list(drafted.notes())
    simulation = simulated(filled_in(text))
    teeth = dict.fromkeys((f"{own} tooth thickness" for own in ("sun", "planet wheel", "ring")), 1)
    values = [own * 180.0 * 60.0 / pi for own in extremes(simulation, "lost motion", teeth)]
    assert values == pytest.approx([8 + 9.2 / 60, 11 + 54.0 / 60], abs=1e-3)


def test_whole_numbers_may_be_written_as_floats() -> None:
    """A public writer has ids as 5.0 in its JSON."""
    content = re.sub(rb'("(?:id|integer)": \d+)', rb"\1.0", pair().json())
    assert b'"id": 5.0' in content
    text = gearbox_draft(FileContent(Path("box.rexs"), content)).scene()[0]
    assert text == gearbox_draft(pair().file()).scene()[0]


def test_allowances_are_read_in_the_words_of_the_file() -> None:
    none = None
    series = "tooth_thickness_deviation_tolerance_series_din_3967_1978"
    rexs = pair().having(
        5,
        **{series: none},
        lower_backlash_allowance_referenced_to_span=(-90.0, "mum"),
        upper_backlash_allowance_referenced_to_span=(-50.0, "mum"),
        number_of_teeth_for_span_measurement=(3, "none"),
    )
    rexs = rexs.having(
        8,
        **{series: none},
        lower_backlash_allowance_balls_or_pins=(-0.2, "mm"),
        upper_backlash_allowance_balls_or_pins=(-0.1, "mm"),
        diameter_of_measuring_ball_or_pin=(3.5, "mm"),
    )
    rexs = rexs.having(
        11,
        center_distance_tolerance_field_din_3964_1980=none,
        lower_center_distance_allowance=(-5.0, "mum"),
        upper_center_distance_allowance=(25.0, "mum"),
    )
    _, read = scene_of(rexs)
    tolerances = read["tolerances"]
    assert tolerances["pinion tooth thickness"]["measured"] == {"span": 3}
    assert tolerances["pinion tooth thickness"]["distribution"] == ["-90 um", "-50 um"]
    assert tolerances["wheel tooth thickness"]["measured"] == {"pins": "3.5 mm"}
    assert tolerances["wheel tooth thickness"]["distribution"] == ["-200 um", "-100 um"]
    assert tolerances["mesh centre distance"]["distribution"] == ["-5 um", "25 um"]
    assert tolerances["rear clearance"]["distribution"] == ["5 um", "20 um"]
    assert tolerances["front clearance"]["distribution"] == {"kind": "constant", "value": "12 um"}


@pytest.mark.parametrize(("teeth", "helix"), [(8, 0.0), (None, 0.0), (None, 15.0)])
def test_a_span_of_a_ring_above_its_nominal_makes_teeth_thinner(teeth: int | None, helix: float) -> None:
    """50 and 90 um along the normals are 1/(cos α_n cos β) as much on arcs; over 2 a they turn the carrier.

    Helical rings have no span, but a file may have its allowances.
    """
    spans: dict[str, tuple[float, str]] = {
        "lower_backlash_allowance_referenced_to_span": (50.0, "mum"),
        "upper_backlash_allowance_referenced_to_span": (90.0, "mum"),
    }
    rexs = planetary(series=("", "", ""), helix=helix).having(12, **spans)
    text, read = scene_of(rexs.having(12, number_of_teeth_for_span_measurement=(teeth, "none")) if teeth else rexs)
    assert read["tolerances"]["ring tooth thickness"]["measured"] == ({"span": 8} if teeth else "normal")
    values = extremes(simulated(text), "lost motion", {"ring tooth thickness": 0 if teeth else 1})
    assert values == pytest.approx([own / (cos(radians(20.0)) * 156.0) for own in (0.05, 0.09)], rel=1e-4)


@pytest.mark.parametrize("teeth", [8, None])
def test_allowances_of_a_ring_below_0_are_those_above_0(teeth: int | None) -> None:
    """Span and size between balls: both make teeth thinner, the limits change places."""
    ring = planetary(series=("", "", ""))
    ring = ring.having(12, number_of_teeth_for_span_measurement=(teeth, "none")) if teeth else ring
    ring = ring.having(12, diameter_of_measuring_ball_or_pin=(6.65, "mm"))
    for what, unit in (("referenced_to_span", "mum"), ("balls_or_pins", "mm")):
        laws = []
        for lower, upper in ((0.05, 0.09), (-0.09, -0.05)):
            scale = 1e3 if unit == "mum" else 1.0
            own: dict[str, tuple[float, str]] = {
                f"lower_backlash_allowance_{what}": (lower * scale, unit),
                f"upper_backlash_allowance_{what}": (upper * scale, unit),
            }
            laws.append(scene_of(ring.having(12, **own))[1]["tolerances"]["ring tooth thickness"])
        assert laws[0] == laws[1]


def test_sizes_of_a_ring_are_between_balls() -> None:
    """Oracle: E_st = d (inv α_Kt - inv α_Kt') with cos α_Kt = d_b cos(π/2z)/(M_dK + D_M); j_t = -E_st turns 2 a."""
    ball, teeth = 6.65, 61
    allowances: dict[str, tuple[float, str]] = {
        "lower_backlash_allowance_balls_or_pins": (0.1, "mm"),
        "upper_backlash_allowance_balls_or_pins": (0.2, "mm"),
        "diameter_of_measuring_ball_or_pin": (ball, "mm"),
    }
    text, read = scene_of(planetary(series=("", "", ""), helix=15.0).having(12, **allowances))
    assert read["tolerances"]["ring tooth thickness"]["measured"] == {"balls": "6.65 mm"}
    assert read["tolerances"]["ring tooth thickness"]["distribution"] == ["100 um", "200 um"]
    cosine, transverse = cos(radians(15.0)), atan(tan(radians(20.0)) / cos(radians(15.0)))
    diameter = 4.0 * teeth / cosine
    base, nearest = diameter * cos(transverse), cos(pi / 2 / teeth)
    inv_k = pi / 2 / teeth + involute(transverse) - ball / (teeth * 4.0 * cos(radians(20.0)))
    size = nearest * base / cos(brentq(lambda angle: involute(angle) - inv_k, 0.0, 1.0)) - ball
    arcs = [diameter * (involute(acos(nearest * base / (size + own + ball))) - inv_k) for own in (0.1, 0.2)]
    values = extremes(simulated(text), "lost motion", {"ring tooth thickness": 1})
    assert values == pytest.approx([own * cosine / 156.0 for own in arcs], rel=1e-4)


@pytest.mark.parametrize(
    ("angle", "module"),
    [((20.0, "°"), (2000.0, "mum")), ((pi / 9, "rad"), (2000.0, "um")), ((20.0, "deg"), (0.002, "m"))],
)
def test_units_are_those_of_the_file(angle: tuple[float, str], module: tuple[float, str]) -> None:
    rexs = pair()
    for side in (6, 7, 9, 10):
        rexs = rexs.having(side, normal_pressure_angle=angle)
    rexs = rexs.having(5, normal_module=module).having(8, normal_module=module)
    assert gearbox_draft(rexs.file()).scene()[0] == gearbox_draft(pair().file()).scene()[0]


def test_of_three_bearings_those_with_a_clearance_are_drafted() -> None:
    rexs = pair().having(12, radial_clearance=None)
    rexs = replace(rexs, components={**rexs.components, 14: ("concept_bearing", "needle", {
        "u_coordinate_on_shaft_inner_side": (40.0, "mm"), "radial_clearance": (0.0, "mum"),
    })}).related("side", assembly=14, inner_part=3, outer_part=2)  # fmt: skip
    read = yaml.safe_load(gearbox_draft(rexs.file()).scene()[0])
    assert [name for name, own in read["parts"].items() if own["kind"] == "bearing"] == ["rear", "needle"]


def test_a_class_of_clearance_is_told_beside_the_line_to_fill_in() -> None:
    limits = dict.fromkeys(("minimum_radial_bearing_clearance", "maximum_radial_bearing_clearance"))
    text = gearbox_draft(pair().having(13, **limits, radial_clearance_class=("C3", "none")).file()).scene()[0]
    assert re.search(
        r"  # rear clearance: .*# to fill in: limits of the radial clearance, class C3$", text, re.MULTILINE
    )


def test_a_chord_is_taken_as_an_arc_and_a_series_goes_before_numbers() -> None:
    numbers = {
        "chordal_tooth_thickness_lower_deviation": (-0.12, "mm"),
        "chordal_tooth_thickness_upper_deviation": (-0.07, "mm"),
    }
    text, read = scene_of(pair().having(5, **numbers))
    assert read["tolerances"]["pinion tooth thickness"]["distribution"] == {"din_3967": "c25"}
    assert "gear 5: chordal_tooth_thickness_…_deviation: not drafted beside gear 5: series of DIN 3967" in text
    series = {"tooth_thickness_deviation_tolerance_series_din_3967_1978": ("zz25", "none")}
    text, read = scene_of(pair().having(5, **numbers, **series))
    assert read["tolerances"]["pinion tooth thickness"]["distribution"] == ["-120 um", "-70 um"]
    assert "the series zz25 has no limits, numbers are drafted instead" in text


def test_a_letter_that_a_diameter_has_no_value_for_is_left_out_by_name() -> None:
    hostile = "zz25\n  x: [y # z"
    rexs = (
        pair()
        .having(11, center_distance=(60.8, "mm"))
        .having(8, tooth_thickness_deviation_tolerance_series_din_3967_1978=None)
    )
    rexs = rexs.having(5, tooth_thickness_deviation_tolerance_series_din_3967_1978=(hostile, "none"))
    assert "wheel tooth thickness: {kind" in scene_of(rexs)[0]
    text, drafted = gearbox_scene_from(
        pair().having(5, tooth_thickness_deviation_tolerance_series_din_3967_1978=("zz25", "none")).file()
    )
    assert "pinion tooth thickness" not in yaml.safe_load(text)["tolerances"]
    (line,) = (own for own in drafted.notes() if "zz25" in own)
    assert line.startswith("left out: cylindrical_gear 5: tooth thickness: ")


def test_a_scene_that_interferes_without_a_series_names_it() -> None:
    lost = {"tooth_thickness_deviation_tolerance_series_din_3967_1978": ("zz25", "none")}
    told = refusal(pair().having(5, **lost).having(8, **lost))
    assert "moves.mesh: the teeth interfere at the mean build: " in told
    assert told.count("; left out: cylindrical_gear ") == 2
    assert "'zz25'" in told


@pytest.mark.parametrize(("helix", "distance"), [(0.0, "78 mm"), (15.0, "80.7515421 mm")])
def test_a_planetary_stage_is_one_set_with_one_contributor_a_pin(helix: float, distance: str) -> None:
    """Lost motion at the carrier: (j_sp + j_rp)/(2 a), 370/156 000 and 540/156 000 rad, whatever the pins do.

    Of helical teeth arcs of the transverse section and the distance are both 1/cos β as large, in the same ranges.
    """
    text, read = scene_of(planetary(helix=helix))
    (move,) = read["moves"].values()
    assert move == {
        "kind": "planetary", "planet": "planet", "planets": 3, "carrier": "carrier",
        "meshes": {"sun": "planet wheel", "ring": "planet wheel"}, "centre_distance": distance,
        "held": "ring", "input": "sun", "output": "carrier",
    }  # fmt: skip
    assert read["tolerances"]["set planet pins"] == {
        "kind": "planet_pin", "of": "carrier", "direction": "radial", "distribution": {"fit": "js7", "of": distance},
    }  # fmt: skip
    hands = [read["parts"][own].get("hand") for own in ("sun", "planet wheel", "ring")]
    assert hands == (["left", "right", "right"] if helix else [None, None, None])
    simulation = simulated(text)
    pins = next(own for own in simulation.system.contributors if own.name == "set planet pins")
    assert len(pins.columns) == 3
    to_arcsec = 180.0 * 3600.0 / pi
    expected = [370 / 156_000 * to_arcsec, 540 / 156_000 * to_arcsec]  # 8′09.2″ and 11′54.0″
    assert expected == pytest.approx([489.2, 714.0], abs=0.05)
    teeth = dict.fromkeys((f"{own} tooth thickness" for own in ("sun", "planet wheel", "ring")), 1)
    for varied in (teeth, teeth | {"set planet pins": 1}, teeth | {"set planet pins": -1}):
        values = [own * to_arcsec for own in extremes(simulation, "lost motion", varied)]
        assert values == pytest.approx(expected, abs=0.1)


def test_a_ring_without_a_series_is_asked_for() -> None:
    text, drafted = gearbox_scene_from(planetary(series=("c25", "c25", "")).file())
    assert "  # ring tooth thickness: {kind: tooth_thickness, of: ring, distribution: {din_3967: c25}}" in text
    assert "Not in the file, to fill in: ring tooth thickness." in list(drafted.notes())
    with_ring = filled_in(text)
    assert yaml.safe_load(with_ring)["tolerances"]["ring tooth thickness"]["distribution"] == {"din_3967": "c25"}


def test_profile_shifts_that_the_file_does_not_say_are_those_without_backlash() -> None:
    """Oracle: the pair's distance without backlash, by a root of the involute equation."""
    rexs = pair()
    sides = [own["left"] for kind, own in rexs.relations if kind == "flank"] + [
        own["right"] for kind, own in rexs.relations if kind == "flank"
    ]
    for side in sides:
        if rexs.components[side][2]["addendum_modification_coefficient"][0] == 0.15:
            rexs = rexs.having(side, addendum_modification_coefficient=None)
    (stage,) = gearbox(rexs).stages
    wheel = stage.second
    assert wheel.shift_guess

    def excess(shift: float) -> float:
        rise = involute(radians(20)) + 2 * (0.2 + shift) * tan(radians(20)) / 60
        working = brentq(lambda angle: involute(angle) - rise, 0.01, 1.0, xtol=1e-15)
        return 60 * cos(radians(20)) / cos(working) - 60.6

    assert wheel.profile_shift == pytest.approx(brentq(excess, -1, 1), abs=1e-6)
    assert stage.normal_backlash == pytest.approx(0.0, abs=2e-6)


def with_shift(rexs: Rexs, shift: float | str) -> Rexs:
    """A pair without limits of its teeth and its distance, whose pinion has another profile shift."""
    series = "tooth_thickness_deviation_tolerance_series_din_3967_1978"
    for side in (6, 7):
        rexs = rexs.having(side, addendum_modification_coefficient=(shift, "none"))
    return rexs.having(5, **{series: None}).having(8, **{series: None})


def test_rounded_profile_shifts_that_interfere_are_drafted_without_backlash() -> None:
    """x 0.2001 and 0.15(00), 60.6726 mm: each half of a last digit, 2 m sin α and 2 sin α_w per mm, take 0.173 µm."""
    rexs = with_shift(pair(), 0.2001).having(
        11, center_distance=(60.6726, "mm"), center_distance_tolerance_field_din_3964_1980=None
    )
    text, drafted = gearbox_scene_from(rexs.file())
    (stage,) = drafted.gearbox.stages
    working = acos(60 * cos(radians(20)) / 60.6726)
    bound = 2 * sin(radians(20)) * 2e-4 + sin(working) * 1e-4
    assert stage.by_rounding == pytest.approx(bound, abs=2e-7)
    assert -bound < (stage.normal_backlash or 0.0) < -1e-4
    assert "# gear 8; x 0.15 in the file, rounded: its teeth interfere" in text
    less = 0.15 - yaml.safe_load(text)["parts"]["wheel"]["profile_shift"]
    assert less == pytest.approx(-(stage.normal_backlash or 0.0) / (4 * sin(radians(20))), abs=2e-9)
    (told,) = (own for own in drafted.notes() if "no backlash" in own)
    assert told == (
        "cylindrical_stage 11 has no backlash without tolerances: normal backlash -0.134 um; rounding of the last "
        "digits of x and center_distance can take 0.17 um: x of gear 8 is less by 9.8e-05 in the scene."
    )
    thin = rexs.having(5, tooth_thickness_deviation_tolerance_series_din_3967_1978=("h25", "none"))
    assert "profile_shift: 0.15}" in scene_of(thin)[0]


@pytest.mark.parametrize("shift", [0.2003, 0.21, 0.25])
def test_teeth_that_rounding_does_not_explain_are_not_changed(shift: float) -> None:
    """0.2003 takes 0.4 µm; 0.21 and 0.15 have too few decimals to be rounded."""
    rexs = with_shift(pair(), shift).having(11, center_distance=(60.6726, "mm"))
    told = refusal(rexs.having(11, center_distance_tolerance_field_din_3964_1980=None))
    assert re.search(
        r"; cylindrical_stage 11: normal backlash -\d+\.\d+ um, rounding of the last digits of x and ", told
    )


@pytest.mark.parametrize(
    ("module", "shift", "by"),
    [
        (9.0, 0.2001, 9 * sin(radians(20)) * 2e-4),  # 0.6 um
        (2.0, "0.20010", 2 * sin(radians(20)) * 2e-5),
        (2.0, 0.25, 0.0),
        (2.0, "2e-1", 0.0),
    ],
)
def test_rounding_takes_what_the_last_digits_can(module: float, shift: float | str, by: float) -> None:
    (stage,) = gearbox(with_shift(pair(module=module), shift).having(11, center_distance=(300, "mm"))).stages
    assert stage.by_rounding == pytest.approx(by, abs=2e-7)


def test_helical_stages_are_read_with_their_backlash() -> None:
    """Sums of x and angles by hand: 0.462830 at 22.80625°, 0.301479 at 21.77512°; j_bn 0.001 and -0.004 µm."""
    fast, slow = gearbox(two_stages()).stages
    assert [fast.tight_shift, slow.tight_shift] == pytest.approx([0.462830, 0.301479], abs=1e-6)
    angles = [own.working_angle for own in (fast, slow)]
    assert [180 / pi * own for own in angles if own] == pytest.approx([22.80625, 21.77512], abs=1e-5)
    assert [1e3 * (own.normal_backlash or 0) for own in (fast, slow)] == pytest.approx([0.001, -0.004], abs=6e-4)


def test_helical_gears_are_drafted_with_their_train() -> None:
    """cd25, filled in, is -95 to -145 um of each gear; a pair's 240 um turn its wheel by 240 um/(m_n z/2)."""
    drafted = gearbox_draft(two_stages().file())
    text = drafted.scene()[0]
    read = yaml.safe_load(text)
    assert [own["kind"] for own in read["moves"].values()] == ["mesh", "mesh", "train"]
    assert read["moves"]["train to three"] == {"kind": "train", "driven": "one", "output": "three"}
    assert "simulated in their meshes alone" not in text
    simulation_of(load_text(text, Path("box.yaml")), Overrides())
    filled = re.sub("# (tolerances:|. tooth thickness)", r"\1", text)
    system = simulation_of(load_text(filled, Path("box.yaml")), Overrides()).system
    lost = next(own for own in system.measures if own.name == "lost motion of three")
    form = system.closed_form(lost)
    assert form is not None
    assert form.mean == pytest.approx(0.24 / (4.5 * 51 / 2) * 23 / 34 + 0.24 / (6.5 * 34 / 2), abs=1e-7)
    assert read["parts"]["a"] == {
        "kind": "helical_gear", "teeth": 27, "module": "4.5 mm", "pressure_angle": "20 deg", "face_width": "15 mm",
        "helix_angle": "21 deg", "hand": "right", "profile_shift": 0.231415,
    }  # fmt: skip
    assert read["parts"]["b"]["hand"] == "left"
    told = list(drafted.notes())
    assert told[0] == "Tolerances from box.rexs: none, all builds are nominal."
    assert [own for own in told if "has no backlash without tolerances" in own] == [
        "cylindrical_stage 18 has no backlash without tolerances: normal backlash 0.001 um.",
        "cylindrical_stage 19 has no backlash without tolerances: normal backlash -0.004 um; rounding of the last "
        "digits of x and center_distance can take 0.045 um: x of gear 15 is less by 9.1e-07 in the scene.",
    ]
    assert read["moves"]["slow"]["azimuth"] == "180 deg"  # back to the first axis


def test_axial_plays_that_are_filled_in_screw_the_train() -> None:
    """By hand: c κ of the held shaft and of the last, c |κ_in - κ_out| between, at 25 um each, κ = h tan β / r."""
    text = gearbox_draft(two_stages().file()).scene()[0]
    plays = re.sub(r"# (tolerances:|\w+ axial play)", r"\1", text)
    assert {own["of"] for own in yaml.safe_load(plays)["tolerances"].values()} == {"one", "two", "three"}
    system = simulated(plays).system
    form = system.closed_form(next(own for own in system.measures if own.name == "lost motion of three"))
    assert form is not None
    teeth = ((27, 4.5, 21.0), (51, 4.5, -21.0), (23, 6.5, -10.0), (34, 6.5, 10.0))
    a, b, c, d = (2.0 * sin(radians(beta)) / (z * module) for z, module, beta in teeth)
    assert form.mean == pytest.approx(0.025 * ((abs(b) + abs(b - c)) * 23 / 34 + d), rel=1e-4)
    assert a * 27 == pytest.approx(-b * 51)


def test_axial_clearances_of_bearings_are_plays_of_helical_shafts() -> None:
    """That of the one bearing that holds a shaft; for two the line to fill in says both, for a spur shaft nothing."""
    writer = Writer()
    first, second, third = (
        writer.shaft(own, (0.0, 0.0, z)) for own, z in (("one", 0.0), ("two", -190.0), ("three", 0.0))
    )
    gears = [
        writer.gear("a", first, 27, 4.5, 0.231415, helix=21.0, start=117.0),
        writer.gear("b", second, 51, 4.5, 0.231415, helix=-21.0, start=72.0),
        writer.gear("c", second, 20, 9.5, 0.0, start=180.0),
        writer.gear("d", third, 20, 9.5, 0.0, start=180.0),
    ]
    writer.stage("fast", gears[0], gears[1], 190.0)
    writer.stage("slow", gears[2], gears[3], 190.0)
    limits: dict[str, Any] = {
        f"{end}_axial_bearing_clearance": (value, "mum") for end, value in (("minimum", 20.0), ("maximum", 60.0))
    }
    rolling = "rolling_bearing_with_catalog_geometry"
    writer.bearing("fixed", first, 0.0, rolling, **limits, axial_force_absorption=("both_directions", "none"))
    writer.bearing("floating", first, 60.0, rolling, **limits, axial_force_absorption=("no_direction", "none"))
    writer.bearing("left", second, 0.0, axial_clearance=(30.0, "mum"), axial_force_absorption=("positive", "none"))
    writer.bearing(
        "right",
        second,
        60.0,
        rolling,
        axial_clearance_class=("C3", "none"),
        axial_force_absorption=("negative", "none"),
    )
    writer.bearing("of spur gears", third, 0.0, axial_clearance=(30.0, "mum"))
    text, read = scene_of(writer.rexs())
    plays = {name: own["distribution"] for name, own in read["tolerances"].items() if own["kind"] == "axial_play"}
    assert plays == {"one axial play": ["20 um", "60 um"]}
    assert "  # bearing fixed: minimum_… and maximum_axial_bearing_clearance\n" in text
    assert "# to fill in: limits of the play between its stops, left 30 um, right class C3\n" in text
    writer.bearing("thrust", first, 90.0, radial_force_absorption=(False, "none"), axial_clearance=(25.0, "mum"))
    assert "fixed 20 um to 60 um, thrust 25 um\n" in gearbox_draft(writer.rexs().file()).scene()[0]


def test_the_classes_of_single_helical_teeth_are_drafted() -> None:
    """Stated classes of one gear, and a pitch to fill in of the others; the train runs with all of them."""
    text, read = scene_of(two_stages().having(6, tolerance_class_according_to_iso_1328_2013=("6", "none")))
    classes = {own["kind"]: own["limits"]["iso_class"] for own in read["tolerances"].values()}
    assert classes == {"pitch_deviation": 6, "profile_slope": 6, "helix_slope": 6}
    simulation = simulated(filled_in(text))
    names = {own.name for own in simulation.system.contributors}
    assert {*names} >= {f"{gear} pitch" for gear in "abcd"} | {f"{own} axial play" for own in ("one", "two", "three")}


def test_shafts_lie_where_the_file_has_them() -> None:
    """Two stages round a corner, the last shaft against the first one: axes of the scene against those of the file."""
    writer = Writer()
    places = [(0.0, 0.0, 0.0), (0.0, 45.0, 0.0), (60.0, 45.0, 50.0)]
    shafts = [writer.shaft(str(k), at, -1.0 if k == 2 else 1.0) for k, at in enumerate(places)]
    gears = [
        writer.gear("a", shafts[0], 20, 1.5, 0.0, series="d25"),
        writer.gear("b", shafts[1], 40, 1.5, 0.0, series="d25"),
        writer.gear("c", shafts[1], 18, 2.0, 0.0, start=50.0, series="d25"),
        writer.gear("d", shafts[2], 32, 2.0, 0.0, start=5.0, series="d25"),
    ]
    writer.stage("first", gears[1], gears[0], 45.0)
    writer.stage("second", gears[2], gears[3], 50.0)
    simulation = simulated(scene_of(writer.rexs())[0])
    system = simulation.system
    assert isinstance(system, GearSystem)
    layout = system.model.layout
    along_w = np.array([[0, 0, 1], [0, -1, 0], [1, 0, 0]], float)  # x of the scene's root is w, its z is u
    for name, at in zip(("0", "1", "2"), places, strict=True):
        seen = layout.world_from_shaft[name][:3, 3]
        assert seen[:2] == pytest.approx((along_w @ np.array(at))[:2], abs=1e-6)


def test_two_load_paths_that_meet_again_have_one_output() -> None:
    """A split-torque box: the pinion drives two lay shafts, both drive the gear in line with it."""
    writer = Writer()
    ends = [("in", 0.0), ("left", 60.0), ("right", -60.0), ("out", 0.0)]
    first, left, right, last = (writer.shaft(name, (0.0, 0.0, at)) for name, at in ends)
    sun = writer.gear("sun", first, 24, 1.5, 0.0, start=0.0, series="e25")
    bull = writer.gear("bull", last, 41, 2.0, 0.0, start=40.0, series="e25")
    for name, shaft in (("left", left), ("right", right)):
        wheel = writer.gear(f"{name} wheel", shaft, 56, 1.5, 0.0, start=0.0, series="e25")
        pinion = writer.gear(f"{name} pinion", shaft, 19, 2.0, 0.0, start=40.0, series="e25")
        writer.stage(f"{name} fast", sun, wheel, 60.0)
        writer.stage(f"{name} slow", pinion, bull, 60.0)
    text, read = scene_of(writer.rexs())
    trains = [own for own in read["moves"].values() if own["kind"] == "train"]
    assert trains == [{"kind": "train", "driven": "in", "output": "out"}]
    assert [own.name for own in simulated(text).system.measures][-1] == "lost motion of out"


@pytest.mark.parametrize("helix", [0.0, 15.0])
def test_a_set_behind_a_stage_is_one_train(helix: float) -> None:
    """A stage drives the sun's shaft: 2 · (1 + 61/17) turns of the motor a turn of the carrier, backwards."""
    rexs = planetary(helix=helix)
    number = len(rexs.components) + 1
    shaft = next(k for k, own in rexs.components.items() if own[1] == "sun shaft")
    writer = Writer("1.1", dict(rexs.components), list(rexs.relations))
    motor = writer.shaft("motor", (-30.0, 0.0, 90.0))
    assert motor == number
    first = writer.gear("first", motor, 30, 2.0, 0.0, series="cd25")
    second = writer.gear("second", shaft, 60, 2.0, 0.0, start=-20.0, series="cd25")
    writer.stage("before", first, second, 90.0)
    text, read = scene_of(writer.rexs())
    assert read["parts"]["sun shaft"]["carries"].keys() == {"sun", "second"}
    assert read["moves"]["train to carrier"] == {"kind": "train", "driven": "motor", "output": "carrier"}
    simulation = simulated(text.replace("output: carrier}", f"output: carrier, ratio: {-2 * (1 + 61 / 17):.6f}}}"))
    assert [own.name for own in simulation.system.measures] == ["before normal backlash", "lost motion of carrier"]
    names = {own.name for own in simulated(filled_in(text)).system.contributors}
    assert {own for own in names if own.endswith("play")} == ({"sun shaft axial play"} if helix else set())


DOCTYPE = b'<!DOCTYPE model [<!ENTITY a "b">]>'


def spoilt(edit: Callable[[bytes], bytes]) -> FileContent:
    return FileContent(Path("box.rexs"), edit(pair().xml()))


def pair_on_a_planet() -> Rexs:
    rexs = planetary()
    writer = Writer("1.1", dict(rexs.components), list(rexs.relations))
    first = writer.gear("first", writer.shaft("motor", (0.0, 0.0, 138.0)), 30, 2.0, 0.0)
    writer.stage("before", first, writer.gear("second", 16, 30, 2.0, 0.0, start=60.0), 60.0)
    return writer.rexs()


BAD = {
    "modules": (
        pair().having(8, normal_module=(2.5, "mm")),
        "box.rexs: cylindrical_stage 11: expected gears of one normal_module, got 2 mm and 2.5 mm",
    ),
    "flanks": (
        pair().having(7, addendum_modification_coefficient=(0.25, "none")),
        "box.rexs: cylindrical_gear 5 'pinion': expected left and right flanks with one pressure angle and profile "
        "shift, got two",
    ),
    "helix": (
        pair().having(8, helix_angle_reference_diameter=(8.0, "deg")),
        "box.rexs: cylindrical_stage 11: helix_angle_reference_diameter: expected one angle with opposite signs, got",
    ),
    "reference": (
        pair().related("assembly", assembly=1, part=99),
        "box.rexs: assembly relation 10: part: expected a component of the file, got the id 99, which it does not have",
    ),
    "ring of parts": (
        pair().related("assembly", assembly=5, part=1),
        "box.rexs: gear_unit 1 'unit': expected it to be no part of itself, got the ring 1 → 3 → 5 → 1",
    ),
    "ring of positions": (
        pair()
        .having(3, reference_component_for_position=(4, "none"))
        .having(4, reference_component_for_position=(3, "none")),
        "box.rexs: shaft 3 'in': expected a position that refers to no position of its own, got a ring",
    ),
    "role": (
        pair().related("assembly", assembly=1),
        "box.rexs: assembly relation 10: expected one ref with role 'part', got 0",
    ),
    "teeth": (
        pair().having(5, number_of_teeth=(False, "none")),
        "box.rexs: cylindrical_gear 5 'pinion': number_of_teeth: expected a value, got 'false'; the program that wrote "
        "it lost it",
    ),
    "unit": (
        pair().having(5, normal_module=(2.0, "inch")),
        "box.rexs: cylindrical_gear 5 'pinion': normal_module: expected the unit 'mm', 'mum', 'um', 'µm', 'μm', 'm', "
        "got 'inch'",
    ),
    "number": (
        pair().having(5, normal_module=("nan", "mm")),
        "box.rexs: cylindrical_gear 5 'pinion': normal_module: expected a number, got 'nan'",
    ),
    "distance": (
        pair().having(11, center_distance=None),
        "box.rexs: cylindrical_stage 11 'mesh': expected center_distance, got none",
    ),
    "worm alone": (
        pair().typed(11, "worm_stage"),
        "box.rexs: expected a cylindrical or planetary stage, got worm_stage 'mesh'",
    ),
    "version": (replace(pair(), version="3.1"), "box.rexs: expected REXS 1.0 to 2.0, got version '3.1'"),
    "interference": (
        pair().having(11, center_distance=(60.0, "mm")),
        "box.rexs: its scene cannot be simulated: ",
    ),
    "doctype": (
        spoilt(lambda own: own.replace(b"<model", DOCTYPE + b"<model")),
        "box.rexs: line 1: expected no DOCTYPE and no entities; nothing is fetched",
    ),
    "other file": (
        spoilt(lambda own: own.replace(b"<model", b'<!DOCTYPE model SYSTEM "file:///etc/passwd"><model')),
        "box.rexs: line 1: expected no DOCTYPE and no entities; nothing is fetched",
    ),
    "no end": (spoilt(lambda own: own[:-9]), "box.rexs: line 1: expected XML, got: unclosed token"),
    "depth": (
        spoilt(lambda own: own.replace(b"<components>", b"<a>" * 99 + b"</a>" * 99 + b"<components>")),
        "box.rexs: line 1: expected at most 12 elements in each other and 2000000 of them",
    ),
    "encoding": (
        spoilt(lambda own: own.replace(b"UTF-8", b"utf-9")),
        "box.rexs: expected XML in UTF-8, got: unknown encoding: utf-9",
    ),
    "other XML": (
        FileContent(Path("box.rexs"), b"<svg/>"),
        "box.rexs: expected a REXS file with a `model` at its top, got other XML",
    ),
    "ids": (
        spoilt(lambda own: own.replace(b'component id="2"', b'component id="1"')),
        "box.rexs: component 1: expected an id of its own, got that of gear_unit 1 'unit'",
    ),
    "json": (FileContent(Path("box.rexsj"), b'{"model": 5}'), "box.rexsj: expected model with keys, got 5"),
    "json twice": (
        FileContent(Path("box.rexsj"), b'{"model": {"a": 1, "a": 2}}'),
        "box.rexsj: expected each key once, got 'a' twice",
    ),
    "brackets": (FileContent(Path("box.rexsj"), b"[" * 100_000), "box.rexsj: expected JSON of a gearbox, got: "),
    "two in a zip": (
        FileContent(Path("box.rexsz"), zipped({"a.rexs": b"", "b.rexsj": b""})),
        "box.rexsz: expected one .rexs or .rexsj in the zip, got 2: a.rexs, b.rexsj",
    ),
    "bomb": (
        FileContent(Path("box.rexsz"), zipped({"a.rexs": b" " * (LARGEST_TEXT + 1)})),
        "box.rexsz: a.rexs: expected at most 20 MB unpacked",
    ),
    "damaged zip": (
        FileContent(Path("box.rexsz"), b"PK\x03\x04" + b"x" * 50),
        "box.rexsz: expected a zip that can be ",
    ),
    "many in a zip": (
        FileContent(Path("box.rexsz"), zipped({f"{k}.png": b"" for k in range(MOST_MEMBERS + 1)})),
        "box.rexsz: expected at most 1000 files in the zip, got 1001",
    ),
    "many stages": (
        replace(pair(), relations=[*pair().relations, *[("stage", {"stage": 11, "gear_1": 5, "gear_2": 8})] * 200]),
        "box.rexs: expected at most 200 cylindrical stages, got 201",
    ),
    "many relations": (
        replace(pair(), relations=[("x", {})] * (2 * MOST_COMPONENTS + 1)),
        "box.rexs: expected at most 50000 components and twice as many relations, got 13 and 100001",
    ),
    "no whole number": (
        pair().having(5, number_of_teeth=(23.5, "none")),
        "box.rexs: cylindrical_gear 5 'pinion': number_of_teeth: expected a whole number, got 23.5",
    ),
    "no teeth": (
        pair().having(5, number_of_teeth=(-23, "none")),
        "box.rexs: cylindrical_gear 5 'pinion': number_of_teeth: expected a number above 0, got -23",
    ),
    "no module": (
        pair().having(5, normal_module=(0.0, "mm")),
        "box.rexs: cylindrical_gear 5 'pinion': expected a module and a pressure angle above 0, and angles below 69",
    ),
    "words": (
        pair().having(5, normal_module=("two", "mm")),
        "box.rexs: cylindrical_gear 5 'pinion': normal_module: expected a number, got 'two'",
    ),
    "two numbers": (
        pair().having(5, normal_module=((2.0, 2.0), "mm")),
        "box.rexs: cylindrical_gear 5 'pinion': normal_module: expected one value, got 2",
    ),
    "plane": (
        pair().having(3, support_vector=((0.0, 1.0), "mm")),
        "box.rexs: shaft 3 'in': support_vector: expected 3 numbers, got 2",
    ),
    "pressure angles": (
        pair().having(6, normal_pressure_angle=(25.0, "deg")).having(7, normal_pressure_angle=(25.0, "deg")),
        "box.rexs: cylindrical_stage 11: expected gears of one normal_pressure_angle, got two",
    ),
    "two rings": (
        pair().typed(5, "ring_gear").typed(8, "ring_gear"),
        "box.rexs: cylindrical_stage 11: expected at most one ring_gear, got two",
    ),
    "no gear": (
        pair().typed(5, "worm_gear"),
        "box.rexs: worm_gear 5 'pinion': expected a cylindrical_gear or ring_gear in a cylindrical_stage",
    ),
    "one gear": (
        replace(pair(), relations=[*pair().relations[:-3], ("stage", {"stage": 11, "gear_1": 5, "gear_2": 5})]),
        "box.rexs: cylindrical_stage 11 'mesh': expected two gears, got cylindrical_gear 5 'pinion' twice",
    ),
    "no distance": (
        pair().having(11, center_distance=(0.0, "mm")),
        "box.rexs: cylindrical_stage 11 'mesh': center_distance: expected one above 0, got 0",
    ),
    "two shafts": (
        pair().related("assembly", assembly=4, part=5),
        "box.rexs: cylindrical_gear 5 'pinion': expected it on one shaft, got 3 and 4",
    ),
    "position of nothing": (
        pair().having(3, reference_component_for_position=(99, "none")),
        "box.rexs: shaft 3 'in': reference_component_for_position: expected a component of the file, got the id 99, "
        "which it does not have",
    ),
    "no axis": (
        pair().having(3, u_axis_vector=((0.0, 0.0, 0.0), "mm")),
        "box.rexs: shaft 3 'in': expected u and w axes with a length, got none",
    ),
    "skew axes": (
        pair().having(3, w_axis_vector=((0.1, 0.0, 1.0), "mm")),
        "box.rexs: shaft 3 'in': expected a w axis square to the u axis, got another",
    ),
    "one shaft": (
        replace(
            pair(),
            relations=[
                (kind, {**own, "assembly": 3} if own.get("part") == 8 else own) for kind, own in pair().relations
            ],
        ),
        "box.rexs: cylindrical_stage 11: expected gears on two shafts, got shafts that turn as one",
    ),
    "crossed shafts": (
        pair().having(4, u_axis_vector=((0.0, 1.0, 0.0), "mm")),
        "box.rexs: cylindrical_stage 11: expected shafts with parallel u axes, got others",
    ),
    "no planets": (
        replace(planetary(), relations=[own for own in planetary().relations if own[0] != "planet_shaft"]),
        "box.rexs: planetary_stage 6 'set': expected planet_shaft, planet_carrier_shaft and cylindrical stages, got",
    ),
    "planets in mesh": (
        planetary().related("planet_shaft", planetary_stage=6, shaft=3),
        "box.rexs: cylindrical_stage 20: expected one gear of a planet, the other central, got 2",
    ),
    "a planet without meshes": (
        planetary().related("planet_shaft", planetary_stage=6, shaft=5),
        "box.rexs: planetary_stage 6 'set': expected the meshes of 4 planets, got those of 3",
    ),
    "no common distance": (
        planetary(1).having(21, center_distance=(78.1, "mm")),
        "box.rexs: planetary_stage 6 'set': expected one center_distance of all meshes, got 78 and 78.1 mm",
    ),
    "one central gear": (
        replace(planetary(), relations=[own for own in planetary().relations if 12 not in own[1].values()]),
        "box.rexs: planetary_stage 6 'set': expected a sun and a ring, or two rings, got one central gear",
    ),
    "a planet with other meshes": (
        pair_on_a_planet(),
        "box.rexs: planetary_stage 6 'set': expected gears of planets that mesh in it alone, got others",
    ),
    "two held": (
        planetary().related("side", assembly=8, inner_part=3, outer_part=2),
        "box.rexs: planetary_stage 6 'set': expected one shaft coupled to the casing, got 2",
    ),
    "bytes": (FileContent(Path("box.rexsj"), b'{"model": "\xff"}'), "box.rexsj: byte 11: expected JSON in UTF-8"),
    "no json": (FileContent(Path("box.rexsj"), b'{"model": \n5'), "box.rexsj: line 2: expected JSON, got: "),
    "json list": (
        FileContent(Path("box.rexsj"), b'{"model": {"version": "1.7", "components": {"a": 1}}}'),
        'box.rexsj: expected a list of components, got {"a": 1}',
    ),
    "infinite": (FileContent(Path("box.rexsj"), b'{"model": NaN}'), "box.rexsj: expected numbers, got NaN"),
    "id": (
        spoilt(lambda own: own.replace(b'component id="2"', b'component id="two"')),
        "box.rexs: id of a component: expected a whole number, got 'two'",
    ),
    "attribute twice": (
        spoilt(lambda own: own.replace(b'id="normal_module"', b'id="number_of_teeth"', 1)),
        "box.rexs: component 5: expected each attribute once, got number_of_teeth twice",
    ),
    "json attribute twice": (
        FileContent(Path("box.rexsj"), pair().json().replace(b'"normal_module"', b'"number_of_teeth"', 1)),
        "box.rexsj: component 5: expected each attribute once, got number_of_teeth twice",
    ),
    "empty": (FileContent(Path("box.rexs"), b""), "box.rexs: line 1: expected XML, got: no element found"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused_in_one_line(name: str) -> None:
    content, expected = BAD[name]
    assert isinstance(content, Rexs | FileContent)
    assert refusal(content).startswith(expected), refusal(content)


def test_spoilt_limits_and_unknown_stages_are_named_and_the_rest_is_drafted() -> None:
    series = "tooth_thickness_deviation_tolerance_series_din_3967_1978"
    rexs = pair().having(5, **{series: (False, "none")})
    number = len(rexs.components) + 1
    more: dict[int, tuple[str, str, Attributes]] = {
        number: ("bevel_stage", "angle drive", {}),
        number + 1: ("bevel_gear", "b", {}),
        number + 2: ("involute_spline_connection", "", {}),
    }
    rexs = replace(rexs, components={**rexs.components, **more})
    for name in ("box.rexs", "box.rexsj"):
        text, drafted = gearbox_scene_from(rexs.file(name))
        left = [own for own in drafted.notes() if own.startswith("left out: ")]
        assert left == [
            f"left out: cylindrical_gear 5 'pinion': {series}: expected a value, got 'false'; the program that wrote "
            "it lost it",
            "left out: bevel_stage 'angle drive': not drafted",
            f"left out: involute_spline_connection {number + 2}: not drafted",
        ]
        assert all(own.removeprefix("left out: ") in text for own in left)
        assert "  # pinion tooth thickness: " in text


SERIES = "tooth_thickness_deviation_tolerance_series_din_3967_1978"
NAMED = {
    "lost position": (
        pair().having(3, u_axis_vector=(False, "mm")),
        "shaft 3 'in': u_axis_vector: expected a value, got 'false'; the program that wrote it lost it",
    ),
    "one limit": (
        pair().having(11, lower_center_distance_allowance=(5.0, "mum")),
        "cylindrical_stage 11 'mesh': expected lower_center_distance_allowance and upper_center_distance_allowance, "
        "got one of them",
    ),
    "limits the other way round": (
        pair().having(13, minimum_radial_bearing_clearance=(25.0, "mum")),
        "rolling_bearing_with_catalog_geometry 13 'rear': minimum_radial_bearing_clearance: expected at most "
        "maximum_radial_bearing_clearance, got 0.025 mm and 0.02 mm",
    ),
    "preload": (
        pair().having(12, radial_clearance=(-3.0, "mum")),
        "concept_bearing 12 'front': radial_clearance: expected a clearance above 0, got -0.003 mm, a preload",
    ),
    "field": (
        pair().having(11, center_distance_tolerance_field_din_3964_1980=("h7", "none")),
        "cylindrical_stage 11 'mesh': center_distance_tolerance_field_din_3964_1980: expected 5 to 11, got 'h7'",
    ),
    "two names": (
        pair().having(5, din_3967_deviation_tolerance_series=("h25", "none")),
        f"cylindrical_gear 5 'pinion': expected one value, got two of {SERIES} and its old name "
        "din_3967_deviation_tolerance_series",
    ),
    "tip diameter": (
        pair().having(5, tip_diameter=(1.0, "mm")),
        "cylindrical_gear 5 'pinion': tip_diameter: expected one above the reference diameter 46 mm, got 1 mm",
    ),
    "pins without diameter": (
        pair().having(
            5,
            lower_backlash_allowance_balls_or_pins=(-0.2, "mm"),
            upper_backlash_allowance_balls_or_pins=(-0.1, "mm"),
        ),
        "cylindrical_gear 5 'pinion': …_backlash_allowance_balls_or_pins: not read without "
        "diameter_of_measuring_ball_or_pin",
    ),
    "ring": (
        planetary().having(
            12,
            lower_backlash_allowance_referenced_to_span=(-90.0, "mum"),
            upper_backlash_allowance_referenced_to_span=(50.0, "mum"),
        ),
        "ring_gear 12 'ring': …_backlash_allowance_referenced_to_span: not read of a ring with limits to both sides of "
        "0, whose sign is not told",
    ),
    "run-out": (
        pair().having(5, runout_tolerance=(20.0, "mum")),
        "cylindrical_gear 5 'pinion': runout_tolerance: not read",
    ),
    "classes of a set": (
        planetary().having(9, tolerance_class_according_to_iso_1328_2013=("6", "none")),
        "sun: class 6 of ISO 1328-1: single teeth of planetary sets do not deviate",
    ),
    "class of a gear in a ring": (
        pair(helix=12.0).typed(8, "ring_gear").having(
            8, helix_angle_reference_diameter=(12.0, "deg"), tolerance_class_according_to_iso_1328_2013=("6", "none"),
        ),
        "wheel: class 6 of ISO 1328-1: single teeth of meshes with rings do not deviate",
    ),
    "shafts apart": (
        pair().having(4, support_vector=((5.0, 0.0, 60.5), "mm")),
        "cylindrical_stage 11: its shafts lie 60.5 mm apart; center_distance 60.6 mm is drafted",
    ),
    "gear without a mate": (
        replace(pair(), components={**pair().components, 14: pair().components[8]}),
        "cylindrical_gear 14 'wheel': without a mesh, not drafted",
    ),
    "bearing in a shaft": (
        pair().related("side", assembly=14, inner_part=3, outer_part=4),
        "1 bearing (needle) between parts that turn: not drafted",
    ),
    "third bearing": (
        pair().related("side", assembly=14, inner_part=3, outer_part=2),
        "1 bearing (needle) on a shaft of a planetary stage or without gears, without a place, or a third one: not "
        "drafted",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", NAMED)
def test_limits_that_cannot_be_read_are_named(name: str) -> None:
    rexs, expected = NAMED[name]
    if len(rexs.components) == 13:
        rexs = replace(rexs, components={**rexs.components, 14: ("concept_bearing", "needle", {})})
    drafted = gearbox_draft(rexs.file())
    assert f"left out: {expected}" in list(drafted.notes())
    assert f"#   {expected}" in drafted.scene()[0]


def test_many_lines_are_left_to_the_scene() -> None:
    rexs = pair()
    more: dict[int, tuple[str, str, Attributes]] = {100 + k: (f"spline_{k:02}", "", {}) for k in range(15)}
    drafted = gearbox_draft(replace(rexs, components={**rexs.components, **more}).file())
    assert list(drafted.notes())[-1] == "left out: 3 more, see the end of the scene"
    assert "spline_14 114: not drafted" in drafted.scene()[0]


def test_a_spoilt_letter_of_a_name_changes_no_line() -> None:
    hostile = ("a: b", "# x", "on", "é\u2028x", "x" * 300, "[1]", "*z", "1e3", "a.b/c", "pinion", "pinion", '"', "")
    wanted = yaml.safe_load(gearbox_draft(pair().file()).scene()[0])
    rexs = pair()
    names = dict(zip(rexs.components, hostile, strict=True))
    named = {number: (kind, names[number], own) for number, (kind, _, own) in rexs.components.items()}
    _, read = scene_of(replace(rexs, components=named))
    for section in ("parts", "tolerances", "moves", "measures"):
        assert [own["kind"] for own in read[section].values()] == [own["kind"] for own in wanted[section].values()]


def test_tips_and_flank_classes_are_those_of_the_file() -> None:
    """Addendum (d_a - d)/(2 m) - x: (51.6 - 46)/4 - 0.2 = 1.2; a coarser class of the pitch counts."""
    rexs = pair().having(
        5,
        tip_diameter=(51.6, "mm"),
        global_tolerance_class_iso_1328_2013=("6", "none"),
        single_pitch_tolerance_class_iso_1328_2013=("7", "none"),
        cumulative_pitch_tolerance_class_iso_1328_2013=("8", "none"),
    )
    _, read = scene_of(rexs)
    assert read["parts"]["pinion"]["addendum"] == 1.2
    classes = {own["kind"]: own["limits"]["iso_class"] for own in read["tolerances"].values() if "limits" in own}
    assert classes == {"pitch_deviation": 8, "profile_slope": 6, "helix_slope": 6}


def test_the_gear_that_drives_is_that_of_the_file_else_the_smaller_one() -> None:
    rexs = pair()
    assert yaml.safe_load(gearbox_draft(rexs.file()).scene()[0])["moves"]["mesh"]["driver"] == "pinion"
    data = {14: ("stage_gear_data", "", {"is_driving_gear": (True, "none")})}
    driven = replace(rexs, components={**rexs.components, **data}).related(
        "stage_gear_data", stage=11, gear=8, stage_gear_data=14
    )
    moves = yaml.safe_load(gearbox_draft(driven.file()).scene()[0])["moves"]
    assert (moves["mesh"]["driver"], moves["train to in"]["driven"]) == ("wheel", "out")
    assert moves["mesh"]["azimuth"] == "180 deg"


@pytest.mark.parametrize(("first", "expected"), [(5, "-30 deg"), (8, "150 deg")])
def test_without_positions_stages_say_where_their_gears_lie(first: int, expected: str) -> None:
    """The angle is counted about -u, and from gear 1 to gear 2; the pinion drives."""
    relations = [own for own in pair().relations if own[0] != "stage"]
    rexs = replace(pair(), relations=relations).related("stage", stage=11, gear_1=first, gear_2=13 - first)
    rexs = rexs.having(4, support_vector=None).having(11, rotating_angle_around_neg_u_axis=(30.0, "deg"))
    assert yaml.safe_load(gearbox_draft(rexs.file()).scene()[0])["moves"]["mesh"]["azimuth"] == expected


def rexs_frame(at: tuple[float, float, float]) -> dict[str, tuple[tuple[float, float, float], str]]:
    return {"support_vector": (at, "mm"), "u_axis_vector": ((0.0, 1.0, 0.0), "mm")}


def test_positions_may_refer_to_each_other_and_leave_out_w() -> None:
    """The second shaft stands in the frame of the first, which is turned and moved."""
    rexs = pair().having(1, **rexs_frame((1.0, 2.0, 3.0)), reference_component_for_position=(1, "none"))
    rexs = rexs.having(3, support_vector=((7.0, 8.0, 9.0), "mm"), w_axis_vector=((0.0, 1.0, 0.0), "mm"))
    at = ((0.0, 60.6, 0.0), "mm")
    rexs = rexs.having(4, reference_component_for_position=(3, "none"), support_vector=at, w_axis_vector=None)
    drafted = gearbox_draft(rexs.file())
    assert drafted.remarks == []
    assert yaml.safe_load(drafted.scene()[0])["moves"]["mesh"]["azimuth"] == "-90 deg"  # v is clockwise of w


def test_a_chain_of_couplings_makes_one_shaft() -> None:
    """The wheel's shaft goes on 100 mm further, with a second pinion there; a disengaged coupling joins nothing."""
    for engaged in (True, False):
        writer = Writer()
        shafts = [writer.shaft(str(k), at) for k, at in enumerate([(0.0, 0.0, 0.0), (0.0, 0.0, 45.0)])]
        shafts += [writer.shaft("2", (100.0, 0.0, 45.0)), writer.shaft("3", (100.0, 0.0, 95.0))]
        teeth = ((0, 20, 1.5), (1, 40, 1.5), (2, 18, 2.0), (3, 32, 2.0))
        gears = [writer.gear("abcd"[k], shafts[k], z, module, 0.0, series="d25") for k, z, module in teeth]
        writer.stage("first", gears[0], gears[1], 45.0)
        writer.stage("second", gears[2], gears[3], 50.0)
        coupling = writer.add("switchable_coupling", is_engaged=(engaged, "none"))
        writer.relate("side", assembly=coupling, inner_part=shafts[1], outer_part=shafts[2])
        _, read = scene_of(writer.rexs())
        trains = [(own["driven"], own["output"]) for own in read["moves"].values() if own["kind"] == "train"]
        assert trains == ([("0", "3")] if engaged else [("0", "1"), ("2", "3")])
        if engaged:
            assert read["parts"]["1"]["carries"] == {"b": {"at": "27.5 mm"}, "c": {"at": "127.5 mm"}}


def test_a_ring_that_drives_or_is_driven_has_its_teeth_where_the_file_has_them() -> None:
    """The ring's axis lies 20 mm along w from the pinion's: teeth meet on the other side of the pinion."""
    writer = Writer()
    first, second = writer.shaft("in", (0.0, 0.0, 0.0)), writer.shaft("rim", (0.0, 0.0, 20.0))
    pinion = writer.gear("pinion", first, 20, 2.0, 0.1, series="d25")
    ring = writer.gear("ring", second, 40, 2.0, -0.1, ring=True, series="d25")
    stage = writer.stage("mesh", pinion, ring, 20.0)
    _, read = scene_of(writer.rexs().having(ring, tip_diameter=(76.8, "mm")))
    assert read["parts"]["ring"]["addendum"] == 0.9  # (80 - 76.8)/4 + 0.1
    assert read["moves"]["mesh"]["azimuth"] == "180 deg"
    assert read["parts"]["ring"]["kind"] == "internal_gear"
    data = writer.add("stage_gear_data", is_driving_gear=(True, "none"))
    writer.relate("stage_gear_data", stage=stage, gear=ring, stage_gear_data=data)
    _, read = scene_of(writer.rexs().having(ring, tip_diameter=(76.8, "mm")))
    assert read["moves"]["mesh"]["driver"] == "ring"
    assert read["moves"]["mesh"]["azimuth"] == "180 deg"


@pytest.mark.parametrize(("shifts", "distance"), [((0.2, 0.0), 30.97), ((0.3, -0.3), 31.2), ((-0.1, 0.25), 31.02)])
def test_backlash_in_a_ring_is_that_of_the_gears_in_3d(shifts: tuple[float, float], distance: float) -> None:
    writer = Writer()
    first, second = writer.shaft("in", (0.0, 0.0, 0.0)), writer.shaft("rim", (0.0, 0.0, distance))
    ring = writer.gear("ring", second, 70, 1.25, shifts[1], ring=True, series="d25")
    writer.stage("mesh", writer.gear("pinion", first, 20, 1.25, shifts[0], series="d25"), ring, distance)
    rexs = writer.rexs().having(ring, tip_diameter=(85.375 - 2.5 * shifts[1], "mm"))
    (stage,) = gearbox(rexs).stages
    simulation = simulated(scene_of(rexs)[0])
    (nominal, _) = extremes(simulation, "mesh normal backlash", {})
    assert stage.normal_backlash == pytest.approx(nominal, abs=1e-6)


@pytest.mark.parametrize(("own", "fits"), [(12.0, True), (-12.0, False)])
def test_a_helical_gear_and_its_ring_have_the_same_hand(own: float, fits: bool) -> None:
    rexs = pair(helix=12.0).typed(8, "ring_gear").having(8, helix_angle_reference_diameter=(own, "deg"))
    if fits:
        assert gearbox(rexs).stages[0].first.helical
    else:
        assert refusal(rexs).endswith("helix_angle_reference_diameter: expected one angle with one sign, got others")


def test_a_face_without_a_width_is_a_guess() -> None:
    text = gearbox_draft(pair().having(5, face_width=None).file()).scene()[0]
    assert "face_width: 20 mm, profile_shift: 0.2}  # gear 5; guess: face_width not in the file\n" in text
    assert text.count("guess") == 1


def test_numbers_in_brackets_are_part_of_a_name() -> None:
    rexs = pair()
    kind, _, attributes = rexs.components[8]
    named = replace(rexs, components={**rexs.components, 8: (kind, "Rad (grob [45])", attributes)})
    assert "Rad (grob 45)" in scene_of(named)[1]["parts"]


def test_pins_of_planets_have_allowances_or_are_asked_for() -> None:
    none = {"center_distance_tolerance_field_din_3964_1980": None}
    rexs = planetary()
    for number, own in planetary().components.items():
        rexs = rexs.having(number, **none) if own[0] == "cylindrical_stage" else rexs
    text = gearbox_draft(rexs.file()).scene()[0]
    assert (
        "  # set planet pins: {kind: planet_pin, of: carrier, direction: radial, distribution: {fit: js7, of: 78"
        in text
    )
    for number, own in planetary().components.items():
        if own[0] == "cylindrical_stage":
            rexs = rexs.having(
                number,
                lower_center_distance_allowance=(-4.0, "mum"),
                upper_center_distance_allowance=(9.0, "mum"),
            )
    assert scene_of(rexs)[1]["tolerances"]["set planet pins"]["distribution"] == ["-4 um", "9 um"]


def test_a_set_that_nothing_holds_has_its_ring_held_as_a_guess() -> None:
    rexs = planetary().having(8, is_engaged=(False, "none"))
    text = gearbox_draft(rexs.file()).scene()[0]
    assert "    held: ring  # guess: no coupling to the casing says it" in text


def test_a_held_carrier_and_loads_decide_what_drives() -> None:
    """The coupling holds the carrier instead of the ring: the sun drives the ring."""
    rexs = planetary()
    relations = [
        own if own[0] != "side" else ("side", {"assembly": 8, "inner_part": 5, "outer_part": 2})
        for own in rexs.relations
    ]
    move = yaml.safe_load(gearbox_draft(replace(rexs, relations=relations).file()).scene()[0])["moves"]["set"]
    assert (move["held"], move["input"], move["output"]) == ("carrier", "sun", "ring")


def test_two_shifts_that_the_file_does_not_say_are_0_and_what_is_left() -> None:
    rexs = pair()
    for side in (6, 7, 9, 10):
        rexs = rexs.having(side, addendum_modification_coefficient=None)
    (stage,) = gearbox(rexs.having(11, center_distance=(60.8, "mm"))).stages
    assert stage.first.profile_shift == 0.0
    assert stage.second.profile_shift == pytest.approx(stage.tight_shift, abs=1e-6)


def test_axes_nearer_than_base_circles_have_no_backlash_to_tell() -> None:
    (stage,) = gearbox(pair().having(11, center_distance=(50.0, "mm"))).stages
    assert (stage.working_angle, stage.tight_shift, stage.normal_backlash) == (None, None, None)


def test_backlash_that_the_program_worked_out_stands_beside_ours() -> None:
    rexs = pair().having(11, minimum_normal_backlash=(100.0, "mum"), maximum_normal_backlash=(0.2, "mm"))
    assert "# the file's program has 100 um to 200 um" in gearbox_draft(rexs.file()).scene()[0]


def test_planets_that_differ_are_refused() -> None:
    rexs = planetary()
    last = max(k for k, own in rexs.components.items() if own[1].startswith("planet wheel"))
    changed = rexs.having(last, tooth_thickness_deviation_tolerance_series_din_3967_1978=("d25", "none"))
    assert refusal(changed).startswith(
        "box.rexs: planetary_stage 6 'set': expected planets that are alike, got another"
    )


def test_rubbish_in_a_zip_is_passed_over() -> None:
    packed = zipped({"__MACOSX/._a.rexs": b"x", "pictures/a.png": b"x", "deep/model.rexs": pair().xml()})
    wanted = gearbox_draft(pair().file()).scene()[0]
    assert gearbox_draft(FileContent(Path("box.rexs"), packed)).scene()[0] == wanted


@pytest.mark.parametrize("name", ["a.rexs", "A.REXSJ", "a.rexsz", "a.rexs.zip"])
def test_the_name_says_that_a_file_is_rexs(name: str) -> None:
    assert is_rexs(Path(name))
    assert not is_rexs(Path(f"{name}.stp"))


def test_the_command_writes_a_scene_that_runs(tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "box.REXSZ").write_bytes(pair().file("a.rexsz").content)
    code, out, err = tol3d("new", "--from", "box.REXSZ")
    assert (code, out) == (0, "box.yaml\n")
    assert "Tolerances from box.REXSZ: 5." in err
    code, out, _ = tol3d("run", "box.yaml", "--trials", "20", "--no-picture")
    assert code == 0
    assert "lost motion of out" in out


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("a.rexs", "b.stp"), "--from: expected one REXS file and no other, got 2 files"),
        (("a.rexs", "--seat", "a.b", "--on", "c.d"), "--seat: expected STEP files"),
        (("a.rexs",), "a.rexs: expected a file, got no such file"),
    ],
)
def test_the_command_says_what_it_wants(tol3d: Command, arguments: tuple[str, ...], expected: str) -> None:
    code, _, err = tol3d("new", "--from", *arguments)
    assert code == 2
    assert expected in " ".join(err.split())
