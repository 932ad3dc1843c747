"""Backlash of one mesh."""

from tol3d.gearing.grammar.measures import AngularBacklashSpec, CircumferentialBacklashSpec, NormalBacklashSpec
from tol3d.gearing.model.measure import Backlash, Measure
from tol3d.gearing.model.measures.measured import measured
from tol3d.gearing.model.mesh import Mesh
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.readings import reader_of
from tol3d.scene import Scene
from tol3d.scene.direction import At
from tol3d.system.positions import Positions

BacklashSpec = NormalBacklashSpec | CircumferentialBacklashSpec | AngularBacklashSpec


@measured.register(NormalBacklashSpec)
@measured.register(CircumferentialBacklashSpec)
@measured.register(AngularBacklashSpec)
def _(spec: BacklashSpec, scene: Scene, name: str, model: Model) -> Measure:
    mesh = model.mesh(spec.of)
    gear = getattr(spec, "gear", None) or mesh.driven
    return Measure(
        name, Backlash(spec.kind, mesh.name, gear, reader_of(spec)(mesh)), _positions_of_mesh(spec, mesh), spec.take
    )


def _positions_of_mesh(spec: BacklashSpec, mesh: Mesh) -> Positions:
    if isinstance(spec.over, At):
        return Positions("at", 1, 1, spec.over.at.internal)
    if spec.over == "random":
        return Positions("random", mesh.pair.long_period_turns, 1)
    turns = 1 if spec.over == "turn" else mesh.pair.long_period_turns
    return Positions(spec.over, turns, turns * spec.positions)
