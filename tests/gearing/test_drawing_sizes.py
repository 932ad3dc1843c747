"""What `tol3d check` says of spans and pins, against gears that are as thick as the limits say."""

import math
from dataclasses import replace

import pytest

from tol3d import check_scene
from tol3d.gearing.effects import ToothThickness
from tol3d.gearing.model import Contributor
from tol3d.gearing.presenting.drawing_sizes import drawing_sizes
from tol3d.gears import InternalGear, SpurGear
from tol3d.gears.tooth_measures import pins_of, span_of
from tol3d.report.page import Shown, Table


def _thickens(contributor: Contributor, part: str) -> bool:
    return isinstance(contributor.effect, ToothThickness) and contributor.effect.part == part


@pytest.mark.parametrize("scene", ["spur_pair", "internal_pair"])
def test_check_prints_sizes_nominal_and_at_the_limits(scene: str) -> None:
    model = check_scene(scene).model
    (table,) = (own for own in drawing_sizes(model) if isinstance(own, Table))
    rows = iter(table.rows)
    for part in model.gears:
        gear = part.gear
        assert isinstance(gear, SpurGear | InternalGear)
        (law,) = (own for own in model.contributors if _thickens(own, part.name))
        assert isinstance(law.effect, ToothThickness)
        counted = 1.0 if scene == "spur_pair" else law.effect.turn * 2 * gear.reference_radius
        ends = [0.0, law.distribution.low * counted, law.distribution.high * counted]
        gears = [replace(gear, tooth_thickness_deviation=gear.tooth_thickness_deviation + own) for own in ends]
        span, pins = span_of(gear), pins_of(gear)
        assert span
        assert pins
        for expected in (lambda g: g.tooth_thickness, span.size, pins.size):
            cells = [own for own in next(rows).cells if isinstance(own, Shown)]
            assert [own.value for own in cells] == pytest.approx([expected(own) for own in gears], abs=1e-9)
            assert [str(own) for own in cells] == [f"{expected(own):.4f}" for own in gears]
        cosine = math.cos(gear.pressure_angle) * (-1 if isinstance(gear, InternalGear) else 1)
        assert span.size(gears[1]) - span.size(gears[0]) == pytest.approx(ends[1] * cosine, abs=1e-12)
    assert next(rows, None) is None


def test_bevel_gears_have_their_arc_alone() -> None:
    (table,) = (own for own in drawing_sizes(check_scene("bevel_pair").model) if isinstance(own, Table))
    assert [row.cells[0] for row in table.rows] == ["arc, mean section"] * 2
