"""Cones as features, datums and seats: against points of their surfaces, tapers by hand, and ends that are searched."""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from scene_texts import refusal
from scipy.spatial.transform import Rotation

from tol3d.assembly.model import Cone
from tol3d.assembly.zones import Zone, catalogue, uniform_in
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]
METHODS = ("exact", "analytic")
T = 0.1
TAPER = Cone(20.0, diameters=(30.0, 22.0))
SINK = Cone(12.0, inner=True, diameters=(8.0, 32.0))


def reached(cone: Cone, components: Array) -> float:
    """The largest distance of displaced points of a surface from the nominal one [mm].

    Args:
        cone: the cone.
        components: offsets of both ends of its axis, and its shift along it.
    """
    start, end, along = components[:2], components[2:4], components[4]
    z = np.append((end - start) / cone.length, 1.0)
    lean = Rotation.align_vectors(z[None] / np.linalg.norm(z), [[0.0, 0.0, 1.0]])[0]
    turns, heights = np.meshgrid(np.linspace(0, 2 * math.pi, 361), [-cone.length / 2, cone.length / 2])
    radii = np.where(heights < 0, *cone.diameters) / 2
    points = np.stack([radii * np.cos(turns), radii * np.sin(turns), heights], axis=-1).reshape(-1, 3)
    moved = lean.apply(points) + np.append((start + end) / 2, along)
    tangent = (cone.diameters[1] - cone.diameters[0]) / 2 / cone.length
    nominal = sum(cone.diameters) / 4 + tangent * moved[:, 2]
    return float(np.abs(np.hypot(moved[:, 0], moved[:, 1]) - nominal).max() / math.hypot(1.0, tangent))


@pytest.mark.parametrize("cone", [TAPER, SINK])
def test_the_zone_of_a_surface_is_what_its_points_have_inside_and_outside(cone: Cone) -> None:
    """The difference is of second order: a circle of radius r that lies off by e is e^2 / 2 r out of round."""
    draw = uniform_in(catalogue.cone_surface(T, cone))
    inside = np.stack(draw.deviations(*np.random.default_rng(1).random((5, 40))), axis=1)
    for scale in (1.0, 1.5):
        excess = draw.zone.excess(scale * inside)
        found = [reached(cone, draw.zone.matrix @ own) - T / 2 for own in scale * inside]
        assert found == pytest.approx(excess, abs=scale**2 * 1e-4)
    assert excess.max() > 0.2 * T > -excess.min()


def run_out(zone: Zone, cone: Cone, heights: tuple[float, ...]) -> float:
    """The largest run-out of draws, read square to the surface in sections [mm]."""
    draw = uniform_in(zone)
    drawn_ends = np.stack(draw.deviations(*np.random.default_rng(2).random((draw.uniforms, 3000))), axis=1)
    ends = drawn_ends @ zone.matrix.T
    start, end = ends[:, :2], ends[:, 2:4]
    tangent = (cone.diameters[1] - cone.diameters[0]) / 2 / cone.length
    cosine, found = 1.0 / math.hypot(1.0, tangent), 0.0
    for z in heights:
        radius = sum(cone.diameters) / 4 + tangent * z
        off, lean = (start + end) / 2 + z * (end - start) / cone.length, (end - start) / cone.length
        read = cosine * off + tangent * cosine * radius * lean  # a lean lifts points at the radius along the axis
        found = max(found, 2.0 * float(np.hypot(*read.T).max()))
    return found


def test_a_run_out_is_read_square_to_the_surface() -> None:
    slant = 1.0 / math.cos(SINK.angle)
    assert 0.97 * T < run_out(catalogue.axis_section(T, 0.0, slant), SINK, (0.0,)) <= T * (1 + 1e-12)
    assert 0.97 * T < run_out(catalogue.cone_run_out(T, SINK), SINK, (-6.0, 6.0)) <= T * (1 + 1e-12)


def spindle(more: str = "", turn: Array | None = None, at: Array | None = None) -> str:
    """A spindle with a taper, drawn in any coordinates; a face and an eye that lie off its datum."""
    turn, at = np.eye(3) if turn is None else turn, np.zeros(3) if at is None else at

    def place(*point: float) -> str:
        return "[" + ", ".join(f"{own!r} mm" for own in (turn @ point + at).tolist()) + "]"

    z, x = str((turn @ [0, 0, 1]).tolist()), str((turn @ [1, 0, 0]).tolist())
    face = f"kind: plane, normal: {z}, along: {x}, extent: [40 mm, 40 mm]"
    return f"""scene: spindle
parts:
  spindle:
    kind: solid
    features:
      taper: {{kind: cone, at: {place(0, 0, 5)}, axis: {z}, length: 20 mm, diameters: [30 mm, 22 mm]}}
      nose: {{{face}, at: {place(0, 0, 40)}}}
      eye: {{kind: point, at: {place(15, 0, 40)}, normal: {z}}}
      rim: {{{face}, at: {place(0, 0, 20)}}}
tolerances:
  eye: {{kind: plus_minus, of: spindle.eye, along: {z}, datums: [taper], distribution: {{kind: constant, value: 0 um}}}}
{more}moves:
  bench: {{kind: fix, part: spindle}}
measures:
  eye over nose: {{kind: gap, from: spindle.nose, to: spindle.eye, along: {z}}}
  gauge: {{kind: inspected_size, of: spindle.taper}}
  off: {{kind: inspected_position, of: spindle.taper}}
  nose off: {{kind: inspected_position, of: spindle.nose, datums: [taper]}}
  surface: {{kind: inspected_set, of: [spindle.taper], surfaces: true}}
"""


SIZE = """  size: {kind: size, of: spindle.taper, distribution: {kind: uniform, lower: -20 um, upper: 20 um}}
"""
PROFILE = """  profile: {kind: profile, of: spindle.taper, zone: {width: 0.1 mm}, law: {kind: uniform}}
"""


def columns(made: Assembled, count: int) -> Mapping[str, Array]:
    """First columns of contributors (count,) by name, in the scene's first trials."""
    deviations = drawn(made.simulation, 0, count).deviations
    return {own.name: deviations[:, where.start] for own, where in made.slices}


@pytest.mark.parametrize("method", METHODS)
def test_a_taper_larger_by_d_lies_d_over_twice_its_tangent_towards_its_thin_end(method: str, tmp_path: Path) -> None:
    """A thicker taper is cut by its gauge nearer to the thin end, so its datum goes there: by d / (2 tan a), here z."""
    made = assembled(spindle(SIZE), tmp_path)
    found, larger = made.drawn(50, method), columns(made, 50)["size"]
    shift = larger / (2.0 * 4.0 / 20.0)
    assert found["eye over nose"] == pytest.approx(shift, abs=1e-12)
    assert found["nose off"] == pytest.approx(2.0 * np.abs(shift), abs=1e-12)
    assert found["gauge"] == pytest.approx(26.0 + larger, abs=1e-12)
    assert found["surface"] == pytest.approx(np.abs(larger) * math.cos(math.atan(0.2)), abs=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_a_profile_holds_the_surface_and_moves_the_datum_by_d_over_the_sine(method: str, tmp_path: Path) -> None:
    made = assembled(spindle(PROFILE), tmp_path)
    found, outward = made.drawn(500, method), columns(made, 500)["profile"]
    # the frame turns about the taper's middle, 35 mm below the eye and 15 mm beside its axis
    assert found["eye over nose"] == pytest.approx(outward / math.sin(math.atan(0.2)), abs=15 * T / 20 * 1.02)
    assert found["gauge"] == pytest.approx(26.0 + 2.0 * outward / math.cos(math.atan(0.2)), abs=1e-12)
    assert 0.95 * T < found["surface"].max() < T * (1 + 1e-3)


@pytest.mark.parametrize("method", METHODS)
def test_size_and_place_of_a_profiled_hole_go_together(method: str, tmp_path: Path) -> None:
    """A hole whose surface lies out of the material is smaller and lies towards its wide end, here -z."""
    made = assembled(spindle(PROFILE).replace("[30 mm, 22 mm]", "[30 mm, 22 mm], hole: true"), tmp_path)
    found, outward = made.drawn(50, method), columns(made, 50)["profile"]
    assert found["gauge"] == pytest.approx(26.0 - 2.0 * outward / math.cos(math.atan(0.2)), abs=1e-12)
    assert found["eye over nose"] == pytest.approx(-outward / math.sin(math.atan(0.2)), abs=15 * T / 20 * 1.02)


def test_both_methods_differ_by_second_order(tmp_path: Path) -> None:
    made = assembled(spindle(PROFILE), tmp_path)
    trials = drawn(made.simulation, 0, 100)
    apart = []
    for scale in (1.0, 0.25):
        exact, linear = (made.values(trials.scaled(scale), method) for method in METHODS)
        apart.append(max(float(np.abs(exact[name] - linear[name]).max()) for name in exact))
    assert apart[1] < apart[0] / 10


FRAMED = (
    "  rim: {kind: position, of: spindle.rim, zone: {width: 0.1 mm}, law: {kind: uniform}, datums: [taper]}\n" + PROFILE
)


def test_coordinates_of_the_part_change_nothing(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    at, turn = rng.uniform(-500, 500, 3), Rotation.random(rng=rng).as_matrix()
    here, moved, turned = (
        assembled(spindle(FRAMED, turn=own, at=there), tmp_path)
        for own, there in ((None, None), (None, at), (turn, at))
    )
    before, after, about = here.drawn(20), moved.drawn(20), turned.drawn(20)
    for name, values in before.items():
        np.testing.assert_allclose(after[name], values, rtol=0, atol=1e-9)
    for name in ("gauge", "surface"):  # the taper has no x of its own
        np.testing.assert_allclose(about[name], before[name], rtol=0, atol=1e-9)


def test_an_axis_before_a_cone_leaves_it_the_shift_along(tmp_path: Path) -> None:
    """With a bore first the cone takes one freedom alone, the place along it: what leans or lies off is the bore's."""
    bore = "      bore: {kind: cylinder, at: [0 mm, 0 mm, 30 mm], axis: [0, 0, 1], length: 20 mm, diameter: 8 mm}\n"
    text = (
        spindle(PROFILE)
        .replace("      nose:", bore + "      nose:")
        .replace("datums: [taper]", "datums: [bore, taper]")
    )
    made = assembled(text, tmp_path)
    shift = columns(made, 20)["profile"] / math.sin(math.atan(0.2))
    for method in METHODS:
        assert made.drawn(20, method)["eye over nose"] == pytest.approx(shift, abs=2e-3 if method == "exact" else 1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_a_face_before_a_cone_leaves_it_the_offset_across(method: str, tmp_path: Path) -> None:
    """A size then moves nothing: the face holds the place along the axis."""
    made = assembled(spindle(SIZE).replace("datums: [taper], distr", "datums: [rim, taper], distr"), tmp_path)
    assert made.drawn(5, method)["eye over nose"] == pytest.approx(0.0, abs=1e-12)


def test_roundness_takes_its_width_from_a_profile_of_a_cone_and_of_a_ball(tmp_path: Path) -> None:
    ball = "      ball: {kind: sphere, at: [0 mm, 0 mm, 60 mm], diameter: 10 mm}\n"
    more = "".join(
        f"  {name} {kind}: {{kind: {kind}, of: spindle.{name}, zone: {{width: {width} mm}}{law}}}\n"
        for name in ("taper", "ball")
        for kind, width, law in (("profile", 0.1, ", law: {kind: uniform}"), ("roundness", 0.04, ""))
    )
    text = spindle(more).replace("      nose:", ball + "      nose:")
    made = assembled(text + "  ball surface: {kind: inspected_set, of: [spindle.ball], surfaces: true}\n", tmp_path)
    found = made.drawn(500)
    for name in ("surface", "ball surface"):
        assert 0.9 * 0.06 < found[name].max() < 0.06 * (1 + 1e-3)
    assert made.system.warnings == ()


def seated(pin: str, hole: str, more: str = "") -> str:
    """A tool in a holder, both cones along z; sizes of both vary."""
    return f"""scene: seat
parts:
  holder:
    kind: solid
    features:
      hole: {{kind: cone, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], {hole}, hole: true}}
      face: {{kind: point, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1]}}
  tool:
    kind: solid
    features:
      cone: {{kind: cone, at: [0 mm, 0 mm, 0 mm], {pin}}}
      tip: {{kind: point, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1]}}
    expansion: 12 um/m/K
tolerances:
  hole: {{kind: size, of: holder.hole, distribution: {{kind: uniform, lower: -50 um, upper: 50 um}}}}
  cone: {{kind: size, of: tool.cone, distribution: {{kind: uniform, lower: -50 um, upper: 50 um}}}}
{more}moves:
  bench: {{kind: fix, part: holder}}
  tool in the holder: {{kind: mate, part: tool, relations: [{{kind: coincident, from: tool.cone, to: holder.hole}}]}}
measures:
  depth: {{kind: gap, from: holder.face, to: tool.tip, along: [0, 0, 1]}}
  aside: {{kind: position_error, of: tool.tip, from: holder, component: x}}
"""


WIDE, ENDS = "length: 30 mm, diameters: [16 mm, 31 mm]", ("holder.hole", "tool.cone")
FAR = "[-200.0 mm, 70.0 mm, 1000.0 mm]"
BESIDE = "      B: {kind: axis, at: [0 mm, 0 mm, 60 mm], axis: [0, 0, 1], length: 9 mm}\n"
RUN_OUT = """  total: {kind: total_run_out, of: spindle.taper, zone: {width: 0.1 mm}, law: {kind: uniform}, datums: [B]}
  lean: {kind: parallelism, of: spindle.taper, zone: {diameter: 0.05 mm}, datums: [B]}
"""
ALIKE = "axis: [0, 0, 1], length: 20 mm, diameters: [20 mm, 28 mm]"
FLIPPED = "axis: [0, 0, -1], length: 20 mm, diameters: [28 mm, 20 mm]"


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("pin", [ALIKE, FLIPPED])
def test_cones_of_one_angle_meet_where_their_sizes_do(pin: str, method: str, tmp_path: Path) -> None:
    """A pin larger by d than its hole stands d / (2 tan a) out towards the wide end."""
    made = assembled(seated(pin, "length: 20 mm, diameters: [20 mm, 28 mm]"), tmp_path)
    sizes = columns(made, 30)
    depth = made.drawn(30, method)["depth"]
    assert depth == pytest.approx((sizes["cone"] - sizes["hole"]) / (2 * 0.2), abs=1e-10)


def searched(pin: tuple[float, ...], hole: tuple[float, ...], larger: float, wider: float) -> float:
    """The height at which a pin lies in a hole: the least at which no place of both is narrower than the pin [mm].

    Args:
        pin, hole: length, diameters at both ends; both about 0 and drawn along z, wider upwards.
        larger, wider: of all sections of the pin, and of the hole.
    """

    def radius(of: tuple[float, ...], z: Array, more: float) -> Array:
        return (of[1] + (of[2] - of[1]) * (z / of[0] + 0.5) + more) / 2

    low, high = -8.0, 8.0
    for _ in range(60):
        height = (low + high) / 2
        ends = max(-hole[0] / 2, height - pin[0] / 2), min(hole[0] / 2, height + pin[0] / 2)
        z = np.array(ends) if ends[0] < ends[1] else np.zeros(0)
        free = (radius(hole, z, wider) >= radius(pin, z - height, larger)).all()
        low, high = (low, height) if free else (height, high)
    return high


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("pin", "hole"),
    [
        ((20.0, 20.0, 28.0), (15.0, 19.0, 28.0)),  # slimmer: the end of the hole
        ((10.0, 20.0, 23.0), (30.0, 16.0, 31.0)),  # slimmer and short: its own thin end
        ((10.0, 20.0, 27.0), (30.0, 16.0, 31.0)),  # its thick end
        ((30.0, 16.0, 37.0), (10.0, 22.0, 25.0)),  # the hole's wide end
    ],
)
def test_cones_of_two_angles_meet_at_the_end_that_a_search_finds(
    pin: tuple[float, ...], hole: tuple[float, ...], method: str, tmp_path: Path
) -> None:
    words = [f"length: {own[0]} mm, diameters: [{own[1]} mm, {own[2]} mm]" for own in (pin, hole)]
    made = assembled(seated(f"axis: [0, 0, 1], {words[0]}", words[1]), tmp_path)
    sizes, depth = columns(made, 4), made.drawn(4, method)["depth"]
    found = [searched(pin, hole, *own) for own in zip(sizes["cone"], sizes["hole"], strict=True)]
    assert depth == pytest.approx(found, abs=1e-9)


def test_where_parts_are_drawn_changes_no_seat_and_the_methods_differ_by_second_order(tmp_path: Path) -> None:
    """Tapers that lie off and lean by profiles; of unequal angles, for there the place of an end counts."""
    text = seated("axis: [0, 0, 1], length: 10 mm, diameters: [20 mm, 23 mm]", WIDE)
    for own in ENDS:
        size = f"kind: size, of: {own}, distribution: {{kind: uniform, lower: -50 um, upper: 50 um}}"
        text = text.replace(size, f"kind: profile, of: {own}, zone: {{width: 0.05 mm}}, law: {{kind: uniform}}")
    here, there = (assembled(own, tmp_path) for own in (text, text.replace("[0 mm, 0 mm, 0 mm]", FAR)))
    for name, values in here.drawn(20).items():
        np.testing.assert_allclose(there.drawn(20)[name], values, rtol=0, atol=1e-9)
    trials = drawn(here.simulation, 0, 30)
    exact, linear = ([here.values(trials.scaled(scale), method) for scale in (1.0, 0.25)] for method in METHODS)
    apart = [
        max(float(np.abs(one[name] - other[name]).max()) for name in one)
        for one, other in zip(exact, linear, strict=True)
    ]
    assert apart[1] < apart[0] / 10


@pytest.mark.parametrize("method", METHODS)
def test_a_cone_grows_about_its_apex(method: str, tmp_path: Path) -> None:
    """Warm by 50 K a tool of 12 um/m/K whose apex lies 60 mm below its origin rises by 36 um."""
    warm = "  warm: {kind: temperature, of: tool, distribution: {kind: constant, value: 50 K}}\n"
    text = (
        seated(ALIKE, "length: 20 mm, diameters: [20 mm, 28 mm]", warm)
        .replace("50 um}", "0 um}")
        .replace("-50 um", "-1 nm")
    )
    made = assembled(text, tmp_path)
    assert made.drawn(1, method)["depth"] == pytest.approx([50 * 12e-6 * 60.0], abs=1e-5)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (spindle(SIZE).replace("datums: [taper], distr", "datums: [{feature: taper, mmb: random}], distr"),
         "expected a cylinder or slot, got 'spindle.taper', which is a cone"),
        (spindle(SIZE).replace("[30 mm, 22 mm]", "[30 mm, 30 mm]"), "expected two diameters that differ"),
        (spindle(SIZE).replace("diameters: [30 mm, 22 mm]", "diameter: 26 mm"), "its `diameter` at the middle with"),
        (spindle(SIZE).replace("diameters: [30 mm, 22 mm]", "diameter: 6 mm, half_angle: 30 deg"), "of 0 mm or more"),
        (
            spindle(SIZE).replace("distribution: {kind: uniform", "envelope: true, distribution: {kind: uniform"),
            "an envelope is of a cylinder, a slot or a tab",
        ),
        (
            spindle(RUN_OUT).replace("      nose:", BESIDE + "      nose:"),
            "expected no orientation beside the total run-out of a cone",
        ),
        (spindle(SIZE + PROFILE), "which holds the cone's diameter too"),
        (spindle(SIZE).replace("along: [0.0, 0.0, 1.0], datums: [taper], distribution", "datums: [taper], distribution")
         .replace("of: spindle.eye", "of: spindle.taper").replace("[taper]", "[nose]"), "across the cone or along"),
        (seated(ALIKE, "length: 20 mm, diameters: [28 mm, 20 mm]"), "expected both to widen the same way"),
        (seated(ALIKE + ", hole: true", "length: 20 mm, diameters: [20 mm, 28 mm]"), "got two holes"),
        (seated(ALIKE, "length: 20 mm, diameters: [40 mm, 48 mm]"), "got ends that do not reach each other"),
    ],
)  # fmt: skip
def test_what_a_cone_cannot_be_is_refused(text: str, words: str, tmp_path: Path) -> None:
    assert words in refusal(text, tmp_path)


def test_a_cone_by_its_angle_is_that_by_its_ends(tmp_path: Path) -> None:
    angle = f"diameter: 26 mm, half_angle: {math.degrees(math.atan(0.2))} deg"
    by_angle = spindle(SIZE).replace("diameters: [30 mm, 22 mm]", angle)
    first, second = (assembled(text, tmp_path).drawn(3)["eye over nose"] for text in (spindle(SIZE), by_angle))
    assert second == pytest.approx(-first, abs=1e-12)
