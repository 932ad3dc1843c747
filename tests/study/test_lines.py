"""Tolerances that several contributors share: a question about one is asked of its line, which changes all of them."""

import math
from pathlib import Path

import pytest
from fixtures import Command
from scene_texts import scene_of, written

from tol3d import InputError
from tol3d.analyses.allocation import allocation
from tol3d.analyses.allocation_section import allocated_scene, groups_of
from tol3d.analyses.before_after import what_if
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.stated_changes import Change, change_of, changed, factor_of
from tol3d.analyses.tolerance_search import Question, Target
from tol3d.analyses.what_to_change import ChangesQuestion, changes_of
from tol3d.scene.edit import write_scene
from tol3d.simulate import load, simulation_of
from tol3d.statistics.distributions import Uniform
from tol3d.study.system.draw import Scalar
from tol3d.study.system.plain import PlainContributor
from tol3d.study.trials.simulation import lines_of

FLOOR, RING = 8.0, 10.0  # um, sigmas of 3 sigma limits
BASE = """  base:
    kind: solid
    features:
      floor: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [100 mm, 100 mm]}
      left: {kind: plane, at: [-50 mm, 0 mm, 50 mm], normal: [1, 0, 0], extent: [100 mm, 100 mm]}
      back: {kind: plane, at: [0 mm, -50 mm, 50 mm], normal: [0, 1, 0], extent: [100 mm, 100 mm]}
      o: {kind: point, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1]}
"""
RINGS = """  ring:
    kind: solid
    features:
      under: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 100 mm]}
      left: {kind: plane, at: [-50 mm, 0 mm, 5 mm], normal: [-1, 0, 0], extent: [100 mm, 10 mm]}
      back: {kind: plane, at: [0 mm, -50 mm, 5 mm], normal: [0, -1, 0], extent: [100 mm, 10 mm]}
      top: {kind: plane, at: [0 mm, 0 mm, 10 mm], normal: [0, 0, 1], extent: [100 mm, 100 mm]}
"""
THICKNESS = "  thickness: {kind: plus_minus, of: ring.top, distribution: {kind: normal, lower: -25 um, upper: 35 um}}\n"
FLATNESS = "  floor: {kind: plus_minus, of: base.floor, distribution: {kind: normal, lower: -24 um, upper: 24 um}}\n"


def pile(rings: list[str]) -> str:
    """Moves and a measure of rings on each other."""
    found, under = "moves:\n  table: {kind: fix, part: base}\n", "base.floor"
    for k, ring in enumerate(rings):
        pairs = [(f"{ring}.under", under), (f"{ring}.left", "base.left"), (f"{ring}.back", "base.back")]
        relations = ", ".join(f"{{kind: coincident, from: {one}, to: {other}}}" for one, other in pairs)
        found += f"  on {k}: {{kind: mate, part: {ring}, relations: [{relations}]}}\n"
        under = f"{ring}.top"
    limits = f"lower_limit: {10 * len(rings) - 0.04} mm, upper_limit: {10 * len(rings) + 0.05} mm"
    return (
        f"{found}measures:\n  gap: {{kind: gap, from: base.o, to: {under}, along: [0, 0, 1], {limits}}}\n"
        "study: {trials: 200, seed: 1}\n"
    )


LIKE = (
    f"scene: like\nparts:\n{BASE}{RINGS}"
    "  ring 2: {kind: solid, like: ring, placed: {at: [0 mm, 0 mm, 10 mm]}}\n"
    "  ring 3: {kind: solid, like: ring 2, placed: {at: [0 mm, 0 mm, 20 mm]}}\n"
    f"tolerances:\n{THICKNESS}{FLATNESS}OWN{pile(['ring', 'ring 2', 'ring 3'])}"
)
OWN = "  thicker: {kind: plus_minus, of: ring 2.top, distribution: {kind: normal, lower: -12 um, upper: 12 um}}\n"


def like(folder: Path, own: str = "") -> Response:
    return response_of(simulation_of(scene_of(LIKE.replace("OWN", own), folder)), analytic=True)


def included(folder: Path, without: str = "", own: str = "") -> Path:
    """A file with one ring, included by another with two names, and that by the scene; the scene itself has it too."""
    folder.mkdir(exist_ok=True)
    (folder / "parts").mkdir(exist_ok=True)
    (folder / "parts" / "ring.yaml").write_text(f"parts:\n{RINGS}tolerances:\n{THICKNESS}", "utf-8")
    pair = "include: {low: ring.yaml, high: {file: ring.yaml, at: [0 mm, 0 mm, 10 mm]}}\n"
    (folder / "parts" / "pair.yaml").write_text(pair, "utf-8")
    third = f"  top: {{file: parts/ring.yaml, at: [0 mm, 0 mm, 20 mm]{without}}}\n"
    text = f"scene: included\ninclude:\n  both: parts/pair.yaml\n{third}parts:\n{BASE}tolerances:\n{FLATNESS}{own}"
    return written(text + pile(["both low ring", "both high ring", "top ring"]), folder)


def halved(response: Response, line: str) -> float:
    """Sigma of the gap [um] with a tolerance half as wide, by slopes, which are 1."""
    found = what_if(response, [Change(line, factor=0.5)], trials=0, draws=0).measures["gap"].after.sigma_by_rates
    assert found is not None
    return found


def test_a_tolerance_of_parts_alike_is_changed_of_all_of_them(tmp_path: Path) -> None:
    """A chain of copies: three rings, one line."""
    response = like(tmp_path)
    assert response.lines["thickness"] == ("thickness", "thickness of ring 2", "thickness of ring 3")
    assert halved(response, "thickness") == pytest.approx(math.sqrt(FLOOR**2 + 3 * (RING / 2) ** 2), rel=1e-6)
    narrower = changed(response, [change_of(response, "thickness=-5 um..15 um")])
    laws = [narrower.drawn_by(name).distribution for name in response.lines["thickness"]]
    assert [(law.low, law.high) for law in laws] == [pytest.approx((-0.005, 0.015))] * 3


def test_a_part_that_states_its_own_tolerance_has_a_line_of_its_own(tmp_path: Path) -> None:
    """Ring 3 is like ring 2, and takes that of the nearest."""
    response = like(tmp_path, OWN)
    assert response.lines["thickness"] == ("thickness",)
    assert response.lines["thicker"] == ("thicker", "thicker of ring 3")
    assert halved(response, "thickness") == pytest.approx(math.sqrt(FLOOR**2 + (RING / 2) ** 2 + 2 * 16), rel=1e-6)


def test_a_tolerance_of_a_file_that_is_included_several_times_is_one(tmp_path: Path) -> None:
    """By way of another file too."""
    response = response_of(simulation_of(load(included(tmp_path))), analytic=True)
    names = ("both low thickness", "both high thickness", "top thickness")
    assert response.lines["thickness of parts/ring.yaml"] == names
    expected = math.sqrt(FLOOR**2 + 3 * (RING / 2) ** 2)
    for line in ("thickness of parts/ring.yaml", "thickness"):  # its name in the file is enough
        assert halved(response, line) == pytest.approx(expected, rel=1e-6)
    with pytest.raises(InputError, match=r"expected 'thickness of parts/ring.yaml', .* got 'top thickness' alone"):
        factor_of(response, "top thickness=0.5")


def test_an_include_that_states_the_tolerance_itself_is_none_of_them(tmp_path: Path) -> None:
    own = OWN.replace("ring 2.top", "top ring.top")
    response = response_of(simulation_of(load(included(tmp_path, ", without: [thickness]", own))), analytic=True)
    assert response.lines["thickness of parts/ring.yaml"] == ("both low thickness", "both high thickness")
    assert response.lines["thicker"] == ("thicker",)
    assert halved(response, "thicker") == pytest.approx(math.sqrt(FLOOR**2 + 2 * RING**2 + 2**2), rel=1e-6)


@pytest.mark.parametrize("kind", ["like", "include"])
def test_an_allocation_has_one_value_and_a_scene_with_it_is_the_same(kind: str, tmp_path: Path) -> None:
    path = included(tmp_path) if kind == "include" else tmp_path / "scene.yaml"
    scene = load(path) if kind == "include" else scene_of(LIKE.replace("OWN", ""), tmp_path)
    line = "thickness of parts/ring.yaml" if kind == "include" else "thickness"
    response = response_of(simulation_of(scene), analytic=True)
    question = Question(groups=groups_of(response), frozen=frozenset({"floor"}))
    found = allocation(response, [Target("gap", (), 20_000.0)], question, draws=400)
    factor = found.tolerances[line].factor
    assert found.tolerances.keys() == {line, "floor"}
    out = path.with_name("allocated.yaml")
    write_scene(allocated_scene(scene, response, found, {}), out)
    again = response_of(simulation_of(load(out)), analytic=True)
    sigma = what_if(again, [Change("floor", factor=1.0)], trials=0, draws=0).measures["gap"].before.sigma_by_rates
    assert sigma == pytest.approx(math.sqrt(FLOOR**2 + 3 * (factor * RING) ** 2), rel=1e-4)  # as its text has digits
    copy = response.lines[line][1]
    with pytest.raises(InputError, match=f"--freeze: expected '{line}', .* got '{copy}' alone"):
        allocation(response, [Target("gap", (), 20_000.0)], Question(frozen=frozenset({copy})), draws=400)


def test_what_a_move_of_a_file_states_is_shared_too(tmp_path: Path) -> None:
    """Such as the bolts of a move, which no tolerance states."""
    stand = f"parts:\n{BASE}moves: {{hold: {{kind: fix, part: base}}}}\n"
    (tmp_path / "stand.yaml").write_text(stand, "utf-8")
    text = "scene: two stands\ninclude: {a: stand.yaml, far b: stand.yaml}\n"
    measured = "{kind: gap, from: a base.o, to: far b base.o, along: [0, 0, 1]}"
    scene = scene_of(f"{text}measures: {{apart: {measured}}}\n", tmp_path)
    names = ("bolt 1 of a hold", "bolt 1 of far b hold", "bolt 2 of a hold")
    found = lines_of(scene, [PlainContributor(name, "size", Scalar(Uniform(-0.01, 0.02))) for name in names])
    assert {own.name: (own.contributors, own.entries) for own in found} == {
        "bolt 1 of hold of stand.yaml": (names[:2], ()),
        "bolt 2 of hold of stand.yaml": (names[2:], ()),
    }


def test_features_of_a_pattern_share_their_line() -> None:
    holes = response_of(simulation_of(load("bracket_in_box")), analytic=True).lines
    assert holes["dowel hole position"] == tuple(f"dowel hole position {k}" for k in range(1, 5))


@pytest.mark.slow
def test_legs_of_a_machine_share_their_lines_and_its_floats_have_none() -> None:
    legs = response_of(simulation_of(load("stewart")), analytic=True).lines
    assert legs["foot x"] == ("foot x", *(f"foot x of foot {k}" for k in range(2, 7)))
    assert legs["float of lower 1"] == ("float of lower 1",)


def test_one_copy_alone_is_refused_with_the_name_of_the_line(tmp_path: Path, tol3d: Command) -> None:
    scene_of(LIKE.replace("OWN", ""), tmp_path)
    code, _, told = tol3d("what-if", str(tmp_path / "scene.yaml"), "--factor", "thickness of ring 3=0.5")
    assert code == 2
    assert "expected 'thickness', one line of the scene" in told


def test_advice_changes_lines_not_copies(tmp_path: Path) -> None:
    """Of three rings alike, on one of which nothing depends: sigma √(8² + 2 · 5²); one nominal, by half for each."""
    scene = LIKE.replace("OWN", "").replace("to: ring 3.top", "to: ring 2.top").replace("29.96", "19.96")
    response = response_of(simulation_of(scene_of(scene.replace("30.05", "20.05"), tmp_path)), analytic=True)
    found = changes_of(response, ChangesQuestion("gap", builds=2000)).measures["gap"]
    steps = {(own.steps[0].contributor, own.steps[0].change is None): own for own in found.proposals}
    assert {name for name, _ in steps} <= {"thickness", "floor"}
    half = steps["thickness", True].after.sigma
    assert half == pytest.approx(math.sqrt(FLOOR**2 + 2 * (RING / 2) ** 2), rel=4 / math.sqrt(2 * 2000))
    moved = steps["thickness", False].steps[0]
    assert moved.change == pytest.approx((5.0 - 2 * 5.0) / 2, abs=1e-6)  # to the middle of -40 and 50, from 10 um
