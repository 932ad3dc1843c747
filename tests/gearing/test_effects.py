"""Effects: each is known to both methods, says where it acts, and numpy and the compiled kernel build it alike."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from gear_trials import drawn_trials
from oracles.far_builds import PAIRS, far_block, far_model
from places import SCENES
from shipped import shipped

from tol3d import load_scene
from tol3d.gearing import effects
from tol3d.gearing.builds.build import build
from tol3d.gearing.builds.displacements import displacements
from tol3d.gearing.effects import (
    AxesOffset,
    AxialPlay,
    AxisOffset,
    AxisTilt,
    Clocking,
    CombinedEffect,
    Effect,
    LinkDeviation,
    Temperature,
    ToothThickness,
    TurningOffset,
)
from tol3d.gearing.engines.exact.compiled_displacements import compiled_displacements
from tol3d.gearing.model import Contributor, Mesh, Model, Reading, Scalar, model_from_scene
from tol3d.gearing.stack_up import stack_of
from tol3d.gearing.stack_up.terms import contribution
from tol3d.gears import RIGHT, SpurGear, SpurPair
from tol3d.statistics.distributions import Distribution

SINGLE = [
    value
    for value in vars(effects).values()
    if isinstance(value, type) and issubclass(value, Effect) and value is not Effect
    if not issubclass(value, CombinedEffect)
]

ALL: tuple[Effect, ...] = (
    ToothThickness("pinion", 0.02),
    TurningOffset("pinion"),
    AxisOffset("pinion"),
    AxisTilt("pinion", (0.0, 1.0, 0.0), pivot=3.0),
    AxesOffset("wheel", "mesh"),
    Temperature(("pinion", "wheel")),
    LinkDeviation("reducer"),
    Clocking("wheel"),
    AxialPlay("wheel"),
)


def mesh_of(name: str, driver: str, driven: str, housing: str | None = None) -> Mesh:
    pinion, wheel = SpurGear(18, 2.0, math.radians(20.0), 10.0), SpurGear(27, 2.0, math.radians(20.0), 10.0)
    return Mesh(name, driver, driven, SpurPair(pinion, wheel, 45.2), RIGHT, housing)


def test_every_effect_is_among_those_that_are_tried_here() -> None:
    """But deviations of single flanks, which have methods of their own: test_single_flanks.py tries them."""
    assert {*(type(effect) for effect in ALL), effects.FlankDeviation} == set(SINGLE)


@pytest.mark.parametrize("pair", ["spur", "bevel 17/43"])
@pytest.mark.parametrize("effect", ALL, ids=lambda effect: type(effect).__name__)
def test_both_methods_know_every_effect_of_every_kind_of_pair(effect: Effect, pair: str) -> None:
    model, _ = far_model(pair, RIGHT)
    stack = stack_of(model, model.meshes[0], Reading())
    moved = list(displacements(effect, model, 1))
    does = contribution(effect, stack, model.contributors[0])
    acts = effect.acts_in(model.meshes[0])
    assert bool(moved) == acts
    # what nothing displaces has no term; the reverse is what a method may leave out, such as growth of bevel gears
    assert acts or does.opening is does.aside is None


# where effects act --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("effect", "first", "second"),
    [
        (ToothThickness("a", 0.02), True, False),
        (TurningOffset("b"), True, True),
        (AxisOffset("b"), True, True),
        (AxisOffset("b", mesh="second"), False, True),
        (AxisTilt("c"), False, True),
        (AxisTilt("b", mesh="first"), True, False),
        (AxesOffset("b", "first"), True, False),
        (Temperature(("box",)), False, True),
        (Temperature(("a", "box")), True, True),
        (LinkDeviation("r"), False, False),
        (Clocking("b"), False, False),
        (AxialPlay("b"), False, False),
        (CombinedEffect((ToothThickness("a", 0.02), AxisOffset("c"))), True, True),
    ],
)
def test_an_effect_acts_in_the_meshes_of_its_parts_or_in_the_one_that_it_names(
    effect: Effect, first: bool, second: bool
) -> None:
    """Gears a - b - c in two meshes; only the second one is held by the box."""
    assert effect.acts_in(mesh_of("first", "a", "b")) == first
    assert effect.acts_in(mesh_of("second", "b", "c", "box")) == second


def test_clocking_turns_the_driven_shaft_by_the_ratio_for_the_driver_and_back_for_the_driven_gear() -> None:
    mesh = mesh_of("mesh", "a", "b")
    assert mesh.rate == Fraction(-18, 27)
    assert Clocking("a").clocking(mesh) == pytest.approx(-2 / 3)
    assert Clocking("b").clocking(mesh) == -1.0
    assert Clocking("c").clocking(mesh) == 0.0
    assert ToothThickness("a", 0.02).clocking(mesh) == 0.0
    both = CombinedEffect((Clocking("a"), Clocking("b")))
    assert both.clocking(mesh) == pytest.approx(-5 / 3)


def test_play_is_of_the_reducer_that_it_names() -> None:
    assert LinkDeviation("r").acts_on("r")
    assert not LinkDeviation("r").acts_on("other")
    assert not Clocking("r").acts_on("r")


def test_axial_play_is_of_the_shaft_that_it_names() -> None:
    assert AxialPlay("s").slides("s")
    assert not AxialPlay("s").slides("other")
    assert not Clocking("s").slides("s")
    assert CombinedEffect((AxisOffset("b"), AxialPlay("s"))).slides("s")
    assert not CombinedEffect((AxisOffset("b"), AxialPlay("s"))).slides("b")


# numpy's builds and the compiled ones -------------------------------------------------------------------------------

ROUNDING = 1e-13  # mm and rad; a few roundings of lengths up to 100 mm each way
FIELDS = ("world_from_shaft", "centre", "axis_turn", "flank_turn", "flank_offset", "scale")


def assert_built_alike(model: Model, deviations: np.ndarray) -> None:
    made, compiled = build(model, deviations), compiled_displacements(model).build(deviations)
    for name in FIELDS:
        ours, theirs = getattr(made, name), getattr(compiled, name)
        assert ours.shape == theirs.shape
        assert np.abs(ours - theirs).max() <= ROUNDING, name


@pytest.mark.parametrize("name", PAIRS)
def test_compiled_builds_of_every_effect_are_numpy_s(name: str) -> None:
    model, _ = far_model(name, RIGHT)
    assert_built_alike(model, far_block(model, 50, 3).deviations)


@pytest.mark.parametrize("scene", shipped("gearing"))
def test_compiled_builds_of_the_shipped_scenes_are_numpy_s(scene: str) -> None:
    model = model_from_scene(load_scene(SCENES / f"{scene}.yaml"))
    assert_built_alike(model, drawn_trials(model, seed=5, first=0, count=40).deviations)


def test_two_effects_of_one_deviation_on_one_seat_add_up() -> None:
    model, _ = far_model("spur", RIGHT)
    twice = CombinedEffect((AxisOffset("wheel"), AxisOffset("wheel", (0.0, 1.0, 0.0), 0.5), AxisOffset("wheel")))
    law = model.contributors[0].distribution
    assert isinstance(law, Distribution)
    model = replace(model, contributors=(Contributor("c", "", twice, Scalar(law), "um"),))
    deviations = np.array([[0.01]])
    for made in (build(model, deviations), compiled_displacements(model).build(deviations)):
        moved = made.world_from_shaft[0, 1, :3, 3] - model.meshes[0].pair.wheel_origin
        assert moved == pytest.approx([0.02, 0.005, 0.0], abs=1e-14)
