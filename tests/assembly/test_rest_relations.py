"""Parts at rest that relations hold before: what these lay stays so, the force moves the rest."""

import numpy as np
import pytest
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, pair, part
from numpy.typing import NDArray

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.model import Assembly, Axis, Fix, Measured, Point, Relation, Rest
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors
from tol3d.errors import InputError

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)
PADS = np.array([[-80.0, -50.0, 0.0], [90.0, -60.0, 0.0], [70.0, 60.0, 0.0], [-90.0, 40.0, 0.0]])
DOWN = -Z


def on_pads(relations: tuple[Relation, ...]) -> Assembly:
    """A plate on pads that stand still, beside a pin that leans; columns: heights, then the pin's ends."""
    columns = Columns()
    base = [feature(f"base.{k}", Point(), frame(p), [columns(Z[:, None])]) for k, p in enumerate(PADS)]
    base.append(feature("base.pin", Axis(40.0, 10.0), frame((30.0, 20.0, 10.0)), [columns(count=4)]))
    base.append(feature("base.far", Point(), frame((-60.0, 10.0, 0.0)), [columns(count=3)]))
    base.append(feature("base.seen", Point(), frame((50.0, 30.0, 20.0))))
    plate = [feature(f"plate.{k}", Point(), frame(p)) for k, p in enumerate(PADS)]
    plate.append(feature("plate.hole", Point(), frame((30.0, 20.0, 0.0)), [columns(count=3)]))
    plate.append(feature("plate.bore", Axis(20.0, 10.0, inner=True), frame((30.0, 20.0, 10.0)), [columns(count=4)]))
    plate.append(feature("plate.far", Point(), frame((-60.0, 10.0, 0.0))))
    plate.append(feature("plate.seen", Point(), frame((50.0, 30.0, 20.0))))
    pairs = tuple(pair(f"plate.{k}", f"base.{k}", Z) for k in range(4))
    move = Rest("rest", "plate", pairs, DOWN, np.array([10.0, -5.0, 0.0]), "fixture", relations)
    measures = {
        name: Measured(GapSpec.reads, ("base.seen", "plate.seen"), axis)
        for name, axis in zip("xyz", np.eye(3), strict=True)
    }
    return assembly(columns, [part("base", base), part("plate", plate)], [Fix("put", "base"), move], measures)


def on_line(point: Array, ends: tuple[Array, Array]) -> float:
    """Distance of a point from a line (mm)."""
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    return float(np.linalg.norm(np.cross(point - ends[0], along)))


def test_a_point_stays_on_a_leaning_pin_while_the_plate_comes_to_lie_on_its_pads() -> None:
    model = on_pads((Relation("coincident", "plate.hole", "base.pin"),))
    rng = np.random.default_rng(1)
    trials = rng.normal(0, 0.1, (40, model.width))
    poses = placing.placed(model, trials)["plate"]
    carried = placing.answers(model, trials, [])[1]["carries:rest"]
    for pose, row, carriers in zip(poses, trials, carried, strict=True):
        pads = PADS + row[:4, None] * Z
        over = (pose[:3, 3] - pads) @ pose[:3, 2]  # of the plate's plane, along its own normal
        assert over.min() > -1e-10
        assert np.abs(over[[int(k) - 1 for k in carriers.split()]]).max() < 1e-10
        assert len(carriers.split()) == 3
        pin = [np.array([30.0 + row[4 + 2 * k], 20.0 + row[5 + 2 * k], z]) for k, z in enumerate((-10.0, 30.0))]
        hole = pose[:3, :3] @ (np.array([30.0, 20.0, 0.0]) + row[11:14]) + pose[:3, 3]
        assert on_line(hole, (pin[0], pin[1])) < 1e-10


def test_a_bore_stays_on_its_pin_while_the_plate_slides_down_to_the_highest_pad() -> None:
    """Coaxial leaves the slide and the turn; one pad carries, for the pin carries the moments. The turn is unseen."""
    model = on_pads((Relation("coaxial", "plate.bore", "base.pin"),))
    trials = np.random.default_rng(2).normal(0, 0.1, (40, model.width))
    poses = placing.placed(model, trials)["plate"]
    carried = placing.answers(model, trials, [])[1]["carries:rest"]
    for pose, row, carriers in zip(poses, trials, carried, strict=True):
        pin = [np.array([30.0 + row[4 + 2 * k], 20.0 + row[5 + 2 * k], z]) for k, z in enumerate((-10.0, 30.0))]
        bore = [np.array([30.0 + row[14 + 2 * k], 20.0 + row[15 + 2 * k], z]) for k, z in enumerate((0.0, 20.0))]
        for end in bore:
            assert on_line(pose[:3, :3] @ end + pose[:3, 3], (pin[0], pin[1])) < 1e-10
        over = (pose[:3, 3] - (PADS + row[:4, None] * Z)) @ pose[:3, 2]
        assert over.min() == pytest.approx(0.0, abs=1e-10)
        assert carriers == str(int(np.argmin(over)) + 1)


@pytest.mark.parametrize(
    "relations",
    [(Relation("coincident", "plate.hole", "base.pin"),), (Relation("coaxial", "plate.bore", "base.pin"),)],
    ids=["point on pin", "bore on pin"],
)
def test_both_methods_differ_by_terms_of_second_order(relations: tuple[Relation, ...]) -> None:
    model = on_pads(relations)
    trials = np.random.default_rng(3).normal(0, 0.1, (60, model.width))
    off = []
    for scale in (1.0, 0.5, 0.25):
        exact = placing.values(model, scale * trials, ["x", "y", "z"])
        linear = torsors.values(model, scale * trials, ["x", "y", "z"])
        off.append(np.max([np.abs(exact[name][0] - linear[name]) for name in "xyz"], axis=0))
    same = [placing.answers(model, scale * trials, [])[1]["carries:rest"] for scale in (1.0, 0.25)]
    assert np.median((off[0] / off[1])[same[0] == same[1]]) == pytest.approx(4.0, rel=0.1)
    assert np.median((off[1] / off[2])[same[0] == same[1]]) == pytest.approx(4.0, rel=0.1)


def test_relations_that_leave_contacts_nothing_are_refused() -> None:
    model = on_pads((Relation("coaxial", "plate.bore", "base.pin"), Relation("coincident", "plate.far", "base.far")))
    with pytest.raises(InputError, match=r"moves\.rest"):
        placing.values(model, np.zeros((1, model.width)), ["x"])
