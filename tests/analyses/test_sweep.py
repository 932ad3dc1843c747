"""Sweeps: every variant is what a run of its scene is, draws are the same in all, and an interrupted one goes on."""

import csv
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from toys.parabola import PARABOLA
from toys.registered import TOYS, known

import tol3d
from tol3d import InputError, Overrides, run_scene
from tol3d.analyses.sweep_charts import sweep_charts
from tol3d.analyses.sweep_table import sweep_report, whole_table
from tol3d.analyses.variant_sweep import Order, Sweep, SweepQuestion, sweep
from tol3d.analyses.variants import Variable, grid_of, hypercube_of, plain_number, variable, variable_of
from tol3d.report.chart_figure import figure_of
from tol3d.report.sheet import as_text
from tol3d.simulate import load
from tol3d.study.execution.watch import Watch
from tol3d.units import Quantity

UPPER = "tolerances.centre distance.distribution.upper"
TEETH = "parts.pinion.teeth"
QUICK = Overrides(trials=200)


def numbers(own: Variable) -> list[Any]:
    return [str(value) if isinstance(value, Quantity) else value for value in own.values]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f"{UPPER}=10um,20 um, 0.03 mm", ["10 um", "20 um", "30 um"]),
        (f"{TEETH}=17..25:2", [17, 19, 21, 23, 25]),
        (f"{TEETH}=17..24:2", [17, 19, 21, 23]),
        (f"{UPPER}=10..30um:10um", ["10 um", "20 um", "30 um"]),
        (f"{UPPER}=0.1mm..0.3mm:100um", ["0.1 mm", "0.2 mm", "0.3 mm"]),
        ("parts.wheel.profile_shift=0..0.2:0.1", [0, 0.1, 0.2]),
        ("parts.wheel.profile_shift=-0.5,0.5", [-0.5, 0.5]),
    ],
)
def test_values_are_listed_or_counted(text: str, expected: list[Any]) -> None:
    own = variable_of(text)
    assert own.field == text.partition("=")[0]
    assert numbers(own) == pytest.approx(expected) if isinstance(expected[-1], float) else numbers(own) == expected


def test_a_grid_has_every_value_with_every_other() -> None:
    points = grid_of([variable(UPPER, "10um,20um"), variable(TEETH, [27, 28, 29])])
    assert [tuple(map(str, point.values())) for point in points] == [
        (upper, teeth) for upper in ("10 um", "20 um") for teeth in ("27", "28", "29")
    ]


def test_a_latin_hypercube_has_one_variant_in_each_part_of_each_range() -> None:
    ranges = [variable(UPPER, "10um..30um"), variable("parts.wheel.profile_shift", "-1.0..1"), variable(TEETH, "1..20")]
    points = hypercube_of(ranges, 20, seed=3)
    for field, low, size in ((UPPER, 10.0, 1.0), ("parts.wheel.profile_shift", -1.0, 0.1)):
        parts = [int((plain_number(point[field]) - low) / size) for point in points]
        assert sorted(parts) == list(range(20))
    assert sorted(plain_number(point[TEETH]) for point in points) == list(range(1, 21))
    assert points == hypercube_of(ranges, 20, seed=3) != hypercube_of(ranges, 20, seed=4)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (TEETH, "--vary: expected FIELD=values"),
        (f"{TEETH}=many", "got 'many'"),
        (f"{UPPER}=10um,20", "expected numbers of one unit, got 10 um and 20"),
        (f"{UPPER}=10um,20deg", "expected numbers of one dimension"),
        (f"{UPPER}=30um..10um:1um", "expected a range from the less to the more"),
        (f"{UPPER}=10um..30um:0um", "expected a step of more than 0"),
        (f"{UPPER}=0um..1m:1um", "expected at most 2000 variants, got 1000001"),
        ("study.trials=10,20", "it says how a scene is simulated"),
        ("study.seed=1,2", "it says how a scene is simulated"),
        ("published.paper.x=1", "expected a number of parts, tolerances, moves or measures"),
    ],
)
def test_what_is_no_variable_is_refused(text: str, words: str) -> None:
    with pytest.raises(InputError) as error:
        variable_of(text)
    assert words in str(error.value)


def test_ranges_and_grids_do_not_mix() -> None:
    with pytest.raises(InputError, match="expected a step behind it for a grid"):
        grid_of([variable(UPPER, "10um..30um")])
    with pytest.raises(InputError, match="expected a range such as"):
        hypercube_of([variable(UPPER, "10um,30um")], 4, 1)
    with pytest.raises(InputError, match="expected each field once"):
        grid_of([variable(UPPER, "10um"), variable(UPPER, "20um")])


# the spur pair --------------------------------------------------------------------------------------


def question(*vary: str) -> SweepQuestion:
    return SweepQuestion(tuple(map(variable_of, vary)))


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Sweep:
    """One of the variants has a pinion whose teeth interfere at the centre distance."""
    out = tmp_path_factory.mktemp("sweep")
    return sweep(load("spur_pair"), question(f"{UPPER}=10um,20um,30um", f"{TEETH}=28,30"), Order(out, QUICK))


def test_a_variant_is_what_a_run_of_its_scene_is(found: Sweep, tmp_path: Path) -> None:
    scene = load("spur_pair").with_({UPPER: "30 um"})
    own = run_scene(scene, out=tmp_path / "run", overrides=Overrides(trials=200, witness=0)).found.measures
    variant = next(each for each in found.variants if each.values == ["30 um", "28"])
    for name, measure in own.items():
        sample, mine = measure.geometric, variant.measures[name]
        assert sample is not None
        assert (mine.mean, mine.sigma, mine.low, mine.high, mine.out_ppm, mine.ppk) == (
            sample.mean,
            sample.sigma,
            sample.low_3sigma,
            sample.high_3sigma,
            sample.out_ppm if measure.has_limits else None,
            sample.ppk,
        )


def test_draws_are_the_same_in_all_variants(found: Sweep) -> None:
    """Limits at -20 and 10, 20, 30 um: draws are mean + sigma z of the same z, so that means lie on a line exactly."""
    means = [own.measures["normal backlash"].mean for own in found.variants if own.numbers[1] == 28]
    low, middle, high = (float(own) for own in means if own is not None)
    assert high - middle == pytest.approx(middle - low, rel=2e-3)  # second order of 20 um
    noise = 2 * 0.342 * (20.0 / 6.0) / math.sqrt(200)  # of the mean z, by what sigma grows
    assert high - low == pytest.approx(2 * 0.342 * 10.0, abs=4 * noise)  # 2 sin 20 deg a um of 10 um of mean


def test_a_variant_that_cannot_be_built_is_a_row_with_its_reason(found: Sweep) -> None:
    failed = [own for own in found.variants if own.reason is not None]
    assert [own.values[1] for own in failed] == ["30"] * 3
    assert all("the teeth interfere" in str(own.reason) and not own.measures for own in failed)
    text = as_text(sweep_report(found), 160)
    ppk = {k: own.measures["normal backlash"].ppk or 0.0 for k, own in enumerate(found.variants) if own.measures}
    best, worst = max(ppk, key=ppk.__getitem__), min(ppk, key=ppk.__getitem__)
    upper, teeth = (found.variants[best].numbers[k] for k in (0, 1))
    varied = f"(centre distance upper {upper:g} µm, pinion teeth {teeth:g})"
    assert f"normal backlash: best variant {best + 1} {varied}" in text
    assert f"; worst variant {worst + 1} (" in text
    assert text.count("not assembled") == (3 + 1) * 2  # a row in each of two measures, and a heading
    assert text.count("could not be assembled") == 1
    assert "the teeth interfere" in text


def test_its_table_has_a_row_a_variant_with_all_digits(found: Sweep) -> None:
    rows = list(csv.DictReader(whole_table(found).csv().splitlines()))
    assert [row[f"{UPPER} [um]"] for row in rows] == ["10.0", "10.0", "20.0", "20.0", "30.0", "30.0"]
    assert float(rows[0]["normal backlash: mean [um]"]) == found.variants[0].measures["normal backlash"].mean
    assert rows[1]["normal backlash: mean [um]"] == ""
    assert rows[1]["could not be assembled"]


def trials_of(*vary: str, out: Path, stop_at: int = -1) -> tuple[Sweep | None, int]:
    """A sweep, and how many trials were run for it."""
    count = 0

    def progress(done: int) -> None:
        nonlocal count
        count += done

    def done(number: int, of: int, words: str) -> None:
        if number == stop_at:
            raise KeyboardInterrupt

    order = Order(out, QUICK, watch=Watch(progress=progress), done=done)
    try:
        return sweep(load("spur_pair"), question(*vary), order), count
    except KeyboardInterrupt:
        return None, count


def test_an_interrupted_sweep_goes_on_where_it_stopped(tmp_path: Path) -> None:
    vary = f"{UPPER}=10um,15um,20um"
    assert trials_of(vary, out=tmp_path / "kept", stop_at=2) == (None, 400)
    kept, more = trials_of(vary, out=tmp_path / "kept")
    assert more == 200
    assert trials_of(vary, out=tmp_path / "kept")[1] == 0
    assert kept == trials_of(vary, out=tmp_path / "anew")[0]
    wider, more = trials_of(f"{UPPER}=10um,15um,20um,25um", out=tmp_path / "kept")
    assert more == 200
    assert wider is not None
    assert not list((tmp_path / "kept").rglob("*.parquet"))


def test_an_engine_that_the_scene_has_not_ends_it_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected one of exact, fcl, analytic, got"):
        sweep(load("spur_pair"), question(f"{UPPER}=1um"), Order(tmp_path / "none", Overrides(engine="exakt")))
    assert not (tmp_path / "none").exists()


def test_a_field_that_is_not_there_ends_it_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='did you mean "centre distance"'):
        trials_of("tolerances.centre distanc.distribution.upper=1um", out=tmp_path / "none")
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("fields", [1, 2, 3])
def test_a_picture_shows_all_variants(found: Sweep, fields: int) -> None:
    """One field: a line of means; two: a map; three: a point a variant in axes for each measure and field."""
    own = found.model_copy(
        update={
            "fields": [*found.fields, "parts.wheel.teeth"][:fields],
            "units": [*found.units, ""][:fields],
            "variants": [
                each.model_copy(update={"numbers": [*each.numbers, 110.0][:fields]}) for each in found.variants
            ],
        }
    )
    figure = figure_of(sweep_charts(own))
    axes = figure.axes
    assert len(axes) == {1: 2, 2: 4, 3: 6}[fields]  # of a map, each with its bar
    if fields == 1:
        assert np.sort(np.asarray(axes[0].lines[0].get_xdata(), dtype=np.float64)).tolist() == [10.0, 20.0, 30.0]
    if fields == 2:
        shown = axes[0].collections[0].get_array()
        assert shown is not None
        assert shown.size == 6


Command = Any


def test_the_command_prints_and_writes_it(tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    vary = ("--vary", f"{UPPER}=10um,20um", "--trials", "100")
    code, out, _ = tol3d("sweep", "spur_pair", *vary, "--csv", "s.csv", "--picture", "s.png")
    assert code == 0
    assert "2 variants of 100 trials, seed 1" in out
    assert "runs/spur_pair-sweep/sweep.json" in out.replace("\n", "")
    assert (tmp_path / "s.png").stat().st_size > 10_000
    assert len((tmp_path / "s.csv").read_text("utf-8").splitlines()) == 3
    code, _, err = tol3d("sweep", "spur_pair", "--vary", "study.seed=1,2")
    assert code == 2
    assert "it says how a scene is simulated" in err


def test_from_python(tmp_path: Path) -> None:
    own = tol3d.sweep("spur_pair", {UPPER: ["10 um", "20 um"]}, overrides=QUICK, picture=tmp_path / "s.png")
    assert len(own.found.variants) == 2
    assert "2 variants of 200 trials" in str(own)
    assert own.to_csv() == whole_table(own.found).csv()
    assert (tmp_path / "s.png").exists()


def test_a_mechanism_from_outside(tmp_path: Path) -> None:
    """Its curve has a lowest and a highest, its own kinds vary, its files come along."""
    with known(PARABOLA):
        field = "tolerances.offset.distribution.upper"
        own = sweep(load(TOYS / "parabola" / "spring.yaml"), question(f"{field}=20um,40um"), Order(tmp_path, QUICK))
        first, second = (each.measures["height"].mean for each in own.variants)
        assert first is not None
        assert second is not None
        assert second - first == pytest.approx(10.0, abs=1.0)  # the mean of a uniform law by half of its upper end
        assert figure_of(sweep_charts(own)).axes


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gearbox_in_housing", "machined_parts", "reducer_3k_train", "robot_shoulder"])
def test_other_scenes_are_swept(name: str, tmp_path: Path) -> None:
    """A limit of the first measure that has one, which changes no build: draws are the same, so that means are too."""
    scene = load(name)
    measure, key = next(
        (measure, key)
        for measure, own in scene.measures.items()
        for key in ("lower_limit", "upper_limit")
        if getattr(own, key, None) is not None
    )
    sign, unit = "-" if key == "lower_limit" else "", str(getattr(scene.measures[measure], key)).split()[1]
    vary = question(f"measures.{measure}.{key}={sign}10000 {unit},{sign}20000 {unit}")
    own = sweep(scene, vary, Order(tmp_path, Overrides(trials=64)))
    first, second = (each.measures[str(measure)] for each in own.variants)
    assert first.mean == second.mean
    assert getattr(second, key) == pytest.approx(2 * getattr(first, key))
