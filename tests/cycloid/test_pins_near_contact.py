"""Number of pins that share a load once they give way by a deflection: both methods against counts gap by gap."""

import cmath
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cycloid_stages import PROFILE, counted, erring, searched
from numpy.typing import NDArray
from places import SCENES
from rv_250 import nothing, rv_250, stage_of
from scene_texts import written

from tol3d import Overrides, SceneError, load_scene, run_scene
from tol3d.gearing.cycloid.exact.contact import contact_shape, first_contact
from tol3d.gearing.cycloid.from_scene import rv_system
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.turning import LinearTurning, Turned
from tol3d.gearing.cycloid.system import RVSystem
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

Array = NDArray[np.float64]

WINDOW = 0.7
PER_RADIAN = 2.2 * 39  # mm, the longest lever
TEXT = (SCENES / "rv_250aii.yaml").read_text("utf-8")
COUNTS = "  pins: {kind: cycloid_pins_near_contact, of: reducer, deflection: 2 um, lower_limit: 3 pins}\n"


def with_counts(folder: Path, counts: str = COUNTS) -> Path:
    folder.mkdir(exist_ok=True)
    return written(TEXT.replace("\nstudy: {", f"{counts}\nstudy: {{"), folder)


def linear_gaps(radial: Array, pitch: Array, profile: Array, phi: float) -> list[tuple[float, float]]:
    """Gap along the normal and lever [mm] of each working pin of two discs, one pin after the other.

    Pins are off outwards (40,); lobes by arcs and material (2, 39); discs are ground by shift and offset of rv_250.
    """
    found, k = [], 88.0 / 114.5
    for disc in range(2):
        for pin in range(40):
            at, phase = 2 * math.pi * pin / 40, 2 * math.pi * (pin / 40 - disc / 2) - phi
            apart = abs(1 - k * cmath.exp(1j * phase))
            outwards, lever = (1 - k * math.cos(phase)) / apart, PER_RADIAN * math.sin(phase) / apart
            if lever > WINDOW * PER_RADIAN:
                lobe = math.floor((at + (phi + math.pi * disc) / 39) * 39 / (2 * math.pi)) % 39
                gap = 0.02 * (outwards - math.sqrt(1 - k * k)) + outwards * radial[pin] - profile[disc, lobe]
                found.append((gap - lever * pitch[disc, lobe] * k / PER_RADIAN, lever))
    return found


@pytest.mark.parametrize("deflection", [0.002, 0.008])
def test_the_analytic_method_counts_linear_gaps_where_the_first_one_is_closed(deflection: float) -> None:
    own, phis = nothing(40), np.linspace(0.0, 39 * 2 * math.pi, 40)
    rng = np.random.default_rng(5)
    own.pins[..., 0] = rng.normal(0.0, 0.004, (40, 40))
    own.lobe_pitch[...], own.lobe_profile[...] = rng.normal(0.0, 0.003, (2, 40, 2, 39))
    found = stage_of(rv_250()).touches(own, phis[:, None], deflection=deflection)
    assert found.near is not None
    counts = []
    for trial, phi in enumerate(phis):
        gaps = linear_gaps(own.pins[trial, :, 0], own.lobe_pitch[trial], own.lobe_profile[trial], phi)
        turn = min(gap / lever for gap, lever in gaps)
        counts.append(sum(gap - turn * lever <= deflection for gap, lever in gaps))
    assert found.near[:, 0].tolist() == counts
    assert len(set(counts)) > 2


@pytest.mark.parametrize("deflection", [0.002, pytest.param(0.006, marks=pytest.mark.slow)])
def test_the_exact_method_counts_gaps_to_dense_points_of_all_flanks(deflection: float) -> None:
    """Distances to points are off by less than a nanometre; no gap of these trials is so near to the deflection."""
    made, phis = erring(3, 2, 0.003, seed=8), np.linspace(0.3, 200.0, 3)
    found = first_contact(contact_shape(PROFILE, WINDOW, 0.0, deflection), made, phis[:, None])
    assert found.near is not None
    for trial, phi in enumerate(phis.tolist()):
        for k, sense in enumerate((1, -1)):
            first = searched(made, trial, phi, sense, WINDOW, 0.0)
            count, nearest = counted(made, trial, phi, first, WINDOW, deflection)
            assert abs(nearest - deflection) > 1e-6
            assert found.near[trial, 0, k] == count


def test_turns_are_the_same_whether_pins_are_counted_or_not(tmp_path: Path) -> None:
    study = simulation_of(load_scene(with_counts(tmp_path)), Overrides())
    system = study.system
    assert isinstance(system, RVSystem)
    own = {measure.name: measure for measure in system.measures if measure.take == "value"}
    trials = drawn(study, 0, 40)
    for method in ("exact", "analytic"):
        both = system.method(method, None).answers(trials, [*own.values()]).values
        for name, measure in own.items():
            assert np.array_equal(system.method(method, None).answers(trials, (measure,)).values[name], both[name])
        assert (both["pins"] >= 1).all()
        assert (both["pins"] == np.round(both["pins"])).all()


def test_a_deflection_of_more_than_every_gap_counts_all_working_pins(tmp_path: Path) -> None:
    """Those whose lever is over 0.7 of the longest; of either flank, counted one by one at the angle of the cranks."""
    text = COUNTS.replace("2 um", "9 mm").replace("reducer,", "reducer, over: {at: 0 deg},")
    study = simulation_of(load_scene(with_counts(tmp_path, text)), Overrides())
    system = study.system
    assert isinstance(system, RVSystem)
    measure = next(measure for measure in system.measures if measure.name == "pins")
    found = system.method("analytic", None).answers(drawn(study, 0, 5), (measure,)).values["pins"]
    nominal = len(linear_gaps(np.zeros(40), np.zeros((2, 39)), np.zeros((2, 39)), 0.0))
    assert (np.abs(found - nominal) <= 1).all()  # the first stage turns the cranks by some minutes


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "lower_limit: 3 pins",
            "lower_limit: 3",
            'measures.pins.lower_limit: expected a count with its unit, such as "3',
        ),
        ("lower_limit: 3 pins", "lower_limit: 3 um", "measures.pins.lower_limit: expected a count"),
        (", deflection: 2 um", "", 'measures.pins: expected the key "deflection" here, found none'),
        ("2 um", "0 um", "measures.pins.deflection: expected a length of more than zero, got '0 um'"),
        (
            "reducer,",
            "reducer, over: turn, take: value,",
            "measures.pins.take: expected min, max, range or curve over a",
        ),
    ],
)
def test_what_cannot_be_counted_is_refused(old: str, new: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError) as caught:
        rv_system(load_scene(with_counts(tmp_path, COUNTS.replace(old, new))))
    assert said in str(caught.value)


@pytest.mark.slow
def test_a_run_has_whole_quantiles_bars_and_shares_out_of_limits(tmp_path: Path) -> None:
    run = run_scene(with_counts(tmp_path), overrides=Overrides(trials=2000), out=tmp_path / "run")
    found, counts = run.summary["measures"]["pins"], run.columns("geometric:pins")["geometric:pins"]
    assert found["unit"] == "pins"
    assert found["geometric"]["p50"] == np.sort(counts)[999]
    assert found["geometric"]["below_limit_ppm"] == pytest.approx(1e6 * np.mean(counts < 3))
    assert found["histogram"]["bin_width"] == 1.0
    assert found["histogram"]["lower_edge"] == min(counts.min(), 1) - 0.5
    assert found["histogram"]["counts"]["geometric"][1] == np.sum(counts == 2)
    assert not found["agreement"]["explanation"]["faults"]
    assert found["agreement"]["explanation"]["second_order_rms"] is None


@pytest.mark.slow
def test_a_count_is_held_to_its_contributors_and_not_to_second_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pins that go inwards for outwards on the analytic method come near where those of the exact one leave."""
    known = LinearTurning.turned

    def turned(self: LinearTurning, deviated: RVDeviated, *rest: Any) -> Turned:
        altered = replace(deviated.stage, pins=-deviated.stage.pins)
        return known(self, replace(deviated, stage=altered), *rest)

    monkeypatch.setattr(LinearTurning, "turned", turned)
    summary = run_scene(with_counts(tmp_path), overrides=Overrides(trials=2000), out=tmp_path / "run").summary
    faults = summary["measures"]["pins"]["agreement"]["explanation"]["faults"]
    assert any("pin circle" in fault for fault in faults), faults
