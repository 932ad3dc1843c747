"""Single flanks on axes that move: the path of contact goes with the axes, leaning ones add to helix slopes."""

from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from fixtures import strips_of
from gearing.deviating_pair import BASES, draws, model_of
from numpy.typing import NDArray

from tol3d import Overrides, run_scene
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.engines.fcl import FclEngine
from tol3d.gearing.meshing.mesh import Meshing
from tol3d.gearing.model import Model, Reading
from tol3d.gearing.stack_up import stack_of

Array = NDArray[np.float64]

WALK = "limits: {iso_class: 6}, law: {kind: random_walk, fill: [0.7, 1]}"
FREE = "each: tooth, limits: {iso_class: 6}, law: {kind: uniform}"
TEETH = [f"  {gear} pitch: {{kind: pitch_deviation, of: {gear}, flanks: each, {WALK}}}" for gear in ("pinion", "wheel")]
SLOPES = [f"  {gear} slope: {{kind: profile_slope, of: {gear}, flanks: each, {FREE}}}" for gear in ("pinion", "wheel")]
COUNT = 300
Turns = Literal["driver", "driven"]


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
    "thin driver": "{kind: tooth_thickness, of: pinion, distribution: {kind: constant, value: -80 um}}",
}


@pytest.mark.slow
@pytest.mark.parametrize("flank", ["right", "left"])
@pytest.mark.parametrize("moved", MOVES)
def test_the_path_of_contact_goes_with_the_axes(moved: str, flank: str, tmp_path: Path) -> None:
    """50 um move its ends by 0.15 mm; pairs that leave it there differ by up to 4 um of gears that stay.

    The driver's teeth meet where their flanks stand, thinner ones later: by up to 2 um of pairs at tip edges.

    What teeth add to the squares of the move (0.14 um, taken out) goes with the square of the slopes.
    """
    model = model_of(tmp_path, "\n".join(TEETH + SLOPES + [f"  move: {MOVES[moved]}"]), flank)
    deviations, angle = draws(model, COUNT, 4)
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
        model = model_of(tmp_path, f"  helix: {helix}\n  lean: {lean}")
        deviations, angle = draws(model, 2, 4)
        assert np.abs(off_um(model, deviations, angle, None)).max() < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("value", [-10, 10])
def test_fcl_sees_leaning_axes_and_helix_slopes_add_up(value: int, tmp_path: Path) -> None:
    helix = "{kind: helix_slope, of: pinion, flanks: right, each: gear, law: {kind: given, right: [10 um]}}"
    lean = f"{{kind: axis_out_of_plane, of: pair, distribution: {{kind: constant, value: {value} um}}}}"
    model = model_of(tmp_path, f"  helix: {helix}\n  lean: {lean}")
    deviations, angle = draws(model, 3, 4)
    fcl = FclEngine(model, {part.name: strips_of(part.gear, model.profile_steps) for part in model.gears})
    made = ExactEngine(model).build(deviations)
    seen = 1e3 * Meshing(fcl, model, model.meshes[0], made, Reading()).seat(angle).non_working.smallest()
    by_theory = 1e3 * stack_of(model, model.meshes[0], Reading()).normal_backlash(deviations, angle, None)
    assert seen == pytest.approx(by_theory, abs=4e3 * fcl.chord_error + 0.1)


@pytest.mark.slow
def test_single_flanks_in_a_housing_agree_on_both_methods(tmp_path: Path) -> None:
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
