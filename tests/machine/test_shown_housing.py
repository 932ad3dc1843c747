"""A housing with a solid stands around its gears, in their world: origin in the first bore, directions of the parts."""

from pathlib import Path

import numpy as np
import pytest
from machine.housed import FOUR_BORES, housed_scene

from tol3d.gearing.machine.presenting import PRESENTER
from tol3d.report.body import Body
from tol3d.simulate import Overrides, run_scene

BUILDER = """
    builder:
      {kind: housing, corner: [-60 mm, -50 mm, -40 mm], size: [200 mm, 150 mm, 80 mm], walls: 12 mm,
       bores: {bore 1: {wall: back, at: [0 mm, 0 mm], diameter: 9 mm}}}"""
ASIDE = """
  aside: {kind: plus_minus, of: housing.bore 2, along: [1, 0, 0], distribution: {kind: constant, value: 0.05 mm}}"""


def extent(body: Body) -> list[float]:
    """Lowest x, y, z and highest x, y, z."""
    vertices, _ = body.mesh
    return [*vertices.min(axis=0).tolist(), *vertices.max(axis=0).tolist()]


@pytest.mark.parametrize(
    ("placed", "box", "bore"),
    [
        ("{}", (-60, -50, -10, 140, 100, 70), (60.15, 45, 0)),
        # turned by 90 degrees about z: x is where -y was, y where x was, whatever its place
        ("{at: [10 mm, 20 mm, 30 mm], x: [0, 1, 0]}", (-100, -60, -10, 50, 140, 70), (-45, 60.15, 0)),
    ],
)
def test_a_housing_stands_around_its_gears(
    tmp_path: Path, placed: str, box: tuple[float, ...], bore: tuple[float, ...]
) -> None:
    scene = tmp_path / "housed.yaml"
    scene.write_text(housed_scene(tolerances=ASIDE, features=FOUR_BORES + BUILDER, placed=placed), encoding="utf-8")
    run = run_scene(scene, overrides=Overrides(trials=2), out=tmp_path / "run")
    (world,) = PRESENTER.display(run, 1, magnify=1.0).worlds
    bodies = {body.name: body for body in world.bodies}
    housing = bodies["housing"]
    assert extent(housing) == pytest.approx(box, abs=1e-9)
    assert world.points["housing.bore 2"] == pytest.approx(bore, abs=1e-9)  # of the trial; the solid is as drawn
    assert [housing.opacity < 1.0, bodies["wheel"].opacity, housing.details is None] == [True, 1.0, False]
    # the shaft runs in its bore: its middle lies halfway between the bores of the trial and of the drawing's far side
    low, high = np.array(extent(bodies["last shaft"])).reshape(2, 3)[:, :2]
    reach = (high - low).max() / 2
    assert np.linalg.norm((low + high) / 2 - bore[:2]) < 0.05 + 1e-3 * reach  # facets round
    assert housing.posed is not None
    corner = housing.posed().world_from_part @ (-60, -50, -40, 1)
    turned = (-60, -50, -10) if placed == "{}" else (50, -60, -10)
    assert corner[:3] == pytest.approx(turned, abs=1e-9)  # for STEP
