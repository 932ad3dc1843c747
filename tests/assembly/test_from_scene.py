"""Assembly from a scene's words: touched planes, form, run-out, copies, parents; by hand."""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled, constant, normal, uniform
from numpy.typing import NDArray

from tol3d.study.system.stated import component_slices, stated

Array = NDArray[np.float64]

PADS = {"a": (10, 10), "b": (110, 10), "c": (60, 70)}
SEEN = (90.0, 50.0)


def cover_on_rim(tolerances: str, points_on: str = "part", more: str = "") -> str:
    """A cover whose three pads lie on the rim of a base, a plane of 120 x 80 mm; the height of a point is read."""
    pads = "".join(
        f"      pad {name}: {{kind: point, at: [{x} mm, {y} mm, 30 mm], normal: [0, 0, -1]}}\n"
        for name, (x, y) in PADS.items()
    )
    rim = (
        "{kind: plane, at: [60 mm, 40 mm, 30 mm], normal: [0, 0, 1], extent: [120 mm, 80 mm]}"
        if points_on == "part"
        else "{kind: plane, at: [60 mm, 40 mm, 30 mm], normal: [0, 0, -1], extent: [120 mm, 80 mm]}"
    )
    sides = "".join(
        f"      side {k}: {{kind: point, at: [{x} mm, 0 mm, 30 mm], normal: [0, -1, 0]}}\n"
        for k, x in ((1, 20), (2, 100))
    )
    sides += "      end: {kind: point, at: [0 mm, 40 mm, 30 mm], normal: [-1, 0, 0]}\n"
    seen = f"      seen: {{kind: point, at: [{SEEN[0]} mm, {SEEN[1]} mm, 30 mm]}}\n"
    base_surface, cover_surface = (f"      rim: {rim}\n", pads) if points_on == "part" else (
        pads.replace("[0, 0, -1]", "[0, 0, 1]"), f"      seat: {rim}\n"
    )  # fmt: skip
    pair = "{{from: cover.pad {0}, to: base.rim}}" if points_on == "part" else "{{from: cover.seat, to: base.pad {0}}}"
    primary = ", ".join(pair.format(name) for name in PADS)
    return f"""
scene: a cover on a rim
parts:
  base:
    kind: solid
    features:
{base_surface}{sides}{seen}
  cover:
    kind: solid
    features:
{cover_surface}{sides}{seen}
tolerances:
{tolerances}
moves:
  machine: {{kind: fix, part: base}}
  laying:
    kind: three_two_one
    part: cover
    points_on: {points_on}
    primary: [{primary}]
    secondary: [{{from: cover.side 1, to: base.side 1, along: [0, {1 if points_on == "part" else -1}, 0]}},
                {{from: cover.side 2, to: base.side 2, along: [0, {1 if points_on == "part" else -1}, 0]}}]
    tertiary: [{{from: cover.end, to: base.end, along: [{1 if points_on == "part" else -1}, 0, 0]}}]
{more}
measures:
  height: {{kind: gap, from: base.seen, to: cover.seen, along: [0, 0, 1]}}
"""


def of_components(made: Assembled, contributor: str, components: Array, method: str = "exact") -> Mapping[str, Array]:
    """Measures of builds whose deviations are 0 but for the components (trials, components) of one contributor."""
    rows = np.zeros((len(components), made.system.assembly.width))
    rows[:, component_slices(made.system)[contributor]] = components
    return made.values(stated(made.system, rows), method)


@pytest.mark.parametrize("method", ["exact", "analytic"])
@pytest.mark.parametrize("points_on", ["part", "fixture"])
def test_pads_rise_with_the_tilt_of_the_plane_that_they_touch(tmp_path: Path, method: str, points_on: str) -> None:
    """The cover lies on the plane wherever its pads are: offset + x rise/60 + y rise/40 about the plane's middle."""
    surface = "base.rim" if points_on == "part" else "cover.seat"
    zone = f"  flatness of seat: {{kind: profile, of: {surface}, zone: {{width: 0.1 mm}}, law: {{kind: uniform}}}}\n"
    made = assembled(cover_on_rim(zone, points_on), tmp_path)
    components = np.array([[0.02, 0.0, 0.0], [0.0, 0.03, 0.0], [0.0, 0.0, -0.02], [0.01, 0.01, 0.02]])
    found = of_components(made, "flatness of seat", components, method)["height"]
    frame = made.system.assembly.features[surface].frame[:3, :3]
    arms = frame.T @ (np.array([*SEEN, 30.0]) - (60.0, 40.0, 30.0))
    expected = components @ np.array([1.0, arms[0] / 60, arms[1] / 40])
    assert found == pytest.approx(expected, abs=2e-5)  # the rest is of second order: rise^2 over the length


def test_form_is_an_error_of_its_own_at_each_pad(tmp_path: Path) -> None:
    form = 0.06
    text = f"  flatness: {{kind: flatness, of: base.rim, zone: {{width: {form} mm}}, law: {{kind: uniform}}}}\n"
    made = assembled(cover_on_rim(text), tmp_path)
    (own,) = made.system.contributors
    assert own.draw.components == ("cover.pad a", "cover.pad b", "cover.pad c")
    corners = np.array([[1.0, x, y] for x, y in PADS.values()])
    weights = np.linalg.solve(corners.T, np.array([1.0, *SEEN]))  # barycentric, of the point in its three pads
    found = of_components(made, "flatness", 0.01 * np.eye(3))["height"]
    assert found == pytest.approx(0.01 * weights, abs=1e-6)
    count = 100_000
    sigma = form / math.sqrt(12) * math.sqrt((weights**2).sum())
    assert made.drawn(count)["height"].std() == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))


def test_form_of_a_copy_that_touches_nothing_draws_nothing(tmp_path: Path) -> None:
    text = "  flatness: {kind: flatness, of: base.rim, zone: {width: 60 um}, law: {kind: uniform}}\n"
    spare = "  spare: {kind: solid, like: base, placed: {at: [300 mm, 0 mm, 0 mm]}}\ntolerances:"
    scene = cover_on_rim(text, more="  beside: {kind: fix, part: spare}").replace("tolerances:", spare)
    assert [own.name for own in assembled(scene, tmp_path).system.contributors] == ["flatness"]


def test_form_takes_its_room_from_the_location(tmp_path: Path) -> None:
    text = (
        "  profile: {kind: profile, of: base.rim, zone: {width: 0.1 mm}, law: {kind: uniform}, datums: [side 1]}\n"
        "  flatness: {kind: flatness, of: base.rim, zone: {width: 0.04 mm}}\n"
        "  parallelism: {kind: parallelism, of: base.rim, zone: {width: 0.03 mm}, datums: [side 1]}\n"
    )
    made = assembled(cover_on_rim(text), tmp_path)
    (own,) = made.system.contributors  # the others refine it
    drawn = np.array(own.draw.deviations(*np.random.default_rng(1).random((own.draw.uniforms, 50_000))))
    rises = np.abs(drawn[1:]).sum(axis=0)
    assert (np.abs(drawn[0]) + rises).max() == pytest.approx(0.03, rel=1e-2)
    assert (np.abs(drawn[0]) + rises).max() <= 0.03 + 1e-12
    assert rises.max() == pytest.approx(0.015, rel=1e-2)


SHAFT = """
scene: a stepped shaft
parts:
  shaft:
    kind: solid
    features:
      seat: {{kind: cylinder, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm, diameter: 20 mm}}
      journal: {{kind: cylinder, at: [0 mm, 0 mm, 50 mm], axis: [0, 0, 1], length: 30 mm, diameter: 15 mm}}
      collar: {{kind: plane, at: [0 mm, 0 mm, 30 mm], normal: [0, 0, 1], radius: 12 mm}}
  twin: {{kind: solid, like: shaft, placed: {{at: [100 mm, 0 mm, 0 mm]}}}}
tolerances:
{tolerances}
moves:
  machine: {{kind: fix, part: shaft}}
  beside: {{kind: fix, part: twin}}
measures:
  size: {{kind: inspected_size, of: shaft.journal}}
  twin's size: {{kind: inspected_size, of: twin.journal}}
  coaxiality: {{kind: inspected_position, of: shaft.journal, datums: [seat]}}
  squareness: {{kind: inspected_orientation, of: shaft.collar, datums: [seat]}}
  apart: {{kind: gap, from: shaft.journal, to: twin.journal, along: [1, 0, 0]}}
"""


def test_run_out_at_a_section_leaves_the_axis_parallel(tmp_path: Path) -> None:
    text = (
        "  run-out: {kind: circular_run_out, of: shaft.journal, zone: {width: 0.04 mm}, law: {kind: uniform}, "
        "datums: [seat]}"
    )
    made = assembled(SHAFT.format(tolerances=text), tmp_path)
    own = made.system.contributors[0]
    assert own.draw.components == ("x", "y")
    found = made.drawn(20_000)["coaxiality"]
    assert found.max() <= 0.04 + 1e-9  # 2 e
    assert found.max() == pytest.approx(0.04, rel=1e-3)
    assert (found**2).mean() == pytest.approx(0.04**2 / 2, rel=0.02)  # uniform in the disc


def test_total_run_out_holds_both_ends(tmp_path: Path) -> None:
    text = (
        "  run-out: {kind: total_run_out, of: shaft.journal, zone: {width: 0.04 mm}, law: {kind: uniform}, "
        "datums: [seat]}"
    )
    made = assembled(SHAFT.format(tolerances=text), tmp_path)
    assert made.system.contributors[0].draw.components == ("start x", "start y", "end x", "end y")
    found = made.drawn(20_000)["coaxiality"]
    assert found.max() <= 0.04 + 1e-9
    assert (found < 0.02).mean() == pytest.approx((1 / 4) ** 2, abs=4 * math.sqrt(1 / 16 / 20_000))  # both ends near


def test_what_is_like_another_has_deviations_of_its_own(tmp_path: Path) -> None:
    text = (
        f"  diameter: {{kind: size, of: shaft.journal, distribution: {uniform(0.01)}}}\n"
        f"  aside: {{kind: plus_minus, of: shaft.journal, along: [1, 0, 0], distribution: {normal(0.02)}}}"
    )
    made = assembled(SHAFT.format(tolerances=text), tmp_path)
    names = [own.name for own in made.system.contributors]
    assert names == ["diameter", "diameter of twin", "aside", "aside of twin"]
    count = 50_000
    found = made.drawn(count)
    assert found["size"].std() == pytest.approx(0.02 / math.sqrt(12), rel=4 / math.sqrt(2 * count))
    assert abs(np.corrcoef(found["size"], found["twin's size"])[0, 1]) < 4 / math.sqrt(count)
    assert found["apart"].mean() == pytest.approx(100, abs=4 * 0.02 * math.sqrt(2 / count))
    assert found["apart"].std() == pytest.approx(0.02 * math.sqrt(2), rel=4 / math.sqrt(2 * count))


def test_an_orientation_alone_lies_in_the_frame_of_its_datums(tmp_path: Path) -> None:
    """The seat tilts, and with it the collar that is square to it: nothing of that shows where it is inspected."""
    own = (
        "  collar: {kind: perpendicularity, of: shaft.collar, zone: {width: 0.03 mm}, law: {kind: uniform}, "
        "datums: [seat]}"
    )
    alone = assembled(SHAFT.format(tolerances=own), tmp_path).drawn(5_000)["squareness"]
    assert alone.max() <= 0.03 + 1e-9
    assert alone.max() == pytest.approx(0.03, rel=1e-2)
    free = f"  seat: {{kind: plus_minus, of: shaft.seat, along: [1, 0, 0], distribution: {constant(0.5)}}}\n"
    both = assembled(SHAFT.format(tolerances=free + own), tmp_path).drawn(5_000)["squareness"]
    assert both == pytest.approx(alone, abs=1e-9)
