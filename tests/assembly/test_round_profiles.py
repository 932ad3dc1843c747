"""Profiles of cylinders and balls: one zone holds the size, the place and the lean of a round surface."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from scene_texts import Edit, refusal
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation
from scipy.stats import ks_2samp

from tol3d.assembly.zones import Confined, Zone, catalogue, normal_in, uniform_in
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Rows = NDArray[np.int_]

T, FEW, MANY = 0.1, 20_000, 200_000
RARE = 1e-7
ZONES: Mapping[str, Callable[..., Zone]] = {"cylinder": catalogue.cylinder_surface, "ball": catalogue.sphere_surface}
LAWS: Mapping[str, Callable[[Zone], Confined]] = {"uniform": uniform_in, "normal": normal_in}


def sides(name: str, points: Array) -> Array:
    """The largest distance of a surface's points from where they lie nominally (trials,): by round sections."""
    turns = 2 * math.pi * np.arange(180) / 180
    round_ = np.stack([np.cos(turns), np.sin(turns)])
    if name == "cylinder":
        ends = [points[:, own] @ round_ for own in (slice(1, 3), slice(3, 5))]
        return np.asarray(np.max([np.abs(points[:, :1] + own).max(axis=1) for own in ends], axis=0))
    return np.asarray(np.abs(points[:, 0]) + np.linalg.norm(points[:, 1:], axis=1))


def rejected(name: str, law: str, count: int) -> Array:
    """Points (count, components) in half widths: of a box, or stage by stage where the middle comes first."""
    rng, size = np.random.default_rng(2), 5 if name == "cylinder" else 4
    if law == "uniform":
        found = np.zeros((0, size))
        while len(found) < count:
            box = rng.uniform(-1, 1, (400_000, size))
            reach = np.hypot(box[:, 1], box[:, 2]) if size == 5 else np.linalg.norm(box[:, 1:], axis=1)
            if size == 5:
                reach = np.maximum(reach, np.hypot(box[:, 3], box[:, 4]))
            found = np.concatenate([found, box[np.abs(box[:, 0]) + reach <= 1]])
        return found[:count]
    middle = redrawn(
        rng, np.zeros((count, size // 2 if size == 5 else 3)), lambda own, _: np.linalg.norm(own, axis=1) <= 1
    )
    off = np.linalg.norm(middle, axis=1)
    outward = redrawn(rng, np.zeros((count, 1)), lambda own, rows: np.abs(own[:, 0]) + off[rows] <= 1)
    if size == 4:
        return np.hstack([outward, middle])
    left, turn = 1.0 - np.abs(outward[:, 0]), rng.uniform(0, 2 * math.pi, count)
    way = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    reach, above = np.zeros(count), np.ones(count)
    for _ in range(50):
        between = (reach + above) / 2
        ends = [np.linalg.norm(middle + sign * between[:, None] * way, axis=1) for sign in (-1, 1)]
        reach, above = np.where(np.max(ends, axis=0) <= left, (between, above), (reach, between))
    length, out = np.zeros(count), np.ones(count, dtype=bool)
    while out.any():  # a length of two normals, no longer than that: redrawn uniform over the area, kept by its density
        length[out] = reach[out] * np.sqrt(rng.random(out.sum()))
        out &= rng.random(count) > np.exp(-4.5 * length**2)
    return np.hstack([outward, middle - length[:, None] * way, middle + length[:, None] * way])


def redrawn(rng: np.random.Generator, points: Array, inside: Callable[[Array, Rows], Flags]) -> Array:
    """Normals of sigma 1/3 until they lie inside, which is asked of points in these rows."""
    out = np.arange(len(points))
    while out.size:
        points[out] = rng.standard_normal((out.size, points.shape[1])) / 3
        out = out[~inside(points[out], out)]
    return points


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", ZONES)
def test_draws_have_the_law_that_rejection_has_and_its_closed_moments(name: str, law: str) -> None:
    draw = LAWS[law](ZONES[name](T))
    rng = np.random.default_rng(1)
    ours = np.stack(draw.deviations(*rng.random((draw.uniforms, MANY))), axis=1)
    others = rejected(name, law, FEW) * T / 2
    directions = rng.standard_normal((4, ours.shape[1]))
    pairs = [*zip(ours.T, others.T, strict=True), *zip((ours @ directions.T).T, (others @ directions.T).T, strict=True)]
    for one, other in pairs:
        assert ks_2samp(one[:FEW], other).pvalue > RARE
    assert ks_2samp(sides(name, ours[:FEW]), sides(name, others)).pvalue > RARE
    products = ours[:, :, None] * ours[:, None, :]
    errors = products.std(axis=0) / math.sqrt(MANY)
    assert (np.abs(products.mean(axis=0) - draw.covariance) < 5 * errors + 1e-15).all()
    assert sides(name, ours[:FEW]).max() <= T / 2 * (1 + 1e-12)
    assert draw.zone.inside(ours).all()


@pytest.mark.parametrize("name", ZONES)
def test_the_support_is_that_of_a_linear_programme(name: str) -> None:
    """Polygons stand for round limits: the cylinder's zone lies between them and these shrunk into it."""
    zone, count = ZONES[name](T), 180
    turns = 2 * math.pi * np.arange(count) / count
    if name == "cylinder":
        round_, zero = np.stack([np.cos(turns), np.sin(turns)], axis=1), np.zeros((count, 2))
        ends = np.vstack([np.hstack([round_, zero]), np.hstack([zero, round_])])
    else:
        ends = np.random.default_rng(3).standard_normal((4000, 3))
        ends /= np.linalg.norm(ends, axis=1, keepdims=True)
    rows = np.vstack([np.hstack([np.full((len(ends), 1), sign), ends]) for sign in (1.0, -1.0)])
    for gradient in np.random.default_rng(1).standard_normal((8, rows.shape[1])):
        program = linprog(-gradient, A_ub=rows, b_ub=np.full(len(rows), T / 2 / 1e-6), bounds=(None, None))
        found = zone.support(gradient)
        assert -program.fun * 1e-6 * (0.9998 if name == "cylinder" else 0.99) <= found <= -program.fun * 1e-6 + 1e-12
        assert gradient @ zone.furthest(gradient) == pytest.approx(found)
        assert sides(name, zone.furthest(gradient)[None])[0] <= T / 2 * (1 + 1e-12)


def plate(law: str = "uniform", turn: Array | None = None, at: Array | None = None, more: str = "") -> str:
    """A plate with a bore, a pin and a ball, drawn in any coordinates."""
    turn, at = np.eye(3) if turn is None else turn, np.zeros(3) if at is None else at

    def place(*point: float) -> str:
        return "[" + ", ".join(f"{own!r} mm" for own in (turn @ point + at).tolist()) + "]"

    def way(*direction: float) -> str:
        return str((turn @ direction).tolist())

    round_ = f"kind: cylinder, axis: {way(0, 0, 1)}, length: 10 mm, diameter: 8 mm"
    zones = f"zone: {{width: 0.1 mm}}, law: {{kind: {law}}}, datums: [A]"
    return f"""scene: plate
parts:
  plate:
    kind: solid
    features:
      A: {{kind: plane, at: {place(0, 0, 0)}, normal: {way(0, 0, -1)}, extent: [100 mm, 60 mm], along: {way(1, 0, 0)}}}
      bore: {{{round_}, at: {place(20, 10, 5)}, hole: true}}
      pin: {{{round_}, at: {place(-20, 10, 5)}}}
      ball: {{kind: sphere, at: {place(0, -10, 5)}, diameter: 12 mm}}
      edge: {{kind: point, at: {place(50, 0, 10)}, normal: {way(1, 0, 0)}}}
tolerances:
  A: {{kind: profile, of: plate.A, zone: {{width: 0.05 mm}}, law: {{kind: uniform}}}}
  bore: {{kind: profile, of: plate.bore, {zones}}}
  pin: {{kind: profile, of: plate.pin, {zones.replace("width: 0.1 mm", "width: 0.1 mm, outward: 0.02 mm")}}}
  ball: {{kind: profile, of: plate.ball, {zones}}}
{more}moves:
  bench: {{kind: fix, part: plate}}
measures:
  bore size: {{kind: inspected_size, of: plate.bore}}
  pin size: {{kind: inspected_size, of: plate.pin}}
  ball size: {{kind: inspected_size, of: plate.ball}}
  bore off: {{kind: inspected_position, of: plate.bore, datums: [A]}}
  pin off: {{kind: inspected_position, of: plate.pin, datums: [A]}}
  x: {{kind: gap, from: plate.bore, to: plate.edge, along: {way(1, 0, 0)}}}
"""


SIZES = ("bore size", "pin size", "ball size")


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_size_and_place_share_the_width_and_a_hole_is_smaller_where_its_surface_lies_outward(
    law: str, method: str, tmp_path: Path
) -> None:
    """|size - nominal| / 2 + position / 2 <= t / 2, in each trial; of the pin about its unequal middle, -0.03 mm."""
    made = assembled(plate(law), tmp_path)
    found, deviations = made.drawn(4000, method), drawn(made.simulation, 0, 4000).deviations
    first = {own.name: deviations[:, where.start] for own, where in made.slices}
    assert found["bore size"] == pytest.approx(8.0 - 2.0 * first["bore"], abs=1e-12)
    assert found["pin size"] == pytest.approx(8.0 + 2.0 * first["pin"], abs=1e-12)
    assert found["ball size"] == pytest.approx(12.0 + 2.0 * first["ball"], abs=1e-12)
    for name, middle in (("bore", 8.0), ("pin", 8.0 - 0.06)):
        used = np.abs(found[f"{name} size"] - middle) + found[f"{name} off"]
        assert used.max() < T + 1e-5  # the datum's tilt is read of second order
        assert used.max() > 0.85 * T


@pytest.mark.parametrize("law", LAWS)
def test_both_methods_differ_by_second_order(law: str, tmp_path: Path) -> None:
    made = assembled(plate(law), tmp_path)
    trials = drawn(made.simulation, 0, 200)
    apart = []
    for scale in (1.0, 0.25):
        exact, linear = (made.values(trials.scaled(scale), method) for method in ("exact", "analytic"))
        apart.append(max(float(np.abs(exact[name] - linear[name]).max()) for name in exact))
    assert apart[1] < max(apart[0] / 10, 1e-12)


@pytest.mark.parametrize("seed", [1, 2])
def test_coordinates_of_the_part_change_nothing(seed: int, tmp_path: Path) -> None:
    """Shifted ones trial by trial; turned ones sizes too, and by closed moments what an axis without an x reads."""
    rng = np.random.default_rng(seed)
    at, turn = rng.uniform(-500, 500, 3), Rotation.random(rng=rng).as_matrix()
    here, moved, turned = (
        assembled(plate(turn=own, at=there), tmp_path) for own, there in ((None, None), (None, at), (turn, at))
    )
    before, after, about = here.drawn(50), moved.drawn(50), turned.drawn(50)
    for name, values in before.items():
        np.testing.assert_allclose(after[name], values, rtol=0, atol=1e-9)
    for name in SIZES:
        np.testing.assert_allclose(about[name], before[name], rtol=0, atol=1e-9)
    assert sigma_of(turned) == pytest.approx(sigma_of(here), rel=1e-9)


def sigma_of(made: Assembled) -> float:
    """Sigma of the distance of the bore, by its closed form."""
    form = made.system.closed_form(next(own for own in made.system.measures if own.name == "x"))
    assert form is not None
    return form.sigma


FITTED = """scene: fit
parts:
  base:
    kind: solid
    features:
      pin: {kind: cylinder, at: [0 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8 mm}
  disc:
    kind: solid
    features:
      bore: {kind: cylinder, at: [0 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8.3 mm, hole: true}
tolerances:
  pin: {kind: profile, of: base.pin, zone: {width: 0.1 mm}, law: {kind: uniform}}
  bore: {kind: profile, of: disc.bore, zone: {width: 0.1 mm}, law: {kind: uniform}}
moves:
  bench: {kind: fix, part: base}
  disc on its pin: {kind: pin_and_hole, part: disc, pairs: [{from: disc.bore, to: base.pin}], float: {kind: centred}}
measures:
  aside: {kind: gap, from: base.pin, to: disc.bore, along: [1, 0, 0]}
"""


def test_play_follows_from_the_size_that_a_profile_holds(tmp_path: Path) -> None:
    made = assembled(FITTED, tmp_path)
    assert np.abs(made.drawn(50)["aside"]).max() < 1e-6


@pytest.mark.parametrize(
    ("more", "change", "words"),
    [
        (
            "  size: {kind: size, of: plate.bore, distribution: {kind: constant, value: 0 um}}\n",
            ("", ""),
            "expected no size of 'plate.bore' beside a profile, which holds the cylinder's diameter too, got 'size'; "
            "write a position for where it lies, or take 'size' out",
        ),
        (
            "  upright: {kind: perpendicularity, of: plate.bore, zone: {diameter: 0.02 mm}, datums: [A]}\n",
            ("", ""),
            "expected no orientation beside the profile of a cylinder, got 'upright'; write size and position, which "
            "an orientation may refine",
        ),
        (
            "",
            ("plate.ball, zone: {width", "plate.ball, zone: {diameter"),
            "expected a width alone, which limits along the",
        ),
        (
            "",
            ("law: {kind: uniform}, datums: [A]}", "law: {kind: ring}, datums: [A]}"),
            "a ring is of where an axis lies",
        ),
    ],
)
def test_what_no_profile_of_a_round_surface_says_is_refused(
    more: str, change: Edit, words: str, tmp_path: Path
) -> None:
    assert words in refusal(plate(more=more).replace(*change), tmp_path)
