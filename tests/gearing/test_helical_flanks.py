"""Single flanks of helical gears that deviate: exact engine and stack-up against a search of deviated surfaces."""

import math
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gear_trials import model_of_scene
from gearing.deviating_pair import draws
from oracles.screw_flanks import Placed, ScrewGear, lag_in_slices

from tol3d.cad.solids import measuring_strips
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.engines.gaps import fcl_engine
from tol3d.gearing.meshing.mesh import Meshing
from tol3d.gearing.model import Mesh, Model, Reading
from tol3d.gearing.stack_up import stack_of
from tol3d.gears import LEFT, RIGHT, InternalGear, InternalPair, SpurPair
from tol3d.gears.iso1328 import flank_tolerances
from tol3d.numerics.arrays import Array

SEARCH = 1e-6  # mm
BOTH = frozenset(("pinion", "wheel"))
PARTS = """\
scene: helical flanks
parts:
  pinion: {kind: helical_gear, teeth: 23, module: 1 mm, helix_angle: 30 deg, hand: right, face_width: 16 mm,
    profile_shift: 0.55, expansion: 11.5e-6 1/K}
  wheel: {kind: helical_gear, teeth: 67, module: 1 mm, helix_angle: 30 deg, hand: left, face_width: 11 mm,
    profile_shift: 0.5441135839, expansion: 11.5e-6 1/K}
  case: {kind: housing, expansion: 23e-6 1/K}
tolerances:
"""
REST = """\
moves:
  pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 53.2 mm, housing: case}
measures:
  play: {kind: normal_backlash, of: pair}
  TE: {kind: transmission_error, of: pair, over: turn, take: curve, positions: 400}
"""
EXTERNAL = PARTS, REST
IN_RING = (
    """\
scene: helical flanks in a ring
parts:
  pinion: {kind: helical_gear, teeth: 27, module: 1 mm, helix_angle: 15 deg, hand: right, face_width: 12 mm,
    profile_shift: 0.2, expansion: 11.5e-6 1/K}
  wheel: {kind: internal_gear, teeth: 79, module: 1 mm, helix_angle: 15 deg, hand: right, face_width: 10 mm,
    profile_shift: -0.2, expansion: 11.5e-6 1/K}
  case: {kind: housing, expansion: 23e-6 1/K}
tolerances:
""",
    REST.replace("53.2", "26.75").replace("400", "1264"),
)
RING_DRIVES = (IN_RING[0], IN_RING[1].replace("driver: pinion, driven: wheel", "driver: wheel, driven: pinion"))
PAIRS = {"external": EXTERNAL, "in a ring": IN_RING, "ring drives": RING_DRIVES}
SQUARES = {"external": (0.03, 0.15), "in a ring": (0.1, 0.6), "ring drives": (0.1, 0.6)}
"""Rms and largest [um] of squares of slopes. Two slopes of 6 um that add up take g^2/(2 b) = 0.1 um where
flanks bend apart by b = 7.9 mm per square of the roll, as the external pair's do, and 0.2 um by 3.1 mm in the ring."""
ALL_PAIRS = pytest.mark.parametrize("pair", PAIRS)
WALK = "limits: {iso_class: 7}, law: {kind: random_walk, fill: [0.7, 1]}"
FREE = "each: tooth, limits: {iso_class: 7}, law: {kind: uniform}"
SLOPES = ("profile_slope", "helix_slope")


def tolerances(*kinds: str) -> str:
    """Lines of a scene: these deviations of both gears, of every flank its own."""
    lines = [
        f"  {gear} {kind}: {{kind: {kind}, of: {gear}, flanks: each, {WALK if kind == 'pitch_deviation' else FREE}}}\n"
        for gear in ("pinion", "wheel")
        for kind in kinds
    ]
    return "".join(lines)


@dataclass(frozen=True)
class Builds:
    """Builds of the pair, at random positions of the driver."""

    model: Model
    deviations: Array
    angle: Array

    @property
    def mesh(self) -> Mesh:
        return self.model.meshes[0]

    @property
    def pair(self) -> SpurPair | InternalPair:
        pair = self.mesh.pair
        assert isinstance(pair, SpurPair | InternalPair)
        return pair

    def read(self, part: float = 1.0) -> Any:
        """The exact engine's reading, of a part of all deviations."""
        engine = ExactEngine(self.model)
        return engine.read(engine.build(part * self.deviations), self.mesh, Reading(), self.angle, BOTH)

    def component(self, row: int, name: str, place: int) -> float:
        """One deviation [mm]; 0 of a tolerance that the scene lacks."""
        slices = self.model.component_slices
        return float(self.deviations[row, slices[name]][place]) if name in slices else 0.0

    def screws(self, row: int) -> tuple[Placed, Placed]:
        """The oracle's gears of a build, deviating as the words of the tolerances have it."""
        found = []
        kind: Any = type(self.pair)
        turned = kind(self.pair.wheel, self.pair.pinion, self.pair.centre_distance)
        for name, pair, at in (
            (self.mesh.driver, self.pair, np.zeros(3)),
            (self.mesh.driven, turned, self.pair.wheel_origin),
        ):
            gear = pair.pinion

            def deviation(tooth: int, side: int, roll: Array, z: Array, name: str = name, pair: Any = pair) -> Array:
                gear, place = pair.pinion, tooth + (0 if side == 1 else pair.pinion.teeth)
                begin = (min if isinstance(gear, InternalGear) else max)(gear.form_roll, pair.start_roll)
                along = (roll - begin) / (gear.tip_roll - begin) - 0.5
                ahead = self.component(row, f"{name} pitch_deviation", place)
                # an arc at the reference circle, along the tangent of the base circle
                level = -side * ahead * gear.base_radius / gear.reference_radius
                slope = self.component(row, f"{name} profile_slope", place)
                helix = self.component(row, f"{name} helix_slope", place)
                return np.asarray(level + slope * along + helix * z / gear.face_width)

            screw = ScrewGear(
                gear.teeth, gear.module, gear.pressure_angle, gear.helix_angle, gear.hand, gear.face_width,
                gear.profile_shift, inside=isinstance(gear, InternalGear), deviation=deviation,
            )  # fmt: skip
            found.append(Placed(screw, np.eye(3), np.array(at, dtype=float)))
        return found[0], found[1]

    def lag(self, row: int, driven: float, side: int) -> float:
        """Arc [mm] on the driven base circle until the first pair of a side touches, by the search."""
        driver, wheel = self.screws(row)
        first = round(-self.angle[row] * driver.gear.teeth / (2 * math.pi))
        turns = (float(self.angle[row]), driven)
        teeth = np.arange(first - 4, first + 5)
        pairs = zip(teeth.tolist(), self.pair.mating_teeth(teeth, RIGHT if side == 1 else LEFT).tolist(), strict=True)
        return min(lag_in_slices(driver, wheel, turns, side, each) for each in pairs)


def drawn(lines: str, folder: Path, count: int, seed: int = 1, pair: str = "external") -> Builds:
    """Builds by the laws of the tolerances."""
    parts, rest = PAIRS[pair]
    (path := folder / "flanks.yaml").write_text(parts + lines + rest)
    model = model_of_scene(path)
    return Builds(model, *draws(model, count, seed))


@pytest.mark.slow
@ALL_PAIRS
@pytest.mark.parametrize(
    "kinds", [("pitch_deviation",), ("profile_slope",), ("helix_slope",), ("pitch_deviation", *SLOPES)]
)
def test_deviated_flanks_touch_where_a_search_of_their_surfaces_finds_them(
    kinds: tuple[str, ...], pair: str, tmp_path: Path
) -> None:
    """At rest a pair of the working flanks is 0 apart, and after the free turn a pair of the others is."""
    builds = drawn(tolerances(*kinds), tmp_path, 3, pair=pair)
    found, side = builds.read(), builds.mesh.working_flank
    assert (found.status == 0).all()
    for row, rest in enumerate(found.driven_angle):
        assert builds.lag(row, rest, side) == pytest.approx(0.0, abs=SEARCH)
        turned = (rest + way * found.driven_turn[row] for way in (1.0, -1.0))
        assert min(abs(builds.lag(row, own, -side)) for own in turned) == pytest.approx(0.0, abs=SEARCH)


@ALL_PAIRS
@pytest.mark.parametrize("kinds", [("pitch_deviation",), SLOPES, ("pitch_deviation", *SLOPES)])
def test_the_stack_up_agrees_trial_by_trial_to_the_second_order(
    kinds: tuple[str, ...], pair: str, tmp_path: Path
) -> None:
    """Gaps and both turns; halved deviations differ by a quarter, by 2^-1.5 where an edge touches a root beyond."""
    builds = drawn(tolerances(*kinds), tmp_path, 200, pair=pair)
    stack, off = stack_of(builds.model, builds.mesh, Reading()), []
    for part in (1.0, 0.5):
        found = builds.read(part)
        assert (found.status == 0).all()
        for turns, values in (
            (None, found.gap),
            ("driven", builds.pair.wheel.section_arm * found.driven_turn),
            ("driver", builds.pair.pinion.section_arm * found.driver_turn),
        ):
            off.append(stack.normal_backlash(part * builds.deviations, builds.angle, turns) - values)  # type: ignore[arg-type]
    rms = 1e3 * np.sqrt((np.array(off) ** 2).mean(axis=1)).reshape(2, 3)  # um
    assert (rms[0] < SQUARES[pair][0]).all(), rms
    assert ((rms[1] < rms[0] / 2**1.5) | (rms[1] < 1e-3)).all(), rms
    assert 1e3 * builds.read().gap.std() > 1.0  # um: what both methods follow


@ALL_PAIRS
def test_shifts_along_the_axis_move_the_ends_of_faces_alone(pair: str, tmp_path: Path) -> None:
    """Backlash by both methods as a driver of the wider face moves: the mate screws, its lines end where they did."""
    mover = "wheel" if pair == "ring drives" else "pinion"
    lines = tolerances("pitch_deviation", *SLOPES)
    shift = (
        f"  along: {{kind: axial_shift, of: {mover}, distribution: {{kind: uniform, lower: -0.4 mm, upper: 0.4 mm}}}}\n"
    )
    builds = drawn(lines + shift, tmp_path, 200, pair=pair)
    stack, found = stack_of(builds.model, builds.mesh, Reading()), builds.read()
    assert (found.status == 0).all()
    off = 1e3 * (stack.normal_backlash(builds.deviations, builds.angle) - found.gap)
    assert np.sqrt((off**2).mean()) < SQUARES[pair][0]  # um, as without the shift
    assert np.abs(off).max() < SQUARES[pair][1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kinds", "pair"),
    [
        *product([("pitch_deviation",), ("profile_slope",), ("helix_slope",)], PAIRS),
        (("pitch_deviation", *SLOPES), "external"),
        (("pitch_deviation", *SLOPES), "in a ring"),
    ],
)
def test_strips_of_deviated_flanks_touch_within_their_chord_error(
    kinds: tuple[str, ...], pair: str, tmp_path: Path
) -> None:
    """Chords lie inside the teeth: the driven gear turns on by up to both errors, and its gap is wider by up to four.

    Helix slopes alone take 5 to 9 um here, so that ends moved by half of it, or alike, would stand out.
    """
    builds = drawn(tolerances(*kinds), tmp_path, 8, pair=pair)
    strips = {part.name: measuring_strips(part.gear, 128) for part in builds.model.gears}
    made = ExactEngine(builds.model).build(builds.deviations)
    engine = fcl_engine(builds.model, strips)
    seat, exact = Meshing(engine, builds.model, builds.mesh, made, Reading()).seat(builds.angle), builds.read()
    assert (seat.status == 0).all()
    sense = -builds.pair.mating_flank(builds.mesh.working_flank)
    turned = builds.pair.wheel.section_arm * (seat.driven_angle - exact.driven_angle) * sense
    wider = seat.non_working.smallest() - exact.gap
    chord, pulled = sum(own.chord_error for own in strips.values()), 0.0073e-3  # mm; a touching edge's slack, in fcl.py
    for off, errors in ((turned, chord), (wider, 2 * chord)):
        assert off.max() < errors + 2 * pulled
        assert off.min() > -2 * pulled
    assert np.ptp(exact.gap) > 40 * chord  # what both follow


@ALL_PAIRS
def test_transmission_error_of_both_sides_follows_single_flanks(pair: str, tmp_path: Path) -> None:
    """The exact rests of both sides less their nominal turns, over 400 positions of a turn, are the stack-up's."""
    builds = drawn(tolerances("pitch_deviation", *SLOPES), tmp_path, 2, pair=pair)
    engine, mesh, gears = ExactEngine(builds.model), builds.mesh, builds.pair
    angles = np.linspace(0.0, 2 * math.pi, 400, endpoint=False)
    stack = stack_of(builds.model, mesh, Reading())
    for side, rests in zip(
        (mesh.working_flank, -mesh.working_flank),
        engine.rests(engine.build(builds.deviations), mesh, Reading(), angles),
        strict=True,
    ):
        assert (rests.status == 0).all()
        exact = (rests.driven_angle - gears.driven_angle(angles)) * gears.wheel.section_arm
        exact = exact + gears.mating_flank(side) * gears.normal_backlash / 2
        off = 1e3 * (exact - stack.turned_by_teeth(side, builds.deviations, angles))
        assert np.sqrt((off**2).mean()) < SQUARES[pair][0]  # as the backlash of all of these
        assert np.abs(off).max() < SQUARES[pair][1]
        assert 1e3 * np.ptp(exact) > 5.0


LEANS = """\
  across: {kind: axis_out_of_plane, of: pair, distribution: {kind: uniform, lower: -30 um, upper: 30 um}}
  along: {kind: axis_in_plane, of: pair, distribution: {kind: uniform, lower: -30 um, upper: 30 um}}
"""


@ALL_PAIRS
def test_transmission_error_follows_axes_that_lean(pair: str, tmp_path: Path) -> None:
    """Pairs touch at ends of their lines, and edges beyond them: over a turn as the exact rests, but for squares."""
    builds = drawn(LEANS, tmp_path, 6, pair=pair)
    angles, mesh = np.linspace(0.0, 2 * math.pi, 400, endpoint=False), builds.mesh
    engine, stack = ExactEngine(builds.model), stack_of(builds.model, mesh, Reading())
    rests = engine.rests(engine.build(builds.deviations), mesh, Reading(), angles)[0]
    assert (rests.status == 0).all()
    exact = (rests.driven_angle - builds.pair.driven_angle(angles)) * builds.pair.wheel.section_arm
    off = 1e3 * (exact - stack.turned_by_teeth(mesh.working_flank, builds.deviations, angles))
    off -= off.mean(axis=1, keepdims=True)  # axes that lean across also turn the whole of the mate
    assert (
        np.sqrt((off**2).mean()) < SQUARES[pair][0] / 2
    )  # lines by their nominal ends alone: up to 0.03, 0.13 and 0.24
    assert 1e3 * np.ptp(exact, axis=1).max() > 1.5


@pytest.mark.parametrize(("gears", "case"), [((60.0, 40.0), 20.0), ((20.0, 20.0), 20.0), ((-30.0, 50.0), 0.0)])
def test_gears_that_grow_apart_touch_on_one_line_of_several(
    gears: tuple[float, float], case: float, tmp_path: Path
) -> None:
    """Base pitches differ: on each side the line counts at which the difference of strains takes most."""
    parts = zip(("pinion", "wheel", "case"), (*gears, case), strict=True)
    lines = "".join(
        f"  {name} warm: {{kind: temperature, of: [{name}], distribution: {{kind: constant, value: {kelvin} K}}}}\n"
        for name, kelvin in parts
    )
    builds = drawn(lines, tmp_path, 40)
    found, stack = builds.read(), stack_of(builds.model, builds.mesh, Reading())
    assert (found.status == 0).all()
    arm = builds.pair.wheel.section_arm * (1 + gears[1] * 11.5e-6)
    off = stack.normal_backlash(builds.deviations, builds.angle, "driven") - arm * found.driven_turn
    strain = 11.5e-6 * max(*map(abs, gears), abs(gears[0] - gears[1]))
    assert np.abs(off).max() < 2 * builds.pair.centre_distance * strain**2  # 0.02 to 0.09 um


def test_two_gears_alike_and_their_housing_only_scale(tmp_path: Path) -> None:
    """j(q gears, a) = q j(gears, a/q), to the last digits."""
    lines = "".join(
        f"  {name} warm: {{kind: temperature, of: [{name}], distribution: {{kind: constant, value: 30 K}}}}\n"
        for name in ("pinion", "wheel")
    )
    builds = drawn(lines, tmp_path, 3)
    q = 1 + 30 * 11.5e-6
    pair = replace(builds.pair, centre_distance=builds.pair.centre_distance / q)
    assert builds.read().gap == pytest.approx(q * pair.normal_backlash, abs=1e-12)


def test_classes_of_helical_gears_count_by_the_reference_diameter() -> None:
    """z 40, m_n 3, beta 30 deg: d 138.564; F_p = 0.002 d + 0.55 sqrt d + 0.7 m + 12 is 20.85 um of class 5."""
    found = flank_tolerances(5, 40, 3.0, 30.0, math.radians(30.0))
    assert 1e3 * found.cumulative_pitch == pytest.approx(21.0, abs=1e-9)
    assert 1e3 * found.profile_slope == pytest.approx(5.5, abs=1e-9)  # 5.339
