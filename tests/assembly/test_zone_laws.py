"""Problem 9: what a zone does to a face and to an axis, law by law, as a scene's measures read it."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from fixtures import Command
from scene_texts import written
from scipy.stats import kstest, norm

from tol3d.errors import SceneError
from tol3d.simulate import Overrides, run_scene
from tol3d.study.effects.first_order import first_orders
from tol3d.study.runs.run import open_run

WIDTH, A, B, LENGTH = 0.1, 100.0, 60.0, 40.0
COUNT = 200_000

SCENE = """
scene: a face and an axis in their zones
parts:
  plate:
    kind: solid
    features:
      base: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [100 mm, 60 mm]}}
      face: {{kind: plane, at: [0 mm, 0 mm, 20 mm], normal: [0, 0, 1], extent: [100 mm, 60 mm]}}
      upright: {{kind: axis, at: [0 mm, 0 mm, 20 mm], axis: [0, 0, 1], length: 40 mm}}
      bore: {{kind: axis, at: [0 mm, 0 mm, 20 mm], axis: [0, 0, 1], length: 40 mm}}
tolerances:
  profile: {{kind: profile, of: plate.face, zone: {{width: 0.1 mm{outward}}}, law: {law}}}
  position: {{kind: position, of: plate.bore, zone: {{diameter: 0.1 mm}}, law: {law}}}
moves:
  machine: {{kind: fix, part: plate}}
measures:
  height: {{kind: gap, from: plate.base, to: plate.face, along: [0, 0, 1]}}
  about x: {{kind: angle, from: plate.base, to: plate.face, about: [1, 0, 0]}}
  about y: {{kind: angle, from: plate.base, to: plate.face, about: [0, 1, 0]}}
  tilt: {{kind: angle, from: plate.upright, to: plate.bore}}
  parallelism: {{kind: inspected_orientation, of: plate.face, datums: [base]}}
  true position: {{kind: inspected_position, of: plate.bore}}
"""


def zoned(folder: Path, law: str, outward: str = "") -> Assembled:
    return assembled(SCENE.format(law=law, outward=outward), folder)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_uniform(tmp_path: Path, method: str) -> None:
    found = zoned(tmp_path, "{kind: uniform}").drawn(COUNT, method)
    half, error = WIDTH / 2, 4 / math.sqrt(2 * COUNT)
    assert (found["height"] - 20).std() == pytest.approx(half / math.sqrt(10), rel=error)
    alpha, beta = half / (B / 2), half / (A / 2)
    assert found["about x"].std() == pytest.approx(alpha / math.sqrt(10), rel=error)
    assert found["about y"].std() == pytest.approx(beta / math.sqrt(10), rel=error)
    share = 1 / 8
    beyond = (np.abs(found["about x"]) > alpha / 2).mean()
    assert beyond == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / COUNT))
    mean, rms = 128 / (45 * math.pi) * half / LENGTH, half / LENGTH
    assert (mean, rms) == pytest.approx((1.131768e-3, 1.25e-3), abs=1e-9)
    spread = math.sqrt(rms**2 - mean**2)
    assert found["tilt"].mean() == pytest.approx(mean, abs=4 * spread / math.sqrt(COUNT))
    assert math.sqrt((found["tilt"] ** 2).mean()) == pytest.approx(rms, rel=8 / math.sqrt(COUNT))
    close = 1 - 3 * math.sqrt(3) / (4 * math.pi)
    near = (found["tilt"] < half / LENGTH).mean()  # ends less than half the width apart
    assert near == pytest.approx(close, abs=4 * math.sqrt(close * (1 - close) / COUNT) + 1e-6)
    # in its zone: the corners, and both ends; reached, and never left
    assert found["parallelism"].max() == pytest.approx(WIDTH, rel=0.05)
    assert found["parallelism"].max() <= WIDTH * (1 + 1e-6)
    assert found["true position"].max() == pytest.approx(WIDTH, rel=0.01)
    assert found["true position"].max() <= WIDTH * (1 + 1e-6)


def test_normals_that_do_not_know_the_zone(tmp_path: Path) -> None:
    """By `process` each coordinate has its 6 sigma in the zone; together they leave it in a quarter of trials."""
    law = "{kind: process, distribution: {kind: normal, mean: 0 mm, sigma: " + repr(WIDTH / 6) + " mm}}"
    found = zoned(tmp_path, law).drawn(COUNT)
    half = WIDTH / 2
    inside = (
        np.abs(found["height"] - 20) + B / 2 * np.abs(found["about x"]) + A / 2 * np.abs(found["about y"])
    ) <= half
    share = 0.7374245  # P(|Z1| + |Z2| + |Z3| <= 3), by quadrature
    assert inside.mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / COUNT))
    flat = (np.abs(found["height"] - 20) + B / 2 * np.abs(found["about x"])) <= half
    plane = (2 * norm.cdf(3 / math.sqrt(2)) - 1) ** 2
    assert flat.mean() == pytest.approx(plane, abs=4 * math.sqrt(plane * (1 - plane) / COUNT))


def test_a_run_counts_what_is_out_of_drawing(tmp_path: Path) -> None:
    law = "{kind: process, distribution: {kind: normal, mean: 0 mm, sigma: " + repr(WIDTH / 6) + " mm}}"
    scene = written(SCENE.format(law=law, outward=""), tmp_path)
    count = 20_000
    run = run_scene(scene, overrides=Overrides(trials=count), out=tmp_path / "run")
    drawn = run.columns("profile.offset [um]", "profile.rise x [um]", "profile.rise y [um]")
    beyond = int((sum(np.abs(own) for own in drawn.values()) > 1e3 * WIDTH / 2).sum())
    assert f"profile: {beyond} of {count} draws are out of drawing; kept as drawn" in run.summary["warnings"]
    share = 1 - 0.7374245
    assert beyond / count == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / count))
    ends = run.columns(*(f"position.{end} {axis} [um]" for end in ("start", "end") for axis in "xy"))
    x1, y1, x2, y2 = ends.values()
    aside = int((np.maximum(np.hypot(x1, y1), np.hypot(x2, y2)) > 1e3 * WIDTH / 2).sum())
    assert any(f"position: {aside} of {count}" in warning for warning in run.summary["warnings"])


SIGMAS = {  # of the middle in its zone of 0.1 mm [um]: of the face, of the bore
    "{kind: uniform}": (100 / 2 / math.sqrt(10), 100 / 4 / math.sqrt(2)),
    "{kind: normal}": (0.98657840 * 100 / 6, math.sqrt(1 - 4.5 / math.expm1(4.5)) * 100 / 6),
    "{kind: process, distribution: {kind: normal, mean: 0 mm, sigma: 0.02 mm}}": (20.0, 20 / math.sqrt(2)),
}


@pytest.mark.parametrize("law", SIGMAS)
def test_check_and_run_tell_the_sigma_of_the_middle_under_each_law(law: str, tol3d: Command, tmp_path: Path) -> None:
    """Both methods: a hole's middle by `normal` has 0.974 of a sixth of the zone, by `process` 1/√2 of it."""
    text = (
        SCENE.format(law=law, outward="")
        + "  aside: {kind: gap, from: plate.upright, to: plate.bore, along: [1, 0, 0]}\n"
    )
    path, count = tmp_path / "scene.yaml", 20_000
    path.write_text(text, encoding="utf-8")
    _, checked, _ = tol3d("check", str(path))
    told = ("run", str(path), "-v", "--trials", str(count), "--no-picture", "--out", str(tmp_path / "run"))
    _, shown, _ = tol3d(*told)
    run = open_run(tmp_path / "run").summary["measures"]
    for name, tolerance, sigma in zip(("height", "aside"), ("profile", "position"), SIGMAS[law], strict=True):
        assert run[name]["law_sigmas_um"] == pytest.approx({tolerance: sigma}, rel=1e-7)
        assert run[name]["analytic_closed_form"]["sigma"] == pytest.approx(sigma, rel=1e-7)
        for method in ("analytic", "geometric"):
            assert run[name][method]["sigma"] == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))
        row = re.search(rf"^{tolerance} .* (\S+) +µm +–", checked, re.MULTILINE)
        assert row is not None
        assert row[1] == f"{sigma:.3g}"
        assert re.search(rf"^{tolerance} .* {sigma:.3g} *$", shown.partition("laws of zones")[2], re.MULTILINE)
    assert "so that the middle has 1/√2 of its sigma" in " ".join(checked.split())


def test_unequal_profile(tmp_path: Path) -> None:
    found = zoned(tmp_path, "{kind: uniform}", ", outward: 0.08 mm").drawn(COUNT)["height"]
    sigma = WIDTH / 2 / math.sqrt(10)
    assert found.mean() == pytest.approx(20 + 0.08 - 0.05, abs=4 * sigma / math.sqrt(COUNT))
    assert found.max() <= 20.08 + 1e-12


def test_closed_forms(tmp_path: Path) -> None:
    system = zoned(tmp_path, "{kind: uniform}").system
    sigmas = {}
    for measure in system.measures:
        form = system.closed_form(measure)
        sigmas[measure.name] = None if form is None else form.sigma
    half = WIDTH / 2
    assert sigmas["height"] == pytest.approx(half / math.sqrt(10), rel=1e-9)
    assert sigmas["about x"] == pytest.approx(half / (B / 2) / math.sqrt(10), rel=1e-9)
    assert sigmas["tilt"] is None  # it is a length of two
    assert sigmas["true position"] is None


def test_the_mean_of_a_process_offsets_a_face_and_does_not_tilt_it(tmp_path: Path) -> None:
    law = "{kind: process, distribution: {kind: normal, mean: 0.02 mm, sigma: 0.005 mm}}"
    found = zoned(tmp_path, law).drawn(20_000)
    error = 4 * 0.005 / math.sqrt(20_000)
    assert found["height"].mean() == pytest.approx(20.02, abs=error)
    assert B / 2 * found["about x"].mean() == pytest.approx(0.0, abs=error)
    assert B / 2 * found["about x"].std() == pytest.approx(0.005, rel=4 / math.sqrt(40_000))


@pytest.mark.parametrize(("law", "words"), [("uniform", "uniform in its zone"), ("normal", "normal in its zone")])
def test_a_result_names_the_law_of_every_zone_that_acts(tmp_path: Path, law: str, words: str) -> None:
    scene = written(SCENE.format(law=f"{{kind: {law}}}", outward=""), tmp_path)
    measures = run_scene(scene, overrides=Overrides(trials=50), out=tmp_path / "run").summary["measures"]
    zones = {"tilt": "position", "true position": "position"}
    assert {name: own.get("laws") for name, own in measures.items()} == {
        name: {zones.get(name, "profile"): words} for name in measures
    }


def test_a_scene_names_one_law_for_all_its_zones_by_an_anchor(tmp_path: Path) -> None:
    text = SCENE.format(law="{kind: normal}", outward="")
    both = text.replace("law: {kind: normal}", "law: &zones {kind: normal}", 1).replace(
        "law: {kind: normal}", "law: *zones"
    )
    found, same = (assembled(own, tmp_path).drawn(20) for own in (both, text))
    assert all(np.array_equal(found[name], same[name]) for name in same)


# a ring ------------------------------------------------------------------------------------------------------

RING = """
scene: an eccentric hole
parts:
  plate:
    kind: solid
    features:
      floor: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [100 mm, 60 mm]}
      bore: {kind: cylinder, at: [0 mm, 0 mm, 20 mm], axis: [0, 0, 1], length: 40 mm, diameter: 30 mm, hole: true}
      upright: {kind: axis, at: [0 mm, 0 mm, 20 mm], axis: [0, 0, 1], length: 40 mm}
tolerances:
  bored:
    {kind: position, of: plate.bore, zone: {diameter: 0.1 mm}, modifier: mmc, law: {kind: ring}, datums: [floor]}
  size: {kind: size, of: plate.bore, distribution: {kind: uniform, lower: 0 mm, upper: 0.2 mm}}
moves:
  machine: {kind: fix, part: plate}
measures:
  x: {kind: gap, from: plate.upright, to: plate.bore, along: [1, 0, 0]}
  y: {kind: gap, from: plate.upright, to: plate.bore, along: [0, 1, 0]}
  tilt: {kind: angle, from: plate.upright, to: plate.bore}
  diameter: {kind: inspected_size, of: plate.bore}
  position: {kind: inspected_position, of: plate.bore}
"""


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_on_a_ring_an_axis_lies_at_half_of_its_trial_s_zone_at_any_phase(tmp_path: Path, method: str) -> None:
    """t = 0.1 mm + bonus in every trial, no lean; mean square (0.3^3 - 0.1^3) / (3 · 0.2) of t, sigma t / 2 / √2."""
    made, count = assembled(RING, tmp_path), 20_000
    found = made.drawn(count, method)
    zone = 0.1 + found["diameter"] - 30
    assert np.hypot(found["x"], found["y"]) == pytest.approx(zone / 2, abs=1e-9)
    assert found["position"] == pytest.approx(zone, abs=1e-9)
    assert np.abs(found["tilt"]).max() < 1e-9
    phase = np.arctan2(found["y"], found["x"]) / (2 * math.pi) % 1
    assert kstest(phase, "uniform").pvalue > 1e-6
    sigma = math.sqrt((0.3**3 - 0.1**3) / 0.6 / 8)
    form = made.system.closed_form(next(own for own in made.system.measures if own.name == "x"))
    assert form is not None
    assert form.sigma == pytest.approx(sigma, rel=1e-5)
    assert found["x"].std() == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))


def test_the_worst_case_on_a_ring_is_half_of_the_widest_zone(tmp_path: Path) -> None:
    made = assembled(RING, tmp_path)
    measure = next(own for own in made.system.measures if own.name == "x")
    found = first_orders(made.simulation, None, [measure])[measure.name]["analytic"]
    assert found.ends == pytest.approx((-150, 150), abs=1e-6)
    assert found.sigma == pytest.approx(1e3 * math.sqrt((0.3**3 - 0.1**3) / 0.6 / 8), rel=1e-5)


UPRIGHT = "  upright: {kind: perpendicularity, of: plate.bore, zone: {diameter: 0.05 mm}, datums: [floor]%s}\nmoves:"
RINGS = {
    "refined": (("moves:", UPRIGHT % ""), "beside the law ring, got 'upright'; on a ring the axis does not lean"),
    "flat": (("{diameter: 0.1 mm}", "{width: 0.1 mm, along: [1, 0, 0]}"), "got ring of a position of 'plate.bore'"),
    "plane": (
        ("moves:", "  top: {kind: profile, of: plate.floor, zone: {width: 0.1 mm}, law: {kind: ring}}\nmoves:"),
        "expected uniform, normal or process, got ring of a profile of 'plate.floor'; a ring is of where an axis lies",
    ),
    "orientation": (("  bored:", "  unread:"), "got ring of a perpendicularity of 'plate.bore'; a ring is of where"),
}


@pytest.mark.parametrize("name", RINGS)
def test_a_ring_is_of_where_an_axis_lies_and_refined_by_nothing(name: str, tmp_path: Path) -> None:
    (old, new), words = RINGS[name]
    text = RING.replace(old, new, 1)
    if name == "orientation":
        text = re.sub(r"  unread:\n.*\n", "", text).replace("moves:", UPRIGHT % ", law: {kind: ring}")
    with pytest.raises(SceneError, match=re.escape(words)) as caught:
        assembled(text, tmp_path)
    assert ".law: " in str(caught.value)
