"""Both methods on the same assemblies: what the analytic method leaves out is of second order in the deviations."""

import numpy as np
import pytest
from assembly.drafts import Draft, Vector, displacement, frame, turned
from numpy.typing import NDArray

from tol3d.assembly.grammar.measures.gap import AngleSpec, DistanceSpec, GapSpec, PointPlaneSpec
from tol3d.assembly.grammar.measures.inspected import (
    InspectedFlatnessSpec,
    InspectedOrientationSpec,
    InspectedPositionSpec,
)
from tol3d.assembly.model import (
    Assembly,
    Axis,
    BestFit,
    Datum,
    Fit,
    Fix,
    Locate,
    Mate,
    Measured,
    Pair,
    Plane,
    Point,
    Relation,
    RoundPlane,
    Shape,
    Weld,
)
from tol3d.assembly.model.datum_frame import Simulator
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)
NEST = [((20, 15, 0), Z), ((180, 15, 0), Z), ((100, 90, 0), Z), ((30, 0, 25), Y), ((170, 0, 25), Y), ((0, 50, 20), X)]


def leaves_out(assembly: Assembly, name: str, deviations: Array) -> Array:
    """Largest amount by which the methods differ, at the deviations and at a tenth of them."""
    found = []
    for factor in (1.0, 0.1):
        exact, codes = placing.values(assembly, factor * deviations, [name])[name]
        assert (codes == OK).all()
        found.append(float(np.abs(torsors.values(assembly, factor * deviations, [name])[name] - exact).max()))
    return np.array(found)


def of_second_order(assembly: Assembly, deviations: Array, rounding: float = 1e-11) -> None:
    """A tenth of the deviations leaves a hundredth, within what the third order makes of it, or rounding."""
    for name in assembly.measures:
        whole, tenth = leaves_out(assembly, name, deviations)
        assert whole < 1e-2, name  # mm: some 0.05 mm squared over 50 mm, by levers of up to 10, squared
        assert tenth < 1.3e-2 * whole + rounding, name


def part_with_datums(draft: Draft, name: str, simulator: Simulator) -> str:
    """A block whose three faces, two bores and what is toleranced to them deviate; the name of its frame A|B|C."""
    shapes: dict[str, tuple[Array, Shape]] = {
        "a": (frame((100, 50, 0), -Z), Plane((200, 100))),
        "b": (frame((100, 0, 20), (0.05, -1, 0)), Plane((160, 30))),
        "c": (frame((0, 50, 20), -X, Y), Plane((60, 30))),
        "disc": (frame((60, 60, 40), Z), RoundPlane(30.0)),
        "bore 1": (frame((40, 40, 20), Z), Axis(40.0, 10.0)),
        "bore 2": (frame((160, 45, 20), Z), Axis(40.0, 10.0)),
    }
    for feature, (at, shape) in shapes.items():
        draft.feature(f"{name}.{feature}", at, shape)
    targets = {"a": [[-80, -30, 0], [80, -20, 0], [0, 40, 0]], "b": [[-60, 5, 0], [60, -5, 0]], "c": [[10, 0, 0]]}
    datums = [Datum((f"{name}.{k}",), simulator, np.array(targets[k], float)) for k in "abc"]
    return draft.datum_frame(name, *datums)


@pytest.mark.parametrize("simulator", ["contact", "fitted", "targets"])
def test_datum_frames_and_what_is_toleranced_to_them(simulator: Simulator) -> None:
    draft = Draft()
    draft.part("part", turned((0.2, -0.5, 1.0), (50, 60, 70)))
    main = part_with_datums(draft, "part", simulator)
    bores, point = [Datum((f"part.bore {k}",)) for k in (1, 2)], np.zeros((1, 3))
    frames = {
        "": "",
        "A|B|C": main,
        "A|1|2": draft.datum_frame("part", Datum(("part.a",)), *bores),
        "A|1-2": draft.datum_frame("part", Datum(("part.a",)), Datum(("part.bore 1", "part.bore 2"))),
        "1|2": draft.datum_frame("part", *bores),
        "1-2|A": draft.datum_frame("part", Datum(("part.bore 1", "part.bore 2")), Datum(("part.a",), simulator, point)),
        "disc|B": draft.datum_frame("part", Datum(("part.disc",)), Datum(("part.b",), "fitted")),
        "1|disc": draft.datum_frame("part", bores[0], Datum(("part.disc",), "contact")),
    }
    draft.feature("part.zero", (0, 0, 0), deviates=False)
    measures: dict[str, Measured] = {}
    for name, parent in frames.items():
        draft.feature(f"part.point {name}", frame((150, 80, 60), (1, 2, 3)), Point(), parent)
        draft.feature(f"part.axis {name}", frame((50, 80, 60), (1, 0, 3)), Axis(30.0), parent)
        draft.feature(f"part.face {name}", frame((50, 80, 60), (1, 0, 3)), Plane((30.0, 20.0)), main)
        draft.feature(f"part.round {name}", frame((50, 80, 60), (1, 0, 3)), RoundPlane(20.0), main)
        for axis, along in zip("xyz", np.eye(3), strict=True):
            measures[f"{name} {axis}"] = displacement(f"part.point {name}", along, "part.zero")
        for feature in ("point", "axis", "face", "round"):
            measures[f"{name} {feature}"] = Measured(
                InspectedPositionSpec.reads, (f"part.{feature} {name}",), frame=main
            )
            measures[f"{name} {feature} in it"] = Measured(
                InspectedPositionSpec.reads, (f"part.{feature} {name}",), frame=parent
            )
        for feature in ("axis", "face", "round"):
            measures[f"{name} tilt of {feature}"] = Measured(
                InspectedOrientationSpec.reads, (f"part.{feature} {name}",), frame=parent
            )
    assembly = draft.assembly((Fix("fix", "part"),), measures)
    of_second_order(assembly, np.random.default_rng(1).normal(size=(40, assembly.width)) * 0.01)


def nested(points_on: str) -> Assembly:
    """A lid on a base by six contacts, a cover mated to the lid, the two welded and placed again on the base."""
    rng = np.random.default_rng(2)
    draft = Draft()
    for name in ("base", "lid", "cover"):
        draft.part(name, turned(rng.normal(size=3), 50.0 * rng.normal(size=3)))

    def at(part: str, point: Vector, z: Vector) -> Array:
        return np.asarray(np.linalg.inv(draft.poses[part]) @ frame(point, z))

    def contacts(round_: str, moving: str) -> tuple[Pair, ...]:
        pairs = []
        for k, (beside, along) in enumerate(NEST):
            normal, point = along + 0.1 * rng.normal(size=3), beside + 5.0 * rng.normal(size=3)
            normal /= np.linalg.norm(normal)
            other = point + np.cross(normal, rng.normal(size=3)) * 10.0
            own = draft.feature(f"{moving}.{round_}{k}", at(moving, point, normal))
            target = draft.feature(f"base.{round_}{k}", at("base", other, normal))
            side = draft.poses["base" if points_on == "part" else "lid"]
            pairs.append(Pair(own, target, normal @ side[:3, :3], (draft.contribution(f"locator {round_}{k}", [""]),)))
        return tuple(pairs)

    first, again = contacts("first", "lid"), contacts("again", "cover")
    draft.feature("lid.top", at("lid", (80, 40, 60), Z), Plane((100, 60)))
    draft.feature("cover.bottom", at("cover", (70, 30, 60), -Z), Plane((100, 60)))
    for k, x in enumerate((30, 130)):
        draft.feature(f"lid.bore {k}", at("lid", (x, 40, 55), Z), Axis(20.0, 8.0))
        draft.feature(f"cover.pin {k}", at("cover", (x, 40, 58), Z), Axis(15.0, 8.0))
    relations = (
        Relation("coincident", "cover.bottom", "lid.top"),
        Relation("coaxial", "cover.pin 0", "lid.bore 0"),
        Relation("coaxial", "cover.pin 1", "lid.bore 1"),
    )
    moves = (
        Fix("fix", "base"),
        Locate("first", "lid", first, "part" if points_on == "part" else "fixture"),
        Mate("mate", "cover", relations),
        Weld("weld", "lid", ("cover",)),
        Locate("again", "lid", again, "part" if points_on == "part" else "fixture"),
    )
    for part, point in (("base", (-20, 30, 80)), ("cover", (90, 20, 90)), ("lid", (150, 90, 30))):
        draft.feature(f"{part}.point", at(part, point, (1, 2, 1)))
        draft.feature(f"{part}.axis", at(part, point, (1, -2, 1)), Axis(30.0))
        draft.feature(f"{part}.face", at(part, point, (0.4, 0.2, 1)), Plane((30.0, 40.0)))
    along = np.array([2.0, -1.0, 2.0]) / 3.0
    measures: dict[str, Measured] = {}
    for after in (1, 2, 4):
        for part in ("lid", "cover"):
            if (after, part) != (1, "cover"):
                measures |= {
                    f"{part} {after} gap": Measured(GapSpec.reads, ("base.point", f"{part}.point"), along, after=after),
                    f"{part} {after} back": Measured(GapSpec.reads, (f"{part}.axis", "base.face"), along, after=after),
                    f"{part} {after} distance": Measured(
                        DistanceSpec.reads, ("base.point", f"{part}.axis"), after=after
                    ),
                    f"{part} {after} plane": Measured(
                        PointPlaneSpec.reads, ("base.point", f"{part}.face"), after=after
                    ),
                    f"{part} {after} angle": Measured(AngleSpec.reads, ("base.axis", f"{part}.face"), after=after),
                    f"{part} {after} sign": Measured(
                        AngleSpec.reads, ("base.axis", f"{part}.axis"), along, after=after
                    ),
                    f"{part} {after} parallel": Measured(
                        AngleSpec.reads, ("lid.top", f"{part}.axis"), along, after=after
                    ),
                }
    return draft.assembly(moves, measures)


@pytest.mark.parametrize("points_on", ["part", "fixture"])
def test_locators_mates_and_welded_bodies(points_on: str) -> None:
    assembly = nested(points_on)
    of_second_order(assembly, np.random.default_rng(3).normal(size=(40, assembly.width)) * 0.01)


@pytest.mark.parametrize("points_on", ["part", "fixture"])
def test_slopes_are_central_differences_of_the_exact_method(points_on: str) -> None:
    """Steps of 0.01 mm leave (0.01 / 50)^2 of a slope, and 1e-12 mm of rounding over the step."""
    assembly = nested(points_on)
    step, width = 0.01, assembly.width
    names = list(assembly.measures)
    sides = [placing.values(assembly, sign * step * np.eye(width), names) for sign in (1.0, -1.0)]
    for name in names:
        found = torsors.slopes(assembly, name, *np.zeros((2, width))).coefficients
        central = (sides[0][name][0] - sides[1][name][0]) / (2.0 * step)
        np.testing.assert_allclose(found, central, atol=1e-6 * max(1.0, float(np.abs(found).max())), err_msg=name)


def test_tangent_cylinders() -> None:
    """A shaft in a V, tilted in the world, its face on an end; it turns about itself no more than these ask."""
    half = np.radians(35.0)
    draft = Draft()
    pose = turned((0.5, 0.2, -0.9), (10, 20, 30))
    draft.part("v", pose)
    draft.part("shaft", pose @ frame((0, 0, 10.0 / np.sin(half))))
    for name, side in (("left", 1.0), ("right", -1.0)):
        normal = (0.0, side * np.cos(half), np.sin(half))
        along = np.array([0.0, -side * np.sin(half), np.cos(half)])
        draft.feature(f"v.{name}", frame(20.0 * along, normal, X), Plane((80, 60)))
    draft.feature("v.end", frame((-30, 0, 20), X), Plane((20, 20)))
    draft.feature("v.zero", frame((0, 5, 0), (0, 1, 2)))
    draft.feature("shaft.journal", frame((0, 0, 0), X, Y), Axis(60.0, 20.0))
    draft.size("shaft.journal")
    draft.feature("shaft.face", frame((-30, 0, 0), -X), Plane((12, 12)))
    draft.feature("shaft.far", (40, 7, -3))
    relations = (
        Relation("coincident", "shaft.face", "v.end"),
        Relation("tangent", "shaft.journal", "v.left"),
        Relation("tangent", "shaft.journal", "v.right"),
    )
    measures = dict(zip("xyz", [displacement("shaft.far", axis, "v.zero") for axis in np.eye(3)], strict=True))
    assembly = draft.assembly((Fix("fix", "v"), Mate("lay", "shaft", relations)), measures)
    of_second_order(assembly, np.random.default_rng(4).normal(size=(40, assembly.width)) * 0.02)


def test_flatness_and_near_points() -> None:
    """Flatness of points that deviate in all directions, distances and angles that are nominally nil."""
    draft = Draft()
    draft.part("part", turned((0.2, 0.4, -0.3), (5, 5, 5)))
    normal = np.array([0.6, 0.0, 0.8])
    base = frame((10, 10, 10), normal)
    points = [(0, 0), (80, 0), (90, 60), (5, 55), (40, 30)]
    names = tuple(draft.feature(f"part.{k}", base @ frame((x, y, 0))) for k, (x, y) in enumerate(points))
    draft.feature("part.near", base @ frame((0, 0, 0)))
    draft.feature("part.axis 1", frame((0, 0, 0), (1, 1, 1)), Axis(40.0))
    draft.feature("part.axis 2", frame((9, 0, 0), (-1, -1, -1)), Axis(30.0))
    measures = {
        "flatness": Measured(InspectedFlatnessSpec.reads, names, normal),
        "near": Measured(DistanceSpec.reads, ("part.0", "part.near")),
        "antiparallel": Measured(AngleSpec.reads, ("part.axis 1", "part.axis 2")),
    }
    assembly = draft.assembly((Fix("fix", "part"),), measures)
    of_second_order(assembly, np.random.default_rng(5).normal(size=(40, assembly.width)) * 0.02)


@pytest.mark.parametrize(("nominal", "sense"), [(180.0, 1.0), (179.5, 1.0), (179.5, -1.0), (-40.0, 1.0)])
def test_angles_about_a_direction_go_on_beyond_half_a_turn(nominal: float, sense: float) -> None:
    """An axis turned by some degrees about z, more and less by up to 1.7 deg: read as it is, never 360 deg off."""
    draft = Draft()
    draft.part("part")
    draft.feature("part.from", frame((0, 0, 0), X), deviates=False)
    turn = np.radians(nominal)
    draft.feature("part.to", frame((30, 20, 5), (np.cos(turn), np.sin(turn), 0.0), Z), Axis(100.0))
    measures = {"angle": Measured(AngleSpec.reads, ("part.from", "part.to"), sense * Z)}
    assembly = draft.assembly((Fix("fix", "part"),), measures)
    leans, y = np.radians([-1.7, -0.6, 0.3, 1.2, 1.7]), np.cross((np.cos(turn), np.sin(turn), 0.0), Z)
    off = -50.0 * np.tan(leans)  # of the end along y of the feature, which lies clockwise
    assert y == pytest.approx([np.sin(turn), -np.cos(turn), 0.0], abs=1e-12)
    rows = np.concatenate([draft.trial({"part.to start y": -own, "part.to end y": own}) for own in off])
    expected = sense * (turn + leans)
    found, codes = placing.values(assembly, rows, ["angle"])["angle"]
    assert (codes == OK).all()
    np.testing.assert_allclose(found, expected, atol=1e-12)
    np.testing.assert_allclose(torsors.values(assembly, rows, ["angle"])["angle"], expected, atol=1e-5)


@pytest.mark.parametrize("criterion", ["squares", "minimax"])
def test_best_fits(criterion: str) -> None:
    """Six points in space, each in all directions, weighted."""
    rng = np.random.default_rng(6)
    draft = Draft()
    pose = turned((0.5, 0.2, -0.9), (10, 20, 30))
    draft.part("base", pose)
    draft.part("part", pose)
    fits = []
    for k, point in enumerate(rng.normal(size=(6, 3)) * 50.0):
        moving, target = (draft.feature(f"{part}.{k}", frame(point, rng.normal(size=3))) for part in ("part", "base"))
        fits.append(Fit(moving, target, float(rng.uniform(0.5, 2.0)), np.eye(3)))
    draft.feature("base.zero", (0, 0, 0))
    draft.feature("part.far", (70, 20, -50))
    move = BestFit("fit", "part", tuple(fits), "squares" if criterion == "squares" else "minimax")
    measures = dict(zip("xyz", [displacement("part.far", axis, "base.zero") for axis in np.eye(3)], strict=True))
    assembly = draft.assembly((Fix("fix", "base"), move), measures)
    # where two points alone hold the part, the largest residual is so flat that 1e-11 mm of it are 1e-5 mm of the pose
    of_second_order(assembly, rng.normal(size=(20, assembly.width)) * 0.02, 1e-11 if criterion == "squares" else 1e-5)
