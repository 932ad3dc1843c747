"""Clearances in every direction that a scene can say: both methods against each other and against plain numbers.

The paper's pair with its bearing clearance moved to either gear and turned into every direction. What the text means
is worked out here again, so that a direction that both methods misread alike is found out.
"""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from fixtures import EngineOf
from gear_trials import drawn_trials, gear_columns
from oracles import exact_eccentric
from oracles.involute_gear import InvoluteGear
from places import SCENES
from scene_texts import written
from vectors import vector

from tol3d import load_scene
from tol3d.gearing.model import Model, model_from_scene
from tol3d.gears.flank import Flank
from tol3d.simulate import Overrides, run_scene

SPUR_PAIR = (SCENES / "spur_pair.yaml").read_text("utf-8")
ALPHA = math.radians(20.0)  # the paper's pair stands at its reference distance: the working pressure angle too
SIN, COS = math.sin(ALPHA), math.cos(ALPHA)
TRIALS = 100

STACK_UP_BOUND = 0.15  # um; 0.05 of squares in the first order, 0.1 of the strips
EXACT_BOUND = 0.12  # um; the strips alone: four chord errors (two flanks touch, two are measured) of 0.024 um


def changed(folder: Path, *replacements: tuple[str, str]) -> Path:
    """The paper's scene with some words replaced."""
    text = SPUR_PAIR
    for old, new in replacements:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return written(text, folder)


def direction_of(gear: str, direction: str, sigma: Flank) -> tuple[float, float]:
    """Direction of a gear's axis, (x, y) in the world of the mesh; sigma is +1 for a right working flank."""
    if direction == "{at: 50 deg}":
        return 0.642787609686539, 0.766044443118978
    away = 1.0 if gear == "wheel" else -1.0
    # a right flank presses the wheel out and down, and the pinion in return in and up
    return {"apart": (away, 0.0), "tooth_force": (away * SIN, -sigma * away * COS)}[direction]


def clearance_scene(folder: Path, gear: str, direction: str, flank: str) -> Model:
    """The clearance, here of 20 to 60 um, of a gear in a direction."""
    old = "of: wheel\n    distribution: {kind: normal, lower: 2 um, upper: 30 um}"
    new = f"of: {gear}\n    direction: {direction}\n    distribution: {{kind: uniform, lower: 20 um, upper: 60 um}}"
    path = changed(folder, (old, new), ("working_flank: right", f"working_flank: {flank}"))
    return model_from_scene(load_scene(path))


def shift_of_the_axis(columns: Mapping[str, np.ndarray], gear: str, direction: str, sigma: Flank) -> np.ndarray:
    """Half the drawn clearance in the direction that the text means, (n, 2) [um]."""
    if direction == "random":
        return np.stack([columns[f"bearing clearance.{axis} [um]"] / 2 for axis in "xy"], axis=1)
    return columns["bearing clearance [um]"][:, None] / 2 * np.array(direction_of(gear, direction, sigma))


def exact_backlash(columns: Mapping[str, np.ndarray], shifts: dict[str, np.ndarray], sigma: Flank) -> np.ndarray:
    """Normal backlash [um] of the paper's pair by the closed form, from the drawn columns, (n,)."""

    thickness = columns["pinion tooth thickness [um]"] + columns["wheel tooth thickness [um]"]
    apart = np.stack([172.5e3 + columns["centre distance [um]"], np.zeros(len(thickness))], axis=1)
    axis = apart + shifts.get("wheel", 0.0) - shifts.get("pinion", 0.0)
    return 1e3 * exact_eccentric.normal_backlash(
        InvoluteGear(28, 2.5, ALPHA, 20.0),
        InvoluteGear(110, 2.5, ALPHA, 20.0),
        thickness * 1e-3,
        axis * 1e-3,
        (
            1e-3 * vector(columns, "pinion eccentricity", "reducer run-out"),
            1e-3 * vector(columns, "wheel eccentricity"),
        ),
        np.radians(columns["position:gear pair [deg]"]),
        sigma,
    )


@pytest.mark.parametrize(("flank", "sigma"), [("right", 1), ("left", -1)])
@pytest.mark.parametrize("direction", ["apart", "tooth_force", "{at: 50 deg}", "random"])
@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_both_methods_take_a_clearance_as_the_text_means_it(
    gear: str, direction: str, flank: str, sigma: Flank, tmp_path: Path, engine_of: EngineOf
) -> None:
    model = clearance_scene(tmp_path, gear, direction, flank)
    columns = gear_columns(model, engine_of(model), drawn_trials(model, 1, 0, TRIALS))
    geometric, analytic = (columns[f"{method}:normal backlash"] for method in ("geometric", "analytic"))
    assert (columns["status"] == "ok").all()
    assert np.abs(geometric - analytic).max() <= STACK_UP_BOUND
    exact = exact_backlash(columns, {gear: shift_of_the_axis(columns, gear, direction, sigma)}, sigma)
    assert np.abs(geometric - exact).max() <= EXACT_BOUND
    # the clearance matters: without it the closed form is microns off
    assert np.abs(geometric - exact_backlash(columns, {}, sigma)).max() > 30 * EXACT_BOUND


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_a_clearance_apart_opens_by_sin_alpha_a_micrometre_whichever_gear_has_it(
    gear: str, tmp_path: Path, engine_of: EngineOf
) -> None:
    model = clearance_scene(tmp_path, gear, "apart", "right")
    columns = gear_columns(model, engine_of(model), drawn_trials(model, 1, 0, TRIALS))
    opened = columns["geometric:normal backlash"] - exact_backlash(columns, {}, 1)
    drawn = columns["bearing clearance [um]"]
    # 2 sin(alpha) times half of it; its square and its product with 40 um of the others stay under 0.05 um
    assert opened == pytest.approx(SIN * drawn, abs=EXACT_BOUND + 0.05)
    assert np.ptp(SIN * drawn) > 5.0


# positions ----------------------------------------------------------------------------------------------------


def test_shares_at_a_fixed_position_are_those_of_the_offsets_as_they_stand_there(tmp_path: Path) -> None:
    """Eccentricities of fixed direction, read at 40 deg of the driver; at random ones they would share nothing."""
    path = changed(
        tmp_path,
        (
            "of: wheel\n    distribution: {kind: rayleigh, scale: 5.166666666666667 um}",
            "of: wheel\n    direction: {at: 25 deg}\n    distribution: {kind: uniform, lower: 0 um, upper: 24 um}",
        ),
        (
            "of: pinion\n    distribution: {kind: rayleigh, scale: 4.5 um}",
            "of: pinion\n    direction: {at: 70 deg}\n    distribution: {kind: uniform, lower: 0 um, upper: 40 um}",
        ),
        ("lower_limit: 15 um  # the paper's lower limit", "over: {at: 40 deg}"),
        ("  lost motion:\n    kind: angular_backlash\n    of: gear pair\n    gear: wheel\n", ""),
        ("    lost motion: {low_3sigma: 54 arcsec, mean: 86 arcsec, high_3sigma: 120 arcsec}", ""),
    )
    count = 600
    measure = run_scene(path, overrides=Overrides(trials=count), out=tmp_path / "run").summary["measures"][
        "normal backlash"
    ]
    # By hand. The pinion's offset stands at 70 + 40 deg. The wheel at 180 + 180/110 - 40 x 28/110 deg has turned by
    # 171.4545 deg, its offset stands at 196.4545 deg. What counts is the x of each: cosines -0.342020 and -0.959055.
    # A length uniform over L has the variance L^2/12; limits at +-3 sigma of a normal are 6 sigma apart.
    variance = {
        "pinion tooth thickness": (COS * 11 / 6) ** 2,
        "wheel tooth thickness": (COS * 11 / 6) ** 2,
        "centre distance": (2 * SIN * 40 / 6) ** 2,
        "wheel eccentricity": (2 * SIN * 0.959055 * 24) ** 2 / 12,
        "bearing clearance": (SIN * 28 / 6) ** 2,
        "pinion eccentricity": (2 * SIN * 0.342020 * 40) ** 2 / 12,
        "reducer run-out": (2 * SIN * 8 / 6) ** 2,
    }
    total = sum(variance.values())
    assert 100 * variance["wheel eccentricity"] / total > 30
    for own in measure["contributors"]:
        share = variance[own["name"]] / total
        assert own["analytic_percent"] == pytest.approx(100 * share, abs=1e-3)
        # four standard errors of a share S by regression on n independent rows: sqrt(S (1 - S)/n)
        error = 4 * math.sqrt(share * (1 - share) / count)
        assert own["geometric_percent"] == pytest.approx(100 * share, abs=100 * error), own["name"]
    # all of it is accounted for, up to the mesh's 0.1 um in 7 um
    assert sum(own["geometric_percent"] for own in measure["contributors"]) == pytest.approx(100.0, abs=0.1)
