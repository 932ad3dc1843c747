"""Proposed changes: closed forms of a normal sum, and scenes changed as proposed and simulated again."""

import json
import math
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import norm
from toys.parabola import PARABOLA
from toys.registered import TOYS, known

import tol3d
from tol3d import InputError, Overrides
from tol3d.analyses.drawn_builds import drawn_builds
from tol3d.analyses.estimated_changes import estimated_changes, not_ok
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.subject import keep, sections_of
from tol3d.analyses.what_to_change import Asked, Changes, ChangesQuestion, changes_of, contributions_of
from tol3d.analyses.what_to_change_picture import changes_of_one, draw_changes
from tol3d.analyses.what_to_change_table import changes_lines, changes_report, contributions_table
from tol3d.distributions.normal import Normal
from tol3d.report.page import page
from tol3d.report.sheet import as_text
from tol3d.scene import Scene
from tol3d.scene.bundled import bundled_scenes
from tol3d.simulate import load, simulation_of
from tol3d.study.simulation import Simulation
from tol3d.study.study import Study
from tol3d.system.draw import Scalar
from tol3d.system.plain import PlainContributor, PlainMeasure, PlainSystem
from tol3d.units import Quantity

Array = NDArray[np.float64]

SLOPES, MEANS, SIGMAS = np.array([2.0, -1.0, 0.5]), np.array([0.3, 0.0, 1.0]), np.array([1.0, 3.0, 2.0])
SIGMA = float(np.linalg.norm(SLOPES * SIGMAS))
MEAN = float(SLOPES @ MEANS)


@dataclass(frozen=True)
class Formula(PlainSystem):
    """A measure that is a function of deviations (n, components)."""

    value: Callable[[Array], Array] = len  # type: ignore[assignment]

    def analytic(self, trials: Any, measure: Any) -> Array:
        return self.value(trials.deviations)

    def exact(self, trials: Any, measure: Any) -> Array:
        return self.value(trials.deviations)


def formula(value: Callable[[Array], Array], lower: float | None, upper: float | None, trials: int = 4000) -> Response:
    contributors = tuple(
        PlainContributor(f"x{k}", "x", Scalar(Normal(float(mean), float(sigma))), "um", 1.0)
        for k, (mean, sigma) in enumerate(zip(MEANS, SIGMAS, strict=True))
    )
    measure = PlainMeasure("value", "value", lower, upper, unit="um", per_internal=1.0)
    return response_of(Simulation(Formula("formula", contributors, (measure,), value), Study(trials=trials)))


def asked(response: Response, builds: int = 4000, accepted: float = 2700.0) -> Any:
    return changes_of(response, ChangesQuestion("value", accepted, builds)).measures["value"]


def linear(x: Array) -> Array:
    return x @ SLOPES


def test_the_mean_of_a_sum_is_centred_by_each_nominal_by_shift_over_slope() -> None:
    """Exactly, for slopes of a sum are known and what the draws are off their means is taken out."""
    (shift,) = asked(formula(linear, -4.0, 10.0)).shifts
    assert shift.target == "middle of the limits"
    assert shift.shift == pytest.approx(3.0 - MEAN, abs=1e-9)
    assert [own.contributor for own in shift.by] == ["x0", "x1", "x2"]
    assert [own.change for own in shift.by] == pytest.approx((3.0 - MEAN) / SLOPES, rel=1e-6)


def test_after_a_change_a_sum_is_as_its_closed_form_says() -> None:
    """Mean, sigma and Ppk within four standard errors of 20 000 builds; the true share lies in its interval."""
    own = asked(formula(linear, -4.0, 10.0, 20_000), 20_000)
    for moved in own.shifts[0].by:
        assert moved.after.mean == pytest.approx(3.0, abs=4 * SIGMA / math.sqrt(20_000))
        assert moved.after.sigma == pytest.approx(SIGMA, rel=4 / math.sqrt(40_000))
        assert moved.after.ppk == pytest.approx(7.0 / (3 * SIGMA), rel=0.03)
        low, high = moved.after.out_ppm_95
        assert low < 2e6 * norm.sf(7.0 / SIGMA) < high
    for half in own.halved:
        narrow = np.where(half.contributor == np.array(["x0", "x1", "x2"]), 0.5, 1.0) * SLOPES * SIGMAS
        assert half.after.sigma == pytest.approx(float(np.linalg.norm(narrow)), rel=4 / math.sqrt(40_000))
    assert [half.contributor for half in own.halved] == ["x1", "x0", "x2"]  # 9, 4 and 1 of the variance of 14
    assert [half.share_percent for half in own.halved] == pytest.approx([900 / 14, 400 / 14, 100 / 14], rel=0.05)


def test_one_limit_is_reached_for_the_accepted_share_and_for_a_ppk() -> None:
    shifts = {own.target: own for own in asked(formula(linear, None, 4.0, 20_000), 20_000).shifts}
    wanted = 4.0 - MEAN - SIGMA * norm.isf(2700e-6)
    density = norm.pdf(norm.isf(2700e-6))  # a quantile's standard error is that of the share over the density
    assert shifts["accepted share"].shift == pytest.approx(
        wanted, abs=4 * SIGMA * math.sqrt(2700e-6 / 20_000) / density
    )
    assert shifts["accepted share"].after.out_ppm <= 2700.0
    assert shifts["Ppk 1.33"].shift == pytest.approx(4.0 - MEAN - 3.99 * SIGMA, rel=0.03)
    assert shifts["Ppk 1.33"].after.ppk == pytest.approx(1.33, rel=1e-3)


def test_a_limit_below_asks_for_the_opposite_shift() -> None:
    above = {own.target: own.shift for own in asked(formula(linear, None, 4.0)).shifts}
    below = {own.target: own.shift for own in asked(formula(lambda x: -linear(x), -4.0, None)).shifts}
    assert {target: -shift for target, shift in below.items()} == pytest.approx(above)


def test_a_mean_off_nominal_is_told_by_contributor() -> None:
    """x0 + x1² / 10 + x2: means of 0.6 and 0.5 by the first order, 0.9 by the second, of the variance 9."""
    own = asked(formula(lambda x: linear(x) - x[:, 1] * SLOPES[1] + 0.1 * x[:, 1] ** 2, None, 2.0))
    taken = {each.contributor: (each.first_order, each.second_order) for each in own.taken}
    assert own.nominal == pytest.approx(0.0, abs=1e-12)
    assert taken["x0"] == pytest.approx((0.6, 0.0), abs=1e-6)
    assert taken["x1"] == pytest.approx((0.0, 0.9), abs=1e-6)
    assert taken["x2"] == pytest.approx((0.5, 0.0), abs=1e-6)
    assert abs(own.taken_together) < 4 * own.taken_error


def test_a_nominal_that_moves_nothing_in_one_direction_moves_no_mean() -> None:
    """|x1| changes by x1 as often one way as the other."""
    own = asked(formula(lambda x: np.abs(x[:, 1]) + 0.2 * x[:, 0], None, 2.0))
    assert [each.contributor for each in own.shifts[0].by] == ["x0"]
    assert own.halved[0].contributor == "x1"


def test_failed_builds_are_out_and_no_shift_mends_them() -> None:
    own = asked(formula(lambda x: np.where(x[:, 1] > 6.0, np.nan, linear(x)), None, 40.0))
    failed = 1e6 * norm.sf(2.0)
    low, high = own.now.out_ppm_95
    assert low < failed < high
    assert own.shifts == []
    assert (own.halved[0].contributor, own.halved[0].after.out_ppm) == (
        "x1",
        pytest.approx(1e6 * norm.sf(4.0), abs=500),
    )


# scenes changed as it says --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def spur() -> Scene:
    """The spur pair with limits that it leaves on both sides."""
    study = {"study.trials": 3000, "study.witness": 0}
    limits = {"measures.normal backlash.lower_limit": "48 um", "measures.normal backlash.upper_limit": "75 um"}
    return load("spur_pair").with_({**limits, **study})


@pytest.fixture(scope="module")
def changes(spur: Scene) -> Changes:
    return changes_of(response_of(simulation_of(spur)), ChangesQuestion(builds=3000))


def simulated(scene: Scene) -> tuple[float, float]:
    response = response_of(simulation_of(scene)).of("normal backlash")
    values = response.values(*response.drawn(3000)).values[:, 0]
    return float(values.mean()), float(values.std(ddof=1))


def with_law(scene: Scene, name: str, shift: float, width: float) -> Scene:
    """With the limits of a normal law moved [um] and narrowed."""
    law: Any = scene.distributed[name].distribution
    lower, upper = (1e3 * own.internal for own in (law.lower, law.upper))
    middle, half = (lower + upper) / 2 + shift, width * (upper - lower) / 2
    own = f"tolerances.{name}.distribution"
    return scene.with_({f"{own}.lower": f"{middle - half!r} um", f"{own}.upper": f"{middle + half!r} um"})


def test_a_scene_changed_as_it_says_has_what_was_said(spur: Scene, changes: Changes) -> None:
    """The same draws, so that only rounding is left; by every nominal and normal tolerance that is told."""
    own = changes.measures["normal backlash"]
    assert own.shifts[0].by
    assert own.halved
    for moved in own.shifts[0].by:
        mean, sigma = simulated(with_law(spur, moved.contributor, moved.change, 1.0))
        assert (mean, sigma) == pytest.approx((moved.after.mean, moved.after.sigma), rel=1e-6)
        assert mean == pytest.approx(61.5, abs=0.01 * abs(own.shifts[0].shift) + 0.5)  # standard error 0.13
    for half in own.halved:
        if half.contributor.endswith(("thickness", "distance", "clearance")):
            assert simulated(with_law(spur, half.contributor, 0.0, 0.5)) == pytest.approx(
                (half.after.mean, half.after.sigma), rel=1e-6
            )


def changed(scene: Scene, name: str, shift: float, factor: float) -> Scene | None:
    """With a tolerance's law moved [um] and so many times as wide, as one would write it; None of others."""
    entry = scene.tolerances[name].model_dump(mode="json")
    law, own = entry.get("distribution") or {}, f"tolerances.{name}"
    if "lower" in law and "upper" in law and law["lower"] is not None:
        lower, upper = (1e3 * Quantity.parse(law[key]).internal for key in ("lower", "upper"))
        middle, half = (lower + upper) / 2 + shift, factor * (upper - lower) / 2
        fields = {"lower": middle - half, "upper": middle + half}
    elif law.get("sigma") is not None:
        mean, sigma = (1e3 * Quantity.parse(law[key]).internal for key in ("mean", "sigma"))
        fields = {"mean": mean + shift, "sigma": factor * sigma}
    elif "diameter" in (entry.get("zone") or {}) and entry.get("law") == {"kind": "uniform"} and not shift:
        diameter = 1e3 * Quantity.parse(entry["zone"]["diameter"]).internal
        return scene.with_({f"{own}.zone.diameter": f"{factor * diameter!r} um"})
    else:
        return None
    return scene.with_({f"{own}.distribution.{key}": f"{value!r} um" for key, value in fields.items()})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "least"), [("door", 25), ("four_pads", 12), ("gearbox_in_housing", 4), ("every_planetary_field", 3)]
)
def test_other_scenes_changed_as_it_says_have_what_was_said(name: str, least: int) -> None:
    _changed_as_it_says(name, least)


def test_an_assembly_changed_as_it_says_has_what_was_said() -> None:
    _changed_as_it_says("clutch", 2)


def _changed_as_it_says(name: str, least: int) -> None:
    """The same draws: means and sigmas within rounding, and the same share out of limits; so many changes at least.

    Of nominals that move a mean and whose law can be moved, and of halved laws and zones.
    """
    scene, builds = load(name), 400
    found = changes_of(response_of(simulation_of(scene)), ChangesQuestion(builds=builds, accepted_ppm=1000.0))
    held = 0
    for measure, own in found.measures.items():
        moved = [(each.contributor, each.change, 1.0, each.after) for shift in own.shifts for each in shift.by]
        for contributor, shift, factor, after in [*moved, *((e.contributor, 0.0, 0.5, e.after) for e in own.halved)]:
            if contributor not in scene.tolerances or (other := changed(scene, contributor, shift, factor)) is None:
                continue
            response = response_of(simulation_of(other)).of(measure)
            built = response.values(*drawn_builds(response, builds))
            values = built.values[built.seated[:, 0], 0]
            got = (float(values.mean()), float(values.std(ddof=1)))
            assert got == pytest.approx((after.mean, after.sigma), rel=1e-5, abs=1e-4)
            lower, upper = (-math.inf if own.lower_limit is None else own.lower_limit), own.upper_limit
            inside = (values >= lower) & (values <= (math.inf if upper is None else upper))
            assert 1e6 * (1 - inside.sum() / builds) == pytest.approx(after.out_ppm, abs=1e6 / builds + 1e-6)
            held += 1
    assert held >= least


def test_no_clearance_is_asked_to_be_less_than_nothing() -> None:
    """The bearing clearance of 2 to 30 um acts by half: it cannot take 30 um out of the backlash."""
    scene = load("spur_pair").with_({"measures.normal backlash.upper_limit": "25 um"})
    own = changes_of(response_of(simulation_of(scene)), ChangesQuestion(builds=500)).measures["normal backlash"]
    middle = next(each for each in own.shifts if each.target == "middle of the limits")
    assert middle.by
    assert "bearing clearance" not in [each.contributor for each in middle.by]


# below a verdict ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def run(spur: Scene, tmp_path_factory: pytest.TempPathFactory) -> Any:
    return tol3d.run_scene(spur, out=tmp_path_factory.mktemp("changes") / "run")


def test_estimates_below_a_verdict_are_near_what_is_simulated(run: Any, spur: Scene, changes: Changes) -> None:
    """A sum nearly: sigma within 3 %, the change of a nominal within 2 %, shares of the variance within 2 points."""
    found = estimated_changes(run, simulation_of(spur))
    assert found is not None
    assert not_ok(run) == ["normal backlash"]
    brief, whole = found.measures["normal backlash"], changes.measures["normal backlash"]
    assert brief.now == whole.now
    exactly = {own.contributor: own for own in whole.halved}
    for half in brief.halved:
        if half.contributor in exactly:
            assert half.after.sigma == pytest.approx(exactly[half.contributor].after.sigma, rel=0.03)
            assert half.share_percent == pytest.approx(exactly[half.contributor].share_percent, abs=2.5)
    nominals = {own.contributor: own.change for own in whole.shifts[0].by}
    for moved in brief.shifts[0].by:
        assert moved.change == pytest.approx(nominals[moved.contributor], rel=0.02)
    assert found.evaluations < 500


def test_a_run_keeps_what_was_found(run: Any, changes: Changes) -> None:
    keep(run, "changes", changes)
    assert sections_of(run)["changes"] == changes


def test_a_run_without_its_trials_is_told_by_its_bars(spur: Scene, tmp_path: Path, changes: Changes) -> None:
    from tol3d.simulate import Execution

    run = tol3d.run_scene(spur, out=tmp_path / "run", execution=Execution(keep_trials=False))
    found = estimated_changes(run, simulation_of(spur))
    assert found is not None
    own, exactly = found.measures["normal backlash"].now, changes.measures["normal backlash"].now
    assert own.sigma == pytest.approx(exactly.sigma, rel=0.01)
    assert own.out_ppm == pytest.approx(exactly.out_ppm, rel=0.1)


def test_nothing_is_said_where_all_is_ok(tmp_path: Path) -> None:
    run = tol3d.run_scene("spur_pair", out=tmp_path / "run", overrides=Overrides(trials=2000, witness=0))
    assert estimated_changes(run, simulation_of(load("spur_pair"))) is None
    none = changes_of(response_of(simulation_of(load("spur_pair"))))
    assert not none.measures
    assert "nothing: no measure is out of its limits" in as_text(changes_report("pair", none), 100)


def test_it_prints_what_it_found(changes: Changes) -> None:
    text = as_text(changes_report("pair", changes), 140)
    own = changes.measures["normal backlash"]
    shift, half = own.shifts[0], own.halved[0]
    assert f"mean +{shift.shift:.3f} µm: middle of the limits" in text
    assert f"  by {shift.by[0].contributor}" in text
    row = next(line for line in text.splitlines() if line.startswith(f"half {half.contributor}"))
    assert f"{half.share_percent:.1f} % of variance" in row
    assert f"{half.after.sigma:.3f}" in row
    narrow = as_text(changes_report("pair", changes), 80).splitlines()
    assert next(k for k, line in enumerate(narrow) if line.startswith("  shift the mean by")) < 5
    assert max(map(len, narrow)) <= 80
    assert len(narrow) < 40
    brief = as_text(page(*changes_lines(changes, "runs/pair")), 140)
    assert "tol3d changes runs/pair" in brief
    assert len(brief.splitlines()) < 10


def test_contributions_of_all_measures_as_numbers() -> None:
    table = contributions_table(contributions_of(formula(linear, None, None)))
    rows = [row.split(",") for row in table.csv().splitlines()]
    assert [row[2] for row in rows[1:]] == ["x0", "x1", "x2"]
    assert [float(row[4]) for row in rows[1:]] == pytest.approx(SLOPES, rel=1e-6)
    assert [float(row[6]) for row in rows[1:]] == pytest.approx(np.abs(SLOPES) * SIGMAS, rel=0.05)


def test_what_cannot_be_asked_is_refused() -> None:
    with pytest.raises(InputError, match=r"expected a limit \(lower_limit, upper_limit\) of any measure"):
        changes_of(formula(linear, None, None))
    with pytest.raises(InputError, match="got 'valu'"):
        changes_of(formula(linear, None, 1.0), ChangesQuestion("valu"))


def test_a_curve_is_told_by_its_ends() -> None:
    """The spring's profile has an upper limit: its highest value is asked for, of a run that names the curve."""
    with known(PARABOLA):
        response = response_of(simulation_of(load(TOYS / "parabola" / "spring.yaml")))
        assert list(changes_of(response, ChangesQuestion(builds=200), bad=["profile"]).measures) == ["profile, highest"]


def test_a_picture_shows_every_change(changes: Changes, tmp_path: Path) -> None:
    own = changes.measures["normal backlash"]
    words = [each for each, _, _ in changes_of_one(own)]
    assert words[0] == "as it is"
    assert len(words) == 1 + sum(1 + len(shift.by) for shift in own.shifts) + len(own.halved)
    draw_changes("pair", changes, tmp_path / "changes.png")
    assert (tmp_path / "changes.png").stat().st_size > 10_000


def test_the_command_keeps_what_it_finds(run: Any, tol3d: Any, tmp_path: Path) -> None:
    """The fixture `run` is left as it is: a copy of it is asked."""
    copy = tmp_path / "run"
    shutil.copytree(run.path, copy)
    code, out, _ = tol3d("changes", str(copy), "--builds", "100", "--csv", str(tmp_path / "c.csv"))
    assert code == 0
    assert "normal backlash · limits 48 µm to 75 µm · 100 builds each" in out
    assert json.loads((copy / "analyses" / "changes.json").read_text("utf-8"))["by"] == "simulation"
    assert (tmp_path / "c.csv").read_text("utf-8").count("\n") == 1 + 2 * 7  # two measures, seven contributors
    assert tol3d("changes", "spur_pair", "--measure", "lost motion")[0] == 2


def test_a_mechanism_from_outside() -> None:
    """The bundled spring: its height is a parabola of x, whose curvature takes the mean off."""
    with known(PARABOLA):
        response = response_of(simulation_of(load(TOYS / "parabola" / "spring.yaml")))
        found = changes_of(response, ChangesQuestion("room", builds=500)).measures["room"]
        assert found.halved
        whole = changes_of(response, ChangesQuestion(builds=500))
        assert set(whole.measures) <= set(response.names)
        assert as_text(changes_report("spring", whole), 120)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(bundled_scenes()))
def test_every_bundled_scene_is_told_or_refused(name: str) -> None:
    response = response_of(simulation_of(load(name)))
    if all((own.lower_limit, own.upper_limit) == (None, None) for own in response.measures):
        with pytest.raises(InputError, match="expected a limit"):
            changes_of(response, ChangesQuestion(builds=100))
        return
    found = changes_of(response, ChangesQuestion(builds=100))
    assert as_text(changes_report(name, found), 120)


@pytest.mark.parametrize("sense", ["upper", "lower"])
def test_builds_that_fail_take_from_the_accepted_share(sense: str) -> None:
    """1000 builds of which 5 may be out: 2 fail, so 3 of the values 0 to 997 may; the shift ends amid the next two."""
    limit = 900.0 if sense == "upper" else 80.0
    lower, upper = (None, limit) if sense == "upper" else (limit, None)
    own = formula(lambda x: x[:, 0], lower, upper)
    now = np.random.default_rng(2).permutation([*range(998), np.nan, np.nan])
    found = list(Asked(own, 5000.0).targets(now, 498.5, 0.0))
    shift = 900.0 - (994 + 995) / 2 if sense == "upper" else 80.0 - (2 + 3) / 2
    assert found == [("accepted share", pytest.approx(shift, abs=1e-9))]
    assert not list(Asked(own, 1000.0).targets(now, 498.5, 0.0))  # one may be out, two have failed already
