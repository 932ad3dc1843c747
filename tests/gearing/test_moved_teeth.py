"""Single flanks on axes that move: the path of contact goes with the axes, leaning ones add to helix slopes."""

from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from fixtures import strips_of
from numpy.typing import NDArray

from tol3d import Overrides, load_scene, run_scene
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.engines.fcl import FclEngine
from tol3d.gearing.meshing import Meshing
from tol3d.gearing.model import Model, Reading, model_from_scene
from tol3d.gearing.stack_up import stack_of

Array = NDArray[np.float64]

SCENE = """
scene: moved
parts:
  pinion: {{kind: spur_gear, teeth: 20, module: 2 mm, face_width: 12 mm}}
  wheel: {{kind: spur_gear, teeth: 30, module: 2 mm, face_width: 10 mm}}
tolerances:
{tolerances}
moves:
  pair: {{kind: mesh, driver: pinion, driven: wheel, centre_distance: 50.2 mm, working_flank: {flank}}}
measures:
  play: {{kind: normal_backlash, of: pair}}
"""
WALK = "limits: {iso_class: 6}, law: {kind: random_walk, fill: [0.7, 1]}"
FREE = "each: tooth, limits: {iso_class: 6}, law: {kind: uniform}"
TEETH = [f"{gear} pitch: {{kind: pitch_deviation, of: {gear}, flanks: each, {WALK}}}" for gear in ("pinion", "wheel")]
SLOPES = [f"{gear} slope: {{kind: profile_slope, of: {gear}, flanks: each, {FREE}}}" for gear in ("pinion", "wheel")]
COUNT = 300
BASES = (20 * np.cos(np.radians(20)), 30 * np.cos(np.radians(20)))
Turns = Literal["driver", "driven"]


def model_of(folder: Path, tolerances: list[str], flank: str = "right") -> Model:
    path = folder / "scene.yaml"
    path.write_text(SCENE.format(tolerances="\n".join(f"  {own}" for own in tolerances), flank=flank), "utf-8")
    return model_from_scene(load_scene(path))


def drawn(model: Model, count: int) -> tuple[Array, Array]:
    generator = np.random.default_rng(4)
    columns = [
        np.stack(np.broadcast_arrays(*own.draw.deviations(*generator.random((own.draw.uniforms, count))),
                                     np.zeros(count))[:-1], axis=-1)
        for own in model.contributors
    ]  # fmt: skip
    return np.concatenate(columns, axis=1), generator.uniform(0.0, 6 * np.pi, count)


def off_um(model: Model, deviations: Array, angle: Array, turns: Turns | None) -> Array:
    """The stack-up less the exact engine, of the gap or of a turn at its arm."""
    engine, mesh = ExactEngine(model), model.meshes[0]
    found = engine.read(engine.build(deviations), mesh, Reading(), angle, frozenset(("pinion", "wheel")))
    assert (found.status == 0).all()
    exact = {None: found.gap, "driven": BASES[1] * found.driven_turn, "driver": BASES[0] * found.driver_turn}[turns]
    return 1e3 * (stack_of(model, mesh, Reading()).normal_backlash(deviations, angle, turns) - exact)


MOVES = {
    "centre distance": "{kind: centre_distance, of: pair, distribution: {kind: constant, value: 50 um}}",
    "wheel runs out": "{kind: eccentricity, of: wheel, distribution: {kind: constant, value: 50 um}}",
    "pinion runs out": "{kind: eccentricity, of: pinion, distribution: {kind: constant, value: 50 um}}",
    "thin teeth": "{kind: tooth_thickness, of: wheel, distribution: {kind: constant, value: -50 um}}",
}


@pytest.mark.slow
@pytest.mark.parametrize("flank", ["right", "left"])
@pytest.mark.parametrize("moved", MOVES)
def test_the_path_of_contact_goes_with_the_axes(moved: str, flank: str, tmp_path: Path) -> None:
    """50 um move its ends by 0.15 mm; pairs that leave it there differ by up to 4 um of gears that stay.

    What teeth add to the squares of the move (0.14 um, taken out) goes with the square of the slopes.
    """
    model = model_of(tmp_path, [*TEETH, *SLOPES, f"move: {MOVES[moved]}"], flank)
    deviations, angle = drawn(model, COUNT)
    alike = deviations.copy()
    alike[:, : -len(model.contributors[-1].draw.components)] = 0.0
    turns: tuple[Turns | None, ...] = (None, "driven", "driver")
    for own in turns:
        off = off_um(model, deviations, angle, own) - off_um(model, alike, angle, own)
        assert np.abs(off).max() < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("gear", ["pinion", "wheel"])
@pytest.mark.parametrize("side", ["right", "left", "together"])
@pytest.mark.parametrize("tilt", ["axis_out_of_plane", "axis_in_plane"])
def test_leaning_axes_add_to_helix_slopes_at_the_end_where_both_count(
    tilt: str, side: str, gear: str, tmp_path: Path
) -> None:
    """10 um of each: with the other sign of the lean a flank side would lose up to 9 um more or less."""
    given = "left: [10 um]" if side == "left" else "right: [10 um]"
    helix = f"{{kind: helix_slope, of: {gear}, flanks: {side}, each: gear, law: {{kind: given, {given}}}}}"
    for value in (-10, 10):
        lean = f"{{kind: {tilt}, of: pair, distribution: {{kind: constant, value: {value} um}}}}"
        model = model_of(tmp_path, [f"helix: {helix}", f"lean: {lean}"])
        deviations, angle = drawn(model, 2)
        assert np.abs(off_um(model, deviations, angle, None)).max() < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("value", [-10, 10])
def test_fcl_sees_leaning_axes_and_helix_slopes_add_up(value: int, tmp_path: Path) -> None:
    helix = "{kind: helix_slope, of: pinion, flanks: right, each: gear, law: {kind: given, right: [10 um]}}"
    lean = f"{{kind: axis_out_of_plane, of: pair, distribution: {{kind: constant, value: {value} um}}}}"
    model = model_of(tmp_path, [f"helix: {helix}", f"lean: {lean}"])
    deviations, angle = drawn(model, 3)
    fcl = FclEngine(model, {part.name: strips_of(part.gear, model.profile_steps) for part in model.gears})
    made = ExactEngine(model).build(deviations)
    seen = 1e3 * Meshing(fcl, model, model.meshes[0], made, Reading()).seat(angle).non_working.smallest()
    by_theory = 1e3 * stack_of(model, model.meshes[0], Reading()).normal_backlash(deviations, angle, None)
    assert seen == pytest.approx(by_theory, abs=4e3 * fcl.chord_error + 0.1)


@pytest.mark.slow
def test_single_flanks_in_a_housing_agree_on_both_roads(tmp_path: Path) -> None:
    """Trial by trial; what is left is of leaning axes, whose ends move the path of contact along the face."""
    gears = ("first pinion", "first wheel", "second pinion", "second wheel")
    teeth = [f"  {own} pitch: {{kind: pitch_deviation, of: {own}, flanks: each, {WALK}}}" for own in gears]
    teeth += [f"  {own} slope: {{kind: profile_slope, of: {own}, flanks: each, {FREE}}}" for own in gears]
    text = (Path(__file__).parents[2] / "scenes" / "housed_gears.yaml").read_text("utf-8")
    (tmp_path / "housed.yaml").write_text(text.replace("tolerances:\n", "tolerances:\n" + "\n".join(teeth) + "\n", 1))
    run = run_scene(tmp_path / "housed.yaml", overrides=Overrides(trials=400, witness=0), out=tmp_path / "run")
    columns = run.columns()
    for name in ("first normal backlash", "second normal backlash"):
        off = columns[f"analytic:{name}"] - columns[f"geometric:{name}"]
        assert np.sqrt(np.mean(off**2)) < 0.15  # um
        assert np.abs(off).max() < 1.1
