"""The scenes of assemblies run, none of their trials fails, and they meet the numbers in the files beside them."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from expected import PRINTED, assert_all_met, assert_closed_forms_are_there, expected, measures_of
from places import SCENES as FOLDER
from shipped import shipped

from tol3d import Overrides, Run, run_scene

SCENES = (*shipped("assembly"), *shipped("machine"))
LONG = (
    "gearbox_in_housing",
    "bolted_cover",
    "bracket_in_box",
    "every_assembly_field",
    "helical_gearbox",
    "hole_and_slot",
    "housed_gears",
    "lid_by_a_wall",
)
"""Those that take seconds, and those whose numbers tests of their own work out by hand."""
DEAR = "robot_arm"
"""A run takes a minute and a half; tests/machine/test_robot_arm.py works its numbers out in seconds."""
MARKS = {DEAR: pytest.mark.nightly, **dict.fromkeys(LONG, pytest.mark.slow)}
EACH = [pytest.param(own, marks=MARKS[own]) if own in MARKS else own for own in SCENES]
SEEN = 1e-5  # um or arcmin: another machine's bits, of lengths up to 100 mm
ARCMIN = 10800 / math.pi


@pytest.mark.parametrize("scene", EACH)
def test_an_assembly_meets_its_expected_numbers(scene: str, run_of: Callable[[str], Run]) -> None:
    assert run_of(scene).summary["engine"] == "exact"
    assert_all_met(run_of(scene), scene, PRINTED + SEEN, PRINTED + SEEN)
    assert_closed_forms_are_there(run_of(scene), scene)


@pytest.mark.parametrize("scene", EACH)
def test_both_methods_of_an_assembly_differ_by_nothing_that_is_not_explained(
    scene: str, run_of: Callable[[str], Run]
) -> None:
    summary = run_of(scene).summary
    lost = expected(scene)["trials"] - expected(scene).get("built", expected(scene)["trials"])
    constant = {name for name, own in measures_of(scene).items() if own["geometric"]["sigma"] == 0.0}
    expected_of_constant = {f"{name}: no tolerance was seen to act on it" for name in constant}
    others = [own for own in summary["warnings"] if f"({lost} do not fit together" not in own]
    assert {own.partition(" in ")[0] for own in others} == expected_of_constant
    for own in summary["measures"].values():
        assert own["agreement"]["explanation"]["faults"] == []


def test_the_cover_s_numbers_follow_by_hand(tmp_path: Any) -> None:
    """Datum C stands off by |a| + |b| of the left wall, rises a, b uniform in |a| + |b| <= 10 um; the cover touches
    it at 0.4 b. The middle of each hole is a normal of 3 sigma = 0.1 mm, cut off there by its length."""
    count = 20_000
    found = run_scene(FOLDER / "cover_on_base.yaml", overrides=Overrides(trials=count), out=tmp_path / "run").summary
    disc = (100 / 3) ** 2 * (1 - 4.5 * math.exp(-4.5) / (1 - math.exp(-4.5)))
    by_hand = {
        "hole offset": (-20 / 3, math.sqrt(2 * disc + 10**2 / 18 + 0.4**2 * 10**2 / 6)),
        "flush": (0.0, math.sqrt(2) * 100 / 3),
    }
    for name, (mean, sigma) in by_hand.items():
        for method in ("analytic", "geometric"):
            own = found["measures"][name][method]
            assert own["mean"] == pytest.approx(mean, abs=4 * sigma / math.sqrt(count))
            assert own["sigma"] == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))


def test_a_part_on_seat_and_pins_lies_as_its_datum_frame_does(tmp_path: Path) -> None:
    """A mate by plane, hole and hole is the frame A | B | C, so the fixture sees the slot's own position.

    Its middle is a normal of 3 sigma = 0.375 mm, cut off there; twice its offset is within what is inspected.
    """
    count = 20_000
    found = run_scene(FOLDER / "part_in_fixture.yaml", overrides=Overrides(trials=count), out=tmp_path / "run")
    shape = 1 - 6 * math.exp(-4.5) / math.sqrt(2 * math.pi) / math.erf(3 / math.sqrt(2))
    sigma = 375 / 3 * math.sqrt(shape)
    own = found.summary["measures"]["slot 2 over pin B"]["geometric"]
    assert own["sigma"] == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))
    assert own["mean"] == pytest.approx(175_000, abs=4 * sigma / math.sqrt(count))
    trials = found.columns("geometric:slot 2 over pin B", "geometric:inspected Position.2")
    height, inspected = trials.values()
    assert (2 * abs(height - 175_000.0) <= inspected + 1e-3).all()  # um


@pytest.mark.slow
def test_the_bracket_s_bores_are_nominally_on_the_axes_of_the_box_s_holes(run_of: Callable[[str], Run]) -> None:
    """By its drawing and the place where it stands; its foot is 3.03784 mm over the floor, -101.10216 + 104.14 mm."""
    measures = run_of("bracket_in_box").summary["measures"]
    for name, own in measures.items():
        if name.endswith((" across", " up")):
            assert max(map(abs, own["nominal"].values())) < 2e-3  # um; files have 7 digits
    assert measures["foot over floor"]["nominal"]["geometric"] == pytest.approx(3037.84, abs=1e-5)
    assert measures["left shaft 1"]["nominal"]["geometric"] == pytest.approx(10_000, abs=1e-2)
