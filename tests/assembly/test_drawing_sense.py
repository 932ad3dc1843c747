"""Drawings that make no sense are refused, and those that do mean what a metrologist reads."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled, uniform

from tol3d.errors import SceneError

BLOCK = """
scene: a block
parts:
  block:
    kind: solid
    features:
      floor: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}}
      top: {{kind: plane, at: [0 mm, 0 mm, 30 mm], normal: [0, 0, 1], extent: [100 mm, 60 mm]}}
      bore: {{kind: cylinder, at: [0 mm, 0 mm, 15 mm], axis: [0, 0, 1], length: 30 mm, diameter: 10 mm, hole: true}}
      seat: {{kind: cylinder, at: [30 mm, 0 mm, 15 mm], axis: [0, 0, 1], length: 30 mm, diameter: 10 mm, hole: true}}
tolerances:
{tolerances}
moves:
  machine: {{kind: fix, part: block}}
measures:
{measures}
"""

FLOOR = "  floor: {kind: profile, of: block.floor, zone: {width: 0.2 mm}, law: {kind: uniform}}\n"
PARALLEL = (
    "  parallel: {kind: parallelism, of: block.top, zone: {width: 0.02 mm}, law: {kind: uniform}, datums: [floor]}\n"
)
SEEN = "  parallelism: {kind: inspected_orientation, of: block.top, datums: [floor]}\n"


def thickness(datums: str) -> str:
    return f"  thickness: {{kind: plus_minus, of: block.top, distribution: {uniform(0.1)}{datums}}}\n"


def test_a_thickness_with_a_parallelism_to_the_floor(tmp_path: Path) -> None:
    """The top follows the floor, which tilts: its parallelism to it stays within the zone, and reaches it."""
    text = BLOCK.format(tolerances=FLOOR + thickness(", datums: [floor]") + PARALLEL, measures=SEEN)
    for method in ("exact", "analytic"):
        found = assembled(text, tmp_path).drawn(20_000, method)["parallelism"]
        assert found.max() == pytest.approx(0.02, rel=0.02)
        assert found.max() <= 0.02 * (1 + 1e-6)


def test_an_orientation_in_another_frame_than_its_feature_is_refused(tmp_path: Path) -> None:
    text = BLOCK.format(tolerances=FLOOR + thickness("") + PARALLEL, measures=SEEN)
    with pytest.raises(SceneError, match=r"parallel\.datums: .* give 'thickness' datums that begin with floor"):
        assembled(text, tmp_path)
    profile = "  profile: {kind: profile, of: block.top, zone: {width: 0.2 mm}, law: {kind: uniform}}\n"
    refined = PARALLEL.replace(" law: {kind: uniform},", "")
    with pytest.raises(SceneError, match="give 'profile' datums that begin with floor"):
        assembled(BLOCK.format(tolerances=FLOOR + profile + refined, measures=SEEN), tmp_path)


@pytest.mark.parametrize(
    ("located", "zone", "words"),
    [
        (("circular_run_out, zone: {width: 0.2 mm}",), "diameter: 0.05 mm", "in which the axis does not lean"),
        (
            ("position, zone: {width: 0.2 mm, along: [1, 0, 0]}", "position, zone: {width: 0.2 mm, along: [0, 1, 0]}"),
            "diameter: 0.05 mm",
            "a lean in both of these zones is not supported",
        ),
    ],
)
def test_a_lean_that_no_zone_of_location_has_is_refused(
    located: tuple[str, ...], zone: str, words: str, tmp_path: Path
) -> None:
    datum = "shaft" if "run_out" in located[0] else "floor"
    text = "".join(
        f"  at {k}: {{kind: {own}, of: block.bore, law: {{kind: uniform}}, datums: [{datum}]}}\n"
        for k, own in enumerate(located)
    )
    kind = "parallelism" if datum == "shaft" else "perpendicularity"
    text += f"  square: {{kind: {kind}, of: block.bore, zone: {{{zone}}}, datums: [{datum}]}}\n"
    shaft = "      shaft: {kind: axis, at: AT, axis: [0, 0, 1], length: 10 mm}\n"
    found = BLOCK.format(tolerances=text, measures=SEEN)
    bore = next(line for line in found.splitlines() if line.startswith("      bore:"))
    at = bore[bore.index("[") : bore.index("]") + 1]
    with pytest.raises(SceneError, match=words):
        assembled(found.replace("      bore:", f"{shaft.replace('AT', at)}      bore:", 1), tmp_path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "{kind: perpendicularity, of: block.top, zone: {width: 1 um}, law: {kind: uniform}, datums: [floor]}",
            "square to 'floor', got one that is parallel to it; that is a parallelism, write kind: parallelism",
        ),
        (
            "{kind: parallelism, of: block.bore, zone: {diameter: 1 um}, law: {kind: uniform}, datums: [floor]}",
            "parallel to 'floor', got one that is square to it; that is a perpendicularity, write kind: perpend",
        ),
        (
            "{kind: coaxiality, of: block.bore, zone: {diameter: 1 um}, law: {kind: uniform}, datums: [floor]}",
            "expected an axis among them",
        ),
        (
            "{kind: coaxiality, of: block.seat, zone: {diameter: 1 um}, law: {kind: uniform}, datums: [bore]}",
            r"own\.of: expected a feature that is nominally on the axis of 'bore', got one 30 mm beside it",
        ),
        (
            "{kind: total_run_out, of: block.seat, zone: {width: 1 um}, law: {kind: uniform}, datums: [bore]}",
            "got one 30 mm beside it",
        ),
    ],
)
def test_orientations_that_the_nominal_part_does_not_have(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        assembled(BLOCK.format(tolerances=f"  own: {text}\n", measures=SEEN), tmp_path)


CROSS = (
    "      wall: {kind: plane, at: [0 mm, -30 mm, 15 mm], normal: [0, -1, 0], extent: [100 mm, 30 mm]}\n"
    "      end: {kind: plane, at: [-50 mm, 0 mm, 15 mm], normal: [-1, 0, 0], extent: [60 mm, 30 mm]}\n"
    "      cross: {kind: cylinder, at: [0 mm, 0 mm, 15 mm], axis: [0, 1, 0], length: 60 mm, diameter: 8 mm}\n"
)
LOCATED = (
    "  position: {kind: position, of: block.cross, zone: {diameter: 0.2 mm}, law: {kind: uniform}, "
    "datums: [floor, wall, end]}\n"
)


def test_squareness_to_a_later_datum_is_refused_with_the_words_that_limit_the_same(tmp_path: Path) -> None:
    """The bore lies along the floor and square to the wall: parallel to the floor first, then square to the wall."""
    square = "  square: {kind: perpendicularity, of: block.cross, zone: {diameter: 0.05 mm}, datums: [wall]}\n"
    seen = "  lean: {kind: inspected_orientation, of: block.cross, datums: [wall]}\n"
    text = BLOCK.format(tolerances=LOCATED + square, measures=seen).replace("tolerances:\n", f"{CROSS}tolerances:\n", 1)
    advice = r"square\.datums: .*got wall; write kind: parallelism with datums: \[floor, wall\] as 'position' states"
    with pytest.raises(SceneError, match=advice):
        assembled(text, tmp_path)
    heeded = text.replace("perpendicularity, of: block.cross", "parallelism, of: block.cross")
    found = assembled(heeded.replace("0.05 mm}, datums: [wall]", "0.05 mm}, datums: [floor, wall]"), tmp_path)
    assert found.drawn(5_000)["lean"].max() == pytest.approx(0.05, rel=0.02)


def test_what_the_nominal_part_has_is_taken(tmp_path: Path) -> None:
    text = (
        "  square: {kind: perpendicularity, of: block.bore, zone: {diameter: 0.1 mm}, law: {kind: uniform}, "
        "datums: [floor]}\n"
        "  parallel: {kind: parallelism, of: block.seat, zone: {diameter: 0.1 mm}, law: {kind: uniform}, "
        "datums: [bore]}\n"
    )
    measure = "  square: {kind: inspected_orientation, of: block.bore, datums: [floor]}\n".replace(
        "square", "squareness"
    )
    found = assembled(BLOCK.format(tolerances=text, measures=measure), tmp_path).drawn(2_000)["squareness"]
    assert found.max() <= 0.1 * (1 + 1e-6)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_an_angle_about_half_a_turn_does_not_jump(tmp_path: Path, method: str) -> None:
    """Faces that look at each other: 180 deg and what they tilt, not -180."""
    tilt = (
        "  tilt: {kind: perpendicularity, of: block.bore, zone: {diameter: 0.1 mm}, law: {kind: uniform}, "
        "datums: [floor]}\n"
    )
    measures = "".join(
        f"  about {axis}: {{kind: angle, from: block.floor, to: block.bore, about: {about}}}\n"
        for axis, about in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
    )
    count = 20_000
    found = assembled(BLOCK.format(tolerances=tilt, measures=measures), tmp_path).drawn(count, method)
    sigma = 0.05 / 2 / 15  # ends opposite, uniform in a disc of 0.05: half of it is the sigma across
    for values in found.values():
        assert np.abs(values - math.pi).max() < 0.004
        assert values.std() == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))


@pytest.mark.parametrize(
    ("measure", "words"),
    [
        ("{kind: gap, from: block.floor, to: block.top, along: [0, 0, 1], upper_limit: 1 deg}", "expected a length"),
        ("{kind: angle, from: block.floor, to: block.top, lower_limit: 1 mm}", "expected an angle"),
        ("{kind: difference, of: height, minus: tilt}", "an angle"),
        ("{kind: difference, of: tilt, minus: tilt, upper_limit: 1 mm}", "expected an angle"),
    ],
)
def test_lengths_go_with_lengths_and_angles_with_angles(tmp_path: Path, measure: str, words: str) -> None:
    more = (
        "  height: {kind: gap, from: block.floor, to: block.top, along: [0, 0, 1]}\n"
        "  tilt: {kind: angle, from: block.floor, to: block.top}\n"
    )
    with pytest.raises(SceneError, match=words):
        assembled(BLOCK.format(tolerances=FLOOR, measures=f"{more}  own: {measure}\n"), tmp_path)


def test_a_difference_of_angles_is_an_angle(tmp_path: Path) -> None:
    measures = (
        "  one: {kind: angle, from: block.floor, to: block.top}\n"
        "  other: {kind: angle, from: block.floor, to: block.bore}\n"
        "  both: {kind: difference, of: one, minus: other, upper_limit: 1 deg}\n"
    )
    system = assembled(BLOCK.format(tolerances=FLOOR, measures=measures), tmp_path).system
    both = next(own for own in system.measures if own.name == "both")
    assert both.unit == "arcmin"
    assert both.upper_limit == pytest.approx(math.radians(1))


@pytest.mark.parametrize(
    ("measure", "words"),
    [
        (
            "points: [block.a, block.b, block.c, block.d], normal: [0, 1, 0]",
            "flat.normal: expected the normal of a plane",
        ),
        (
            "points: [block.a, block.b, block.e, block.f], normal: [0, 0, 1]",
            "flat.points: expected points that do not all",
        ),
    ],
)
def test_flatness_of_points_that_lie_on_no_such_plane(tmp_path: Path, measure: str, words: str) -> None:
    places = {"a": (0, 0), "b": (10, 0), "c": (10, 10), "d": (0, 10), "e": (20, 0), "f": (30, 0)}
    points = "".join(f"      {name}: {{kind: point, at: [{x} mm, {y} mm, 0 mm]}}\n" for name, (x, y) in places.items())
    text = BLOCK.format(tolerances=FLOOR, measures=f"  flat: {{kind: inspected_flatness, {measure}}}\n")
    with pytest.raises(SceneError, match=words):
        assembled(text.replace("tolerances:\n", f"{points}tolerances:\n", 1), tmp_path)


def test_a_law_that_leaves_nothing_of_a_diameter(tmp_path: Path) -> None:
    size = "  size: {kind: size, of: block.bore, distribution: {kind: uniform, lower: -10 mm, upper: 0 mm}}\n"
    with pytest.raises(SceneError, match=r"size\.distribution: expected sizes above 0, got down to -10 mm"):
        assembled(BLOCK.format(tolerances=size, measures=SEEN), tmp_path)


def test_two_flat_positions_across_each_other_limit_a_hole_in_both_directions(tmp_path: Path) -> None:
    """The common pair of a drawing: 0.1 along x, 0.3 along y; the middle of two ends, uniform each for itself."""
    text = "".join(
        f"  position {axis}: {{kind: position, of: block.bore, zone: {{width: {width} mm, along: {along}}}, "
        "law: {kind: uniform}, datums: [floor]}\n"
        for axis, width, along in (("x", 0.1, [1, 0, 0]), ("y", 0.3, [0, 1, 0]))
    )
    measures = "".join(
        f"  {axis}: {{kind: gap, from: block.floor, to: block.bore, along: {along}}}\n"
        for axis, along in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
    )
    count = 50_000
    found = assembled(BLOCK.format(tolerances=text, measures=measures), tmp_path).drawn(count)
    for axis, width in (("x", 0.1), ("y", 0.3)):
        sigma = width / 2 / math.sqrt(3) / math.sqrt(2)
        assert found[axis].std() == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))
    slanted = text.replace("[0, 1, 0]", "[1, 1, 0]")
    with pytest.raises(SceneError, match="would count twice"):
        assembled(BLOCK.format(tolerances=slanted, measures=measures), tmp_path)
