"""Starter scenes, as `tol3d new` writes them: each kind of system has one, and each runs as it is."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from toys.parabola import PARABOLA
from toys.registered import known
from typer.testing import CliRunner

from tol3d import Overrides, run_scene
from tol3d.cli import app
from tol3d.errors import InputError
from tol3d.kinds import all_mechanisms, load_scene
from tol3d.simulate import load, simulation_of
from tol3d.study.system.mechanism import Starter, starter_named, starters_of

STARTERS = {one.name: one for own in all_mechanisms() for one in starters_of(own)}
TRIALS = 64


def _new(*words: str) -> tuple[int, str]:
    ended = CliRunner().invoke(app, ["new", *words])
    if isinstance(ended.exception, InputError):
        return 2, str(ended.exception)
    return ended.exit_code, ended.output


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_mechanism_has_a_starter() -> None:
    assert {one.mechanism for one in STARTERS.values()} == {own.name for own in all_mechanisms()}
    assert {"spur_pair", "internal_pair", "bevel_pair", "train"} <= set(STARTERS)


@pytest.mark.parametrize("starter", STARTERS.values(), ids=STARTERS)
def test_a_starter_runs_as_it_is_and_every_trial_has_its_values(starter: Starter, here: Path) -> None:
    assert _new(starter.name)[0] == 0
    scene = here / f"{starter.name}.yaml"
    assert scene.read_text("utf-8") == starter.text
    run = run_scene(scene, overrides=Overrides(trials=TRIALS), out=here / "run")
    for name, measure in run.summary["measures"].items():
        for method in ("analytic", "geometric"):
            assert measure[method]["count"] == TRIALS, name
            assert measure[method]["sigma"] > 0.0, name


@pytest.mark.parametrize("starter", STARTERS.values(), ids=STARTERS)
def test_a_starter_is_of_its_mechanism_small_and_without_a_warning(starter: Starter, here: Path) -> None:
    _new(starter.name)
    scene = load_scene(here / f"{starter.name}.yaml")
    assert starter.mechanism in {own.name for own in scene.grammar.vocabularies_of(scene)}
    assert not simulation_of(load(here / f"{starter.name}.yaml")).warnings
    lines = starter.text.splitlines()
    assert len(lines) <= 100
    assert max(map(len, lines)) <= 128
    comments = sum("# " in line for line in lines)
    assert comments >= 10, "a starter teaches by its comments"
    assert starter.title.endswith(".")
    assert starter.title in _new()[1]
    for page in re.findall(r"docs/\w+\.md", starter.text):
        assert (Path(__file__).parents[2] / page).is_file()


def test_a_file_that_is_there_stays_without_force(here: Path) -> None:
    (here / "spur_pair.yaml").write_text("mine")
    code, said = _new("spur_pair")
    assert (code, said) == (2, "spur_pair.yaml: is there already; --force replaces it, --out names another")
    assert (here / "spur_pair.yaml").read_text() == "mine"
    assert _new("spur_pair", "--force")[0] == 0
    assert (here / "spur_pair.yaml").read_text("utf-8") == STARTERS["spur_pair"].text
    assert _new("spur-pair", "--out", "deep/other.yaml")[0] == 0
    assert (here / "deep" / "other.yaml").is_file()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["bevle_pair"], "expected a kind of system, got 'bevle_pair'; did you mean \"bevel_pair\"?"),
        (
            ["door"],
            "expected a kind of system, got 'door'; known here: bevel_pair, internal_pair, spur_pair, train, assembly, "
            "machine, linkage, planetary, rv_reducer; `tol3d scenes --copy door` copies the bundled scene of this name",
        ),
        (["gearing"], "gearing: expected one starter scene, found 4: bevel_pair, internal_pair, spur_pair, train"),
        (["--out", "a.yaml"], "--out: expected a kind of system before it; `tol3d new` lists them"),
        (["linkage", "--out", "."], ".: expected a file, this is a folder; --out names another"),
    ],
)
def test_what_cannot_be_written_gets_one_message(words: list[str], said: str, here: Path) -> None:
    assert _new(*words) == (2, said)
    assert not list(here.iterdir())


def test_a_mechanism_of_one_starter_is_as_good_a_name() -> None:
    assert starter_named("cycloid", all_mechanisms()).name == "rv_reducer"


def test_a_mechanism_from_outside_brings_its_own_and_one_without_is_said(tmp_path: Path) -> None:
    with known(PARABOLA):
        assert "without a starter scene: parabola" in _new()[1]
        code, said = _new("parabola")
        assert code == 2
        assert said.count("\n") == 0
        assert said.startswith("parabola: this mechanism brings no starter scene")
    with known(replace(PARABOLA, starters="toys:parabola")):
        assert starter_named("parabola", all_mechanisms()).name == "spring"
    with known(replace(PARABOLA, starters="toys.parabola:nowhere")):
        assert _new("parabola") == (
            2,
            "parabola: expected starter scenes (*.yaml) at toys.parabola:nowhere, found none",
        )


def test_two_starters_of_one_name_are_told_apart_by_their_mechanisms() -> None:
    twin = replace(PARABOLA, starters="tol3d.gearing.planetary:starters")
    with known(twin):
        with pytest.raises(InputError, match="found 2: planetary/planetary, parabola/planetary"):
            starter_named("planetary", all_mechanisms())
        assert starter_named("parabola/planetary", all_mechanisms()).mechanism == "parabola"
