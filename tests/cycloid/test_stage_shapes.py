"""An RV reducer of shapes: walls, and solids that stand clear of each other where they are placed."""

import math
from dataclasses import fields, replace
from itertools import combinations
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from OCP.BRepExtrema import BRepExtrema_DistShapeShape

from tol3d.cad.solids import PosedPart, export_step
from tol3d.cad.solids.cad import solid_of
from tol3d.errors import GeometryError
from tol3d.gearing.cycloid.exact.contact import ContactStage
from tol3d.gearing.cycloid.exact.places import StagePlaces, StageShapes, usual_shapes
from tol3d.gearing.cycloid.model.limits import circle_fault, hole_faults, largest_hole, lobe_reach
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification
from tol3d.gearing.cycloid.model.shapes import CrankSection, Crankshaft, DiscHoles
from tol3d.gearing.cycloid.model.shapes_cad import carrier_of, crank, ring
from tol3d.gearing.cycloid.model.stage import Deviated
from tol3d.gears import SpurGear

CLEAR = 0.02  # mm, all round the lobes
RV_250 = DiscProfile(
    pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2, modification=Modification(offset=CLEAR)
)
TWENTY = math.radians(20)


def stage(profile: DiscProfile = RV_250, discs: int = 2) -> ContactStage:
    return ContactStage(profile, discs, 3, 63.0, 1.5, 0.7)


def reducer(discs: int = 2) -> StageShapes:
    sun, planet = (
        SpurGear(teeth, 2.0, TWENTY, 20.0, bore=bore, tooth_thickness_deviation=-0.05)
        for teeth, bore in ((21, 20.0), (42, 24.0))
    )
    return usual_shapes(stage(discs=discs), 20.0, first=(sun, planet))


def nominal(crank_angle: float, discs: int = 2) -> tuple[PosedPart, ...]:
    return reducer(discs).placed(StagePlaces.nominal(stage(discs=discs), crank_angle))


def solids(parts: tuple[PosedPart, ...], *names: str) -> list[cq.Solid]:
    found = {part.name: part for part in parts}
    return [placed(found[name]) for name in names]


def placed(part: PosedPart) -> cq.Solid:
    pose = part.world_from_part
    angle = math.degrees(math.atan2(pose[1, 0], pose[0, 0]))
    return solid_of(part.shape).solid.moved(cq.Location(tuple(pose[:3, 3].tolist()), (0, 0, 1), angle))


def apart(one: cq.Solid, other: cq.Solid) -> float:
    return float(BRepExtrema_DistShapeShape(one.wrapped, other.wrapped).Value())


def boxes_meet(one: cq.Solid, other: cq.Solid) -> bool:
    a, b = one.BoundingBox(), other.BoundingBox()
    lows = np.maximum([a.xmin, a.ymin, a.zmin], [b.xmin, b.ymin, b.zmin])
    return bool((lows < np.minimum([a.xmax, a.ymax, a.zmax], [b.xmax, b.ymax, b.zmax])).all())


@pytest.mark.parametrize(("disc", "pin"), [("disc 1", 1), ("disc 2", 14)])
def test_discs_stand_off_their_pins_by_the_offset_of_their_grinding(disc: str, pin: int) -> None:
    """Both mesh, though their eccentrics point apart: the upper one is clocked by half a lobe pitch."""
    lobed, round_pin = solids(nominal(0.7), disc, f"pin {pin}")
    assert apart(lobed, round_pin) == pytest.approx(CLEAR, abs=1e-6)


@pytest.mark.slow
def test_cranks_stand_in_the_middle_of_their_holes() -> None:
    """Rollers, which are not drawn, take 0.3 of a hole's diameter; nearest is the other eccentric, across the gap."""
    parts, shapes = nominal(2.1), reducer()
    hole = shapes.discs[0].holes.crank_diameter
    for disc, number in (("disc 1", 2), ("disc 2", 3)):
        assert apart(*solids(parts, disc, f"crank {number}")) == pytest.approx(
            math.hypot(0.15 * hole - 2 * 2.2, 2.0), abs=1e-6
        )


@pytest.mark.slow
def test_three_discs_mesh_with_their_eccentrics_a_third_of_a_turn_apart() -> None:
    parts = nominal(0.7, discs=3)
    for disc, pin in (("disc 1", 5), ("disc 2", 12), ("disc 3", 31)):
        assert apart(*solids(parts, disc, f"pin {pin}")) == pytest.approx(CLEAR, abs=1e-6)
    assert apart(*solids(parts, "disc 2", "crank 2")) > 1.0


@pytest.mark.slow
@pytest.mark.parametrize(("sense", "seed"), [(1, 1), (-1, 2)])
def test_solids_of_a_trial_touch_where_the_exact_contact_says(sense: int, seed: int) -> None:
    """All but the errors of lobes, which no solid has; the solid leaves the profile by 0.001 um."""
    rng = np.random.default_rng(seed)
    nothing = Deviated.nothing(1, 40, 2, 3)
    lobes = ("lobe_pitch", "lobe_profile")
    errors = {
        field.name: 0.004 * rng.standard_normal(getattr(nothing, field.name).shape)
        for field in fields(nothing)
        if field.name not in (*lobes, "crank_phases")
    }
    deviated = replace(nothing, **errors, crank_phases=5e-5 * rng.standard_normal((1, 3)))
    phi = float(rng.uniform(0.0, 200.0))
    found = stage().touches(deviated, np.array([[phi]]), (float(sense),))
    disc, pin = divmod(int(found.places[0, 0, 0]), 40)
    parts = reducer().placed(StagePlaces(stage(), deviated, phi, float(found.turns[0, 0, 0])))
    touching = [f"disc {disc + 1}", f"pin {pin + 1}"]
    assert apart(*solids(parts, *touching)) == pytest.approx(0.0, abs=2e-6)
    # a second of arc further back there is a gap of lever times that
    back = StagePlaces(stage(), deviated, phi, float(found.turns[0, 0, 0]) - sense * 4.8481e-6)
    assert 0.7 * 85.8 < apart(*solids(reducer().placed(back), *touching)) / 4.8481e-6 < 85.8 * 1.05
    for other in (disc, 1 - disc):
        for number in (pin - 1, (pin + 2) % 40):
            assert apart(*solids(parts, f"disc {other + 1}", f"pin {number % 40 + 1}")) > 1e-5


@pytest.mark.slow
def test_posts_pass_their_windows_however_the_cranks_stand() -> None:
    """A post stands off its window by the room about it, and by twice the eccentricity more on the far side."""
    for angle in (0.0, 1.3):
        disc, carrier = solids(nominal(angle), "disc 1", "carrier")
        assert apart(disc, carrier) == pytest.approx(0.02 * 63.0, abs=1e-6)


def test_parts_stand_in_the_world_as_crank_and_lobes_say() -> None:
    parts = {part.name: part.world_from_part for part in nominal(0.6)}
    assert parts["disc 1"][:2, 3] == pytest.approx([2.2 * math.cos(0.6), 2.2 * math.sin(0.6)])
    assert parts["disc 2"][:2, 3] == pytest.approx(-parts["disc 1"][:2, 3])
    assert parts["disc 1"][2, 3] == -parts["disc 2"][2, 3] == -11.0
    for name in ("disc 1", "disc 2", "carrier"):
        assert math.atan2(parts[name][1, 0], parts[name][0, 0]) == pytest.approx(-0.6 / 39)
    assert len(parts) == 1 + 40 + 2 + 1 + 3 + 1 + 3


@pytest.mark.parametrize("bore", [0.0, 24.0])
def test_planets_stand_above_the_carrier_and_share_no_plane_with_their_cranks(bore: float) -> None:
    """The outer face of the flange is at 21 + 2 + 16 mm and a gap of 2 mm above it; the sun is 4 mm wider."""
    sun, planet = SpurGear(21, 2.0, TWENTY, 24.0), SpurGear(42, 2.0, TWENTY, 20.0, bore=bore)
    shapes = usual_shapes(stage(), 20.0, first=(sun, planet))
    parts = {part.name: part.world_from_part for part in shapes.placed(StagePlaces.nominal(stage(), 0.6))}
    assert parts["sun"][2, 3] == parts["planet 1"][2, 3] == pytest.approx(21 + 2 + 16 + 2 + 12)
    top = shapes.crank.start + sum(part.length for part in shapes.crank.sections)
    assert top == pytest.approx(43.0 if bore == 0.0 else 63.0 - 0.6)
    assert shapes.crank.start == pytest.approx(-39.0 + 0.6)


@pytest.mark.slow
def test_nominal_parts_overlap_nowhere() -> None:
    """Parts whose boxes meet are checked; ring, pins and first stage apart."""
    parts = [part for part in nominal(0.4) if "pin " not in part.name]
    made = {part.name: placed(part) for part in parts}
    seconds = {"sun", "planet 1", "planet 2", "planet 3", "pin ring"}
    for one, other in combinations(made, 2):
        if not {one, other} & seconds and boxes_meet(made[one], made[other]):
            assert apart(made[one], made[other]) > 0.01, (one, other)


@pytest.mark.slow
@pytest.mark.parametrize("planet", ["planet 1", "planet 3"])
def test_planets_mesh_with_the_sun_wherever_the_cranks_stand(planet: str) -> None:
    """Thinned by 0.05 mm each, teeth in the middle of their backlash stand off by 0.05 cos(20 deg) mm."""
    sun, round_one = solids(nominal(1.9), "sun", planet)
    assert apart(sun, round_one) == pytest.approx(0.05 * math.cos(TWENTY), abs=1e-4)


@pytest.mark.slow
def test_pins_fill_their_holes_and_lobes_keep_off_the_ring() -> None:
    parts = nominal(0.4)
    housing, pin, disc = solids(parts, "pin ring", "pin 3", "disc 1")
    assert housing.intersect(pin).Volume() == pytest.approx(0.0, abs=1e-9)
    assert apart(housing, disc) > 0.5


@pytest.mark.slow
def test_the_reducer_is_exported_whole(tmp_path: Path) -> None:
    left_out = ("disc 2", "sun", "planet", "pin 1", "pin 2", "pin 3")
    parts = tuple(part for part in nominal(0.3) if not part.name.startswith(left_out))
    export_step(parts, tmp_path / "rv.step")
    read = [
        solid
        for solid in cq.importers.importStep(str(tmp_path / "rv.step")).solids().vals()
        if isinstance(solid, cq.Solid)
    ]
    assert len(read) == len(parts)
    assert sum(solid.Volume() for solid in read) == pytest.approx(
        sum(solid_of(part.shape).solid.Volume() for part in parts), rel=1e-6
    )


# single parts ---------------------------------------------------------------------------------------


def test_the_ring_is_a_tube_less_the_outer_parts_of_its_pin_holes() -> None:
    """The part of each hole outside the bore: the disc less the lens of two circles."""
    shape = reducer().ring
    bore, hole, circle = shape.bore_radius, shape.pin_radius, shape.pin_circle_radius
    part = ring(shape)
    assert bore == circle  # half of each pin is held
    half = 2 * math.asin(hole / (2 * circle))
    other = 2 * math.acos(hole / (2 * circle))
    lens = (bore**2 * (2 * half - math.sin(2 * half)) + hole**2 * (other - math.sin(other))) / 2
    section = math.pi * (shape.outer_radius**2 - bore**2) - 40 * (math.pi * hole**2 - lens)
    assert part.solid.isValid()
    assert part.solid.Volume() == pytest.approx(section * shape.width, rel=1e-9)
    assert len(part.faces) == 40 + 40 + 3
    for pin in (0, 11):
        azimuth = 2 * math.pi * pin / 40
        x, y, _ = part.faces[f"pin {pin + 1} hole"].Center().toTuple()
        assert math.atan2(y, x) == pytest.approx(azimuth, abs=1e-9)


def test_a_crankshaft_has_its_eccentrics_beside_its_axis() -> None:
    sections = (CrankSection(20.0, 30.0), CrankSection(36.0, 15.0, 2.0), CrankSection(36.0, 15.0, 2.0, math.pi))
    part = crank(Crankshaft(sections, -10.0))
    volume = math.pi * (10.0**2 * 30 + 18.0**2 * 30)
    assert part.solid.Volume() == pytest.approx(volume, rel=1e-9)
    assert part.faces["section 2"].Center().toTuple() == pytest.approx((2.0, 0.0, 27.5), abs=1e-6)
    assert part.faces["section 3"].Center().toTuple() == pytest.approx((-2.0, 0.0, 42.5), abs=1e-6)
    assert set(part.faces.values()) == set(part.solid.Faces())


def test_sections_that_do_not_touch_are_refused() -> None:
    with pytest.raises(GeometryError, match="do not touch"):
        crank(Crankshaft((CrankSection(4.0, 5.0), CrankSection(4.0, 5.0, 4.5)), 0.0))


# limits ---------------------------------------------------------------------------------------------


def test_the_usual_shapes_have_no_fault() -> None:
    shapes = reducer()
    assert not list(hole_faults(RV_250, shapes.discs[0].holes))
    assert 0.0 < shapes.carrier.post_diameter < shapes.discs[0].holes.window_diameter - 2 * 2.2  # it goes round by 2.2
    assert lobe_reach(RV_250) < shapes.ring.bore_radius < 114.5 + 5.0


@pytest.mark.parametrize(
    ("changed", "field", "words"),
    [
        ({"crank_diameter": 90.0, "bore_diameter": 0.0, "window_diameter": 0.0}, "crank_diameter", "the lobes' roots"),
        ({"crank_diameter": 56.0, "bore_diameter": 69.0}, "crank_diameter", "the bore"),
        ({"window_diameter": 76.0, "bore_diameter": 0.0}, "window_diameter", "crank holes beside it"),
        ({"cranks": 8, "window_diameter": 0.0, "bore_diameter": 0.0}, "crank_diameter", "the next one"),
    ],
)
def test_holes_without_a_wall_are_refused_with_the_largest_that_leave_one(
    changed: dict[str, float], field: str, words: str
) -> None:
    values = {"circle_radius": 63.0, "crank_diameter": 50.0, "window_diameter": 48.0, "bore_diameter": 60.0} | changed
    cranks = int(values.pop("cranks", 3))
    holes = DiscHoles(cranks, **values)
    (fault,) = list(hole_faults(RV_250, holes))
    assert fault.field == field
    assert words in fault.words
    most = float(fault.words.split("at most ")[1].split(" mm")[0])
    assert not list(hole_faults(RV_250, DiscHoles(cranks, **(values | {field: most}))))
    assert list(hole_faults(RV_250, DiscHoles(cranks, **(values | {field: most + 0.002}))))


def test_lobes_reach_the_tip_circle_and_the_eccentricity() -> None:
    """Over all crank angles, no lobe's point lies further out, and one does as far."""
    points = RV_250.points(np.linspace(0.0, 2 * math.pi, 39 * 64 + 1)) @ [1.0, 1.0j]
    turns = np.exp(1j * np.linspace(0.0, 2 * math.pi, 401))
    furthest = max(float(np.abs(points + 2.2 * turn).max()) for turn in turns)
    assert lobe_reach(RV_250) == pytest.approx(furthest, abs=2e-3)


@settings(max_examples=100, deadline=None)
@given(
    st.integers(5, 60), st.floats(0.4, 0.85), st.integers(2, 8), st.integers(1, 4), st.floats(0.02, 0.98), st.booleans()
)
def test_whatever_goes_through_the_discs_is_drawn_with_walls_about_it(
    pins: int, shortening: float, cranks: int, discs: int, place: float, stated: bool
) -> None:
    """All circles of crankshafts that are not refused, and the smallest holes that are not."""
    bare = DiscProfile(pins, 100.0, 0.1, shortening * 100.0 / pins)
    profile = replace(bare, pin_radius=0.8 * min(bare.smallest_convex_radius, 100.0 * math.sin(math.pi / pins)))
    circle, eccentricity = place * profile.root_radius, profile.eccentricity
    assume(circle_fault(profile, cranks, circle) is None)
    hole = 2 * eccentricity + 1e-3 if stated else None
    shapes = usual_shapes(ContactStage(profile, discs, cranks, circle, 1.5, 0.7), crank_hole=hole)
    holes, carrier = shapes.discs[0].holes, shapes.carrier
    for diameter in (holes.crank_diameter, holes.window_diameter):
        assert circle + diameter / 2 < profile.root_radius
        assert circle - diameter / 2 > holes.bore_diameter / 2
    beside = 2 * circle * math.sin(math.pi / (2 * cranks))
    assert beside > (holes.crank_diameter + holes.window_diameter) / 2
    assert min(section.diameter for section in shapes.crank.sections) > 0.0
    eccentric = shapes.crank.sections[1]
    assert eccentric.diameter / 2 > eccentricity + shapes.crank.sections[0].diameter / 2  # round the journal
    assert holes.crank_diameter > eccentric.diameter
    if holes.window_diameter:
        assert 0.0 < carrier.post_diameter < holes.window_diameter - 2 * eccentricity
    assert carrier.post_diameter >= 0.0
    assert beside > (carrier.hole_diameter + carrier.post_diameter) / 2
    assert carrier.hole_diameter > shapes.crank.sections[0].diameter


def test_a_circle_on_which_holes_meet_or_reach_the_roots_is_refused_with_one_that_does() -> None:
    for circle, sign in ((3.0, 1), (106.0, -1)):
        fault = circle_fault(RV_250, 3, circle)
        assert fault is not None
        limit = float(fault.words.split(" mm")[0].split()[-1])
        assert circle_fault(RV_250, 3, limit - sign * 1e-3) is not None
        assert circle_fault(RV_250, 3, limit + sign * 1e-3) is None
        assert largest_hole(RV_250, 3, limit) == pytest.approx(2 * RV_250.eccentricity, abs=1e-3)
    fault = circle_fault(DiscProfile(4, 40.0, 5.0, 8.0), 8, 12.0)
    assert fault is not None
    assert fault.field == "cranks"


def test_a_carrier_without_room_for_posts_is_its_lower_flange() -> None:
    shapes = usual_shapes(ContactStage(RV_250, 2, 8, 14.0, 1.5, 0.7), 20.0)
    assert shapes.carrier.post_diameter == 0.0
    made = carrier_of(shapes.carrier)
    assert made.solid.isValid()
    assert {name.split()[0] for name in made.faces} == {"lower"}
    ends = made.solid.BoundingBox()
    assert (ends.zmin, ends.zmax) == pytest.approx(
        (-shapes.carrier.between / 2 - shapes.carrier.flange_width, -shapes.carrier.between / 2), abs=1e-5
    )
