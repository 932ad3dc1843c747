"""A plain system: units by what a tolerance and a measure are of, deviations by kind, methods as functions."""

from typing import ClassVar, Literal

import numpy as np
import pytest

from tol3d.scene import Grammar, Scene
from tol3d.scene.bases import AngleLimit, MeasureSpec, MoveSpec, PartSpec, ToleranceSpec
from tol3d.scene.entry import Reference
from tol3d.study.system.draw import Planar
from tol3d.study.system.mechanism import Mechanism
from tol3d.study.system.plain import LengthSpec, PlainSystem, contributors_of, measures_of
from tol3d.study.system.stated import nominal_build, stated
from tol3d.units import Dimension


class _Nameless:
    def references(self) -> tuple[Reference, ...]:
        return ()


class BlockSpec(PartSpec):
    kind: Literal["block"]


class ShiftSpec(_Nameless, ToleranceSpec):
    kind: Literal["shift"]


class TiltSpec(_Nameless, ToleranceSpec):
    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)
    kind: Literal["tilt"]


class WarmthSpec(_Nameless, ToleranceSpec):
    dimensions: ClassVar[tuple[Dimension, ...]] = ("temperature",)
    kind: Literal["warmth"]


class PutSpec(_Nameless, MoveSpec):
    kind: Literal["put"]


class HeightSpec(_Nameless, LengthSpec):
    kind: Literal["height"]


class SlopeSpec(_Nameless, MeasureSpec):
    dimension: ClassVar[Dimension] = "angle"
    gives_curve: ClassVar[bool] = False
    several_positions: ClassVar[bool] = False
    kind: Literal["slope"]
    lower_limit: AngleLimit | None = None
    upper_limit: AngleLimit | None = None


BLOCKS = Mechanism(
    "blocks", (BlockSpec,), (ShiftSpec, TiltSpec, WarmthSpec), (PutSpec,), (HeightSpec, SlopeSpec), system="none:none"
)
ENTRIES = {
    "scene": "a block",
    "parts": {"block": {"kind": "block"}},
    "tolerances": {
        "shift": {"kind": "shift", "distribution": {"kind": "rayleigh", "scale": "2 um"}},
        "first tilt": {"kind": "tilt", "distribution": {"kind": "constant", "value": "3 arcmin"}},
        "second tilt": {"kind": "tilt", "distribution": {"kind": "constant", "value": "1 deg"}, "description": "mine"},
    },
    "moves": {"put": {"kind": "put"}},
    "measures": {
        "height": {"kind": "height", "of": "put", "lower_limit": "5 um"},
        "slope": {"kind": "slope", "of": "put", "upper_limit": "2 arcmin"},
    },
}


@pytest.fixture
def scene() -> Scene:
    made: Scene = Grammar((BLOCKS,)).scene.model_validate(ENTRIES)
    return made


@pytest.fixture
def system(scene: Scene) -> PlainSystem:
    return PlainSystem(
        "a block", contributors_of(scene, {ShiftSpec: lambda law, tolerance: Planar(law, None)}), measures_of(scene)
    )


def test_columns_are_in_the_units_of_what_tolerances_are_of(system: PlainSystem) -> None:
    assert [own.columns for own in system.contributors] == [
        ("shift.x [um]", "shift.y [um]"),
        ("first tilt [arcmin]",),
        ("second tilt [arcmin]",),
    ]
    shift, _, tilt = system.contributors
    assert shift.per_unit == 1e-3  # mm
    assert tilt.distribution.mean / tilt.per_unit == pytest.approx(60.0)  # a degree
    assert tilt.description == "mine"


def test_limits_are_internal_and_a_measure_s_unit_is_that_of_its_dimension(system: PlainSystem) -> None:
    height, slope = system.measures
    assert (height.lower_limit, height.upper_limit, height.unit) == (0.005, None, "um")
    assert (slope.lower_limit, slope.unit) == (None, "arcmin")
    assert slope.upper_limit is not None
    assert slope.upper_limit * slope.per_internal == pytest.approx(2.0)


def test_deviations_of_a_kind_add_up_and_are_0_where_there_is_none(system: PlainSystem) -> None:
    height, _ = system.measures
    trials = stated(system, np.array([[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 9.0]]))
    assert system.deviations(trials, "shift").tolist() == [[1.0, 2.0], [5.0, 6.0]]
    assert system.deviations(trials, "tilt").tolist() == [[7.0], [16.0]]
    assert system.deviations(trials, "warmth").tolist() == [[0.0], [0.0]]
    assert system.deviations(trials, "warmth", height, 3).tolist() == [[0.0] * 3] * 2
    assert len(nominal_build(system)) == 1


def test_methods_are_its_two_functions() -> None:
    class Sums(PlainSystem):
        def analytic(self, trials, measure):  # type: ignore[no-untyped-def]
            return trials.deviations.sum(axis=1)

        def exact(self, trials, measure):  # type: ignore[no-untyped-def]
            return np.hypot(*trials.deviations[:, :2].T)

    made: Scene = Grammar((BLOCKS,)).scene.model_validate(ENTRIES)
    sums = Sums("sums", contributors_of(made, {ShiftSpec: lambda law, tolerance: Planar(law, None)}), measures_of(made))
    trials = stated(sums, np.array([[3.0, 4.0, 0.0, 1.0]]))
    found = {name: sums.method(name, sums.materials(name)).answers(trials, sums.measures) for name in sums.methods}
    assert {name: answers.values["height"].tolist() for name, answers in found.items()} == {
        "analytic": [[8.0]],
        "exact": [[5.0]],
    }
