"""Shifts of bevel gears' apexes along the pitch line, against vectors in the world; gears unequal, axes not square."""

import numpy as np
import pytest
from numpy.typing import NDArray

from tol3d.gearing.effects import AxisOffset, AxisTilt, Effect, TurningOffset
from tol3d.gearing.model import Contributor, Reading
from tol3d.gearing.stack_up.term import NominalMesh, Role
from tol3d.gearing.stack_up.terms import contribution
from tol3d.gearing.system import GearSystem
from tol3d.gears import BevelPair
from tol3d.simulate import Overrides, load, simulation_of
from tol3d.statistics.distributions.normal import Normal
from tol3d.study.system.draw import Planar, Scalar

Array = NDArray[np.float64]

TEXT = """
scene: an unequal bevel pair
parts:
  pinion: {kind: bevel_gear, teeth: 17, module: 3 mm, pressure_angle: 20 deg, face_width: 12 mm}
  wheel: {kind: bevel_gear, teeth: 41, module: 3 mm, pressure_angle: 20 deg, face_width: 12 mm}
tolerances:
  offset: {kind: axes_offset, of: pair, distribution: {kind: normal, lower: -9 um, upper: 9 um}}
moves:
  pair: {kind: bevel_mesh, driver: pinion, driven: wheel, shaft_angle: 75 deg, working_flank: left}
measures:
  play: {kind: normal_backlash, of: pair}
study: {trials: 10}
"""


@pytest.fixture(scope="module")
def mesh(tmp_path_factory: pytest.TempPathFactory) -> NominalMesh[BevelPair]:
    path = tmp_path_factory.mktemp("bevel") / "scene.yaml"
    path.write_text(TEXT, "utf-8")
    system = simulation_of(load(path), Overrides()).system
    assert isinstance(system, GearSystem)
    (own,) = system.model.meshes
    assert isinstance(own.pair, BevelPair)
    return NominalMesh(system.model, own, own.pair, Reading())


def pitch_line(mesh: NominalMesh[BevelPair], role: Role) -> Array:
    """Direction of the pitch line from the apex, in the gear's own frame; counted as the driver's less the driven's.

    It leans from the axis by the pitch angle: of the driver towards the driven axis, of that one towards the driver's.
    """
    wheel = mesh.pair.world_from_wheel
    axes = {"driver": np.array([0.0, 0.0, 1.0]), "driven": wheel @ (0.0, 0.0, 1.0)}
    other = axes["driven" if role == "driver" else "driver"]
    teeth, others = (17, 41) if role == "driver" else (41, 17)
    apart = np.arccos(axes["driver"] @ axes["driven"])
    assert apart == pytest.approx(np.radians(75))
    leans = np.arctan2(np.sin(apart), others / teeth + np.cos(apart))  # tan delta = sin Sigma / (z' / z + cos Sigma)
    towards = other - (other @ axes[role]) * axes[role]
    line = np.cos(leans) * axes[role] + np.sin(leans) * towards / np.linalg.norm(towards)
    return np.asarray(line if role == "driver" else -(wheel.T @ line))


def along_line(mesh: NominalMesh[BevelPair], effect: Effect, *, planar: bool = False) -> Array:
    """Shift along the pitch line by each component of a contributor at rest."""
    draw = Planar(Normal(0.0, 1.0), None) if planar else Scalar(Normal(0.0, 1.0))
    contributor = Contributor("x", "x", effect, draw, "um")
    term = contribution(effect, mesh, contributor).along_line
    assert term is not None
    return np.concatenate([term.change(row[None], (np.zeros(1), np.zeros(1))) for row in np.eye(2 if planar else 1)])


@pytest.mark.parametrize("role", ["driver", "driven"])
def test_shifts_and_turns_of_an_axis_move_its_apex_along_the_pitch_line(
    mesh: NominalMesh[BevelPair], role: Role
) -> None:
    part, line = "pinion" if role == "driver" else "wheel", pitch_line(mesh, role)
    rng = np.random.default_rng(4)
    for direction in rng.normal(size=(5, 3)):
        unit = direction / np.linalg.norm(direction)
        found = along_line(mesh, AxisOffset(part, tuple(unit.tolist()), 1.7))
        assert found == pytest.approx([1.7 * unit @ line], abs=1e-12)
        turn = along_line(mesh, AxisTilt(part, tuple(unit.tolist()), 1.0, 23.0))  # about (0, 0, 23 mm)
        assert turn == pytest.approx([np.cross(unit, [0.0, 0.0, -23.0]) @ line], abs=1e-11)
    for effect in (AxisOffset(part), TurningOffset(part)):
        assert along_line(mesh, effect, planar=True) == pytest.approx(line[:2], abs=1e-12)


def test_what_shifts_both_gears_alike_shifts_no_apex_against_the_other(mesh: NominalMesh[BevelPair]) -> None:
    unit = np.array([0.36, -0.48, 0.8])
    seen = mesh.pair.world_from_wheel.T @ unit
    both = along_line(mesh, AxisOffset("pinion", (0.36, -0.48, 0.8))) + along_line(
        mesh, AxisOffset("wheel", tuple(seen.tolist()))
    )
    assert both == pytest.approx([0.0], abs=1e-12)
