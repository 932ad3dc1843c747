"""The frame in which a part is drawn: no measure depends on where its origin lies or how its axes turn."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from assembly.drafts import Draft, displacement, frame, moved_as_a_whole
from assembly.framed_parts import FLAT, MOVES, base, cover, pairs, tolerances
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from places import SCENES
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation
from shipped import shipped

from tol3d.assembly.model import (
    Assembly,
    Axis,
    BestFit,
    Contribution,
    Datum,
    DatumFrame,
    Engage,
    Fix,
    Floating,
    Gauges,
    Locate,
    Measured,
    Move,
    Pair,
    Plane,
    Point,
    Rest,
    Shape,
    Slot,
    Touch,
)
from tol3d.assembly.model.datum_frame import GaugeRoom
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors
from tol3d.simulate import Overrides, load, simulation_of
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

FAR = np.array([-2000.0, 700.0, -900.0])
"""mm"""
FAR_OFF = 600.0
"""mm"""


def drawn_elsewhere(assembly: Assembly, changes: Mapping[str, Array]) -> Assembly:
    """The same assembly, its parts in other coordinates: of each the pose (4, 4) of its old frame in the new one."""

    def turned(direction: Array | None, part: str) -> Array | None:
        is_of_tilt = direction is not None and len(direction) == 2  # along or across it, whatever the coordinates
        return direction if direction is None or is_of_tilt else direction @ changes[part][:3, :3].T

    def owner(feature: str) -> str:
        return assembly.features[feature].part

    def measured(own: Measured) -> Measured:
        minus = own.minus and measured(own.minus)
        part = owner(own.features[0]) if own.features else ""
        return replace(own, direction=turned(own.direction, part) if part else own.direction, minus=minus)

    def frame(own: DatumFrame) -> DatumFrame:
        shifts = (Contribution(c.contributor, c.columns, changes[own.part][:3, :3] @ c.matrix) for c in own.shifted_by)
        return replace(own, shifted_by=tuple(shifts))

    def pair(own: Pair, move: Locate | Rest) -> Pair:
        carrier = owner(own.target) if move.points_on == "part" else move.part
        return replace(own, normal=changes[carrier][:3, :3] @ own.normal)

    def moved(move: Move) -> Move:
        match move:
            case Locate():
                return replace(move, pairs=tuple(pair(own, move) for own in move.pairs))
            case Rest():
                change = changes[move.part]
                at = change[:3, :3] @ move.at + change[:3, 3]
                return replace(move, pairs=tuple(pair(own, move) for own in move.pairs), at=at)
            case BestFit():
                turns = {own.target: changes[owner(own.target)][:3, :3] for own in move.fits}
                fits = (replace(own, directions=own.directions @ turns[own.target].T) for own in move.fits)
                return replace(move, fits=tuple(fits))
            case Touch():
                return replace(move, pressed=turned(move.pressed, owner(move.contacts[0].target)))
            case Engage() if move.floating.along is not None:
                along = turned(move.floating.along, owner(move.floating.at))
                return replace(move, floating=replace(move.floating, along=along))
        return move

    return replace(
        assembly,
        parts=tuple(
            replace(
                part,
                pose=part.pose @ np.linalg.inv(changes[part.name]),
                features=tuple(replace(own, frame=changes[part.name] @ own.frame) for own in part.features),
                datum_frames=tuple(frame(own) for own in part.datum_frames),
            )
            for part in assembly.parts
        ),
        moves=tuple(moved(move) for move in assembly.moves),
        measures={name: measured(own) for name, own in assembly.measures.items() if own.kind != "clearance"},
    )


def shift(by: Array) -> Array:
    found = np.eye(4)
    found[:3, 3] = by
    return found


def askew(assembly: Assembly, seed: int) -> Assembly:
    """The same assembly somewhere in the world, each of its parts in other coordinates."""
    rng = np.random.default_rng(seed)

    def pose() -> Array:
        made = np.eye(4)
        made[:3, :3], made[:3, 3] = Rotation.random(rng=rng).as_matrix(), rng.uniform(-FAR_OFF, FAR_OFF, 3)
        return made

    turned, whole = drawn_elsewhere(assembly, {part.name: pose() for part in assembly.parts}), pose()
    moves = (
        replace(own, force=whole[:3, :3] @ own.force) if isinstance(own, Rest) else own for own in turned.moves
    )  # the only direction of the world
    return moved_as_a_whole(replace(turned, moves=tuple(moves)), whole)


def agree(assembly: Assembly, other: Assembly, deviations: Array, atol: float = 1e-9) -> None:
    """Both methods give the same for two assemblies, trial by trial to 1e-6 um or `atol` [mm]."""
    names = list(other.measures)
    here, there = (placing.values(own, deviations, names) for own in (assembly, other))
    linear, its = (torsors.values(own, deviations, names) for own in (assembly, other))
    for name in names:
        np.testing.assert_array_equal(here[name][1], there[name][1], err_msg=name)
        np.testing.assert_allclose(there[name][0], here[name][0], atol=atol, rtol=0, err_msg=f"exact: {name}")
        np.testing.assert_allclose(its[name], linear[name], atol=atol, rtol=0, err_msg=f"analytic: {name}")
        assert (here[name][1] == OK).any()


# datum frames ------------------------------------------------------------------------------------------------

X, Y, Z = np.eye(3)
SHAPES: Mapping[str, tuple[Array, Shape]] = {
    "floor": (frame((60, 40, 0), -Z, X), Plane((120, 80))),
    "side": (frame((60, 0, 10), -Y, X), Plane((110, 16))),
    "ramp": (frame((0, 45, 12), (-1, 0.3, 0.2), Y), Plane((60, 14))),
    "bore": (frame((20, 25, 10), Z, X), Axis(20.0, 12.0, inner=True)),
    "hole": (frame((95, 60, 10), Z, X), Axis(20.0, 8.0, inner=True)),
    "seat": (frame((110, 40, 25), X, Z), Axis(24.0, 12.0)),
    "slot": (frame((100, 25, 10), Y, X), Slot((30.0, 20.0), 8.0)),
    "ball": (frame((15, 70, 22)), Point()),
    "pin1": (frame((20, 25, 30), Z, X), Axis(20.0, 12.0)),
    "pin2": (frame((50, 39, 30), Z, X), Axis(10.0, 6.0)),
    "pin3": (frame((95, 60, 30), Z, X), Axis(15.0, 8.0)),
}
FRAMES: Sequence[Sequence[str]] = [
    ["floor"],
    ["bore"],
    ["slot"],
    ["bore-hole"],
    ["floor", "side"],
    ["floor", "side fitted"],
    ["floor", "side targets"],
    ["floor", "side targets", "ramp"],
    ["floor", "side", "ramp"],
    ["floor", "ramp"],
    ["floor", "bore"],
    ["floor", "bore", "slot"],
    ["floor", "bore", "hole"],
    ["floor", "bore-hole"],
    ["floor", "bore-hole", "side fitted"],
    ["pin1-pin2-pin3"],
    ["floor", "pin1-pin2-pin3"],
    ["floor", "pin3-pin1-pin2", "side fitted"],
    ["floor", "slot"],
    ["seat", "floor"],
    ["seat", "slot"],
    ["seat", "ramp"],
    ["bore", "slot", "floor"],
    ["slot", "bore"],
    ["ramp", "floor", "ball"],
    ["ball", "floor"],
    ["floor", "ball", "side"],
    ["floor", "pin1-pin2-pin3 pattern"],
    ["bore-hole pattern", "floor"],
    ["floor", "side", "bore-slot pattern"],
    ["floor-side pattern", "ball"],
    ["floor", "bore*", "side"],
    ["floor", "bore*", "slot"],
    ["bore*", "side targets"],
]
"""With a star: on a gauge, centred in its room of 0.5 mm."""


def datum(words: str) -> Datum:
    name, _, simulator = words.replace("*", "").partition(" ")
    features = tuple(f"p.{own}" for own in name.split("-"))
    if simulator == "targets":
        return Datum(features, "targets", np.array([[-50.0, 4, 0], [50, -5, 0]]))
    if simulator == "pattern":
        return Datum(features, "pattern")
    return Datum(features, "fitted" if simulator == "fitted" else "contact")


def datums_in(names: Sequence[str]) -> tuple[Assembly, Array]:
    """A plate with a frame of some datums, where four points lie that it carries, and some trials."""
    draft = Draft()
    draft.part("p", frame((300, -40, 15), (0.1, 0.2, 1), (1, 1, 0)))
    for own in names:
        for name in own.replace("*", "").split()[0].split("-"):
            draft.feature(f"p.{name}", *SHAPES[name])
    held = draft.datum_frame("p", *(datum(own) for own in names))
    if "bore*" in names:
        gauges = Gauges((GaugeRoom("p.bore", 11.0, True),), Floating("centred"))
        draft.datum_frames[held] = replace(draft.datum_frames[held], gauges=gauges)
    draft.feature("p.zero", (0, 0, 0), deviates=False)
    measures = {}
    for k, tip in enumerate([(0, 0, 0), (100, 0, 0), (0, 100, 0), (0, 0, 100)]):
        draft.feature(f"p.tip {k}", tip, parent=held, deviates=False)
        for axis, along in zip("xyz", np.eye(3), strict=True):
            measures[f"{k}{axis}"] = displacement(f"p.tip {k}", along, "p.zero")
    assembly = draft.assembly((Fix("fix", "p"),), measures)
    return assembly, np.random.default_rng(len(names[-1])).normal(0.0, 0.05, (4, assembly.width))


@pytest.mark.parametrize("names", FRAMES, ids="|".join)
def test_a_datum_frame_lies_alike_in_all_coordinates(names: Sequence[str]) -> None:
    """To 1e-6 um; after a gauge to 1e-3 um: where its room stops a datum, a place goes with the root of rounding."""
    assembly, deviations = datums_in(names)
    atol = 1e-6 if "bore*" in names and len(names) > 1 else 1e-9
    agree(assembly, drawn_elsewhere(assembly, {"p": shift(FAR)}), deviations, atol)
    agree(assembly, askew(assembly, 1), deviations, atol)


@pytest.mark.parametrize("names", FRAMES, ids="|".join)
def test_both_methods_differ_by_second_order_in_every_datum_frame(names: Sequence[str]) -> None:
    """A quarter of the deviations leaves a sixteenth of their difference; a first-order one would leave a quarter."""
    assembly, deviations = datums_in(names)
    apart = []
    for scale in (1.0, 0.25):
        exact = placing.values(assembly, scale * deviations, list(assembly.measures))
        linear = torsors.values(assembly, scale * deviations, list(assembly.measures))
        apart.append(max(float(np.abs(exact[name][0] - linear[name]).max()) for name in exact))
    assert apart[1] < apart[0] / 10


@pytest.mark.parametrize("name", ["floor", "bore", "slot", "bore-hole", "pin1-pin2-pin3"])
def test_the_centre_of_a_first_datum_moves_along_what_it_holds_and_is_not_twisted(name: str) -> None:
    """Half a millimetre in 120, finite: the frame takes the nominal centre to that of the trial by the least turn."""
    assembly, _ = datums_in([name])
    row = np.random.default_rng(3).normal(0.0, 0.5, (1, assembly.width))
    read = placing.values(assembly, row, list(assembly.measures))
    tips = np.array([[read[f"{k}{axis}"][0][0] for axis in "xyz"] for k in range(4)])
    turn = (tips[1:] - tips[0]).T / 100
    centres = [SHAPES[own][0][:3, 3] for own in name.split("-")]
    z = centres[-1] - centres[0] if len(centres) > 1 else SHAPES[name][0][:3, 2]
    centre, off, z = np.mean(centres, axis=0), middle_off(assembly, name, row), z / np.linalg.norm(z)
    slid = off @ z * z if len(centres) > 1 else np.zeros(3)  # along a line of several nothing is held
    np.testing.assert_allclose(turn @ (centre + slid) + tips[0], centre + off, atol=1e-12)
    spin = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    assert spin @ z == pytest.approx(0, abs=1e-12)


def test_a_common_datum_of_several_is_the_line_of_least_squares_through_their_centres() -> None:
    """Oracle: the sum of squared distances of the places from a line, made least by a search over four numbers."""
    names = ["pin1", "pin2", "pin3"]
    assembly, _ = datums_in(["-".join(names)])
    rows = np.random.default_rng(8).normal(0.0, 0.5, (5, assembly.width))
    read = placing.values(assembly, rows, list(assembly.measures))
    for k, row in enumerate(rows):
        tips = np.array([[read[f"{n}{axis}"][0][k] for axis in "xyz"] for n in range(4)])
        turn = (tips[1:] - tips[0]).T / 100
        nominal = np.array([SHAPES[own][0][:3, 3] for own in names])
        places = nominal + [middle_off(assembly, own, row[None]) for own in names]

        def distances(line: Array, places: Array = places) -> Array:
            """From the line y = a + b x, z = c + d x."""
            way = np.array([1.0, line[1], line[3]]) / np.sqrt(1 + line[1] ** 2 + line[3] ** 2)
            off = places - [0.0, line[0], line[2]]
            return np.asarray((off - np.outer(off @ way, way)).ravel())

        best = least_squares(distances, [0.0, 0.5, 30.0, 0.0], xtol=1e-15, ftol=1e-15, gtol=1e-15).x
        way = np.array([1.0, best[1], best[3]])
        along = turn @ (nominal[2] - nominal[0])
        np.testing.assert_allclose(np.cross(along / np.linalg.norm(along), way / np.linalg.norm(way)), 0, atol=1e-7)
        middle = turn @ nominal.mean(axis=0) + tips[0]
        assert np.abs(distances(best, middle[None])).max() < 1e-5  # the search ends at a sum that is flat within 1e-14


def middle_off(assembly: Assembly, name: str, row: Array) -> Array:
    """Offset of the middle of a datum (3,), by its own components."""
    found = []
    for own in name.split("-"):
        feature = assembly.features[f"p.{own}"]
        moved = row[0, feature.moved_by[0].columns]
        local = [*(moved[:2] + moved[2:]) / 2, 0.0] if isinstance(feature.shape, Axis) else [0.0, 0.0, moved[0]]
        found.append(feature.frame[:3, :3] @ local)
    return np.asarray(np.mean(found, axis=0))


# moves -------------------------------------------------------------------------------------------------------

LOOSE = {
    "flat": ("mate", FLAT),
    "hinge": ("mate", "relations: [{kind: coaxial, from: cover.hole, to: base.pin 1}]"),
    "lying": (
        "mate",
        "relations: [{kind: tangent, from: cover.roll, to: base.top}, "
        "{kind: coincident, from: cover.side, to: base.back}]",
    ),
    "fit": ("best_fit", f"pairs: {pairs('hole:pin 1', 'hole 2:pin 2', 'tip:rim')}".replace("}", ", along: ALONG}")),
    "pads": (
        "rest",
        f"contacts: {pairs('A1:top', 'A2:top', 'A3:top', 'A4:top')}, force: {{direction: [0, 0, -1], at: WEIGHT}}",
    ),
    "roller": ("touch", "contacts: [{from: cover.roll, to: base.top}, {from: cover.roll, to: base.back}]"),
}
"""Moves that leave something free."""


def every_move(folder: Path) -> Assembled:
    """A base, and for each move a cover of the same drawing that it lays on the base."""
    rng = np.random.default_rng(7)
    frames = [(Rotation.random(rng=rng).as_matrix(), rng.uniform(-50, 50, 3)) for _ in range(2)]
    host, lid = base(*frames[0]), cover(*frames[1])
    lid.round("roll", (40, 10, 10), 20.0, (1, 0, 0), 30.0, hole=False)
    placed = lid.text.splitlines()[1].strip()
    cases = {**{kind: (kind, words) for kind, words in MOVES.items()}, **LOOSE}
    names = ["cover", *(f"{case} cover" for case in list(cases)[1:])]
    parts = "".join(f"  {name}: {{kind: solid, like: cover, {placed}}}\n" for name in names[1:])
    moves = measures = ""
    for name, (case, (kind, words)) in zip(names, cases.items(), strict=True):
        words = words.replace("WEIGHT", lid.at((70, 50, 2))).replace(
            "ALONG", f"[{host.way((0, 0, 1))}, {host.way((0, 1, 0))}]"
        )
        moves += f"  lay by {case}: {{kind: {kind}, part: {name}, {words}}}\n".replace("cover.", f"{name}.")
        rocking = ", rocking: largest" if kind == "rest" else ""
        for axis, along in zip("xyz", np.eye(3), strict=True):
            read = f"from: base.rim, to: {name}.tip, along: {host.way(along)}{rocking}"
            measures += f"  {case} {axis}: {{kind: gap, {read}}}\n"
    on_gauge = "datums: [top, {feature: pin 1, mmb: "
    measures += f"  bore on a gauge: {{kind: inspected_position, of: base.bore, {on_gauge}least}}]}}\n"
    zones = tolerances(1.0).replace("datums: [top, back, left]", "datums: [top]")
    zones = zones.replace("datums: [top, pin 1]", f"{on_gauge}random}}]")
    text = (
        f"scene: every move\nparts:\n  base:\n{host.text}  cover:\n{lid.text}{parts}tolerances:\n{zones}"
        "  top: {kind: profile, of: base.top, zone: {width: 0.06 mm}, law: {kind: normal}}\n"
        "  under: {kind: profile, of: cover.under, zone: {width: 0.04 mm, outward: 0.01 mm}, law: {kind: uniform}}\n"
        f"moves:\n  bench: {{kind: fix, part: base}}\n{moves}measures:\n{measures}"
    )
    return assembled(text, folder)


def test_every_move_lays_a_part_alike_in_all_coordinates(tmp_path: Path) -> None:
    made = every_move(tmp_path)
    assembly, deviations = made.system.assembly, drawn(made.simulation, 0, 12).deviations
    elsewhere = {part.name: shift((k + 1) * FAR) for k, part in enumerate(assembly.parts)}
    agree(assembly, drawn_elsewhere(assembly, elsewhere), deviations)


@pytest.mark.slow
def test_every_move_lays_a_part_alike_in_turned_coordinates(tmp_path: Path) -> None:
    made = every_move(tmp_path)
    agree(made.system.assembly, askew(made.system.assembly, 1), drawn(made.simulation, 0, 40).deviations)


# scenes ------------------------------------------------------------------------------------------------------


def plate(at: Array) -> str:
    """A plate whose origin lies at a place, and whose features lie where they always do."""

    def place(*point: float) -> str:
        return "[" + ", ".join(f"{own!r} mm" for own in (np.array(point) - at).tolist()) + "]"

    law = "law: {kind: uniform}"
    hole = "axis: [0, 0, 1], length: 10 mm, diameter: 8 mm, hole: true"
    return f"""scene: plate
parts:
  plate:
    kind: solid
    placed: {{at: {place(*(2 * at)).replace("-0.0", "0.0")}}}
    features:
      A: {{kind: plane, at: {place(0, 0, 0)}, normal: [0, 0, -1], extent: [100 mm, 60 mm]}}
      B: {{kind: plane, at: {place(0, -30, 5)}, normal: [0, -1, 0], extent: [100 mm, 10 mm]}}
      edge: {{kind: point, at: {place(50, 0, 10)}, normal: [1, 0, 0]}}
      hole 1: {{kind: cylinder, at: {place(20, 10, 5)}, {hole}}}
      hole 2: {{kind: cylinder, at: {place(20, -10, 5)}, {hole}}}
tolerances:
  A: {{kind: profile, of: plate.A, zone: {{width: 0.05 mm}}, {law}}}
  B: {{kind: profile, of: plate.B, zone: {{width: 0.05 mm}}, {law}, datums: [A]}}
  hole 1: {{kind: position, of: plate.hole 1, zone: {{diameter: 0.01 mm}}, {law}, datums: [A]}}
  hole 2: {{kind: position, of: plate.hole 2, zone: {{diameter: 0.01 mm}}, {law}, datums: [A, B]}}
moves:
  bench: {{kind: fix, part: plate}}
measures:
  in A: {{kind: gap, from: plate.hole 1, to: plate.edge, along: [1, 0, 0]}}
  in A B: {{kind: gap, from: plate.hole 2, to: plate.edge, along: [1, 0, 0]}}
"""


def test_a_hole_in_a_frame_is_as_far_from_an_edge_wherever_the_origin_lies(tmp_path: Path) -> None:
    """2000 trials; of [A] by hand too: a twentieth of the zone's diameter and what A's tilt does to 5 mm of height."""
    here, there = (assembled(plate(at), tmp_path) for at in (np.zeros(3), FAR))
    for method in ("exact", "analytic"):
        its = there.drawn(2000, method)
        for name, values in here.drawn(2000, method).items():
            np.testing.assert_allclose(its[name], values, atol=1e-9, rtol=0)
    # both ends in discs of 0.005: their mean has 0.0025 / sqrt(2); rises in |w| + |x| + |y| <= 0.025: 0.025 / sqrt(10)
    sigma = np.hypot(0.0025 / np.sqrt(2), 5 / 50 * 0.025 / np.sqrt(10))
    assert here.drawn(2000)["in A"].std() == pytest.approx(sigma, rel=5 / np.sqrt(2 * 2000))


def bundled(name: str) -> tuple[Assembly, Array]:
    simulation = simulation_of(load(SCENES / f"{name}.yaml"), Overrides())
    return Assembled(simulation).system.assembly, drawn(simulation, 0, 40).deviations


SCENES_HERE = [
    pytest.param(own, marks=[] if own == "every_assembly_field" else pytest.mark.slow) for own in shipped("assembly")
]


@pytest.mark.parametrize("name", SCENES_HERE)
def test_an_origin_elsewhere_changes_no_measure_of_a_bundled_scene(name: str) -> None:
    assembly, deviations = bundled(name)
    elsewhere = {part.name: shift((k + 1) * FAR) for k, part in enumerate(assembly.parts)}
    agree(assembly, drawn_elsewhere(assembly, elsewhere), deviations)


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped("assembly"))
def test_turned_coordinates_change_no_measure_of_a_bundled_scene(name: str) -> None:
    """The ends of what may rock on four pads are sought by steps, to 1e-7 mm."""
    assembly, deviations = bundled(name)
    agree(assembly, askew(assembly, 1), deviations, 1e-7 if name == "four_pads" else 1e-9)
