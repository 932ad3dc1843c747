"""F_r and f_i'' of teeth, against what a master gear and balls in the spaces would read."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

import tol3d
from tol3d import SceneError, check_scene
from tol3d.gearing.effects import FlankDeviation
from tol3d.gears import SpurGear, SpurPair
from tol3d.gears.tooth_measures import OverPins
from tol3d.scene import Scene
from tol3d.simulate import load

FR: dict[str, object] = {
    "kind": "tooth_run_out",
    "of": "pinion",
    "distribution": {"kind": "uniform", "lower": "0 um", "upper": "30 um"},
}
FI: dict[str, object] = {
    "kind": "tooth_to_tooth",
    "of": "wheel",
    "limits": {"size": "14 um"},
    "law": {"kind": "uniform"},
}


def with_(tolerance: Mapping[str, object]) -> Scene:
    """The bundled spur pair with this tolerance alone."""
    scene = load("spur_pair")
    return scene.with_({"tolerances": {"own": tolerance}, "published": {}})


def test_half_of_the_run_out_is_eccentricity() -> None:
    """Bit for bit the same trials as those of an eccentricity of half of it, whose balls run out by twice that."""
    half = {
        "kind": "eccentricity",
        "of": "pinion",
        "distribution": {"kind": "uniform", "lower": "0 um", "upper": "15 um"},
    }
    found = []
    for tolerance in (FR, half):
        response = tol3d.response(with_(tolerance)).of("normal backlash")
        found.append(response.values(*response.drawn(50, seed=1)).values)
    np.testing.assert_array_equal(found[0], found[1])
    gear, off = SpurGear(24, 2.0, math.radians(20), 10.0), 0.015
    centre = OverPins(3.5).size(gear) / 2 - 3.5 / 2
    spaces = np.exp(1j * (2 * np.arange(24) + 1) * math.pi / 24)
    radii = np.abs(centre * spaces + off * np.exp(0.3j))
    assert np.ptp(radii) == pytest.approx(2 * off, rel=0.01)


def test_a_tooth_pushes_a_master_gear_out_by_what_is_drawn() -> None:
    """Both flanks offset by rho sin(alpha) take from the backlash what axes nearer by rho do."""
    model = check_scene(with_(FI)).model
    (own,) = model.contributors
    assert isinstance(own.effect, FlankDeviation)
    out = {place.factor for places in own.effect.places for place in places}
    assert out == {math.sin(math.radians(20))}
    assert all(len({place.tooth for place in places}) == 1 and len(places) == 2 for places in own.effect.places)
    drawn = np.stack(own.draw.deviations(*np.random.default_rng(1).random((own.draw.uniforms, 200))))
    assert np.abs(np.diff(drawn, axis=0)).max() < 0.014
    assert np.abs(drawn).max() == pytest.approx(0.007, rel=0.01)
    gear, rho = SpurGear(24, 2.0, math.radians(20), 10.0), 0.007
    thick = replace(
        gear, tooth_thickness_deviation=2 * rho * math.sin(gear.pressure_angle) / math.cos(gear.pressure_angle)
    )
    apart = 48.0
    taken = SpurPair(gear, gear, apart).normal_backlash - SpurPair(thick, gear, apart).normal_backlash
    nearer = SpurPair(gear, gear, apart).normal_backlash - SpurPair(gear, gear, apart - rho).normal_backlash
    assert taken == pytest.approx(nearer, rel=2 * rho / apart / math.tan(gear.pressure_angle) ** 2)


def test_grades_state_the_limits() -> None:
    graded = FI | {"limits": {"grade": 7}}  # of the wheel: see the table of tests/standards/test_iso_1328_2.py
    (own,) = check_scene(with_(graded)).model.contributors
    assert 2 * own.distribution.high == pytest.approx(own.distribution.high - own.distribution.low)
    assert own.distribution.high > 0.0


@pytest.mark.parametrize(
    ("tolerance", "words"),
    [
        (FR | {"kind": "F_r"}, "write tooth_run_out: the run-out of teeth; run_out is of a shaft"),
        (FR | {"kind": "F_i″"}, "write tooth_run_out of F_i'' - f_i''"),
        (FR | {"distribution": {"iso_17485": "F_r 7"}}, "iso_17485: expected limits, .* not in tol3d, got"),
        (
            FR | {"distribution": {"iso_1328_2": "F_r 7", "module": "3 mm", "of": "70 mm", "law": {"kind": "uniform"}}},
            "distribution.module: expected 2.5 mm, as 'pinion' has it, got '3 mm'",
        ),
        (FI | {"limits": {"grade": 13}}, "limits.grade: expected a grade of f_i'' from 4 to 12"),
        (FI | {"limits": {}}, "either grade or size, got neither"),
        (FI | {"limits": "14 um"}, "limits such as"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_line(tolerance: Mapping[str, object], words: str) -> None:
    with pytest.raises(SceneError, match=words) as refused:
        check_scene(with_(tolerance))
    assert "\n" not in str(refused.value)
