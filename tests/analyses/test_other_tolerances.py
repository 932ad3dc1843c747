"""Other tolerances of a response: its deviations are those of a scene that says so, bit for bit."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from analyses.linear_stacks import stack

from tol3d import InputError
from tol3d.analyses.response import Response, response_of
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.scene.bases import ToleranceSpec
from tol3d.scene.bundled import bundled_scenes
from tol3d.scene.edit import with_tolerances, write_scene
from tol3d.simulate import load, simulation_of
from tol3d.statistics.distributions.constant import Constant
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.study.system.draw import JointDraw, Planar, Scalar
from tol3d.study.system.other_laws import naturally_stays, scaled
from tol3d.study.trials.simulation import Simulation

TRIALS = 40


@cache
def simulation(name: str) -> Simulation:
    return simulation_of(load(name))


def meant(scene: Scene, response: Response, entry: str) -> list[str]:
    """The contributors of a tolerance: itself, or one for each feature that it is of."""
    others = set(scene.tolerances) - {entry}
    return [
        own.name
        for own in response.contributors
        if own.name == entry or (own.name.startswith(f"{entry} ") and own.name not in others)
    ]


def _same(scene: Scene, response: Response, entry: str, factor: float) -> bool:
    """True if a scene with a scaled tolerance draws and measures as the response does; False where it is refused."""
    names = meant(scene, response, entry)
    if not names:
        return False
    try:
        stays = naturally_stays(response.draws[names[0]])
        spec = scene.tolerances[entry].scaled(factor, stays, scene.files)
        own = response.scaled(dict.fromkeys(names, factor))
    except InputError:
        return False
    written = response_of(simulation_of(with_tolerances(scene, {entry: spec})))
    if isinstance(spec, ToleranceSpec):  # the law as it is written, to ten digits
        law = spec.distribution.resolve(scene.files)
        if type(law) is type(response.draws[names[0]].distribution):
            own = response.with_laws(dict.fromkeys(names, law))
    drawn, positions = own.drawn(TRIALS)
    assert _alike(drawn, written.drawn(TRIALS)[0]), entry
    assert not np.array_equal(drawn, response.drawn(TRIALS)[0]), entry
    found, expected = (each.values(drawn, positions).values for each in (own, written))
    assert _alike(found, expected), entry
    return True


def _alike(found: Array, expected: Array) -> bool:
    """To the bit, or to rounding where a scene writes a computed decimal."""
    return bool(np.allclose(found, expected, rtol=1e-12, atol=1e-12, equal_nan=True))


@pytest.mark.parametrize(
    ("name", "entries"),
    [
        ("spur_pair", ("centre distance", "wheel eccentricity", "bearing clearance")),
        ("bolted_cover", ("base hole 1 size", "base hole 1", "cover hole 2")),
        ("gearbox_in_housing", ("dowel 1 seat", "inside profile", "first wheel tooth thickness")),
        ("reducer_3k", ("sun thinning", "P1 eccentricity", "pins outwards")),
    ],
)
def test_a_scene_with_other_tolerances_draws_the_same(name: str, entries: tuple[str, ...]) -> None:
    scene = load(name)
    response = response_of(simulation(name))
    for entry in entries:
        assert _same(scene, response, entry, 0.5)


IN_CI = ("bevel_pair", "every_assembly_field", "every_planetary_field", "reducer_3k_flexible", "tooth_deviations")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(own, marks=pytest.mark.slow if own in IN_CI else pytest.mark.nightly)
        for own in sorted(bundled_scenes())
    ],
)
def test_every_scene_with_other_tolerances_draws_the_same(name: str) -> None:
    scene = load(name)
    response = response_of(simulation(name))
    held = [_same(scene, response, entry, factor) for entry in scene.tolerances for factor in (0.5, 0.9)]
    assert any(held) or not held


def test_a_bonus_follows_the_size_that_gives_it() -> None:
    """Half of a size's tolerance leaves at most half of the bonus: the axes of a hole at MMC lie nearer."""
    response = response_of(simulation("bolted_cover"))
    size, hole = "base hole 1 size", "base hole 1"
    law = response.draws[size].distribution
    assert isinstance(law, Normal)
    other = response.with_laws({size: law.within(law.limits[0], sum(law.limits) / 2)})
    most = [float(np.abs(own.drawn(2000)[0][:, own.slices[hole]]).max()) for own in (response, other)]
    assert most[1] < most[0]
    told, drawn = other.draws[hole], other.drawn(20_000)[0][:, other.slices[hole]]
    assert isinstance(told, JointDraw)
    assert np.diagonal(told.covariance)[:2] == pytest.approx(drawn.var(axis=0)[:2], rel=0.05), (
        "its spread is told so too"
    )


def test_tolerances_that_act_elsewhere_too_are_refused() -> None:
    response = response_of(simulation("bolted_cover"))
    with pytest.raises(InputError, match="cover hole 1 size: expected a tolerance that acts by its deviation alone"):
        response.scaled({"cover hole 1 size": 0.5})


def test_a_scene_is_written_with_them(tmp_path: Path) -> None:
    scene = load("gearbox_in_housing")
    factors = {"dowel 1 seat": 0.5, "first wheel eccentricity": 1.25, "inside profile": 0.7}
    changed = {name: scene.tolerances[name].scaled(factor, "middle", scene.files) for name, factor in factors.items()}
    write_scene(with_tolerances(scene, changed), tmp_path / "other.yaml")
    written = (tmp_path / "other.yaml").read_text(encoding="utf-8")
    assert "zone: {diameter: 5 um}" in written
    assert "{kind: rayleigh, scale: 5 um}" in written
    assert "zone: {width: 0.07 mm}" in written
    assert load(tmp_path / "other.yaml").tolerances["edge profile"] == scene.tolerances["edge profile"]


def test_a_length_that_begins_at_nothing_goes_on_doing_so() -> None:
    own = Planar(Uniform(0.0, 0.006), None)
    assert scaled(own, 2.0) == Planar(Uniform(0.0, 0.012), None)
    for draw in (Planar(Uniform(0.003, 0.013), None), Scalar(Uniform(0.0, 0.016))):
        mean = draw.distribution.mean
        assert scaled(draw, 0.5).distribution.mean == pytest.approx(mean)


def test_a_limit_that_stays() -> None:
    own = stack([1.0], [0.0], laws=[Normal(-0.0245, 0.0055 / 3, (-0.030, -0.019))])
    upper = own.scaled({"x0": 0.5}, {"x0": "high"}).draws["x0"].distribution
    assert (upper.low, upper.high, upper.mean) == pytest.approx((-0.0245, -0.019, -0.02175))


def test_what_cannot_be_is_refused() -> None:
    own = stack([1.0, 1.0], [0.0, 0.0], least=0.0, laws=[Normal(0.016, 0.014 / 3, (0.002, 0.030)), Constant(0.1)])
    with pytest.raises(InputError, match=r"x0: expected at least 0 um, for less is not physical, got down to -0\.8 um"):
        own.scaled({"x0": 1.2})
    with pytest.raises(InputError, match="x1: expected a law that can be scaled, got a constant"):
        own.scaled({"x1": 1.2})
    with pytest.raises(InputError, match="expected a contributor, got 'x7'; known here: x0, x1"):
        own.scaled({"x7": 1.2})
    with pytest.raises(InputError, match="x0: expected a contributor that lies in a zone, got a Scalar"):
        own.sized({"x0": 1.2})


# scope ------------------------------------------------------------------------------------------------------

SCOPED = ("spur_pair", "bolted_cover", "three_stage_train")


@pytest.mark.parametrize(
    "name", [own if own in SCOPED else pytest.param(own, marks=pytest.mark.slow) for own in sorted(bundled_scenes())]
)
def test_a_scope_offers_what_scaling_accepts_and_ends_where_it_refuses(name: str) -> None:
    """Every contributor: its ends and factors between them, and just beyond and farther, by `scaled` alone."""
    response = response_of(simulation(name))
    kept = response.kept(4)
    for own in response.slices:
        scope = response.scope(own)
        low, high = scope.factors or (1.0, 1.0)
        for factor in (low, low**0.7, low**0.3, 1.0, high**0.3, high**0.7, high):
            assert (factor in scope) == _accepted(response, own, factor) == (scope.factors is not None), own
            if factor in scope:
                assert np.isfinite(kept.redrawn(response.scaled({own: factor}).draws).columns).all(), own
        for end, why, way in ((low, scope.below, 1 / 1.00001), (high, scope.above, 1.00001)):
            assert bool(why) or end in (0.001, 1000.0), own
            for factor in (end * way, end * way**20_000, end * way**200_000) if why else ():
                assert factor not in scope, own
                assert not _accepted(response, own, factor), own


def _accepted(response: Response, name: str, factor: float) -> bool:
    try:
        response.scaled({name: factor})
    except InputError:
        return False
    return True


def test_a_scope_ends_where_a_length_would_be_below_0_and_says_so() -> None:
    own = stack([1.0, 1.0], [0.0, 0.0], least=0.0, laws=[Normal(0.016, 0.014 / 3, (0.002, 0.030)), Constant(0.1)])
    scope, fixed = own.scope("x0"), own.scope("x1")
    assert scope.factors == pytest.approx((0.001, 16 / 14), rel=1e-9)
    assert scope.below == ""
    assert scope.above == "x0: expected at least 0 um, for less is not physical, got down to -1.6 um"
    assert str(scope) == f"0.001 to 1.14286 ({scope.above})"
    assert fixed.factors is None
    assert (
        str(fixed) == "cannot be scaled: x1: expected a law that can be scaled, got a constant, which does not spread"
    )


def test_a_line_has_the_scope_that_all_its_contributors_have() -> None:
    response = response_of(simulation_of(load("box_with_discs")))
    line, several = next((name, own) for name, own in response.lines.items() if len(own) > 1)
    lows, highs = zip(*(response.scope(own).factors or (1.0, 1.0) for own in several), strict=True)
    assert response.scope(line).factors == pytest.approx((max(lows), min(highs)), rel=1e-9)
