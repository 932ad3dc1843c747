"""A run whose mechanism is not installed where it is opened: what is said names that mechanism, and what to do."""

import json
from pathlib import Path

import pytest
from fixtures import Command
from toys.pins import PINS
from toys.registered import TOYS, known

from tol3d import InputError, Overrides, open_run, run_scene
from tol3d.study.runs.summary.kinds import default_kinds
from tol3d.study.runs.summary.text import missing_mechanism

WORDS = (
    "summary.json: expected the mechanism 'pins' (Python module 'toys.pins.system') that made this run, for its "
    "measures of kind 'least_gap', 'slide': install the package that brings it, or register it in your program first "
    "(tol3d.register)"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of the pins, which nobody knows any more."""
    with known(PINS):
        return run_scene(
            TOYS / "pins" / "pins.yaml", overrides=Overrides(trials=40), out=tmp_path_factory.mktemp("pins") / "run"
        ).path


def test_it_is_opened_where_its_mechanism_is_known_and_names_it(folder: Path) -> None:
    with known(PINS):
        maker = open_run(folder).found.mechanism
    assert maker is not None
    assert (maker.name, maker.module) == ("pins", "toys.pins.system")


def test_elsewhere_the_mechanism_is_named_and_what_to_install(folder: Path) -> None:
    with pytest.raises(InputError) as refused:
        open_run(folder)
    assert str(refused.value) == f"{folder}/{WORDS}"


@pytest.mark.parametrize(
    "arguments", [("compare",), ("view", "--worst", "--screenshot", "view.png"), ("export", "--trial", "0")]
)
def test_every_command_that_opens_it_says_so(tol3d: Command, folder: Path, arguments: tuple[str, ...]) -> None:
    code, _, err = tol3d(arguments[0], str(folder), *arguments[1:])
    assert code == 2
    assert WORDS in " ".join(err.split())
    assert "Traceback" not in err


def test_of_an_older_run_that_names_no_mechanism_the_kinds_are_named(folder: Path) -> None:
    summary = json.loads((folder / "summary.json").read_text("utf-8"))
    del summary["mechanism"]
    assert missing_mechanism(summary).startswith("expected the mechanism that made this run, for its measures of kind ")


def test_a_kind_that_tol3d_itself_does_not_have_is_damage_or_another_version(folder: Path) -> None:
    """No package brings what a mechanism of its own would have."""
    summary = json.loads((folder / "summary.json").read_text("utf-8"))
    summary["mechanism"] = {"name": "gears", "module": "tol3d.gearing.system"}
    assert missing_mechanism(summary) == ""


def test_nothing_is_missed_of_known_kinds(folder: Path) -> None:
    summary = json.loads((folder / "summary.json").read_text("utf-8"))
    with known(PINS):
        assert missing_mechanism(summary, default_kinds()) == ""
