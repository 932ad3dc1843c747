"""Counterbores, countersinks, slots, tabs and patterns of holes of solids that CadQuery made with known dimensions."""

import math
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from foreign_parts import moved, solid, step_file, turned

from tol3d.cad.step.machined import HolePattern, Machined
from tol3d.cad.step.reading import read_step

CORNERS = ((-30.0, -14.0), (-30.0, 16.0), (34.0, -14.0), (34.0, 16.0))


def machined(made: cq.Workplane, folder: Path, *, askew: bool = True) -> Machined:
    """Features found on a solid, which stands askew and off its origin."""
    shape = solid(made)
    part = read_step(step_file({"part": turned(shape) if askew else shape}, folder / "part.step")).part(None)
    return part.machined


def plate(thickness: float = 12.0) -> cq.Workplane:
    return cq.Workplane().box(90, 60, thickness).faces(">Z").workplane(origin=(0, 0, 0))


def test_counterbored_holes_are_counted_and_measured(tmp_path: Path) -> None:
    """Four ⌀6.6 through 12 mm with ⌀11 × 6.8 from the top, in a grid of 64 × 30; nothing else."""
    found = machined(plate().pushPoints(CORNERS).cboreHole(6.6, 11, 6.8), tmp_path)
    assert [own.kind for own in found.stepped] == ["counterbore"] * 4
    for own in found.stepped:
        assert (2 * own.hole.radius, own.diameter, own.depth, own.angle) == pytest.approx((6.6, 11, 6.8, 0), abs=1e-9)
        np.testing.assert_allclose(own.out, np.subtract(moved((0, 0, 1)), moved((0, 0, 0))), atol=1e-9)
    (grid,) = found.patterns
    assert (grid.layout.kind, len(grid.holes)) == ("grid", 4)
    assert 2 * grid.holes[0].radius == pytest.approx(6.6, abs=1e-9)
    assert sorted(grid.layout.pitches) == pytest.approx([30, 64], abs=1e-9)
    assert found.all == (*found.stepped, grid)
    middle = moved((2.0, 1.0, -6 + 5.2 / 2))
    np.testing.assert_allclose(grid.at, middle, atol=1e-9)


def test_countersunk_holes_are_counted_and_measured(tmp_path: Path) -> None:
    """Three ⌀5 with ⌀10.4 × 82°: (10.4 - 5) / 2 / tan 41° deep, in a row 17 mm apart; a chamfer of a hole is none."""
    made = plate().pushPoints([(-20, 5), (-3, 5), (14, 5)]).cskHole(5, 10.4, 82)
    made = made.faces("<Z").workplane(origin=(0, 0, 0)).pushPoints([(30, -20)]).hole(9)
    made = made.faces("<Z").edges("%CIRCLE").edges(cq.selectors.RadiusNthSelector(-1)).chamfer(0.8)
    found = machined(made, tmp_path)
    assert [own.kind for own in found.stepped] == ["countersink"] * 3
    for own in found.stepped:
        depth = 2.7 / math.tan(math.radians(41))
        sizes = 2 * own.hole.radius, own.diameter, own.depth, math.degrees(own.angle)
        assert sizes == pytest.approx((5, 10.4, depth, 82), abs=1e-8)
    (row,) = found.patterns
    assert (row.layout.kind, row.layout.counts) == ("row", (3,))
    assert row.layout.pitches == pytest.approx((17,), abs=1e-9)


def test_a_groove_between_two_holes_is_no_counterbore(tmp_path: Path) -> None:
    shaft = cq.Workplane().circle(20).extrude(40).faces(">Z").workplane().hole(10)
    groove = cq.Workplane().circle(7).extrude(3).translate((0, 0, 18))
    assert not machined(shaft.cut(groove), tmp_path).stepped
    stepped = machined(shaft.cut(groove).faces("<Z").workplane().cboreHole(10, 16, 4), tmp_path).stepped
    assert [(own.diameter, own.depth) for own in stepped] == [pytest.approx((16, 4), abs=1e-9)]


@pytest.mark.parametrize(("count", "start", "angle"), [(6, 11.0, 360.0), (5, 0.0, 200.0), (3, 40.0, 360.0)])
def test_a_polar_array_is_a_circle_of_holes(count: int, start: float, angle: float, tmp_path: Path) -> None:
    """On ⌀44 about the bore: 6 and 3 at equal angles, 5 over 200°, in a disc that stands off its middle."""
    made = cq.Workplane().circle(40).extrude(9).faces(">Z").workplane().hole(20)
    holes = cq.Workplane().polarArray(22, start, angle, count).circle(2.25).extrude(9)
    made = made.cut(holes).translate((7, -3, 1))
    (circle,) = machined(made, tmp_path).patterns
    assert (circle.layout.kind, circle.layout.counts) == ("circle", (count,))
    assert circle.layout.diameter == pytest.approx(44, abs=1e-8)
    assert circle.layout.equal is (angle == 360.0)
    np.testing.assert_allclose(circle.at, moved((7, -3, 5.5)), atol=1e-8)


def test_two_circles_and_a_row_of_equal_holes_are_parted(tmp_path: Path) -> None:
    """As on a plate for two brackets: 3 and 4 on ⌀30 and ⌀24, a row of 4, and one hole by itself."""
    four = [(22 + 12 * math.cos(0.3 + k * math.pi / 2), 12 * math.sin(0.3 + k * math.pi / 2)) for k in range(4)]
    three = [(-28 + 15 * math.cos(k * 2 * math.pi / 3), 15 * math.sin(k * 2 * math.pi / 3)) for k in range(3)]
    row = [(-38 + 21.0 * k, 26.0) for k in range(4)]
    made = cq.Workplane().box(110, 70, 8).faces(">Z").workplane(origin=(0, 0, 0))
    found = machined(made.pushPoints([*three, *four, *row, (51, -31)]).hole(4), tmp_path).patterns
    told = sorted((own.layout.kind, own.layout.counts, round(sum(own.layout.pitches), 6)) for own in found)
    assert told == [("circle", (3,), 0.0), ("grid", (2, 2), round(24 * math.sqrt(2), 6)), ("row", (4,), 21.0)]
    assert sum(len(own.holes) for own in found) == 11


def test_holes_of_other_size_depth_or_mouth_are_of_no_pattern(tmp_path: Path) -> None:
    made = plate().pushPoints([(-30, 0), (-15, 0)]).hole(5).faces(">Z").workplane(origin=(0, 0, 0))
    made = made.pushPoints([(0, 0)]).hole(5, 7).faces(">Z").workplane(origin=(0, 0, 0))
    made = made.pushPoints([(15, 0)]).cboreHole(5, 9, 4).faces(">Z").workplane(origin=(0, 0, 0))
    assert not machined(made.pushPoints([(30, 0)]).hole(5.2), tmp_path).patterns


@pytest.mark.parametrize(("across", "along"), [(3, 4), (2, 5)])
def test_a_grid_of_holes_has_its_pitches(across: int, along: int, tmp_path: Path) -> None:
    made = cq.Workplane().box(90, 60, 6).faces(">Z").workplane(origin=(0, 0, 0)).rarray(14, 11, along, across).hole(3)
    (grid,) = machined(made, tmp_path).patterns
    assert isinstance(grid, HolePattern)
    assert dict(zip(grid.layout.counts, grid.layout.pitches, strict=True)) == {
        along: pytest.approx(14, abs=1e-9), across: pytest.approx(11, abs=1e-9),
    }  # fmt: skip


def test_tabs_rise_from_a_face_that_goes_on_beyond_them(tmp_path: Path) -> None:
    """A tab 8 × 30 × 5 and a square boss of 12 × 12 × 3 on a plate: one each; a wall on the plate's edge is none."""
    made = cq.Workplane().box(90, 60, 10).translate((0, 0, -5))
    made = made.union(cq.Workplane().box(8, 30, 5).translate((-20, 3, 2.5)))
    made = made.union(cq.Workplane().box(12, 12, 3).translate((20, -7, 1.5)))
    made = made.union(cq.Workplane().box(6, 60, 14).translate((42, 0, 7)))
    found = machined(made, tmp_path).tabs
    sizes = sorted((own.width, own.length, own.height) for own in found)
    assert sizes == [pytest.approx((8, 30, 5), abs=1e-9), pytest.approx((12, 12, 3), abs=1e-9)]


def test_a_plain_block_with_holes_and_rounded_edges_has_none(tmp_path: Path) -> None:
    made = plate().pushPoints([(0, 0), (20, 7)]).hole(6).edges("|Z").fillet(3)
    assert machined(made, tmp_path).all == ()


def test_slots_open_at_one_end_have_one_round_or_flat_one(tmp_path: Path) -> None:
    """A round slot 9 wide from x = 12 to the edge at 45, a notch 7 wide and 20 long, a groove 5 wide across the plate,
    3 deep; a pocket, a step and a slot whose other end is flat are none.
    """
    made = cq.Workplane().box(90, 60, 10)
    made = made.cut(cq.Workplane().circle(4.5).extrude(20).translate((12, 8, -10)))
    made = made.cut(cq.Workplane().box(33, 9, 20).translate((28.5, 8, 0)))
    made = made.cut(cq.Workplane().box(20, 7, 20).translate((-35, -4, 0)))
    made = made.cut(cq.Workplane().box(5, 60, 6).translate((-9, 0, 5)))
    made = made.cut(cq.Workplane().box(12, 8, 4).translate((15, -15, 5)))
    made = made.cut(cq.Workplane().box(9, 90, 6).translate((45, 0, -5)))
    made = made.cut(cq.Workplane().box(11, 6, 20).translate((-32.5, 18, 0)))
    made = made.cut(cq.Workplane().circle(3).extrude(20).translate((-27, 18, -10)))
    found = machined(made, tmp_path).slots
    assert {own.words: tuple(own.middle) for own in found} == {
        "slot 9 wide, 37.5 long, 10 deep, open at one end": pytest.approx(moved((28.5, 8.0, 0.0)), abs=1e-9),
        "slot 7 wide, 20 long, 10 deep, open at one end": pytest.approx(moved((-35.0, -4.0, 0.0)), abs=1e-9),
        "groove 5 wide, 60 long, 3 deep": pytest.approx(moved((-9.0, 0.0, 3.5)), abs=1e-9),
    }


def test_a_pin_stands_in_an_open_slot_within_its_walls_alone(tmp_path: Path) -> None:
    made = cq.Workplane().box(90, 60, 10).cut(cq.Workplane().box(20, 7, 20).translate((-35, -4, 0)))
    (notch,) = machined(made, tmp_path).slots
    up = np.subtract(moved((0.0, 0.0, 1.0)), moved((0.0, 0.0, 0.0)))
    told = [
        notch.holds(np.array(moved(at)), up, radius, 12.0)
        for at, radius in (
            ((-35.0, -4.0, 3.0), 3.4), ((-26.0, -4.0, 3.0), 3.4), ((-35.0, -4.1, 3.0), 3.4), ((-46.0, -4.0, 3.0), 3.4),
            ((-24.0, -4.0, 3.0), 3.4), ((-35.0, -4.0, 12.0), 3.4), ((-35.0, -4.0, 3.0), 3.6), ((-35.0, -4.0, 3.0), 1.7),
        )
    ]  # fmt: skip
    assert told == [True, True, *[False] * 6]
