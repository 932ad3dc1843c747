"""High-low-mean shares against what a first-order stack-up gives by hand."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from formulas import formula
from numpy.typing import NDArray
from places import SCENES

from tol3d import Overrides, Scene, load_scene, run_scene
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.study.effects import high_low_mean
from tol3d.study.effects.first_order import first_order
from tol3d.study.effects.high_low_mean import extents, high_low_mean_percents, high_low_mean_ranges
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.system.draw import Planar, Scalar
from tol3d.study.system.measure import Measure
from tol3d.study.system.plain import PlainMeasure, PlainSystem
from tol3d.study.system.stated import mean_deviations
from tol3d.study.trials.evaluation import Evaluation
from tol3d.study.trials.overrides import simulation_of
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

Array = NDArray[np.float64]

ALPHA = math.radians(20)
SIN, COS = math.sin(ALPHA), math.cos(ALPHA)

Tolerances = Mapping[str, tuple[Mapping[str, str], Mapping[str, Any]]]


def made(tolerances: Tolerances, **measure: object) -> Scene:
    gear = {"kind": "spur_gear", "module": "2.5 mm", "face_width": "20 mm"}
    return Scene.model_validate(
        {
            "scene": "high low mean",
            "parts": {"pinion": {**gear, "teeth": 28}, "wheel": {**gear, "teeth": 110}},
            "tolerances": {name: {"distribution": law, **rest} for name, (law, rest) in tolerances.items()},
            "moves": {"pair": {"kind": "mesh", "driver": "pinion", "driven": "wheel", "centre_distance": "172.5 mm"}},
            "measures": {"play": {"kind": "normal_backlash", "of": "pair", **measure}},
        }
    )


def normal(lower: str, upper: str) -> dict[str, str]:
    return {"kind": "normal", "lower": lower, "upper": upper}


CENTRE = {"kind": "centre_distance", "of": "pair"}
THIN = {"thin teeth": ({"kind": "constant", "value": "-120 um"}, {"kind": "tooth_thickness", "of": "wheel"})}
PAPERLIKE = {
    "thickness": (normal("-30 um", "-19 um"), {"kind": "tooth_thickness", "of": "pinion"}),
    "distance": (normal("-20 um", "20 um"), {"kind": "centre_distance", "of": "pair"}),
    "eccentricity": ({"kind": "rayleigh", "scale": "4.5 um"}, {"kind": "eccentricity", "of": "pinion"}),
    "clearance": (normal("6 um", "20 um"), {"kind": "bearing_clearance", "of": "wheel"}),
    "tilt": (normal("-10 um", "10 um"), {"kind": "axis_in_plane", "of": "pair"}),
}
# what each moves the normal backlash by [um] between its ends
RANGES = {
    "thickness": COS * 11,
    "distance": 2 * SIN * 40,
    "eccentricity": 2 * SIN * 2 * 4.5 * math.sqrt(-2 * math.log(0.0027)),  # 99.73 % of a Rayleigh length, both ways
    "clearance": SIN * 14,
    "tilt": SIN * 10,  # either sign closes: from the mean to one end
}


@pytest.mark.parametrize("engine", ["analytic", "fcl"])
def test_each_contributor_counts_by_the_square_of_its_range_alone(engine: str, tmp_path: Path) -> None:
    run = run_scene(made({**THIN, **PAPERLIKE}), overrides=Overrides(trials=4, engine=engine), out=tmp_path / "run")
    found = {c["name"]: c["high_low_mean_percent"] for c in run.summary["measures"]["play"]["contributors"]}
    total = sum(own**2 for own in RANGES.values())
    # the stack-up is first order: 0.02 um of a range of 27 um is 0.15 % of its square
    expected = {"thin teeth": 0.0} | {name: 100 * own**2 / total for name, own in RANGES.items()}
    assert found == {name: pytest.approx(percent, abs=0.15) for name, percent in expected.items()}


def test_a_length_in_a_random_direction_acts_along_its_worst_one(tmp_path: Path) -> None:
    # at 50 deg of the driver its offset opens most along 130 deg of the gear; the distance as a yardstick
    law = {"kind": "constant", "value": "7 um"}
    tolerances = {
        **THIN,
        "eccentricity": (law, {"kind": "eccentricity", "of": "pinion"}),
        "distance": (normal("-7 um", "7 um"), {"kind": "centre_distance", "of": "pair"}),
    }
    scene = made(tolerances, over={"at": "50 deg"})
    run = run_scene(scene, overrides=Overrides(trials=4), out=tmp_path / "run")
    shares = {c["name"]: c["high_low_mean_percent"] for c in run.summary["measures"]["play"]["contributors"]}
    assert shares["eccentricity"] == pytest.approx(50.0, abs=0.3)
    assert shares["distance"] == pytest.approx(50.0, abs=0.3)


def test_a_fixed_direction_counts_by_its_ends(tmp_path: Path) -> None:
    across: Tolerances = {
        **THIN,
        "across": (normal("-7 um", "7 um"), {"kind": "eccentricity", "of": "pinion", "direction": {"at": "90 deg"}}),
        "distance": (normal("-7 um", "7 um"), {"kind": "centre_distance", "of": "pair"}),
    }
    run = run_scene(made(across, over={"at": "0 deg"}), overrides=Overrides(trials=4), out=tmp_path / "run")
    shares = {c["name"]: c["high_low_mean_percent"] for c in run.summary["measures"]["play"]["contributors"]}
    assert shares["across"] < 0.01
    assert shares["distance"] == pytest.approx(100.0, abs=0.01)


def test_a_build_that_does_not_seat_leaves_the_shares_open(tmp_path: Path) -> None:
    tight = {"distance": (normal("-40 um", "60 um"), {"kind": "centre_distance", "of": "pair"})}
    run = run_scene(made(tight), overrides=Overrides(trials=4), out=tmp_path / "run")
    (share,) = run.summary["measures"]["play"]["contributors"]
    assert share["high_low_mean_percent"] is None


@pytest.mark.parametrize("mean_seats", [False, True])
def test_no_build_is_asked_for_at_ends_that_are_not_known(mean_seats: bool) -> None:
    """If builds do not seat, neither the steepest direction nor slopes are numbers, and no share is known."""
    system = simulation_of(made({**THIN, **PAPERLIKE}), Overrides(trials=4)).system
    (measure,) = system.measures
    mean = mean_deviations(system, measure.positions)

    def values(rows: np.ndarray) -> np.ndarray:
        assert np.isfinite(rows).all()
        return np.where((rows == mean).all(axis=1) & mean_seats, 0.0, np.nan)

    def read(rows: np.ndarray, measures: object) -> dict[str, np.ndarray]:
        return {measure.name: values(rows)}

    assert set(high_low_mean_ranges(system, [measure], read)[measure.name].values()) == {None}
    linear = first_order(Simulation(system, Study()), [measure], read)[measure.name]
    assert math.isnan(linear.mean) is not mean_seats
    assert np.isnan(linear.ends).all()


def test_every_one_of_200_contributors_has_both_its_shares(tmp_path: Path) -> None:
    """Ranges of 1 and 2 um, a hundred each: squares of 1 and 4 in a sum of 500."""
    small, large = ((normal(f"-{half} um", f"{half} um"), CENTRE) for half in (0.5, 1.0))
    many = {f"{size} {k}": own for k in range(100) for size, own in (("small", small), ("large", large))}
    run = run_scene(made({**THIN, **many}), overrides=Overrides(trials=500), out=tmp_path / "run")
    told = {own["name"]: own for own in run.summary["measures"]["play"]["contributors"]}
    expected = {name: 0.2 if name.startswith("small") else 0.8 for name in many}
    found = {name: told[name]["high_low_mean_percent"] for name in many}
    assert found == {name: pytest.approx(own, rel=1e-4) for name, own in expected.items()}
    off = [
        (told[name]["geometric_percent"] - own) / told[name]["geometric_percent_se"] for name, own in expected.items()
    ]
    assert len(off) == 200
    assert max(map(abs, off)) < 5.0  # standard errors; a share of 0.2 % is within what 500 trials see
    assert sum(told[name]["geometric_percent"] for name in many) == pytest.approx(100.0, abs=5 * 100 * 20 / 500)
    assert any("201 tolerances act" in warning for warning in run.summary["warnings"])


def test_ends_that_go_with_contributors_times_measures_are_built_for_the_largest_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Three of four zones are taken to first order: their shares differ by what is not linear."""
    simulation = simulation_of(load_scene("cover_on_base"), Overrides())
    system = simulation.system
    method = method_of(simulation, materials_of(simulation))
    assert [(own.asking, own.exact) for own in extents(system, system.measures)] == [(4, 4)]
    rows: list[int] = []

    def read(builds: Array, measures: Sequence[Measure]) -> Mapping[str, Array]:
        rows.append(len(builds))
        return Evaluation(system, method).values(builds, measures)

    exact = high_low_mean_ranges(system, system.measures, read)
    built = sum(rows)
    monkeypatch.setattr(high_low_mean, "MOST_ENDS", 0)
    monkeypatch.setattr(high_low_mean, "MOST_EXACT", 1)
    rows.clear()
    found = high_low_mean_ranges(system, system.measures, read)
    assert [(own.asking, own.exact) for own in extents(system, system.measures)] == [(4, 1)]
    assert sum(rows) <= built - 2 * 3  # both ends of three zones, where they differ by measure for each
    for name, ranges in exact.items():
        own = high_low_mean_percents(ranges)
        shares = high_low_mean_percents(found[name])
        assert shares == {each: pytest.approx(share, rel=0.01, abs=1e-6) for each, share in own.items()}
        assert sum(share > 0.1 for share in own.values() if share is not None) > 1


def test_ranges_are_counted_from_the_mean_build_wherever_that_is() -> None:
    """40 + (x0 - 3)² + 2 x1 - (x2 + 1)²: x0 of 2 to 4, whose mean is in the vertex, x1 of 6 to 9, x2 of 0 to 4.

    Over x0 the measure ends where it began: its range is 1, that of the mean to both ends. Over x1 it is 6, over x2,
    from one side of the vertex at -1 to the far end, 25 - 1.
    """
    own = formula(
        lambda x: 40.0 + (x[:, 0] - 3.0) ** 2 + 2.0 * x[:, 1] - (x[:, 2] + 1.0) ** 2,
        [Scalar(Uniform(2.0, 4.0)), Scalar(Uniform(6.0, 9.0)), Scalar(Uniform(0.0, 4.0))],
    )

    def values(rows: Array, measures: Sequence[Measure]) -> Mapping[str, Array]:
        return {"value": own.values(rows, own.positions(len(rows), "rest")).values[:, 0]}

    found = high_low_mean_ranges(own.simulation.system, own.measures, values)["value"]
    assert found == pytest.approx({"x0": 1.0, "x1": 6.0, "x2": 24.0}, rel=1e-9)
    squares = np.array([1.0, 36.0, 576.0])
    shares = dict(zip(("x0", "x1", "x2"), 100 * squares / squares.sum(), strict=True))
    assert high_low_mean_percents(found) == pytest.approx(shares, rel=1e-9)


def test_ranges_are_the_same_whether_measures_are_built_for_apart_or_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """Zones act along a direction of each measure's own; values read of no measure that did not ask where apart."""
    simulation = simulation_of(load_scene(SCENES / "cover_on_base.yaml"))
    system, method = simulation.system, method_of(simulation, materials_of(simulation))
    found, read = [], []
    for call in (10**12, -(10**12)):
        asked: list[int] = []

        def values(rows: Array, measures: Sequence[Measure], asked: list[int] = asked) -> Mapping[str, Array]:
            asked.append(len(rows) * len(measures))
            return Evaluation(system, method).values(rows, measures)

        monkeypatch.setattr(high_low_mean, "CALL", call)
        found.append(high_low_mean_ranges(system, system.measures, values))
        read.append(sum(asked))
    together, apart = found
    assert apart == together
    assert read[1] < read[0]


def test_a_measure_that_cannot_be_built_beside_the_mean_asks_for_nothing_where_others_ask_apart(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Three lengths in a plane; two of three measures, each time other ones, act along the same direction of each."""
    law = Uniform(-0.01, 0.03)
    alike, apart = np.array([1.0, 2.0]), np.array([-3.0, 0.5])
    slopes = {
        "a": np.concatenate([alike, alike, apart]),
        "b": np.concatenate([alike, apart, alike]),
        "c": np.concatenate([apart, alike, alike]),
    }
    own = formula(lambda x: x[:, 0], [Planar(law, None)] * 3)
    names = (*slopes, "never")
    assert isinstance(own.simulation.system, PlainSystem)
    system = replace(own.simulation.system, measures=tuple(PlainMeasure(name, name, unit="1") for name in names))

    def values(rows: Array, measures: Sequence[Measure]) -> Mapping[str, Array]:
        assert len(rows)
        every = {name: rows @ slope for name, slope in slopes.items()}
        every["never"] = np.where(rows.any(axis=1), np.nan, 0.0)
        return {measure.name: every[measure.name] for measure in measures}

    monkeypatch.setattr(high_low_mean, "CALL", -(10**12))
    found = high_low_mean_ranges(system, system.measures, values)
    for name, slope in slopes.items():
        expected = 2 * law.radius * np.hypot(slope[::2], slope[1::2])
        assert [*found[name].values()] == pytest.approx(expected, rel=1e-9)
    assert set(found["never"].values()) == {None}
