"""Numbers that are most likely a slip: warned of just beyond each threshold, not before it, and of no bundled scene."""

import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from fixtures import Command
from places import SCENES
from scene_texts import scene_of

from tol3d import SceneError
from tol3d.kinds import load_scene
from tol3d.scene import Scene
from tol3d.simulate import simulation_of
from tol3d.study.system.mechanism import mechanism_of

Warned = Callable[..., Sequence[str]]
"""Warnings on a bundled scene in which some texts are replaced by others."""

TAN, COS = math.tan(math.radians(20)), math.cos(math.radians(20))


def of_the_system(scene: Scene) -> Sequence[str]:
    """Warnings of gears; assemblies have those of the scene alone, and take long to lay."""
    mechanism = mechanism_of(scene)
    return () if mechanism.name == "assembly" else mechanism.system_of(scene).warnings


@pytest.fixture
def warned(tmp_path: Path) -> Warned:
    def of(name: str, *edits: tuple[str, str]) -> Sequence[str]:
        text = (SCENES / f"{name}.yaml").read_text("utf-8")
        for old, new in edits:
            assert old in text, old
            text = text.replace(old, new, 1)
        for file in SCENES.glob("*.csv"):
            if not (tmp_path / file.name).exists():
                (tmp_path / file.name).write_bytes(file.read_bytes())
        scene = scene_of(text, tmp_path)
        return *scene.grammar.warnings(scene), *of_the_system(scene)

    return of


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.yaml")), ids=lambda path: path.stem)
def test_no_bundled_scene_warns(path: Path) -> None:
    scene = load_scene(path)
    assert (*scene.grammar.warnings(scene), *of_the_system(scene)) == ()


# slips in units and signs -------------------------------------------------------------------------

PAIR = "centre_distance: 172.5 mm"
SLIPS = {
    "a face of a tenth of the module": ("spur_pair", "face_width: 20 mm", "face_width: {}", ("0.2501 mm", "0.2499 mm")),
    "a shaft of a hundred diameters": ("gearbox_in_housing", "start: -100 mm", "start: {}", ("-1500 mm", "-1501 mm")),
    "a reducer's free turn": ("robot_shoulder", "backlash: 1 arcmin", "backlash: {}", ("5 deg", "5.001 deg")),
    "a field at another distance": (
        "spur_pair",
        "distribution: {kind: normal, lower: -20 um, upper: 20 um}",
        "distribution: {{fit: js7, of: {}, law: {{kind: uniform}}}}",
        ("171 mm", "170 mm"),
    ),
    "teeth thicker in every build": (
        "spur_pair",
        "distribution: {kind: normal, lower: -30 um, upper: -19 um}",
        "measured: {{span: 4}}\n    distribution: {{kind: normal, lower: {}, upper: 9 um}}",
        ("0 um", "1 um"),
    ),
    "the spring of a carrier": ("reducer_3k_flexible", "force: 60 N", "force: {}", ("1000 kN", "1001 kN")),
}


@pytest.mark.parametrize("words", SLIPS)
def test_a_slip_is_warned_of_just_beyond_what_may_be(words: str, warned: Warned) -> None:
    name, old, new, values = SLIPS[words]
    assert [len(warned(name, (old, new.format(own)))) for own in values] == [0, 1]


def test_whole_sizes_are_refused_where_deviations_belong(warned: Warned) -> None:
    """W of the pinion over 4 teeth: m cos(alpha) (3.5 pi + 28 inv alpha) = 26.8115 mm."""
    nominal = 2.5 * COS * (3.5 * math.pi + 28 * (TAN - math.radians(20)))
    old = "distribution: {kind: normal, lower: -30 um, upper: -19 um}"
    law = f"{{kind: normal, lower: {nominal - 0.038:.4f} mm, upper: {nominal - 0.001:.4f} mm}}"
    words = rf"expected deviations from the nominal span over 4 teeth of {nominal:.4f} mm, .*deviations they are -0.03"
    with pytest.raises(SceneError, match=words):
        warned("spur_pair", (old, f"measured: {{span: 4}}\n    distribution: {law}"))
    with pytest.raises(SceneError, match=r"nominal tooth thickness of 3\.9270 mm"):
        warned("spur_pair", (old, "distribution: {kind: uniform, lower: 3.85 mm, upper: 3.91 mm}"))


def test_what_is_less_than_physical_is_warned_of(tmp_path: Path) -> None:
    text = (
        (SCENES / "spur_pair.yaml")
        .read_text("utf-8")
        .replace("lower: 2 um, upper: 30 um", "lower: -3 um, upper: 30 um")
    )
    (line,) = simulation_of(scene_of(text, tmp_path)).warnings
    assert line == ("tolerances.bearing clearance: expected at least 0 um, for less is not physical, got down to -3 um")


TWO = """
scene: two points
parts:
  base:
    kind: solid
    features:
      face: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [30 mm, 20 mm]}
      pin: {kind: cylinder, at: [5 mm, 2 mm, 7 mm], axis: [0, 0, 1], length: 14 mm, diameter: 9 mm}
      far: {kind: point, at: [3 mm, FAR, 1 mm], normal: [0, 0, 1]}
tolerances:
  lean: {kind: perpendicularity, of: base.pin, zone: {diameter: WIDE}, law: {kind: uniform}, datums: [face]}
  size: {kind: size, of: base.pin, distribution: {fit: g6, of: CLASS, law: {kind: uniform}}}
moves: {table: {kind: fix, part: base}}
measures: {d: {kind: distance, from: base.face, to: base.far}}
"""
LEAN = 14 * math.tan(math.radians(10))


@pytest.mark.parametrize(
    ("word", "values", "said"),
    [
        ("FAR", ("10.0 m", "10.1 m"), "parts.base.features.far: expected a place within 10 m of another feature"),
        (
            "WIDE",
            (f"{LEAN - 1e-3:.4f} mm", f"{LEAN + 1e-3:.4f} mm"),
            "tolerances.lean.zone: expected a lean of at most",
        ),
        ("CLASS", ("9.08 mm", "9.1 mm"), "tolerances.size.distribution.of: expected the size of 'base.pin', 9 mm"),
    ],
)
def test_a_slip_in_a_drawing_is_warned_of(word: str, values: tuple[str, str], said: str, tmp_path: Path) -> None:
    lines = []
    for value in values:
        text = TWO.replace(word, value).replace("FAR", "1 m").replace("WIDE", "1 mm").replace("CLASS", "9 mm")
        scene = scene_of(text, tmp_path)
        lines.append(list(scene.grammar.warnings(scene)))
    assert lines[0] == []
    assert [line.startswith(said) for line in lines[1]] == [True]


# teeth ----------------------------------------------------------------------------------------------


def arc(module: float, shift: float = 0.0) -> float:
    """s = m (pi/2 + 2 x tan alpha) [mm]."""
    return module * (math.pi / 2 + 2 * shift * TAN)


R_E = 3 * math.sqrt(17**2 + 26**2 + 2 * 17 * 26 * math.cos(math.radians(75))) / (2 * math.sin(math.radians(75)))
"""Cone distance [mm] of every_bevel_field: m sqrt(z1^2 + z2^2 + 2 z1 z2 cos Sigma) / (2 sin Sigma)."""

PINION = "{kind: normal, lower: -36 um, upper: -20 um, sigmas: 4}"
HOUSED = "of: first pinion, distribution: {kind: normal, lower: -50 um, upper: -30 um}"
IN_TRAIN = "of: P2, measured: normal, distribution: {kind: uniform, lower: -45 um, upper: -25 um}"
OF_PLANETS = "measured: normal, distribution: {kind: normal, lower: -60 um, upper: -40 um}"
RV_SUN = "of: sun, measured: normal, distribution: {kind: normal, lower: -40 um, upper: -20 um}"
BEVEL = """of: wheel
    distribution: {kind: normal, lower: -60 um, upper: -40 um}"""
RING = """of: ring
    distribution: {kind: normal, lower: -60 um, upper: -30 um}"""

TEETH = {
    "a spur gear": ("every_field", PINION, arc(2.0, 0.2), "pinion"),
    "a ring": ("internal_pair", RING, arc(1.5, -0.25), "ring"),
    "a bevel gear, in the middle of its face": ("every_bevel_field", BEVEL, arc(3.0, -0.2) * (1 - 6 / R_E), "wheel"),
    "a gear in a housing": ("housed_gears", HOUSED, arc(1.5), "first pinion"),
    "a planet, along the normal": ("every_planetary_field", OF_PLANETS, arc(1.5) * COS, "planet wheel"),
    "a planet of a set in a train, along the normal": ("reducer_3k_train", IN_TRAIN, arc(1.0) * COS, "P2"),
    "the sun of an RV reducer, along the normal": ("rv_250aii", RV_SUN, arc(2.0) * COS, "sun"),
}


@pytest.mark.parametrize("words", TEETH)
def test_teeth_may_be_a_tenth_thinner(words: str, warned: Warned) -> None:
    name, old, thickness, gear = TEETH[words]
    start = old[: old.index("{kind")]
    for share, count in ((0.0999, 0), (0.1001, 1)):
        lines = warned(name, (old, f"{start}{{kind: constant, value: {-share * thickness:.6f} mm}}"))
        assert len(lines) == count
    assert lines[0].startswith("tolerances.")
    assert f"distribution: expected at most 10 % of the tooth thickness of {gear!r}" in lines[0]
    assert "(10.01 %); state the deviation of the thickness from nominal" in lines[0]


def test_the_thickness_of_each_law_is_that_of_its_ends(warned: Warned, tmp_path: Path) -> None:
    """A tenth of the pinion is 0.34328 mm; a Rayleigh length reaches 3.6350 of its scale, sqrt(-2 ln 0.00135)."""
    with_outlier = "\n".join(["t [um]", *["-30"] * 999, "-344"])
    without = "\n".join(["t [um]", *["-30"] * 999, "-343"])
    for count, empirical in ((0, without), (1, with_outlier)):
        (tmp_path / "t.csv").write_text(empirical)
        law = '{kind: empirical, file: t.csv, column: "t [um]", unit: um, draws: as_measured}'
        assert len(warned("every_field", (PINION, law))) == count
    for below, above in (
        ("{kind: normal, lower: -343 um, upper: -300 um}", "{kind: normal, lower: -344 um, upper: -300 um}"),
        ("{kind: normal, mean: -313 um, sigma: 10 um}", "{kind: normal, mean: -314 um, sigma: 10 um}"),
        (
            "{kind: normal, lower: -320 um, upper: -300 um, sigmas: 1}",
            "{kind: normal, lower: -330 um, upper: -310 um, sigmas: 1}",
        ),
        ("{kind: uniform, lower: -343 um, upper: 0 um}", "{kind: uniform, lower: -344 um, upper: 0 um}"),
        (
            "{kind: triangular, lower: -343 um, mode: -9 um, upper: 0 um}",
            "{kind: triangular, lower: -344 um, mode: -9 um, upper: 0 um}",
        ),
        ("{kind: rayleigh, scale: 94.4 um}", "{kind: rayleigh, scale: 94.5 um}"),
    ):
        said = ["\n".join(warned("every_field", (PINION, law))) for law in (below, above)]
        assert ["at most 10 %" in own for own in said] == [False, True], below


def test_teeth_whose_flanks_meet_at_the_tip_are_refused(warned: Warned) -> None:
    """The angle 2 (s/(2 r) + inv alpha - inv alpha_a) that a tooth takes at its tip closes by E/r."""
    at_tip = math.acos(24 * COS / 26.4)  # r = 24 mm, r_a = 26.4 mm
    pointed = arc(2.0, 0.2) + 48 * (TAN - math.radians(20) - (math.tan(at_tip) - at_tip))
    law = "{{kind: constant, value: {:.4f} mm}}"
    assert len(warned("every_field", (PINION, law.format(-pointed + 0.001)))) == 1
    words = "tolerances.pinion tooth thickness.distribution: expected teeth of 'pinion' .* where their flanks meet"
    with pytest.raises(SceneError, match=words):
        warned("every_field", (PINION, law.format(-pointed - 0.001)))
    with pytest.raises(SceneError, match="planet wheel"):
        warned("every_planetary_field", (OF_PLANETS, "distribution: {kind: constant, value: -40 mm}"))


# RV reducers ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("field", "below", "above"),
    [
        ("shift", "-249 um", "-251 um"),  # 5 % of a pin radius of 5 mm are 250 um
        ("offset", "249 um", "251 um"),
        ("rotation", "9.97 arcmin", "10.03 arcmin"),  # at a lever of 39 * 2.2 mm = 85.8 mm: 10.017 arcmin
    ],
)
def test_discs_may_be_ground_by_a_twentieth_of_the_pin_radius(
    field: str, below: str, above: str, warned: Warned
) -> None:
    as_drawn = "shift: -20 um, offset: -12.795 um"
    others = {"shift": "", "offset": "shift: -20 um, ", "rotation": "shift: -20 um, offset: 0 um, "}[field]
    found = [warned("rv_250aii", (as_drawn, f"{others}{field}: {value}")) for value in (below, above)]
    assert [len(lines) for lines in found] == [0, 1]
    assert found[1][0].startswith(f"parts.disc.{field}: expected at most 5 % of the pin radius of 'pin ring' (5 mm)")


@pytest.mark.parametrize(
    ("old", "kind"),
    [
        ("{kind: normal, lower: -10 um, upper: 10 um}", "disc pitch"),
        ("{kind: normal, lower: -0.5 um, upper: 0.5 um}", "disc profile"),
        ("{kind: rayleigh, scale: 0.66666667 um}", "crank run-out"),
        ("{kind: rayleigh, scale: 2 um}", "disc run-out"),
    ],
)
def test_lobes_discs_and_cranks_may_lie_off_by_half_of_the_pin_radius(old: str, kind: str, warned: Warned) -> None:
    """2.5 mm."""
    found = [warned("rv_250aii", (old, f"{{kind: constant, value: {value}}}")) for value in ("2.5 mm", "2.51 mm")]
    assert [len(lines) for lines in found] == [0, 1]
    words = f"tolerances.{kind}.distribution: expected at most 50 % of the pin radius of 'pin ring' (5 mm), got 2.51 mm"
    assert found[1][0].startswith(words)


AS_PITCHED = "direction: tangential, distribution: {kind: normal, lower: -0.1 um, upper: 0.1 um}"


def test_pins_may_lie_off_by_half_of_their_pitch(warned: Warned) -> None:
    """The pitch is 2 * 114.5 mm sin(pi/40) = 17.967 mm: 8.983 mm."""
    law = "direction: radial, distribution: {{kind: uniform, lower: -0.1 um, upper: {}}}"
    found = [warned("rv_250aii", (AS_PITCHED, law.format(upper))) for upper in ("8.98 mm", "8.99 mm")]
    assert [len(lines) for lines in found] == [0, 1]
    words = "tolerances.pin pitch.distribution: expected at most 50 % of the pitch of the pins of 'pin ring' (17.97 mm)"
    assert found[1][0].startswith(words)


def test_neighbouring_pins_may_come_close(warned: Warned) -> None:
    """Between pins of 10 mm are 7.9671 mm; pins 17.5 um further in take 2 * 0.0175 mm sin(pi/40) = 0.0027 mm of it.

    Towards each other they have 3.9822 mm each, and overlap by 0.0016 mm at 3.983 mm.
    """
    law = "direction: tangential, distribution: {{kind: uniform, lower: -{0}, upper: {0}}}"
    found = [warned("rv_250aii", (AS_PITCHED, law.format(far))) for far in ("3.981 mm", "3.983 mm")]
    assert [len(lines) for lines in found] == [0, 1]
    assert found[1][0].startswith("parts.pin ring.pin_radius: expected pins that stay clear of their neighbours")
    assert "overlap by up to 0.0016" in found[1][0]


# planetary sets -------------------------------------------------------------------------------------


ROUND = "direction: tangential, distribution: {kind: normal, lower: -6 um, upper: 6 um}"


def test_planets_may_come_close(warned: Warned) -> None:
    """Three pins at 33.9 mm are 33.9 sqrt(3) = 58.7165 mm apart, and planets have tips of 1.5 * 23 = 34.5 mm.

    Of the 24.2165 mm between them the other pins' tolerances take 2 * 14.5401 um (a Rayleigh length of 4 um),
    2 * 5 um (a bore's zone) and 6 um sqrt(3) (inwards): 24.1670 mm remain, 12.0835 mm for each.
    """
    law = "direction: tangential, distribution: {{kind: uniform, lower: -{0}, upper: {0}}}"
    found = [warned("every_planetary_field", (ROUND, law.format(far))) for far in ("12.08 mm", "12.09 mm")]
    assert [len(lines) for lines in found] == [1, 2]  # far beyond half of a module they are in any case
    assert found[1][1].startswith("moves.stage.planets: expected planets that stay clear of their neighbours")


def test_pins_of_planets_may_lie_off_by_half_of_a_module(warned: Warned) -> None:
    law = "direction: radial, distribution: {{kind: constant, value: {}}}"
    found = [warned("every_planetary_field", (ROUND, law.format(far))) for far in ("0.75 mm", "-0.751 mm")]
    assert [len(lines) for lines in found] == [0, 1]
    words = "tolerances.pins round.distribution: expected at most 50 % of the module of 'planet wheel' (1.5 mm)"
    assert found[1][0].startswith(words)


@pytest.mark.parametrize(
    ("name", "old", "below", "above", "gear"),
    [  # a Rayleigh length reaches 3.6350 of its scale: 1 mm at 0.2751 mm, 0.75 mm at 0.20633 mm
        ("every_field", "{kind: rayleigh, scale: 3 um}", "{SCALE 275 um}", "{SCALE 276 um}", "pinion"),
        ("every_field", "{kind: rayleigh, scale: 1.5 um}", "{SCALE 275 um}", "{SCALE 276 um}", "pinion"),
        ("every_field", "mean: 0 um, sigma: 6 um, lower: -12 um", "LOW -1 mm", "LOW -1.1 mm", "pinion"),
        ("every_planetary_field", "{kind: rayleigh, scale: 3 um}", "{SCALE 206 um}", "{SCALE 207 um}", "planet wheel"),
        (
            "every_bevel_field",
            "lower: -9 um, upper: 9 um",
            "lower: -9 um, upper: 1.5 mm",
            "lower: -9 um, upper: 1.51 mm",
            "pinion",
        ),
        (
            "housed_gears",
            "lower: 5 um, upper: 15 um",
            "lower: 0 mm, upper: 1 mm",
            "lower: 0 mm, upper: 1.1 mm",
            "second wheel",
        ),
    ],
)
def test_axes_may_lie_off_by_half_of_a_module(
    name: str, old: str, below: str, above: str, gear: str, warned: Warned
) -> None:
    full = [law.replace("SCALE", "kind: rayleigh, scale:") for law in (below, above)]
    full = [law.replace("LOW", "mean: 0 um, sigma: 6 um, lower:") for law in full]
    found = [warned(name, (old, law)) for law in full]
    assert [len(lines) for lines in found] == [0, 1]
    assert f"distribution: expected at most 50 % of the module of {gear!r}" in found[1][0]


# faces and temperatures -----------------------------------------------------------------------------


def test_gears_may_shift_by_their_face_width(warned: Warned) -> None:
    """The wheel of every_field is 16 mm wide; the end of a law that is farther from 0 counts."""
    old = "lower: -0.1 mm, upper: 0.1 mm"
    found = [warned("every_field", (old, f"lower: {low}, upper: 15 mm")) for low in ("-16 mm", "-16.1 mm")]
    assert [len(lines) for lines in found] == [0, 1]
    words = "distribution: expected at most 100 % of the face width of 'wheel' (16 mm), got -16.1 mm (100.6 %)"
    assert words in found[1][0]


def test_shafts_may_slide_by_the_face_width_of_their_narrowest_gear(warned: Warned) -> None:
    """The second wheel of helical_gearbox is 74 mm wide."""
    old = "of: output, distribution: {kind: uniform, lower: 40 um, upper: 90 um}"
    found = [warned("helical_gearbox", (old, old.replace("90 um", size))) for size in ("74 mm", "90 mm")]
    assert [len(lines) for lines in found] == [0, 1]
    words = "distribution: expected at most 100 % of the face width of 'second wheel' (74 mm), got 90 mm (121.6 %)"
    assert words in found[1][0]


def test_faces_may_be_a_metre_wide(warned: Warned) -> None:
    found = [warned("every_field", ("face_width: 18 mm", f"face_width: {width}")) for width in ("1 m", "1001 mm")]
    assert found[0] == ()
    assert found[1] == ("parts.pinion.face_width: expected at most 1 m, got 1001 mm; check the unit",)


@pytest.mark.parametrize(
    ("law", "below", "above"),
    [
        ("{{kind: constant, value: {} K}}", -293.16, -293.15),
        ("{{kind: uniform, lower: {} K, upper: 20 K}}", -293.16, -293.15),
        ("{{kind: normal, mean: {} K, sigma: 1 K}}", -290.16, -290.14),  # to its 3 sigma
        ('{{kind: empirical, file: t.csv, column: "t [K] {}", unit: K}}', -293.16, -293.15),
    ],
)
def test_nothing_is_colder_than_absolute_zero(
    law: str, below: float, above: float, warned: Warned, tmp_path: Path
) -> None:
    """-273.15 degC are -293.15 K from 20 degC."""
    old = "{kind: normal, mean: 30 K, sigma: 10 K}"

    def laid(lowest: float) -> Sequence[str]:
        (tmp_path / "t.csv").write_text(f"t [K] {lowest}\n20\n{lowest}\n")
        lines = warned("warm_bar", (old, law.format(lowest)))
        scene = load_scene(tmp_path / "scene.yaml")
        mechanism_of(scene).system_of(scene)  # it reads what files have
        return lines

    assert laid(above) == ()
    with pytest.raises(SceneError, match=r"at least -293.15 K, which is absolute zero, .*got -293.16 K"):
        laid(below)


# shafts ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "below", "above", "words"),
    [
        (
            "far output bearing: {kind: bearing, shaft: output, at: 34 mm}",  # the shaft goes from -40 to 60 mm
            "far output bearing: {kind: bearing, shaft: output, at: 60 mm}",
            "far output bearing: {kind: bearing, shaft: output, at: 6.01 cm}",
            "parts.far output bearing.at: expected a place on 'output', whose end is at 60 mm, got 60.1 mm, 0.1 mm",
        ),
        (
            "output bearing: {kind: bearing, shaft: output, at: -34 mm}",
            "output bearing: {kind: bearing, shaft: output, at: -40 mm}",
            "output bearing: {kind: bearing, shaft: output, at: -41 mm}",
            "parts.output bearing.at: expected a place on 'output', whose start is at -40 mm, got -41 mm, 1 mm beyond",
        ),
        (
            "output: {kind: shaft, diameter: 20 mm",  # in a hub of 20 mm
            "output: {kind: shaft, diameter: 2 cm",
            "output: {kind: shaft, diameter: 20.1 mm",
            "parts.output.diameter: expected at most 20 mm, the diameter of the bore of 'second wheel', got 20.1 mm",
        ),
        (
            "at: [102.9 mm, 37.8 mm, -34 mm], axis: [0, 0, 1], length: 12 mm, diameter: 35 mm",  # around 20 mm
            "at: [102.9 mm, 37.8 mm, -34 mm], axis: [0, 0, 1], length: 12 mm, diameter: 20 mm",
            "at: [102.9 mm, 37.8 mm, -34 mm], axis: [0, 0, 1], length: 12 mm, diameter: 19.9 mm",
            "parts.output.diameter: expected at most 19.9 mm, the diameter of 'housing.output bore', got 20 mm",
        ),
        (
            "start: -40 mm, end: 60 mm",  # bores at -34 and 34 mm
            "start: -40 mm, end: 34 mm",
            "start: -40 mm, end: 33.9 mm",
            "parts.far output bearing.at: expected a place on 'output', whose end is at 33.9 mm, got 34 mm, 0.1 mm",
        ),
    ],
)
def test_shafts_fit(old: str, below: str, above: str, words: str, warned: Warned) -> None:
    assert warned("housed_gears", (old, below)) == ()
    assert warned("housed_gears", (old, above))[0].startswith(words)


def test_bores_hold_their_shaft(warned: Warned) -> None:
    """The middle shaft goes from -40 to 40 mm, its far bore is in the middle of 28 to 40 mm."""
    old = "middle: {kind: shaft, diameter: 12 mm, start: -40 mm, end: 40 mm"
    assert warned("housed_gears", (old, old.replace("end: 40 mm", "end: 34 mm"))) == ()
    (line,) = warned("housed_gears", (old, old.replace("end: 40 mm", "end: 33 mm")))
    words = "moves.middle in its bores.in[1]: expected a place on 'middle', whose end is at 33 mm, got 34 mm, 1 mm"
    assert line.startswith(words)


# features -------------------------------------------------------------------------------------------

PLATE = """
scene: a plate
parts:
  table: {kind: solid, features: {top: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], radius: 90 mm}}}
  plate:
    kind: solid
    features:
      hole: {kind: cylinder, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 9 mm, diameter: 8 mm, hole: true}
      ball: {kind: sphere, at: [9 mm, 0 mm, 0 mm], diameter: 6 mm}
      slot: {kind: slot, at: [0 mm, 9 mm, 0 mm], normal: [1, 0, 0], extent: [9 mm, 9 mm], width: 4 mm}
      axis: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 9 mm}
      face: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [9 mm, 9 mm]}
tolerances:
  own: TOLERANCE
moves:
  still: {kind: fix, part: table}
  too: {kind: fix, part: plate}
measures:
  gap: {kind: gap, from: table.top, to: plate.hole, along: [1, 0, 0]}
"""

SIZES = {
    "a position of a hole": (
        "{{kind: position, of: plate.hole, zone: {{diameter: {}}}, law: {{kind: uniform}}}}",
        ("4 mm", "4.01 mm"),
        "zone: expected at most 50 % of the diameter of 'plate.hole' (8 mm), got 4.01 mm (50.12 %)",
    ),
    "a process in a zone": (
        "{{kind: position, of: plate.ball, zone: {{diameter: 1 mm}}, "
        "law: {{kind: process, distribution: {{kind: normal, mean: 0 mm, sigma: {}}}}}}}",
        ("1 mm", "1.01 mm"),
        "law.distribution: expected at most 50 % of the diameter of 'plate.ball' (6 mm), got",
    ),
    "a position of a slot": (
        "{{kind: position, of: plate.slot, zone: {{width: {}}}, law: {{kind: normal}}}}",
        ("2 mm", "2.01 mm"),
        "zone: expected at most 50 % of the width of 'plate.slot' (4 mm), got 2.01 mm (50.25 %)",
    ),
    "a straightness": (
        "{{kind: straightness, of: plate.hole, zone: {{diameter: {}}}}}",
        ("0.4 cm", "0.41 cm"),
        "zone: expected at most 50 % of the diameter of 'plate.hole' (8 mm), got 4.1 mm (51.25 %)",
    ),
    "a size": (
        "{{kind: size, of: plate.hole, distribution: {{kind: uniform, lower: {}, upper: 0 mm}}}}",
        ("-4 mm", "-4.2 mm"),
        "distribution: expected at most 50 % of the diameter of 'plate.hole' (8 mm), got -4.2 mm (52.5 %)",
    ),
    "limits of a size": (
        "{{kind: size, of: plate.hole, limits: [0 mm, {}], distribution: {{kind: constant, value: 0 mm}}}}",
        ("4 mm", "5 mm"),
        "limits: expected at most 50 % of the diameter of 'plate.hole' (8 mm), got 5 mm (62.5 %)",
    ),
    "a dimension": (
        "{{kind: plus_minus, of: plate.slot, distribution: {{kind: constant, value: {}}}}}",
        ("2 mm", "-2.4 mm"),
        "distribution: expected at most 50 % of the width of 'plate.slot' (4 mm), got -2.4 mm (60 %)",
    ),
}


def of_the_plate(tmp_path: Path, tolerance: str) -> Sequence[str]:
    scene = scene_of(PLATE.replace("TOLERANCE", tolerance), tmp_path)
    return tuple(scene.grammar.warnings(scene))


@pytest.mark.parametrize("words", SIZES)
def test_a_deviation_may_be_half_of_its_feature(words: str, tmp_path: Path) -> None:
    tolerance, (below, above), expected = SIZES[words]
    assert of_the_plate(tmp_path, tolerance.format(below)) == ()
    (line,) = of_the_plate(tmp_path, tolerance.format(above))
    assert line.startswith(f"tolerances.own.{expected}")


def test_what_has_no_size_is_not_judged(tmp_path: Path) -> None:
    axis = "{kind: position, of: plate.axis, zone: {diameter: 200 mm}, law: {kind: uniform}}"
    face = "{kind: profile, of: plate.face, zone: {width: 200 mm}, law: {kind: uniform}}"
    assert (*of_the_plate(tmp_path, axis), *of_the_plate(tmp_path, face)) == ()


def test_check_and_run_say_it_and_the_summary_keeps_it(tol3d: Command, tmp_path: Path) -> None:
    text = (SCENES / "spur_pair.yaml").read_text("utf-8")
    shaft = """
  axle: {kind: shaft, start: -9 mm, end: 9 mm, carries: {pinion: {}}}
  ball: {kind: bearing, shaft: axle, at: 10 mm}"""
    for old, new in (
        ("{kind: normal, lower: -30 um, upper: -19 um}", "{kind: constant, value: -0.5 mm}"),
        ("\nparts:", f"\nparts:{shaft}"),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "thin.yaml").write_text(text, "utf-8")
    scene = load_scene(tmp_path / "thin.yaml")
    expected = [*scene.grammar.warnings(scene), *of_the_system(scene)]
    assert [line.partition(": ")[0] for line in expected] == [
        "parts.ball.at",
        "tolerances.pinion tooth thickness.distribution",
    ]
    run = ["run", str(tmp_path / "thin.yaml"), "--trials", "20", "--no-picture", "--out", str(tmp_path / "run"), "-q"]
    for command in (["check", str(tmp_path / "thin.yaml")], run):
        code, out, err = tol3d(*command)
        assert code == 0
        for line in expected:
            assert line in " ".join((out + err).split())
    assert json.loads((tmp_path / "run" / "summary.json").read_text("utf-8"))["warnings"][-2:] == expected
