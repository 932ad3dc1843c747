"""A kind of tolerance of its own, added from the outside: its words, its effect, what that displaces, its first order.

The kind is a coating: every flank of a gear lies further out by its thickness t. An involute that moves along its
normals is an involute of the same base circle, so that each flank side of a spur pair loses t: j_bn falls by 2 t,
exactly. On a bevel pair the same holds to first order in the middle of the face.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from tol3d import Overrides, Run, Scene, load_scene, run_scene
from tol3d.gearing.builds.build import build
from tol3d.gearing.builds.displacements import Displacement, displacements
from tol3d.gearing.builds.rates import build_rates
from tol3d.gearing.builds.slots import FLANK_OFFSET
from tol3d.gearing.effects import Effect
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.engines.exact.compiled_displacements import compiled_displacements
from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearToleranceSpec, Meaning
from tol3d.gearing.mechanism import GEARING
from tol3d.gearing.model import Contributor, Mesh, Model, Reading, model_from_scene
from tol3d.gearing.model.nominal import Nominal
from tol3d.gearing.slopes.coefficients import mean_slopes
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.gearing.stack_up import Term, closed_form, stack_of
from tol3d.gearing.stack_up.term import NominalMesh
from tol3d.gearing.stack_up.terms import NOTHING, Contribution, contributes
from tol3d.gears import GearPair
from tol3d.scene import Grammar
from tol3d.study.system.stated import stated

# what a new kind of tolerance is: four pieces, each of which would be a file of its own ------------------------------


class CoatingSpec(GearToleranceSpec):
    """t, a length: a coating lies on every flank of the gear."""

    kind: Literal["coating"]

    def meaning(self, nominal: Nominal) -> Meaning:
        """The gear is coated."""
        return Meaning(Coating(self.of), least=0.0)


@dataclass(frozen=True)
class Coating(Effect):
    """Thickness [mm] of a layer on every flank of a gear."""

    part: str

    def acts_in(self, mesh: Mesh) -> bool:
        """In every mesh of the gear."""
        return self.part in (mesh.driver, mesh.driven)


@displacements.register
def _(effect: Coating, model: Model, components: int) -> Iterator[Displacement]:
    for seat in model.seats_of(effect.part):
        yield Displacement(seat, FLANK_OFFSET, np.array([[1.0]]))


@contributes(Coating)
def _(effect: Coating, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    return Contribution(opening=Term(contributor, -2.0)) if mesh.role(effect.part) else NOTHING


# a scene with it ----------------------------------------------------------------------------------------------------

COATED = Grammar((replace(GEARING, tolerances=(*GEARING.tolerances, CoatingSpec)),))
LOW, HIGH = 0.002, 0.010  # mm of the coating
ALPHA = math.radians(20.0)
CENTRE_DISTANCE = 50.2  # mm; 20 and 30 teeth of 2 mm stand at 50 mm without play

SCENE = """
scene: coated
parts:
  pinion: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 12 mm}
  wheel: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 10 mm}
tolerances:
  plating: {kind: coating, of: pinion, distribution: {kind: uniform, lower: 2 um, upper: 10 um}}
  wheel thickness: {kind: tooth_thickness, of: wheel, distribution: {kind: uniform, lower: -20 um, upper: 0 um}}
moves:
  pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 50.2 mm}
measures:
  play: {kind: normal_backlash, of: pair}
"""


def coated(folder: Path, text: str = SCENE) -> Scene:
    path = folder / "coated.yaml"
    path.write_text(text, "utf-8")
    return load_scene(path, COATED)


def nominal_play() -> float:
    """j = 2 (r_b1 + r_b2) (inv alpha_w - inv alpha) [mm] of teeth of the nominal thickness."""
    bases = (20 + 30) * math.cos(ALPHA)
    working = math.acos(bases / CENTRE_DISTANCE)
    return 2 * bases * (math.tan(working) - working - math.tan(ALPHA) + ALPHA)


def expected(run: Run) -> Any:
    """Normal backlash [um] of each trial of the scene."""
    plating, thickness = (run.columns(name)[name] for name in ("plating [um]", "wheel thickness [um]"))
    return 1e3 * nominal_play() - 2 * plating - math.cos(ALPHA) * thickness


CHORDS_UM = 0.1  # four flanks of two chords each, 120 steps a flank: 0.012 um apiece


@pytest.mark.parametrize(
    ("engine", "column", "bound_um"),
    [("exact", "geometric:play", 1e-6), ("fcl", "geometric:play", CHORDS_UM), ("analytic", "analytic:play", 1e-9)],
)
def test_a_run_s_engines_read_a_new_kind_as_its_closed_form_says(
    engine: Any, column: str, bound_um: float, tmp_path: Path
) -> None:
    run = run_scene(coated(tmp_path), overrides=Overrides(trials=24, engine=engine), out=tmp_path / "run")
    plating = run.columns("plating [um]")["plating [um]"]
    assert 1e3 * LOW <= plating.min() < plating.max() <= 1e3 * HIGH
    assert run.columns(column)[column] == pytest.approx(expected(run), abs=bound_um)


def test_shares_and_closed_form_know_a_new_kind(tmp_path: Path) -> None:
    """Var(2 t) = 4 (8 um)^2/12 against cos^2 alpha (20 um)^2/12 of the other gear's teeth."""
    scene = coated(tmp_path)
    run = run_scene(scene, overrides=Overrides(trials=20_000), out=tmp_path / "run")
    by_plating, by_thickness = 4 * 8.0**2, (math.cos(ALPHA) * 20.0) ** 2
    share = 100 * by_plating / (by_plating + by_thickness)
    model = model_from_scene(scene)
    form = closed_form(model, model.measures[0])
    assert form is not None
    assert form.percent("plating") == pytest.approx(share, abs=1e-9)
    (told,) = (own for own in run.summary["measures"]["play"]["contributors"] if own["name"] == "plating")
    assert told["analytic_percent"] == pytest.approx(share, abs=1e-9)
    assert abs(told["geometric_percent"] - share) <= 4 * told["geometric_percent_se"] < 2.0


def test_derivatives_by_a_new_kind_are_minus_two_per_mm(tmp_path: Path) -> None:
    model = model_from_scene(coated(tmp_path))
    (play,) = model.measures
    engine = ExactEngine(model)
    deviations = np.array([[0.004, -0.01], [0.009, -0.003], [0.0, 0.0]])
    rates = sensitivities(model, engine, stated(model, deviations), play)
    assert rates[:2, 0] == pytest.approx([-2.0, -2.0], abs=1e-9)
    slopes = {slope.name: slope for slope in mean_slopes(model, engine, play)}
    assert (slopes["plating"].below, slopes["plating"].above) == pytest.approx((-2.0, -2.0), abs=1e-9)


def test_builds_rates_and_compiled_builds_read_the_same_displacement(tmp_path: Path) -> None:
    model = model_from_scene(coated(tmp_path))
    deviations = np.array([[0.004, -0.01], [0.009, 0.0]])
    made, compiled = build(model, deviations), compiled_displacements(model).build(deviations)
    assert made.flank_offset.tolist() == compiled.flank_offset.tolist() == [[0.004, 0.0], [0.009, 0.0]]
    assert build_rates(model, made, deviations).flank_offset[:, :, 0].tolist() == [[1.0, 0.0], [1.0, 0.0]]


def test_of_a_bevel_pair_the_geometry_confirms_a_new_kind_to_first_order(tmp_path: Path) -> None:
    text = """
scene: coated bevel pair
parts:
  pinion: {kind: bevel_gear, teeth: 17, module: 2 mm, face_width: 10 mm}
  wheel: {kind: bevel_gear, teeth: 43, module: 2 mm, face_width: 10 mm}
tolerances:
  plating: {kind: coating, of: wheel, distribution: {kind: uniform, lower: 2 um, upper: 10 um}}
  thin: {kind: tooth_thickness, of: pinion, distribution: {kind: constant, value: -60 um}}
moves:
  pair: {kind: bevel_mesh, driver: pinion, driven: wheel, shaft_angle: 90 deg}
measures:
  play: {kind: normal_backlash, of: pair}
"""
    model = model_from_scene(coated(tmp_path, text))
    (play,), engine = model.measures, ExactEngine(model)
    rates = sensitivities(model, engine, stated(model, np.array([[0.006, -0.06]])), play)
    stack = stack_of(model, model.meshes[0], Reading())
    (plating,) = (term for term in stack.terms if term.contributor.name == "plating")
    assert rates[0, 0] == pytest.approx(plating.coefficient, abs=2e-3)


def test_a_word_of_no_kind_is_refused_and_the_new_one_named(tmp_path: Path) -> None:
    with pytest.raises(Exception, match="coating"):
        coated(tmp_path, SCENE.replace("kind: coating", "kind: coatin"))
    shipped = tmp_path / "shipped.yaml"
    shipped.write_text(SCENE, "utf-8")
    with pytest.raises(Exception, match="coating"):
        load_scene(shipped)


# what is forgotten is named ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Forgotten(Effect):
    """An effect without displacements and term."""

    def acts_in(self, mesh: Mesh) -> bool:
        """Nowhere."""
        return False


def test_an_effect_that_a_method_does_not_know_is_named(tmp_path: Path) -> None:
    model = model_from_scene(coated(tmp_path))
    first, *others = model.contributors
    model = replace(model, contributors=(replace(first, effect=Forgotten()), *others))
    with pytest.raises(TypeError, match=r"displacements.py has no function for the effect Forgotten"):
        build(model, np.zeros((1, model.component_count)))
    with pytest.raises(TypeError, match=r"stack_up/terms.py has no function for the effect Forgotten"):
        stack_of(model, model.meshes[0], Reading())
