"""Patterns whose places tie, and parts pushed to flat ends of their room: against linear programmes and closed forms.

The oracle cuts each cone |o + B q| <= c by planes in HiGHS, about the directions that the best pose so far has, until
both bounds meet; a lens of two discs is a closed form. Certificates (tests/contact) allow 5e-6 mm where multipliers
tie, and take rows and statuses as they are: slack to 1e-9 mm, rows and statuses are held here.
"""

from pathlib import Path

import numpy as np
import pytest
from assembly.placing.built_by_numbers import posed
from assembly.placing.one_sided_parts import pads
from assembly.plates import hole, pin, two_plates
from assembly.test_shifted_coordinates import askew
from assembly_trials import Assembled, assembled, point
from numpy.typing import NDArray
from oracles.cutting_planes import cut

from tol3d.assembly.model.statuses import NO_BUILD, NOT_UNIQUE, OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors
from tol3d.contact.programme import Programme
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]


def solved(offsets: Array, clearances: Array, rows: Array, push: Array | None = None) -> tuple[Array, float]:
    """The step and its centred slack by the solver of both methods; the step is found."""
    programme = Programme.of(len(rows), rows.shape[2], 1)
    goal = None if push is None else push[:, None]
    programme.solve(offsets[:, :, None], clearances[:, None], rows[..., None], goal=goal)
    assert programme.found[0]
    return programme.steps[:, 0], float(programme.slack[0])


def tied(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Offsets, clearances and rows of 2 to 8 holes on a grid or a circle, at one or both ends, most of them alike.

    All freedoms of a plane, the turn alone, the shifts alone, or tilts too; some holes are slots; up to two ends are
    displaced, or all by 1e-7 mm, and one clearance may be another.
    """
    count = int(rng.choice([2, 3, 4, 4, 5, 6, 8]))
    if rng.random() < 0.5:
        at = 50.0 * np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])[rng.permutation(9)[:count]]
    else:
        turns = 2 * np.pi * np.arange(count) / count
        at = 50.0 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    ends = int(rng.integers(1, 3))
    at = np.repeat(at, ends, axis=0)
    reach, freed = max(float(np.hypot(*at.T).max()), 1.0), int(rng.integers(5))
    slot = np.repeat(rng.random(count) < 0.1, ends)
    rows = np.zeros((len(at), 2, 5))
    rows[:, 0, 0] = rows[:, 1, 1] = 1.0
    rows[:, 0, 2], rows[:, 1, 2] = -at[:, 1] / reach, at[:, 0] / reach
    rows[:, 0, 3] = rows[:, 1, 4] = np.tile([5.0, 15.0][:ends], count) / reach
    chosen = [[2], [0, 1], [0, 1, 2, 3, 4] if ends == 2 else [0, 1, 2], [0, 1, 2], [0, 1, 2]][freed]
    rows, offsets = rows[:, :, chosen], np.zeros((len(at), 2))
    for _ in range(rng.integers(3)):
        offsets[rng.integers(len(at))] = 0.1 * rng.choice([-1, 0, 1, 0.5, 1e-3], 2)
    offsets += 1e-7 * rng.normal(size=offsets.shape) * (rng.random() < 0.3)
    rows[slot, 1], offsets[slot, 1] = 0.0, 0.0
    clearances = np.full(len(at), 0.5)
    clearances[rng.integers(len(at))] += rng.choice([0.0, 0.0, -0.3, 0.1, -0.55])
    return offsets, clearances, np.ascontiguousarray(rows)


@pytest.mark.parametrize("seeds", [range(12), pytest.param(range(12, 92), marks=pytest.mark.slow)])
def test_tied_patterns_have_the_slack_and_the_reach_of_cutting_planes(seeds: range) -> None:
    """Slack to 1e-9 mm and, of a room, how far it goes along a freedom or any direction."""
    lost = 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        place = tied(rng)
        slack = solved(*place)[1]
        expected = cut(*place)
        lost += bool(np.isnan(expected))
        assert not abs(slack - expected) > 1e-9, seed
        size = place[2].shape[2]
        if slack > 0.0 and np.linalg.matrix_rank(place[2].reshape(-1, size)) == size:
            way = int(rng.integers(size))
            push: Array = np.asarray(rng.normal(size=size) if seed % 2 else np.eye(size)[way])
            q, _ = solved(*place, push)
            assert (place[1] - np.hypot(*(place[0] + place[2] @ q).T)).min() > -1e-11, seed
            expected = cut(*place, push)
            lost += bool(np.isnan(expected))
            assert not abs(push @ q - expected) > 1e-9 * max(1.0, abs(expected)), seed
    assert lost <= len(seeds) / 6  # oracles, of two a seed


def test_a_pin_goes_to_the_end_of_its_lens() -> None:
    """Both ends of a pin in a hole make a lens of two discs; its farthest point is of a disc or a corner."""
    rng = np.random.default_rng(2)
    corners = 0
    for turn in np.append(rng.uniform(0, 2 * np.pi, 20), [0.0, np.pi / 2]):
        radius, along = rng.uniform(0.05, 0.3), np.array([np.cos(turn), np.sin(turn)])
        apart = rng.uniform(0.05, 0.9) * radius * np.array([1.0, 0.0])
        tips = [(side + radius * along, -side) for side in (apart, -apart)]
        inside = [tip for tip, other in tips if np.hypot(*(tip - other)) <= radius]
        corner = np.sqrt(radius**2 - apart[0] ** 2) * np.array([0.0, 1.0])
        expected = inside[0] if inside else max((corner, -corner), key=lambda own: float(own @ along))
        corners += not inside
        rows = np.repeat(np.eye(2)[None], 2, axis=0)
        q, slack = solved(np.array([apart, -apart]), np.full(2, radius), rows, along)
        assert slack == pytest.approx(radius - apart[0], abs=1e-12)
        np.testing.assert_allclose(q, expected, rtol=0, atol=1e-9)
    assert 3 < corners < 19


FEATURE = "{kind: cylinder, at: [%d mm, %d mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: %d mm%s}"


def cover(floating: str, folder: Path) -> Assembled:
    """Four bolts of 8 mm in holes of 9 mm; hole 4 has a zone of 0.3 mm, and all the others lie exactly."""
    at = ((-70, -50), (70, -50), (-70, 50), (70, 50))
    face = "{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, %d], extent: [160 mm, 120 mm]}"
    none = "{kind: constant, value: 0 mm}"
    parts = {
        "housing": [f"screw {k}: {FEATURE % (*own, 8, '')}" for k, own in enumerate(at)],
        "cover": [f"hole {k}: {FEATURE % (*own, 9, ', hole: true')}" for k, own in enumerate(at)],
    }
    lines = ["scene: cover", "parts:"]
    for sign, (name, own) in zip((1, -1), parts.items(), strict=True):
        lines += [f"  {name}:", "    kind: solid", "    features:", f"      face: {face % sign}"]
        lines += [f"      {each}" for each in own]
    lines += ["tolerances:"]
    lines += [f"  screw {k}: {{kind: size, of: housing.screw {k}, distribution: {none}}}" for k in range(4)]
    lines += [f"  hole {k}: {{kind: size, of: cover.hole {k}, distribution: {none}}}" for k in range(4)]
    lines += [
        "  off: {kind: position, of: cover.hole 3, datums: [face, hole 0], zone: {diameter: 0.3 mm}, "
        "law: {kind: uniform}}",
        "moves:",
        "  down: {kind: fix, part: housing}",
        "  on: {kind: pattern, part: cover, relations: [{kind: coincident, from: cover.face, to: housing.face}], "
        f"float: {floating}, pairs: [",
        ", ".join(f"{{from: cover.hole {k}, to: housing.screw {k}}}" for k in range(4)) + "]}",
        "measures:",
        "  slack: {kind: slack, of: on}",
        "  x: {kind: gap, from: housing.screw 0, to: cover.hole 0, along: [1, 0, 0]}",
    ]
    return assembled("\n".join(lines), folder)


@pytest.mark.parametrize("floating", ["{kind: centred}", "{kind: random}"])
def test_one_end_of_one_hole_off_leaves_half_of_it(floating: str, tmp_path: Path) -> None:
    """Holes 0 to 2 tie; what end e of hole 3 is off by d costs d / 2, to second order (d / 10)^2 / 2 of d / 2."""
    made = cover(floating, tmp_path)
    own = next(place for contributor, place in made.slices if contributor.name == "off")
    rows = np.repeat(np.zeros((1, made.system.assembly.width)), 9, axis=0)
    sizes = np.array([0.1, 0.03])
    for k in range(4):
        rows[1 + 2 * k : 3 + 2 * k, own.start + k] = sizes
    values, codes = placing.values(made.system.assembly, rows, ["slack"])["slack"]
    assert (codes == OK).all()
    expected = 0.5 - np.concatenate([[0.0], np.tile(sizes / 2, 4)])
    np.testing.assert_allclose(values, expected, rtol=0, atol=2.6e-6)
    np.testing.assert_allclose(torsors.values(made.system.assembly, rows, ["slack"])["slack"], expected, atol=1e-9)
    x, codes = placing.values(made.system.assembly, rows, ["x"])["x"]
    assert np.isfinite(x).all()
    assert np.isfinite(torsors.values(made.system.assembly, rows, ["x"])["x"]).all()


@pytest.mark.parametrize("floating", ["{kind: centred}", "{kind: random}", "{kind: toward, along: [1, 0, 0], at: AT}"])
def test_eight_tied_ends_go_together_down_to_a_slack_that_is_rounding(floating: str, tmp_path: Path) -> None:
    """Slacks of ±1e-9 mm about FITS, all eight ends alike: statuses by the stated slack, and of those built no play.

    Sizes of 8 mm leave 2e-15 mm of a slack; a part drawn 600 mm off, 1e-13 mm.
    """
    made = cover(floating.replace("AT", "cover.hole 0"), tmp_path)
    place = {contributor.name: own for contributor, own in made.slices}
    slacks = np.array([1e-6, 1e-9, 1e-12, 0.0, -1e-12, -0.9e-9, -1.1e-9, -2e-9, -1e-6])
    rows = np.zeros((len(slacks), made.system.assembly.width))
    for k in range(4):
        rows[:, place[f"hole {k}"]] = (2 * slacks - 1.0)[:, None]
    for assembly in (made.system.assembly, askew(made.system.assembly, 1)):
        values = placing.values(assembly, rows, ["slack", "x"])
        np.testing.assert_allclose(values["slack"][0], slacks, rtol=0, atol=2e-12)
        assert (values["slack"][1] == OK).all()
        np.testing.assert_array_equal(values["x"][1], np.where(slacks < -1e-9, NO_BUILD, OK))
        built = slacks > -1e-9
        play = np.maximum(slacks[built], 0.0)
        assert (np.abs(values["x"][0][built]) <= play + 2e-9).all()  # less than nothing is no room to go
        linear = torsors.values(assembly, rows, ["slack", "x"])
        np.testing.assert_allclose(linear["slack"], slacks, rtol=0, atol=2e-12)
        assert (np.abs(linear["x"][built]) <= play + 2e-9).all()


@pytest.mark.parametrize("pose", [np.eye(4), posed((0.3, -1.2, 0.8), (600.0, -400.0, 500.0))], ids=["drawn", "askew"])
def test_a_plate_on_tied_pads_has_no_unique_pose_from_a_nanometre_s_millionth_on(pose: Array) -> None:
    """Two pads across a rectangle are h higher: a corner over the third one moves by 2 h, and 1e-9 mm of it is none."""
    at = np.array([[-100.0, -60.0], [100.0, -60.0], [100.0, 60.0], [-100.0, 60.0]])
    model = pads(at).rested(pose, seen=[(np.array([100.0, -60.0, 0.0]), np.array([0.0, 0.0, 1.0]))])
    highs = np.array([0.0, 1e-12, 0.4e-9, 0.6e-9, 1e-9, 1e-6])
    rows = np.outer(highs, [1.0, 0.0, 1.0, 0.0])
    values, codes = placing.values(model, rows, ["0"])["0"]
    np.testing.assert_array_equal(codes, np.where(2 * highs > 1e-9, NOT_UNIQUE, OK))
    assert (np.abs(values[codes == OK]) < 1e-9).all()
    values, codes = placing.values(model, rows[:, [1, 0, 3, 2]], ["0"])["0"]  # the corner lies on its pad
    assert (codes == OK).all()
    np.testing.assert_allclose(values, highs, rtol=0, atol=2e-12)


ENDS = {"q": point((0, 0, 0)), "r": point((100, 0, 0))}
SIZES = """
  size 1: {kind: size, of: base.pin 1, distribution: {kind: constant, value: 0 mm}}
  size 2: {kind: size, of: base.pin 2, distribution: {kind: constant, value: 0 mm}}
  size 3: {kind: size, of: plate.hole 1, distribution: {kind: uniform, lower: -0.02 mm, upper: 0.02 mm}}
  size 4: {kind: size, of: plate.hole 2, distribution: {kind: constant, value: 0 mm}}
"""
READ = """
  qx: {kind: gap, from: base.q, to: plate.q, along: [1, 0, 0]}
  qy: {kind: gap, from: base.q, to: plate.q, along: [0, 1, 0]}
  ry: {kind: gap, from: base.r, to: plate.r, along: [0, 1, 0]}
"""


def pushed_plate(wide: float, along: tuple[float, float]) -> str:
    """A plate on two pins of 10 mm, of which one has a hole of another diameter [mm], pushed as far as it goes."""
    pins = {"pin 1": pin((0, 0, 5), 10), "pin 2": pin((100, 0, 5), 10)}
    holes = {"hole 1": hole((0, 0, 5), 10.1), "hole 2": hole((100, 0, 5), wide)}
    pairs, floating = [*zip(holes, pins, strict=True)], f"{{kind: toward, along: {[*along, 0.0]}, at: plate.q}}"
    return two_plates(pins | ENDS, holes | ENDS, pairs, SIZES, READ, floating=floating, middle=(50, 0, 0))


FLAT = 0.06 * np.sqrt(2e-12)
"""mm; of a circle of 0.06 mm what lies within a gap of 1e-12 of its radius, where interior points may end."""


@pytest.mark.parametrize("wide", [10.12, 10.4, 12.0])
@pytest.mark.parametrize("along", [(0.8, 0.6), (-0.6, 0.8), (0.0, 1.0), (0.96, -0.28)])
def test_a_hole_is_pushed_as_far_as_its_own_clearance_whichever_way(
    along: tuple[float, float], wide: float, tmp_path: Path
) -> None:
    """The other hole leaves a turn about this one open, which its clearance centres to second order of 0.05 mm."""
    text = pushed_plate(wide, along)
    elsewhere = "placed: {at: [300 mm, -200 mm, 70 mm], z: [0, 0.6, 0.8], x: [0.6, 0.64, -0.48]}"
    for place, bound in (("", 1e-9), (elsewhere, FLAT)):
        made = assembled(text.replace("kind: solid\n", f"kind: solid\n    {place}\n"), tmp_path)
        _is_pushed(made, along, bound)


def _is_pushed(made: Assembled, along: tuple[float, float], bound: float) -> None:
    (columns,) = (own for contributor, own in made.slices if contributor.name == "size 3")
    room = 0.05 + drawn(made.simulation, 0, 20).deviations[:, columns][:, 0] / 2
    assert 0.04 < room.min() < 0.045 < 0.055 < room.max() < 0.06
    for method in ("exact", "analytic"):
        found = made.drawn(20, method)
        for name, share in zip(("qx", "qy"), along, strict=True):
            np.testing.assert_allclose(found[name], share * room, rtol=0, atol=bound)
        np.testing.assert_allclose(found["ry"], 0.0, atol=2 * 0.06**2 / 100)
