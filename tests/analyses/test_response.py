"""Analyses read scenes: the same values as their runs have, and the same laws from standard normals."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from analyses.linear_stacks import stack
from scipy.stats import ks_2samp, norm

from tol3d import InputError, Overrides, run_scene
from tol3d.analyses import what_if
from tol3d.analyses.response import Response, Values, response_of
from tol3d.assembly.zones.float_draw import FloatDraw
from tol3d.numerics.arrays import Array
from tol3d.scene.bundled import bundled_scenes
from tol3d.simulate import load, simulation_of
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.study.system.dependent import DrawnAs
from tol3d.study.system.draw import Ball, Draw, Each, Planar, Scalar
from tol3d.study.system.normals import groups_of, normal_count, uniforms_of
from tol3d.study.trials import draws
from tol3d.study.trials.simulation import Simulation

QUICK = ("spur_pair", "hole_and_slot", "gearbox_in_housing")
TRIALS = 200


def response(name: str, trials: int = TRIALS, *, analytic: bool = False) -> Response:
    return response_of(simulation(name, trials), analytic=analytic)


@cache
def simulation(name: str, trials: int) -> Simulation:
    return simulation_of(load(name), Overrides(trials=trials))


def _same_as_a_run(name: str, folder: Path, trials: int) -> None:
    """Every measure of both methods, and both ends of every curve."""
    run = run_scene(name, overrides=Overrides(trials=trials, witness=0), out=folder / name)
    columns = run.columns()
    for method in run.found.methods:
        own = response(name, trials, analytic=method == "analytic")
        found = own.values(*own.drawn(trials))
        for k, measure in enumerate(own.names):
            curve, _, end = measure.rpartition(", ") if measure in own.curves else (measure, "", "")
            kept = np.asarray(columns[f"{method}:{curve}"], dtype=np.float64)
            kept = {"": kept, "lowest": kept.min(axis=-1), "highest": kept.max(axis=-1)}[end]
            values = found.values[:, k]
            assert np.array_equal(values, np.where(np.isfinite(values), kept, np.nan), equal_nan=True)
            assert np.isfinite(values[found.seated[:, k]]).all()
            if method == "geometric":
                codes = np.array(found.texts)[found.codes[:, k]]
                assert codes.tolist() == np.asarray(columns[f"status:{curve}"]).tolist()
        assert own.evaluations == trials


@pytest.mark.parametrize("name", QUICK)
def test_values_of_kept_trials_are_theirs_to_the_bit(name: str, tmp_path: Path) -> None:
    _same_as_a_run(name, tmp_path, TRIALS)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(bundled_scenes()) - set(QUICK)))
def test_values_of_kept_trials_of_every_scene_are_theirs_to_the_bit(name: str, tmp_path: Path) -> None:
    _same_as_a_run(name, tmp_path, 5 * TRIALS)


def _drawn(draw: Draw, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Components of standard normals, and of uniforms (count, components)."""
    generator = np.random.default_rng(5)
    normals = generator.standard_normal((normal_count(draw), count))
    uniforms = generator.random((draw.uniforms, count))
    return np.array(draw.deviations(*uniforms_of(draw, list(normals)))).T, np.array(draw.deviations(*uniforms)).T


DRAWS: dict[str, Draw] = {
    "scalar": Scalar(Uniform(-1.0, 3.0)),
    "planar": Planar(Normal(2.0, 0.5), None),
    "planar fixed": Planar(Normal(2.0, 0.5), 0.3),
    "ball": Ball(Uniform(0.0, 2.0)),
    "float": FloatDraw(("disc", "interval", "room"), ("x", "y", "along", *(f"d{k}" for k in range(6)), "start")),
}


@pytest.mark.parametrize("name", DRAWS)
def test_normals_draw_the_same_law_as_uniforms(name: str) -> None:
    """Each component, and the products of two of them; a fixed seed, so that one in a million fails by chance."""
    by_normals, by_uniforms = _drawn(DRAWS[name], 20_000)
    for k in range(by_normals.shape[1]):
        for other in range(k + 1):
            pair = (own[:, k] * (own[:, other] if other < k else 1.0) for own in (by_normals, by_uniforms))
            assert ks_2samp(*pair).pvalue > 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(bundled_scenes()))
def test_normals_draw_the_laws_of_every_scene(name: str) -> None:
    own = response(name)
    assert own.rough == ()
    by_normals = own.deviations(np.random.default_rng(6).standard_normal((20_000, own.dimension)))
    by_study, _ = own.drawn(20_000, seed=8)
    compared = [k for k in range(own.components) if by_study[:, k].std() > 0.0]
    least = min((ks_2samp(by_normals[:, k], by_study[:, k]).pvalue for k in compared), default=1.0)
    assert least > 1e-4 / max(len(compared), 1)


def test_no_direction_of_a_plane_is_special() -> None:
    """Turned normals are turned deviations, also where an angle begins anew; the length goes by its own quantile."""
    draw = Planar(Normal(2.0, 0.5), None)
    for angle in (-1e-9, 0.0, 1e-9, math.pi, 2.0):
        x, y = draw.deviations(
            *uniforms_of(draw, [np.array([1.5 * math.cos(angle)]), np.array([1.5 * math.sin(angle)])])
        )
        length = 2.0 + 0.5 * norm.ppf(-math.expm1(-(1.5**2) / 2))
        assert (x[0], y[0]) == pytest.approx((length * math.cos(angle), length * math.sin(angle)), abs=1e-12)


def test_gradients_are_the_slopes_of_theory() -> None:
    """The analytic method knows every slope of a linear measure; both methods' are those at small steps."""
    own = response("door")
    for measure in own.measures:
        form = own.simulation.system.closed_form(measure)
        assert form is not None
        analytic = response_of(own.simulation, analytic=True).of(measure.name)
        for asked, error in ((analytic, 1e-9), (own.of(measure.name), 1e-4)):
            gradient = asked.gradient(asked.mean)[0, 0]
            for share in form.shares:
                size = float(np.linalg.norm(gradient[asked.slices[share.name]])) / measure.per_internal
                assert size == pytest.approx(abs(share.coefficient), rel=error, abs=error)


def test_gradients_of_a_spur_pair_are_those_of_its_involutes() -> None:
    """Normal backlash grows by 2 sin of the working pressure angle with centre distance: differences of 1 um hold it.

    From j = 2 r_b (inv a_w - ...) with cos a_w = r_b / a, r_b the sum of the base radii.
    """
    own = response("spur_pair").of("normal backlash")
    centre, base = own.slices["centre distance"].start, 172.5 * math.cos(math.radians(20.0))
    builds = np.zeros((9, own.components))
    builds[:, centre] = np.linspace(-0.03, 0.05, 9)
    slopes = own.gradient(builds)[:, 0, centre] / own.measures[0].per_internal
    assert slopes == pytest.approx(2.0 * np.sin(np.arccos(base / (172.5 + builds[:, centre]))), rel=1e-9)


def test_a_scene_without_tolerances_has_no_slopes() -> None:
    own = response_of(simulation_of(load("spur_pair").model_copy(update={"tolerances": {}}), Overrides(trials=10)))
    assert own.gradient(np.zeros((3, 0))).shape == (3, len(own.names), 0)


def test_other_tolerances_of_the_same_system() -> None:
    own = response("spur_pair").of("normal backlash")
    name = next(each.name for each in own.contributors if isinstance(each.draw, Scalar))
    law = own.draws[name].distribution
    other = own.with_draws({name: Scalar(Normal(law.mean + 1.0, law.sigma))})
    shifted, same = other.drawn(50)[0] - own.drawn(50)[0], own.slices[name]
    assert shifted[:, same] == pytest.approx(1.0, abs=1e-9)
    assert np.abs(np.delete(shifted, np.arange(own.components)[same], axis=1)).max() == 0.0
    assert other.mean[same] == pytest.approx(own.mean[same] + 1.0)
    with pytest.raises(InputError, match="expected a contributor, got 'nobody'"):
        own.with_draws({"nobody": Scalar(Normal(0.0, 1.0))})
    with pytest.raises(InputError, match="expected a draw of 1 components, got one of 3"):
        own.with_draws({name: Ball(Uniform(0.0, 1.0))})


def test_a_draw_that_does_not_say_what_its_uniforms_are_is_told() -> None:
    class Stranger:
        uniforms = 2

    assert groups_of(Stranger()) is None
    assert normal_count(Stranger()) == 2


def test_measures_are_chosen_by_name() -> None:
    with pytest.raises(InputError, match="got 'normal backlas'; did you mean"):
        response("spur_pair").of("normal backlas")


REDRAWN = ("spur_pair", "every_field")  # plain, correlated


@pytest.mark.parametrize(
    "name", [own if own in REDRAWN else pytest.param(own, marks=pytest.mark.slow) for own in sorted(bundled_scenes())]
)
def test_builds_drawn_again_are_those_of_the_other_tolerances_to_the_bit(name: str) -> None:
    """Each contributor that can be another one, from the kept draws and from those of the one before; then back."""
    own = response(name)
    kept = own.kept(16)
    last = kept
    for contributor in own.slices:
        try:
            other = own.scaled({contributor: 0.9})
        except InputError:
            continue
        expected, positions = other.drawn(16)
        last = last.redrawn(other.draws)
        for found in (kept.redrawn(other.draws), last):
            assert np.array_equal(found.deviations, expected), contributor
            assert found.positions.keys() == positions.keys()
            assert all(np.array_equal(found.positions[key], positions[key]) for key in positions)
        assert not np.array_equal(last.deviations, kept.deviations), contributor
    assert np.array_equal(last.redrawn(own.draws).deviations, own.drawn(16)[0])


def test_only_what_changes_is_drawn_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hole's position reads the size that gives its bonus: with the size both are drawn, alone the position only."""
    own, drawn = response("bolted_cover"), list[str]()
    size, hole = "base hole 1 size", "base hole 1"
    kept, others = own.kept(4), {name: own.scaled({name: 0.9}) for name in (size, hole)}
    expected, fill = {name: other.drawn(4)[0] for name, other in others.items()}, draws.fill

    def told(columns: Array, slices: Any, some: Sequence[DrawnAs], uniforms: draws.Uniforms) -> None:
        drawn.extend(each.name for each in some)
        fill(columns, slices, some, uniforms)

    monkeypatch.setattr(draws, "fill", told)
    for name, names in ((size, [size, hole]), (hole, [hole])):
        drawn.clear()
        assert np.array_equal(kept.redrawn(others[name].draws).deviations, expected[name])
        assert drawn == names
    drawn.clear()
    kept.redrawn(own.draws)
    assert drawn == []


def test_draws_of_another_system_or_with_more_uniforms_are_refused() -> None:
    own = response("spur_pair")
    kept, wide = own.kept(4), own.with_draws({"wheel eccentricity": Each(Normal(0.0, 1.0), ("a", "b"))})
    with pytest.raises(InputError, match="expected draws of the same contributors"):
        kept.redrawn(response("door").draws)
    assert kept.redrawn(wide.draws).deviations.shape == (4, own.components)
    with pytest.raises(InputError, match="centre distance: expected a draw of 1 uniform at most, got one of 2"):
        own.with_draws({"centre distance": Sum()}).drawn(4)


class Sum(Scalar):
    """A length of two uniforms, where the scene has one of one."""

    uniforms = 2

    def __init__(self) -> None:
        super().__init__(Normal(0.0, 1.0))


# pieces, slopes and frames --------------------------------------------------------------------------------


def test_values_in_pieces_are_those_of_all_at_once_to_the_bit() -> None:
    """At positions and with builds that cannot be assembled; every row once, in order, the first 64 of them first."""
    own = response("spur_pair")
    deviations, positions = own.drawn(400)
    deviations[::7] *= -20.0
    expected = own.values(deviations, positions)
    assert not expected.seated.all()
    pieces = [*own.pieces(deviations, positions)]
    assert [rows.start for rows, _ in pieces] == [0, *(rows.stop for rows, _ in pieces[:-1])]
    assert (pieces[0][0].stop, pieces[-1][0].stop) == (64, 400)
    assert np.array_equal(np.concatenate([each.values for _, each in pieces]), expected.values, equal_nan=True)
    assert np.array_equal(np.concatenate([each.codes for _, each in pieces]), expected.codes)


@pytest.mark.parametrize("name", ["every_cycloid_field", "rv_bearing_play", "rv_train"])
def test_a_build_of_a_reducer_has_the_same_bits_alone_and_among_others(name: str) -> None:
    """Nothing of a build is summed, or padded, by how many there are."""
    own = response(name, analytic=True)
    deviations, positions = own.drawn(80)
    expected = own.values(deviations, positions).values
    for size in (1, 7):
        for first in range(0, 80, size):
            rows = slice(first, first + size)
            values = own.values(deviations[rows], {key: places[rows] for key, places in positions.items()}).values
            assert np.array_equal(values, expected[rows])


@pytest.mark.parametrize(
    ("fixed", "each", "sizes"),
    [
        (0.018, 2e-5, [64, 331, 5296, 8100, 100]),  # 331 = 64 · 0.1 / 0.01928; 16 · 331; (10 - 1) · 0.018 / 2e-5
        (0.14, 1e-3, [64, 128, 360, 360]),  # twice as many to learn; then (0.5 - 0.14) / 1e-3
        (0.14, 1e-4, [64, 128, 2048, 3600]),  # at most 16 times as many
        (0.7, 1e-2, [64, 32, 70, 70]),  # half as many to learn; then as long again as the fixed part
        (0.0, 1e-2, [64, 32, 10, 10]),
    ],
)
def test_pieces_grow_to_a_tenth_of_a_second(
    fixed: float, each: float, sizes: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a clock that only evaluations move: so many seconds a call and a build."""
    own, clock = stack([1.0], [1.0]), [0.0]
    measure = Response.values

    def timed(asked: Response, deviations: Array, positions: object = None) -> Values:
        clock[0] += fixed + each * len(deviations)
        return measure(asked, deviations)

    monkeypatch.setattr(Response, "values", timed)
    monkeypatch.setattr("time.perf_counter", lambda: clock[0])
    rows = [rows for rows, _ in own.pieces(own.drawn(sum(sizes))[0])]
    assert [one.stop - one.start for one in rows] == sizes


def test_an_analysis_stops_within_an_evaluation_and_tells_how_far_it_is() -> None:
    """An error of the callback comes out; the bits are those of all builds at once."""
    told = list[str]()
    what_if("spur_pair", factor={"centre distance": 0.5}, trials=400, draws=0, activity=told.append)
    assert "400 trials before, 400 of 400 builds" in told

    class StoppedError(Exception):
        pass

    def stop(done: int, builds: int) -> None:
        raise StoppedError

    own = response("spur_pair")
    deviations, positions = own.drawn(400)
    with pytest.raises(StoppedError):
        replace(own, between=stop).values(deviations, positions)
    found = replace(own, between=lambda done, builds: None).values(deviations, positions)
    assert np.array_equal(found.values, own.values(deviations, positions).values, equal_nan=True)


def test_slopes_of_some_contributors_are_those_among_all_and_cost_their_builds_alone() -> None:
    own = response("spur_pair").of("lost motion")
    builds, positions = own.drawn(3)
    everything, names = own.gradient(builds, positions), ["wheel eccentricity", "centre distance"]
    before = own.evaluations
    found = own.gradient(builds, positions, names)
    assert own.evaluations - before == 3 * 2 * 3  # builds, both sides, components
    columns = [k for name in names for k in range(own.slices[name].start, own.slices[name].stop)]
    assert np.array_equal(found, everything[:, :, columns])
    assert np.abs(found).min() > 0.0


@pytest.mark.parametrize("engine", ["exact", "analytic"])
def test_a_frame_of_drawn_builds_is_that_of_their_run(engine: str, tmp_path: Path) -> None:
    run = run_scene("spur_pair", overrides=Overrides(trials=8, witness=0, engine=engine), out=tmp_path / "run")
    own = response_of(simulation_of(load("spur_pair"), Overrides(trials=8, engine=engine)))
    found = own.frame(*own.drawn(8))
    assert {"centre distance [um]", "position:gear pair [deg]"} < {*found.columns}
    assert len(found.columns) == 11 + (4 if engine == "exact" else 2)
    assert found.equals(run.frame()[[*found.columns]])


def test_a_response_shows_itself_in_a_line() -> None:
    own, five = response("door"), "upper gap, lower gap, roof gap, upper flush, lower flush, …"
    assert repr(own) == f"<Response of door in its body opening, exact: {five}; 17 contributors>"
    assert ": roof gap; 17" in repr(own.of("roof gap"))
    assert ", analytic: " in repr(response("door", analytic=True))


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda own: own.slices["centre distanse"], "expected a contributor, .*did you mean .centre distance"),
        (lambda own: own.scaled({"x": 2.0}).draws["y"], "expected a contributor, got 'x'; known here"),
        (lambda own: own.draws["y"], "expected a contributor, got 'y'"),
        (lambda own: own.lines["y"], "expected a line of the scene that states a tolerance, got 'y'"),
        (lambda own: own.scaled({}, {"y": "low"}), "expected a contributor, got 'y'"),
        (lambda own: own.scope("y"), "expected a contributor, got 'y'"),
        (lambda own: own.gradient(own.mean, names=["y"]), "expected a contributor, got 'y'"),
        (lambda own: own.deviations(np.zeros(own.dimension), ["y"]), "expected a contributor, got 'y'"),
        (lambda own: own.drawn(-1), "expected a number of builds, got -1"),
        (lambda own: own.values(np.zeros(3)), r"expected deviations \(n, 10\), got \(1, 3\)"),
        (lambda own: own.values(own.mean, {}), "expected positions {'gear pair': .*, by name, got {}"),
        (lambda own: own.values(own.drawn(2)[0], own.drawn(3)[1]), "expected positions .*2,.*got .*3,"),
    ],
)
def test_wrong_names_and_shapes_are_refused_in_words(ask: Callable[[Response], object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        ask(response("spur_pair"))
