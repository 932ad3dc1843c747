"""Scenes of helical gears: both methods with every tolerance of a pair, what is refused, and what check prints."""

import math
import re
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
from gear_trials import drawn_trials, gear_columns, measure_of, model_of_scene
from printing import printed

from tol3d import check_scene
from tol3d.apps.records.from_scene import mesh_of
from tol3d.cad.solids import measuring_strips
from tol3d.errors import InputError, SceneError
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.engines.gaps import fcl_engine
from tol3d.gearing.grammar.checks import helices_elsewhere
from tol3d.gearing.grammar.parts import HelicalGearSpec
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import Model, Reading
from tol3d.gearing.stack_up import stack_of
from tol3d.gears import InternalPair, SpurPair
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.scene.bases import MoveSpec
from tol3d.scene.entry import Reference
from tol3d.simulate import load
from tol3d.study.system.trials import Trials

PARTS = """\
scene: helical pair
parts:
  pinion: {kind: helical_gear, teeth: %(z1)d, module: %(m)s mm, helix_angle: %(beta)s deg, hand: %(hand)s,
    face_width: %(b1)s mm, profile_shift: %(x1)s, expansion: 11.5e-6 1/K}
  wheel: {kind: %(wheel)s, teeth: %(z2)d, module: %(m)s mm, helix_angle: %(beta)s deg, hand: %(mate)s,
    face_width: %(b2)s mm, profile_shift: %(x2)s, expansion: 11.5e-6 1/K}
  case: {kind: housing, expansion: 23e-6 1/K}
"""
TOLERANCES = """\
tolerances:
  pinion thickness: {kind: tooth_thickness, of: pinion, distribution: {kind: normal, lower: -80 um, upper: -40 um}}
  wheel thickness: {kind: tooth_thickness, of: wheel, measured: normal,
    distribution: {kind: normal, lower: -90 um, upper: -50 um}}
  distance: {kind: centre_distance, of: gear pair, distribution: {kind: normal, lower: -20 um, upper: 20 um}}
  pinion eccentricity: {kind: eccentricity, of: pinion, distribution: {kind: rayleigh, scale: 4 um}}
  wheel run-out: {kind: run_out, of: wheel, distribution: {kind: rayleigh, scale: 6 um}}
  clearance: {kind: bearing_clearance, of: wheel, distribution: {kind: normal, lower: 2 um, upper: 20 um}}
  force: {kind: bearing_clearance, of: pinion, direction: tooth_force,
    distribution: {kind: normal, lower: 2 um, upper: 20 um}}
  in plane: {kind: axis_in_plane, of: gear pair, distribution: {kind: normal, lower: -0.3 mrad, upper: 0.3 mrad}}
  out of plane: {kind: axis_out_of_plane, of: gear pair,
    distribution: {kind: normal, lower: -0.3 mrad, upper: 0.3 mrad}}
  wheel axial: {kind: axial_shift, of: wheel, distribution: {kind: normal, lower: -100 um, upper: 100 um}}
  pinion face: {kind: mounting_face, of: pinion, distribution: {kind: normal, lower: -60 um, upper: 60 um}}
  gears warm: {kind: temperature, of: [pinion, wheel], distribution: {kind: normal, lower: -10 K, upper: 10 K}}
  case warm: {kind: temperature, of: [case], distribution: {kind: normal, lower: -10 K, upper: 10 K}}
"""
REST = """\
moves:
  gear pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: %(a)s mm, housing: case}
measures:
  normal backlash: {kind: normal_backlash, of: gear pair}
  arc: {kind: circumferential_backlash, of: gear pair}
  free turn: {kind: angular_backlash, of: gear pair}
  drive TE: {kind: transmission_error, of: gear pair, over: turn, take: curve, positions: %(positions)s}
study: {trials: 100, seed: 1}
"""
WORKED: dict[str, Any] = {
    "z1": 23, "z2": 67, "m": 1, "beta": 30, "hand": "right", "mate": "left", "b1": 16, "b2": 11, "x1": 0.55,
    "x2": 0.5441135839, "a": 53, "wheel": "helical_gear", "positions": 40,
}  # fmt: skip
RING: dict[str, Any] = {
    "wheel": "internal_gear", "z1": 27, "z2": 79, "beta": 15, "mate": "right", "b1": 12, "b2": 10, "x1": 0.2,
    "x2": -0.2, "a": 26.917180691,
}  # fmt: skip


def text(tolerances: str = TOLERANCES, **changed: Any) -> str:
    """A scene of the worked pair, some numbers changed."""
    numbers = {**WORKED, **changed}
    return PARTS % numbers + tolerances + REST % numbers


@pytest.fixture
def scene(tmp_path: Any) -> Scene:
    """The worked pair with every tolerance that acts on it."""
    (path := tmp_path / "helical.yaml").write_text(text())
    return load(path)


@pytest.fixture
def ring_scene(tmp_path: Any) -> Scene:
    """The same of a gear in a ring."""
    (path := tmp_path / "ring.yaml").write_text(text(**RING))
    return load(path)


@pytest.fixture
def driving_ring(ring_scene: Scene) -> Scene:
    """The same, and the ring drives."""
    return ring_scene.with_({"moves.gear pair.driver": "wheel", "moves.gear pair.driven": "pinion"})


ALL_KINDS = pytest.mark.parametrize("kind", ["scene", "ring_scene", "driving_ring"])


def difference(model: Model, deviations: Array, angles: Array) -> Array:
    """Stack-up less exact normal backlash [mm], (rows,)."""
    engine, mesh = ExactEngine(model), model.meshes[0]
    found = engine.read(engine.build(deviations), mesh, Reading(), angles)
    assert (found.status == 0).all()
    return np.asarray(stack_of(model, mesh, Reading()).normal_backlash(deviations, angles) - found.gap)


def random_model(
    rng: np.random.Generator, tmp_path: Any, *, inside: bool = False, tolerances: str = TOLERANCES
) -> Model:
    """A pair with all tolerances, at the distance at which its nominal teeth have no backlash."""
    while True:
        z1, z2 = rng.integers(18, 70, 2).tolist()
        if inside:  # contact away from the pinion's base circle, and room for gears that grow by themselves
            z1, z2 = max(24, min(z1, z2)), max(z1, z2) + 30
        beta, m = float(rng.uniform(8.0, 35.0)), float(rng.uniform(1.0, 4.0))
        hand, mate = ("right", "left") if rng.random() < 0.5 else ("left", "right")
        mate = hand if inside else mate
        b1, b2, (x1, x2) = float(m * rng.uniform(8, 16)), float(m * rng.uniform(8, 16)), rng.uniform(0.0, 0.3, 2)
        own: dict[str, Any] = {"z1": z1, "z2": z2, "m": m, "beta": beta, "hand": hand, "mate": mate, "b1": b1, "b2": b2}
        own["positions"] = 16 * z1  # what deviating teeth need
        apart = m * ((z1 + z2) / 2 / math.cos(math.radians(beta)) + x1 + x2 + 0.05)
        if inside:
            own, x2 = {**own, "wheel": "internal_gear"}, -x1
            apart = m * ((z2 - z1) / 2 / math.cos(math.radians(beta)) - 0.02)
        path = tmp_path / "random.yaml"
        try:
            for made in ("", tolerances):
                path.write_text(text(made, **own, x1=float(x1), x2=float(x2), a=f"{apart:.12f}"))
                model = model_of_scene(path)
                pair = model.meshes[0].pair
                assert isinstance(pair, SpurPair | InternalPair)
                apart = pair.zero_backlash_centre_distance
        except SceneError:
            continue
        return model


def random_builds(model: Model, rng: np.random.Generator, *, kelvin: float, flanks: float = 1.0) -> tuple[Array, Array]:
    """Deviations of some um, tilts of some tenths of a mrad and temperatures, thinner teeth, and angles of the driver.

    Args:
        model: of the builds.
        rng: draws them.
        kelvin: temperatures, per mm of the others.
        flanks: of single flanks, per mm of the others.
    """
    deviations = rng.uniform(-1, 1, (60, model.component_count)) * 0.008
    for contributor in model.contributors:
        columns = model.component_slices[contributor.name]
        factor = flanks if contributor.kind in FLANKS else {"mrad": 0.01, "K": kelvin}.get(contributor.unit, 1.0)
        deviations[:, columns] *= factor
        if contributor.kind == "tooth_thickness":
            deviations[:, columns] -= 0.05
    return deviations, rng.uniform(-3.0, 3.0, len(deviations))


PAIRS = 200


@pytest.mark.slow
@pytest.mark.parametrize("inside", [False, True])
def test_differences_of_the_methods_fall_to_a_quarter_as_deviations_are_halved(inside: bool, tmp_path: Any) -> None:
    """All tolerances of random pairs at once; the backlash itself is one of them, as contact lines end j apart.

    Left out are rings that touch their gear less than the largest backlash above the beginning of its involute: on the
    other side their tips may reach below it, and the exact engine calls such builds out of range.
    """
    rng, ratios = np.random.default_rng(2), list[float]()
    while len(ratios) < PAIRS:
        model = random_model(rng, tmp_path, inside=inside)
        pair = model.meshes[0].pair
        if isinstance(pair, InternalPair) and pair.inner.base_radius * (pair.start_roll - pair.inner.form_roll) < 0.15:
            continue
        # tips of rings reach far where gears grow by themselves
        deviations, angles = random_builds(model, rng, kelvin=100.0 if inside else 500.0)
        whole, half = (np.sqrt((difference(model, own, angles) ** 2).mean()) for own in (deviations, deviations / 2))
        ratios.append(whole / half)
    share = np.mean([3.5 < ratio < 4.5 for ratio in ratios])
    assert share >= 0.95, sorted(ratios)


FLANKS = ("pitch_deviation", "profile_slope", "helix_slope")
SINGLE_FLANKS = TOLERANCES + "".join(
    f"  {gear} {kind}: {{kind: {kind}, of: {gear}, flanks: each, limits: {{iso_class: 6}}, {law}}}\n"
    for gear in ("pinion", "wheel")
    for kind, law in zip(
        FLANKS, ("law: {kind: random_walk, fill: [0.7, 1]}", *2 * ("each: tooth, law: {kind: uniform}",)), strict=True
    )
)


@pytest.mark.slow
@pytest.mark.parametrize(("inside", "flanks"), [(False, 1.0), (True, 0.3)])
def test_so_do_those_with_deviations_of_single_flanks(inside: bool, flanks: float, tmp_path: Any) -> None:
    """Slopes and pitches of every flank by themselves, up to 8 um, in rings up to 2.4 um.

    Left out are builds in which teeth beyond those of the tolerances' class might touch: out of range.
    """
    rng, ratios = np.random.default_rng(3), list[float]()
    while len(ratios) < PAIRS:
        model = random_model(rng, tmp_path, inside=inside, tolerances=SINGLE_FLANKS)
        deviations, angles = random_builds(model, rng, kelvin=100.0 if inside else 500.0, flanks=flanks)
        engine, mesh = ExactEngine(model), model.meshes[0]
        found = [engine.read(engine.build(own), mesh, Reading(), angles) for own in (deviations, deviations / 2)]
        ok = (found[0].status == 0) & (found[1].status == 0)
        if ok.sum() < len(ok) / 2:
            continue
        deviations, angles = deviations[ok], angles[ok]
        whole, half = (np.sqrt((difference(model, own, angles) ** 2).mean()) for own in (deviations, deviations / 2))
        ratios.append(whole / half)
    share = np.mean([3.5 < ratio < 4.5 for ratio in ratios])
    assert share >= 0.95, sorted(ratios)


@ALL_KINDS
def test_builds_at_their_tolerances_differ_by_tenths_of_a_micrometre(kind: str, request: pytest.FixtureRequest) -> None:
    model = model_of_scene(request.getfixturevalue(kind))
    rng = np.random.default_rng(5)
    rows = [
        contributor.draw.deviations(*(1.0 - rng.random((contributor.draw.uniforms, 500))))
        for contributor in model.contributors
    ]
    deviations = np.stack([column for own in rows for column in own], axis=1)
    off = difference(model, deviations, rng.uniform(-3.0, 3.0, 500))
    assert np.sqrt((off**2).mean()) < 0.15e-3  # mm; squares of 20 um over the flanks' radii, and f j/tan(beta_b)
    assert np.abs(off).max() < 0.6e-3


@pytest.mark.parametrize("kind", ["external", "ring", "driving ring"])
def test_transmission_error_and_backlash_follow_contact_lines_of_tilted_axes(kind: str, tmp_path: Any) -> None:
    """A constant tilt of 0.3 mrad alone: up to p_bn sin(beta_b) cos(beta_b) f within every pitch, by both methods."""
    constant = "distribution: {kind: constant, value: "
    tilt = f"tolerances:\n  out: {{kind: axis_out_of_plane, of: gear pair, {constant}0.3 mrad}}}}\n"
    driven = "pinion" if kind == "driving ring" else "wheel"  # a thinner driver's lines would lie elsewhere
    thin = f"  thin: {{kind: tooth_thickness, of: {driven}, {constant}-100 um}}}}\n"
    (path := tmp_path / "tilted.yaml").write_text(text(tilt + thin, **({} if kind == "external" else RING)))
    swapped = {"moves.gear pair.driver": "wheel", "moves.gear pair.driven": "pinion"}
    model = model_of_scene(load(path).with_(swapped if kind == "driving ring" else {}))
    measure = measure_of(model, "drive TE")
    deviations = np.array([[own.distribution.mean for own in model.contributors]])
    trials = Trials(deviations, {mesh.name: np.zeros(1) for mesh in model.meshes})
    by_stack = analytic_values(model, measure, trials)[0]
    engine, mesh = ExactEngine(model), model.meshes[0]
    angles = np.array(model.driver_angles(measure, mesh.name))
    rests, _ = engine.rests(engine.build(deviations), mesh, Reading(), angles)
    ((sense, _),) = measure.kind.backlashes  # inside a ring gears turn alike
    turned = sense * (rests.driven_angle[0] - mesh.pair.driven_angle(angles))
    exact = turned - turned[0]
    pair = mesh.pair
    assert isinstance(pair, SpurPair | InternalPair)
    beta_b, f = pair.pinion.base_helix_angle, 0.3e-3 * math.cos(pair.working_pressure_angle)
    largest = pair.pinion.base_pitch * math.sin(beta_b) * math.cos(beta_b) * f / pair.wheel.section_arm
    assert 0.4 * largest < np.ptp(exact) < 1.05 * largest
    assert np.abs(by_stack - exact).max() < 0.15 * largest  # lines end where mates do that stand the backlash apart
    rows = np.repeat(deviations, len(angles), axis=0)
    gap = engine.read(engine.build(rows), mesh, Reading(), angles).gap
    off = stack_of(model, mesh, Reading()).normal_backlash(rows, angles) - gap
    assert np.abs(off).max() < 0.3 * largest * pair.wheel.section_arm  # of both sides


@ALL_KINDS
def test_axial_shifts_turn_the_mate_and_open_nothing(kind: str, request: pytest.FixtureRequest) -> None:
    model = model_of_scene(request.getfixturevalue(kind))
    deviations = np.zeros((2, model.component_count))
    deviations[1, model.component_slices["wheel axial"]] = 0.05
    deviations[1, model.component_slices["pinion face"]] = -0.03
    engine, mesh = ExactEngine(model), model.meshes[0]
    deviations[:, model.component_slices["distance"]] = 0.05 if kind == "scene" else -0.05  # room for the teeth
    found = engine.read(engine.build(deviations), mesh, Reading(), np.array([0.4, 0.4]))
    assert found.gap[0] == pytest.approx(found.gap[1], abs=1e-12)
    turned = mesh.pair.wheel.twist * (-0.08 if kind == "driving_ring" else 0.08)
    assert found.driven_angle[1] - found.driven_angle[0] == pytest.approx(turned, abs=1e-13)
    stack = stack_of(model, mesh, Reading())
    aside = stack.aside(deviations, np.array([0.4, 0.4]))
    assert aside[1] - aside[0] == pytest.approx(turned * mesh.pair.wheel.section_arm, abs=1e-15)


@ALL_KINDS
def test_a_tilt_in_the_plane_of_the_axes_screws_the_teeth(kind: str, request: pytest.FixtureRequest) -> None:
    """The middle of both rests turns by kappa2 r_w2 of it, beside what the contact lines take from either side."""
    model = model_of_scene(request.getfixturevalue(kind))
    deviations = np.zeros((2, model.component_count))
    deviations[1, model.component_slices["in plane"]] = 1e-4
    deviations[:, model.component_slices["distance"]] = 0.05 if kind == "scene" else -0.05
    engine, mesh = ExactEngine(model), model.meshes[0]
    drive, back = engine.rests(engine.build(deviations), mesh, Reading(), np.array([0.4]))
    middle = (drive.driven_angle + back.driven_angle)[:, 0] / 2
    aside = stack_of(model, mesh, Reading()).aside(deviations, np.array([0.4, 0.4])) / mesh.pair.wheel.section_arm
    assert aside[1] - aside[0] == pytest.approx(middle[1] - middle[0], abs=3e-7)  # f j/tan(beta_b)
    assert abs(aside[1] - aside[0]) > 0.5 * abs(mesh.pair.wheel.twist) * mesh.pair.working_radii[1] * 1e-4


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"parts.wheel.hand": "right"}, "moves.gear pair.driven: external helical gears .* need opposite hands"),
        (
            {"parts.wheel.helix_angle": "29 deg"},
            "moves.gear pair.driven: gears on parallel axes need the same helix_angle",
        ),
        ({"parts.wheel.helix_angle": "-30 deg"}, "expected an angle of zero or more .hand gives the sense"),
        ({"parts.wheel.normal_module": "1 mm"}, "of a helical gear it is the normal module"),
        ({"parts.wheel.transverse_module": "1 mm"}, r"the normal one, m_t cos\(helix_angle\)"),
        (
            {"parts.wheel.module": "1.1547 mm", "parts.pinion.module": "1.1547 mm"},
            "; module is the normal one, 1.1547 mm",
        ),
        ({"parts.wheel.kind": "spur_gear"}, "got 'helix_angle'; gears of kind helical_gear or internal_gear have it"),
        ({"measures.arc.read_at": "mean_section"}, "measures.arc.read_at: expected face, got mean_section"),
        ({"measures.arc.tooth": "driver"}, "measures.arc.tooth: expected all, got driver"),
    ],
)
def test_what_was_never_derived_or_does_not_mesh_is_refused(scene: Scene, changed: dict[str, Any], words: str) -> None:
    with pytest.raises(SceneError, match=words):
        model_of_scene(scene.with_(changed))


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (
            {"parts.wheel.hand": "left"},
            "moves.gear pair.driven: a helical gear and its ring need the same hand, got right and left",
        ),
        ({"parts.wheel.helix_angle": "14 deg"}, "gears on parallel axes need the same helix_angle, got 15 deg and 14"),
        ({"parts.wheel.helix_angle": "-15 deg"}, "expected an angle of zero or more .hand gives the sense"),
        ({"parts.wheel.hand": None}, "parts.wheel.hand: expected right or left beside a helix_angle of 15 deg, got n"),
        (
            {"tolerances.wheel thickness.measured": {"span": 5}},
            "tolerances.wheel thickness.measured.span: an internal helical gear has no span.*such as .balls: 1.65 mm",
        ),
        (
            {"tolerances.wheel thickness.measured": {"pins": "1.7 mm"}},
            "tolerances.wheel thickness.measured.pins: straight pins cut the flanks .*such as .balls: 1.65 mm",
        ),
        ({"measures.arc.read_at": "mean_section"}, "measures.arc.read_at: expected face, got mean_section"),
    ],
)
def test_rings_that_do_not_mesh_are_refused(ring_scene: Scene, changed: dict[str, Any], words: str) -> None:
    with pytest.raises(SceneError, match=words):
        model_of_scene(ring_scene.with_(changed))


@pytest.mark.parametrize(
    ("section", "entry", "words"),
    [
        (
            "tolerances",
            "p: {kind: profile_form, of: wheel, flanks: each, each: tooth, shape: barrel, limits: {iso_class: 6},\n"
            "    law: {kind: uniform}}",
            "tolerances.p.of: expected the name of a spur gear",
        ),
        (
            "tolerances",
            "b: {kind: bearing_clearance, of: left, direction: tooth_force, mesh: gear pair,\n"
            "    distribution: {kind: normal, lower: 2 um, upper: 20 um}}",
            "tolerances.b.direction: expected apart, random, {at: …} or a second bearing, got tooth_force",
        ),
    ],
)
def test_entries_that_know_no_helix_refuse_it(section: str, entry: str, words: str, tmp_path: Any) -> None:
    added = text().replace("  case:", "  left: {kind: bearing, shaft: wheel}\n  case:", 1)
    (path := tmp_path / "added.yaml").write_text(added.replace(f"{section}:\n", f"{section}:\n  {entry}\n", 1))
    with pytest.raises(SceneError, match=re.escape(words)):
        model_of_scene(path)


@pytest.mark.parametrize(
    ("kind", "of", "limit"),
    [
        ({"z2": 40, "a": 121.4}, "138.564 mm", 40.0),  # m_n z is 120 mm, whose range has 30 um
        ({"wheel": "internal_gear", "mate": "right", "z2": 93, "a": 109.0}, "322.16 mm", 52.0),  # 279 mm: 40 um
    ],
)
def test_a_graded_run_out_of_teeth_is_that_of_the_reference_diameter(
    kind: dict[str, Any], of: str, limit: float, tmp_path: Path
) -> None:
    """m_n z/cos(beta) as drawings round it, of a ring too; F_r of grade 7 at m_n 3 by the table of ISO 1328-2:1997."""
    own = {"z1": 30, "m": 3, "beta": 30, "b1": 30, "b2": 30, "x1": 0, "x2": 0, **kind}

    def checked(stated: str) -> Model:
        grade = f"distribution: {{iso_1328_2: F_r 7, module: 3 mm, of: {stated}, law: {{kind: uniform}}}}"
        (path := tmp_path / "graded.yaml").write_text(
            text(f"tolerances:\n  own: {{kind: tooth_run_out, of: wheel, {grade}}}\n", **own)
        )
        return model_of_scene(path)

    with pytest.raises(SceneError, match=f"of: expected {of[:5]}.*, as 'wheel' has it"):
        checked(f"{3 * own['z2']} mm")
    (contributor,) = checked(of).contributors
    assert 2e3 * contributor.distribution.high == pytest.approx(limit, abs=1e-9)  # teeth off by half of it


class Unknown(MoveSpec):
    """A move of a mechanism that knows no helix."""

    words: ClassVar[str] = "a move of another mechanism"
    kind: Literal["unknown"] = "unknown"

    def references(self) -> tuple[Reference, ...]:
        """A gear."""
        return (Reference(("gear",), "pinion", (HelicalGearSpec,)),)


def test_moves_of_other_mechanisms_refuse_helical_gears(scene: Scene) -> None:
    """Those that they name."""
    beside = scene.model_copy(update={"moves": {**scene.moves, "x": Unknown()}})
    found = dict(helices_elsewhere(beside))
    assert set(found) == {("parts", "pinion", "kind")}
    assert "expected a spur_gear, for 'x' is a move of another mechanism" in found["parts", "pinion", "kind"]
    assert not list(helices_elsewhere(scene))


def test_records_of_a_rig_know_spur_gears_alone(scene: Scene) -> None:
    meshes = {mesh.name: mesh for mesh in model_of_scene(scene).meshes}
    with pytest.raises(InputError, match="expected a mesh of two external spur gears, got none"):
        mesh_of(meshes, "helical pair", None)


def test_a_steep_helix_and_contact_by_overlap_alone_are_warned_of(tmp_path: Any) -> None:
    (path := tmp_path / "steep.yaml").write_text(text("", beta=50, x1=0, x2=0, b1=9, b2=9, a=70.1))
    scene = load(path)
    said = " ".join(map(str, scene.grammar.warnings(scene)))
    assert (
        "50 deg is steeper than the 45 deg that gears on parallel axes have at most as a rule; simulated as it is"
        in said
    )
    assert any("is below 1: contact is kept by the overlap" in own for own in check_scene(scene).model.warnings)


def test_check_prints_the_helix_and_sizes_over_balls(scene: Scene) -> None:
    said = printed(check_scene(scene))
    for label in ("normal module m_n [mm]", "helix angle β [°], hand", "overlap ratio ε_β", "total contact ratio ε_γ"):
        assert label in said


def test_check_prints_a_helical_ring_between_balls_alone(ring_scene: Scene) -> None:
    said = printed(check_scene(ring_scene))
    for label in (
        "79, inside",
        "15, right   15, right",
        "arc s_n, normal section",
        "outer diameter",
        "between balls of",
    ):
        assert label in said
    assert "over 4 spaces" not in said
    assert "between pins of" not in said


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_the_witness_agrees_within_its_chord_error(seed: int, tmp_path: Any) -> None:
    """FCL on strips between generators of the CAD flanks, random pairs with every tolerance, the last two of rings."""
    model = random_model(np.random.default_rng(70 + seed), tmp_path, inside=seed > 5)
    strips = {part.name: measuring_strips(part.gear, 96) for part in model.gears}
    trials = drawn_trials(model, 1, 0, 6)
    measures = [measure_of(model, "normal backlash"), measure_of(model, "arc")]
    by_fcl, exact = (
        gear_columns(model, engine, trials, measures) for engine in (fcl_engine(model, strips), ExactEngine(model))
    )
    chord = sum(own.chord_error for own in strips.values()) * 1e3
    compared = 0
    for name, values in exact.items():
        if name.startswith("geometric:"):
            compared += 1
            # two contacts of two flanks; circumferential arcs are 1/(cos alpha cos beta) as long
            assert np.abs(np.asarray(by_fcl[name]) - np.asarray(values)).max() < 3.2 * chord + 0.02, name
    assert compared >= 2
