"""Analyses as functions: what their commands print, in numbers what they write, refused in words."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from fixtures import Command

from tol3d import InputError, Overrides, analyses, load_scene, run_scene
from tol3d.study.runs.run import open_run

ASKED: dict[str, tuple[Callable[[Any], Any], tuple[str, ...]]] = {
    "what-if": (
        lambda of: analyses.what_if(
            of,
            set={"centre distance": "js6"},
            factor={"reducer run-out": 2},
            limits={"normal backlash": "12 um..70 um"},
            quick=True,
        ),
        (
            *("--set", "centre distance=js6", "--factor", "reducer run-out=2"),
            *("--limits", "normal backlash=12 um..70 um", "--quick"),
        ),
    ),
    "effects": (
        lambda of: analyses.effects(of, measure="normal backlash", base=8, position="as-input"),
        ("--measure", "normal backlash", "--base", "8", "--position", "as-input"),
    ),
    "rare": (
        lambda of: analyses.rare(of, measure="normal backlash", method="form", seed=2),
        ("--measure", "normal backlash", "--method", "form", "--seed", "2"),
    ),
    "changes": (
        lambda of: analyses.changes(of, accept_ppk=2.5, builds=60),
        ("--accept-ppk", "2.5", "--builds", "60"),
    ),
    "methods": (
        lambda of: analyses.methods(of, measure="normal backlash", trials=50),
        ("--measure", "normal backlash", "--trials", "50"),
    ),
    "allocate": (
        lambda of: analyses.allocate(
            of, ppk=1.5, bound={"reducer run-out": "0.9..1.2"}, freeze=["centre distance"], draws=200
        ),
        ("--ppk", "1.5", "--bound", "reducer run-out=0.9..1.2", "--freeze", "centre distance", "--draws", "200"),
    ),
}  # fmt: skip


SLOW = ("effects", "allocate")


@pytest.mark.parametrize("name", [pytest.param(own, marks=pytest.mark.slow if own in SLOW else ()) for own in ASKED])
def test_a_function_gives_what_its_command_prints_and_writes(name: str, tol3d: Command, tmp_path: Path) -> None:
    """Its words, rules and wrapping apart; and every number of its frame, with all digits, in the command's file."""
    ask, arguments = ASKED[name]
    code, out, _ = tol3d(name, "spur_pair", *arguments, "--csv", str(tmp_path / "numbers.csv"))
    assert code == 0
    answer = ask("spur_pair")
    words = {word for word in str(answer).split() if set(word) != {"─"}}
    assert len(words) > 30
    assert words <= set(out.split())
    with (tmp_path / "numbers.csv").open(encoding="utf-8") as file:
        written = [*csv.reader(file)]
    frame = answer.frame()
    numbers = {float(cell) for row in written for cell in row if _is_number(cell)}
    found = {own for cells in frame.to_numpy().T for own in cells if isinstance(own, float) and np.isfinite(own)}
    assert len(found) >= 2
    assert found <= numbers


def _is_number(cell: str) -> bool:
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False


def test_frames_have_a_row_for_each_thing_asked_of() -> None:
    halved = analyses.what_if("spur_pair", factor={"centre distance": 0.5}, quick=True)
    frame = halved.frame()
    sigmas = frame[frame["name"] == "sigma by rates"].set_index("measure")
    assert [*sigmas.index] == ["normal backlash", "lost motion"]
    own = halved.found.measures["lost motion"]
    assert sigmas.loc["lost motion", ["before", "after"]].tolist() == [
        own.before.sigma_by_rates,
        own.after.sigma_by_rates,
    ]
    assert [*halved.frames] == ["tolerances", "normal backlash [µm]", "lost motion [′]"]
    assert len(halved.figure().axes) == 2
    assert halved.frames["tolerances"]["after"].tolist() == ["normal -10 … 10 µm"]
    effects = analyses.effects("spur_pair", base=8).frame()
    assert len(effects) == 2 * 7
    assert effects["shapley"].isna().all()
    assert effects["slope"].dtype == np.float64


def test_a_run_keeps_what_is_asked_of_it_and_a_scene_of_python_is_asked_too(tmp_path: Path) -> None:
    scene = load_scene("spur_pair").with_({"study.trials": 40, "study.witness": 0})
    run = run_scene(scene, out=tmp_path / "run")
    answers = [analyses.methods(of, measure="lost motion") for of in (run, str(run.path), scene)]
    assert [own.kept for own in answers] == [run.path / "analyses" / "methods.json"] * 2 + [None]
    assert answers[0].frame().equals(answers[1].frame())
    assert "analyses/methods.json" in open_run(run.path).manifest.sums
    assert answers[2].found.measures["lost motion"].worst == answers[0].found.measures["lost motion"].worst


@pytest.mark.slow
def test_an_allocation_has_its_scene() -> None:
    answer = analyses.allocate("spur_pair", ppk=1.5, draws=200)
    factor = answer.found.factors["centre distance"]
    stated: Any = answer.scene.tolerances["centre distance"]
    law = stated.distribution.resolve({})
    assert law.limits[1] - law.limits[0] == pytest.approx(0.04 * factor, rel=1e-9)
    assert factor != 1.0


def test_variants_have_a_frame(tmp_path: Path) -> None:
    field = "tolerances.centre distance.distribution.upper"
    found = analyses.sweep("spur_pair", {field: ["10 um", "30 um"]}, overrides=Overrides(trials=40))
    frame = found.frame()
    assert frame[f"{field} [um]"].tolist() == [10.0, 30.0]
    assert frame["lost motion: mean [arcmin]"].tolist() == [
        own.measures["lost motion"].mean for own in found.found.variants
    ]


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda: analyses.what_if("spur_pair"), "expected a change"),
        (lambda: analyses.what_if("spur_pair", factor={"centre distanc": 2.0}), "did you mean .centre distance"),
        (lambda: analyses.effects("spur_pair", position=cast(Any, "home")), "position: expected averaged or as-input"),
        (lambda: analyses.rare("spur_pair", method=cast(Any, "guess")), "method: expected auto, .* got 'guess'"),
        (lambda: analyses.changes("spur_pair", accept=1.0, accept_ppk=1.0), "accept or accept_ppk, got both"),
        (lambda: analyses.methods("spur_pear"), "spur_pear: no such file"),
    ],
)  # fmt: skip
def test_wrong_words_are_refused(ask: Callable[[], object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        ask()


def test_names_are_there_and_listed() -> None:
    assert dir(analyses) == sorted(analyses.__all__)
    assert all(getattr(analyses, name).__doc__ for name in analyses.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'guess'"):
        analyses.guess  # noqa: B018
