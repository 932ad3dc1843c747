"""Tilted discs as a tolerance: both methods, rates, and the scene that lacks a width."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES
from scene_texts import scene_of

from tol3d import load_scene
from tol3d.errors import SceneError
from tol3d.gearing.cycloid.from_scene import rv_system
from tol3d.gearing.cycloid.model.profile import UNMODIFIED
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.reducer.turning import ExactTurning, LinearTurning

Array = NDArray[np.float64]
SCENE = SCENES / "every_cycloid_field.yaml"


def bare() -> RVSet:
    """The scene's reducer without clearance, which keeps feet where they are."""
    own = rv_system(load_scene(SCENE)).own
    return replace(own, profile=replace(own.profile, modification=UNMODIFIED))


def tilted(own: RVSet, scale: float) -> tuple[RVDeviated, Array]:
    """Tilts of some size [rad] of both discs, and turns of the output."""
    rng = np.random.default_rng(1)
    deviated = RVDeviated.nothing(own, 60)
    deviated.disc_tilts[...] = scale * rng.standard_normal(deviated.disc_tilts.shape)
    return deviated, rng.uniform(0, 3, (60, 1))


@pytest.mark.parametrize("sense", [1, -1])
def test_methods_differ_by_the_square_of_tilts(sense: int) -> None:
    own, off, effect = bare(), [], []
    for scale in (1e-4, 1e-5):
        deviated, turns = tilted(own, scale)
        exact, linear = (method(own).turned(deviated, turns, sense).turns for method in (ExactTurning, LinearTurning))
        off.append(np.abs(exact - linear).max())
        effect.append(np.abs(linear - LinearTurning(own).turned(RVDeviated.nothing(own, 60), turns, sense).turns).max())
    assert 30 < off[0] / off[1] < 300
    assert effect[0] / effect[1] == pytest.approx(10, rel=1e-6)
    assert off[0] < effect[0] / 50  # 4 mm off mid-face by 1e-4 rad over levers of 15 mm: 5 arc seconds


def test_rates_are_those_on_the_side_of_the_tilts() -> None:
    own = bare()
    deviated, turns = tilted(own, 1e-5)
    method = LinearTurning(own)
    found = method.turned(deviated, turns, -1)
    rates = method.rates(deviated.disc_tilts, turns[:, 0], found, -1)
    flat = method.turned(RVDeviated.nothing(own, 60), turns, -1)
    term = (rates.disc_tilts * deviated.disc_tilts).sum(axis=(1, 2))
    # without clearance all pins touch a flat disc: whichever is first with a tilt starts from there
    np.testing.assert_allclose(term, (found.turns - flat.turns)[:, 0], rtol=0, atol=1e-12)


def test_discs_tilt_only_where_their_width_is_stated(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"parts\.disc: expected the width of the disc, .* 'width: 20 mm'; got none"):
        rv_system(scene_of(SCENE.read_text("utf-8").replace(", width: 8 mm, hole", ", hole"), tmp_path))
