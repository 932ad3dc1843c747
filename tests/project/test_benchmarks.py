"""The benchmarks run, a few trials each, and what README's speeds are compared with measures the right thing."""

import ast
import importlib
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path

import pytest
import random_mutants
import structure
import studies
import whole_gears
from gear_trials import model_of_scene
from places import ROOT

from tol3d.gearing.model import Backlash

FOLDER = ROOT / "benchmarks"
NUMBER = r"([\d,]*\.?\d+)"

FEW: Mapping[str, tuple[str, ...]] = {
    "app": ("spur_pair", "--times", "2"),
    "assemblies": ("--trials", "1024", "--rounds", "1", "--systems", "stack"),
    "convergence": ("--studies", "2", "--largest", "1024"),
    "curves": ("--trials", "20", "--positions", "8", "--long", "16", "--rounds", "1", "--workers", "1"),
    "cycloid": ("--units", "20", "--angles", "20", "--rounds", "1", "--threads", "1"),
    "disc_profile": (),
    "fcl_speed": ("--trials", "10", "--naive", "1", "--rounds", "1"),
    "linkages": ("--trials", "1000", "--rounds", "1", "--poses", "5", "--along", "2"),
    "memory": ("--trials", "100", "--scenes", "spur_pair", "cover_on_base"),
    "pairs": ("--trials", "500", "--rounds", "1"),
    "planetary": ("--trials", "1000", "--rounds", "1", "--workers", "1"),
    "random_mutants": ("--number", "2"),
    "rare": ("--seeds", "2", "--level", "1000"),
    "rig_records": ("--rows", "4000"),
    "scale": ("--sizes", "3x2z", "--trials", "100"),
    "stages": ("--trials", "1024", "--kept", "64", "--rounds", "1"),
    "startup": ("--runs", "1", "--ways", "without both", "--packages", "colorsys", "no_such_package"),
    "studies": ("--naive", "1", "--rounds", "1", "--most", "100", "--warm", "--systems", "spur pair"),
    "step_mutations": ("--number", "3"),
    "structure": ("--trials", "16", "--route"),
    "tooth_curves": ("--trials", "10", "--rounds", "1", "--workers", "1"),
    "trains": ("--rounds", "1", "--contacts", "400", "--trains", "split torque"),
    "zones": ("--trials", "1024", "--rounds", "1"),
}
"""Arguments with which each benchmark takes seconds."""

LONG = (
    "app",
    "assemblies",
    "convergence",
    "curves",
    "cycloid",
    "fcl_speed",
    "linkages",
    "memory",
    "pairs",
    "rare",
    "rig_records",
    "scale",
    "startup",
    "structure",
    "studies",
    "tooth_curves",
    "trains",
    "zones",
)
"""Those that take more than a few of them."""

ROWS: Mapping[str, tuple[str, ...]] = {
    "app": tuple(
        rf"spur_pair │ normal backlash │ 2000 +│ {question} +│ +{NUMBER} +│ +{NUMBER}"
        for question in (
            *("scene", "card, first", "estimate, first", "estimate while moving"),
            *("card after release", "sliders", "check", "keep"),
        )
    ),
    "assemblies": (rf"3-2-1 stack of three blocks, 20 contributors +│ +{NUMBER} │ +{NUMBER} │ +{NUMBER}",),
    "convergence": tuple(
        rf"sigma driver at one position +{sampler} +order -?[\d.]+ +at 1024: {NUMBER} um"
        for sampler in ("Monte Carlo", "Latin hypercube", "scrambled Sobol'")
    ),
    "disc_profile": (rf"longest lever +{NUMBER} mm at {NUMBER} deg", rf"largest clearance +{NUMBER} um"),
    "curves": (
        rf"curves of both sides +│ +128 │ +20 │ +1 │ +{NUMBER}",
        rf"curve of the angular backlash +│ +128 │ +20 │ +1 │ +{NUMBER}",
        rf"ranges of both sides, long +│ +256 │ +20 │ +1 │ +{NUMBER}",
    ),
    "cycloid": (
        rf"one sense +│ +1 │ +{NUMBER} │ +{NUMBER}",
        rf"both senses +│ +1 │ +{NUMBER} │ +{NUMBER}",
        rf"both, near +│ +1 │ +{NUMBER} │ +{NUMBER}",
    ),
    "fcl_speed": (
        rf"strips, normal backlash +{NUMBER} trials/s",
        rf"strips, every measure +{NUMBER} trials/s",
        rf"naive, whole gears +{NUMBER} trials/s",
        rf"strips, mean section, one tooth +{NUMBER} trials/s",
        rf"strips, whole face, all teeth +{NUMBER} trials/s",
    ),
    "linkages": (
        rf"kernel, pointing error at rest +│ +loops │ +{NUMBER} │ +{NUMBER}",
        rf"exact method, pointing error at far +│ +trials │ +{NUMBER} │ +{NUMBER}",
        rf"exact method, worst pointing error +│ +reads │ +{NUMBER} │ +{NUMBER}",
    ),
    "memory": tuple(rf"{own}, +100 trials, exact: +{NUMBER} MB" for own in ("spur_pair", "cover_on_base")),
    "pairs": tuple(
        rf"{own} +│ +{NUMBER} │ +{NUMBER}" for own in ("external", "internal, driving pinion", "internal, driving ring")
    ),
    "planetary": (
        rf"programme, first order +│ +1 │ +{NUMBER} │ +{NUMBER}",
        rf"programme, placed gears +│ +1 │ +{NUMBER} │ +{NUMBER}",
        rf"whole study, both methods +│ +1 │ +{NUMBER} │ +{NUMBER}",
    ),
    "scale": (rf"3x2z │ +100 │ +{NUMBER} │ +{NUMBER} │ +[\d.]+ │ +[\d.]+ │ +{NUMBER}",),
    "stages": (
        rf"draws +│ +{NUMBER} │ +{NUMBER}",
        rf"statistics, regressors included +│ +{NUMBER} │ +{NUMBER}",
        rf"one drawn again +│ +{NUMBER} │ +{NUMBER} │ +{NUMBER}",
    ),
    "random_mutants": (rf"(?m)^tol3d/[\w/]+\.py:{NUMBER}\n    \S.*\n    \S.*\n",),
    "rare": (
        rf"importance sampling: {NUMBER} of 2 intervals hold 0.0507 ppm",
        rf"mean {NUMBER} ppm, spread {NUMBER} %",
        rf"first order: {NUMBER} ppm",
        rf"subset simulation: {NUMBER} ppm, standard error +{NUMBER} %, {NUMBER} builds",
    ),
    "rig_records": (rf"4000 rows a side: +{NUMBER} s, +{NUMBER} s of a processor, the fit +{NUMBER} s",),
    "startup": (
        rf"without both +{NUMBER} s",
        rf"tol3d --help +{NUMBER} s",
        rf" numba +{NUMBER} ms",
        rf"colorsys +{NUMBER} ms",
        "no_such_package +(not installed)",
    ),
    "studies": (
        rf"naive way, spur pair: {NUMBER} trials/s",
        rf"spur pair │ exact +│ +100 │ +1 │ statistics │ +{NUMBER}",
        rf"spur pair │ exact +│ +100 │ +2 │ statistics │ +{NUMBER}",
        rf"spur pair │ exact +│ +100 │ +2 │ kept +│ +{NUMBER}",
        rf"spur pair │ fcl +│ +100 │ +1 │ statistics │ +{NUMBER}",
        rf"spur pair │ analytic +│ +100 │ +2 │ statistics │ +{NUMBER}",
    ),
    "step_mutations": (rf"{NUMBER} files, the longest {NUMBER} s; 0 faults",),
    "structure": (
        rf"rooms +│ +{NUMBER}",
        rf"import levels of rooms +│ +{NUMBER}",
        rf"arrows between rooms +│ +{NUMBER}",
        rf"functions that write into an argument +│ +{NUMBER}",
        rf"largest file \(lines\) +│ +[\w/.]+ \({NUMBER}\)",
        rf"run_scene: returns to a room left before +│ +{NUMBER}",
        "run_scene calls .*study > .*gearing",
    ),
    "tooth_curves": tuple(
        rf"{own} +│ {take} +│ +10 │ +1 │ +{NUMBER}"
        for own in ("pitches", "pitches, slopes and forms")
        for take in ("curve", "range")
    ),
    "trains": (rf"split torque │ +100 │ +1 │ +{NUMBER}", rf"split torque │ +200 │ +2 │ +{NUMBER}"),
    "zones": tuple(
        rf"{zone} +│ +{NUMBER} │ +{NUMBER} │ +{NUMBER} │ +{NUMBER}" for zone in ("rectangle", "axis, refined")
    ),
}
"""Output of each benchmark: a split train has four meshes, so 400 contacts are 100 trials."""


def benchmarks() -> list[str]:
    """Names of the files that are run."""
    return sorted(path.stem for path in FOLDER.glob("*.py") if "\ndef main(" in path.read_text("utf-8"))


@pytest.mark.parametrize(
    "name", [pytest.param(own, marks=pytest.mark.slow if own in LONG else ()) for own in benchmarks()]
)
def test_a_benchmark_runs_and_prints_every_row(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "1")  # what fcl_speed sets where nothing is said, for this test only
    out = tmp_path / f"{name}.png"
    more = ("--out", str(out)) if name in ("convergence", "disc_profile") else ()
    importlib.import_module(name).main([*FEW[name], *more])
    printed = capsys.readouterr().out
    for row in ROWS[name]:
        found = re.search(row, printed)
        assert found, f"no row {row!r} in\n{printed}"
        assert all(float(number.replace(",", "")) > 0 for number in found.groups() if number != "not installed")
    assert out.exists() == bool(more)


@pytest.mark.slow
def test_reducers_are_timed_by_each_method(capsys: pytest.CaptureFixture[str]) -> None:
    importlib.import_module("planetary").main(["--methods", "4", "--rounds", "1"])
    printed = capsys.readouterr().out
    for scene in ("rv_250aii", "reducer_3k", "robot_arm"):
        found = re.search(rf"{scene} +│ +{NUMBER} │ +{NUMBER}", printed)
        assert found, printed
        assert all(float(number.replace(",", "")) > 0 for number in found.groups())


@pytest.mark.slow
def test_the_app_is_timed_in_a_browser(capsys: pytest.CaptureFixture[str]) -> None:
    importlib.import_module("app").main(["spur_pair", "--browser", "--times", "3"])
    printed = capsys.readouterr().out
    found = re.fullmatch(rf"spur_pair: dashed curve on the screen after {NUMBER} ms, at most {NUMBER} ms\n", printed)
    assert found, printed
    assert 0 < float(found[1]) <= float(found[2])


@pytest.mark.slow
def test_answers_of_the_app_have_a_row_for_each_scene(capsys: pytest.CaptureFixture[str]) -> None:
    """All of two small scenes' builds are there with the first answer, and no answer takes longer than all together."""
    importlib.import_module("app").main(["--every", "spur_pair", "two_plates"])
    _, _, *rows = capsys.readouterr().out.splitlines()
    for row, scene in zip(rows, ("spur_pair", "two_plates"), strict=True):
        name, _, trials, opening, solid, builds, estimate, longest = (own.strip() for own in row.strip("|").split("|"))
        assert name == scene
        assert 200 <= int(builds) <= int(trials)
        for own in (opening, solid, estimate, longest):
            assert re.match(r"\d+\.\d\d \(\d+\.\d\d\)", own), row


@pytest.mark.slow
def test_whole_gears_find_the_backlash_of_thinned_teeth() -> None:
    """(Δs1 + Δs2) cos α of the means (24.5 and 26.5 µm thinner) at the nominal centre distance.

    Chords lie inside the flanks and make each contact late by the chord errors of both gears at most; each contact is
    found with a gap of GAP_XTOL at most.
    """
    model = model_of_scene(studies.SCENES / "spur_pair.yaml")
    model = whole_gears.with_mean_thickness(model)
    gears = whole_gears.WholeGears(model)
    found = whole_gears.nominal_free_turn(gears, model) * 110 * 2.5 / 2 * 0.9396926207859084  # base radius, cos 20°
    expected = (0.0245 + 0.0265) * 0.9396926207859084
    assert gears.chord_error < 0.0015
    assert -2 * whole_gears.GAP_XTOL < found - expected < 2 * gears.chord_error


def test_levels_are_the_longest_path_with_each_cycle_one_place() -> None:
    """hall -> study <-> library -> cellar, and a short cut from the hall to the cellar: three levels, by hand."""
    files = {
        "house.hall": {"house.study.desk", "house.cellar"},
        "house.study.desk": {"house.study.lamp", "house.library"},
        "house.study.lamp": set[str](),
        "house.library": {"house.study.lamp", "house.cellar"},
        "house.cellar": set[str](),
    }
    rooms = structure.arrows_between_rooms(files)
    assert rooms == {"hall": {"study", "cellar"}, "study": {"library"}, "library": {"study", "cellar"}, "cellar": set()}
    assert structure.named(rooms) == ("library <-> study",)
    assert structure.levels(rooms) == 3
    assert structure.named(files) == ()
    assert structure.levels(files) == 4  # hall, desk, library, and below it lamp or cellar


def test_functions_that_write_into_an_argument_are_counted_once_each_and_no_others() -> None:
    source = """
def item(rows, k): rows[k] = 1.0; rows[k + 1] = 2.0
def attribute(run): run.made.name += "s"
def method(found): found.steps.append(1)
def keyword(values, out): add(values, 1.0, out=out)
def deleted(names): del names[0]
def own(): rows = [0]; rows[0] = 1; rows.append(2)
def copied(rows): rows = rows.copy(); rows[0] = 1
def read(rows): return rows.index(rows[0])
def within(rows):
    def kept(rows): return rows
    return kept
class Sum:
    def add(self, own): self.total += own
@kernel("f8(f8[:])")
def compiled(rows): rows[0] = 1.0
"""
    assert structure.writers(source) == ["item", "attribute", "method", "keyword", "deleted"]


def test_faults_of_a_source_are_these_and_no_others() -> None:
    """One change each, listed by hand; bytes count, not signs: µ is two."""
    source = """
LEAST: Final[float] = 0.0
@kernel("f8(f8[0])")
def area(rows: Sequence[1], more: float = 3.0) -> Row[2]:
    µ = -rows[0] * (more
                    + 1)  # + is found in the code
    if len(rows) <= 2 or f"{more + 1}" == "-" + "1":
        raise ValueError(2.0 * more)
    return max(µ, np.sin(more) - 7)
"""
    expected = [
        (2, "LEAST: Final[float] = 1.0"),
        (4, "def area(rows: Sequence[1], more: float = 4.5) -> Row[2]:"),
        (5, "    µ = -rows[0] / (more"),
        (5, "    µ = rows[0] * (more"),
        (5, "    µ = -rows[1] * (more"),
        (6, "                    - 1)  # + is found in the code"),
        (6, "                    + 2)  # + is found in the code"),
        (7, '    if len(rows) < 2 or f"{more + 1}" == "-" + "1":'),
        (7, '    if len(rows) >= 2 or f"{more + 1}" == "-" + "1":'),
        (7, '    if len(rows) <= 3 or f"{more + 1}" == "-" + "1":'),
        (9, "    return min(µ, np.sin(more) - 7)"),
        (9, "    return max(µ, np.sin(more) + 7)"),
        (9, "    return max(µ, np.cos(more) - 7)"),
        (9, "    return max(µ, np.sin(more) - 8)"),
    ]
    assert [(own.line, own.new) for own in random_mutants.faults("area.py", source)] == expected


def test_a_draw_is_of_lines_of_their_own_and_another_by_another_seed() -> None:
    first, again, other = (random_mutants.drawn(seed, 300) for seed in (1, 1, 2))
    assert first == again
    assert len({(own.file, own.line) for own in first}) == 300
    assert len(set(first) & set(other)) < 30  # of some 10 000 lines: nine are expected in common
    for own in first[:20]:
        lines = (ROOT / own.file).read_text("utf-8").splitlines()
        assert lines[own.line - 1] == own.old != own.new
        lines[own.line - 1] = own.new
        ast.parse("\n".join(lines))


@pytest.mark.parametrize("name", studies.SYSTEMS)
def test_systems_are_read_as_they_say(name: str, tmp_path: Path) -> None:
    """Every measure of the written scene: what the table's row says is what is measured."""
    expected = {
        "bevel pair, mean section, one tooth": ("section", "section", "driven"),
        "bevel pair, mean section, all teeth": ("section", "section", "all"),
        "bevel pair, whole face, all teeth": ("face", "face", "all"),
        "spur pair": ("face", "face", "all"),
    }
    scene = studies.scene_of(studies.SYSTEMS[name], tmp_path)
    model = model_of_scene(scene)
    for measure in model.measures:
        assert isinstance(measure.kind, Backlash)
        reading = measure.kind.reading
        assert (reading.contact, reading.gap, reading.teeth) == expected[name]


def test_no_ignore_hides_an_attribute() -> None:
    """A comment that silences mypy about an attribute outlives the attribute: a benchmark stopped that way."""
    hiding = [
        f"{path.relative_to(ROOT)}:{number}"
        for folder in ("tol3d", "parts", "benchmarks", "tests")
        for path in sorted((ROOT / folder).rglob("*.py"))
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1)
        for codes in re.findall(r"[#] type: ignore(\[[\w, -]*\])?", line)
        if not codes or "attr-defined" in codes or "union-attr" in codes
    ]
    assert hiding == []


def test_benchmarks_are_typed() -> None:
    """Every function says what it takes and gives; mypy, which the suite runs, then checks them strictly."""
    untyped = [
        f"{path.name}:{node.lineno} {node.name}"
        for path in sorted(FOLDER.glob("*.py"))
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.FunctionDef) and node.returns is None
    ]
    assert untyped == []
    assert "benchmarks" in tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["mypy"]["files"]
