"""Transmission error of a mesh, or of the meshes of a train in series."""

from dataclasses import replace
from typing import Final

from tol3d.gearing.grammar.measures import TransmissionErrorSpec
from tol3d.gearing.model.drive import least_common
from tol3d.gearing.model.links import Link, Parallel
from tol3d.gearing.model.measure import Backlash, Measure, TransmissionError
from tol3d.gearing.model.measures.measured import measured
from tol3d.gearing.model.mesh import Mesh
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.readings import reader_of
from tol3d.gearing.model.shafts import Train
from tol3d.scene import Scene
from tol3d.system.positions import Positions

POSITIONS_A_TOOTH: Final = 16  # the eighth harmonic of the tooth mesh, and its peak to 1e-3 by the parabola
MOST_IN_ALL: Final = 1_000_000  # positions of a trial: 8 MB of them, and as many contacts


@measured.register
def _(spec: TransmissionErrorSpec, scene: Scene, name: str, model: Model) -> Measure:
    mesh = next((mesh for mesh in model.meshes if mesh.name == spec.of), None)
    if mesh is not None:
        kind = TransmissionError(mesh.name, mesh.driven, spec.flank, ((_pushed(mesh), _rest(spec, mesh)),))
        turns = mesh.pair.long_period_turns
    else:
        kind = _of_train(spec, scene, name, model)
        turns = _period(model, kind)
    _refuse_coarse(spec, scene, name, model, kind)
    turns = 1 if spec.over == "turn" else turns
    if turns * spec.positions > MOST_IN_ALL:
        raise scene.refuse(
            ("measures", name, "over"),
            f"expected up to {MOST_IN_ALL} positions in all, got {spec.positions} a turn over {turns} turns; take "
            "fewer a turn, or over: turn",
        )
    return Measure(name, kind, Positions(spec.over, turns, turns * spec.positions), spec.take)


def _rest(spec: TransmissionErrorSpec, mesh: Mesh) -> Backlash:
    reading = replace(reader_of(spec)(mesh), flank=spec.flank)
    return Backlash("rest_angle", mesh.name, mesh.driven, reading)


def _pushed(mesh: Mesh) -> float:
    """The sense about its z in which the driver pushes the driven gear: off its right flanks, forwards."""
    return float(mesh.driven_flank)


def _of_train(spec: TransmissionErrorSpec, scene: Scene, name: str, model: Model) -> TransmissionError:
    train = model.train(spec.of)
    path = model.layout.load_path(train.driven, train.output)
    meshes = [_mesh_of(element, scene, name, model, train) for element in path]
    if not meshes:
        raise scene.refuse(("measures", name, "of"), f"expected a train with a mesh, got {train.output!r} alone")
    senses, backlashes = [], []
    for mesh in meshes:
        shaft, carried = model.layout.carrying[mesh.driven]
        ratio = float(model.layout.ratio(train.output, shaft))
        senses.append((1.0 if ratio > 0.0 else -1.0) * carried.sense * _pushed(mesh))
        backlashes.append((abs(ratio) * _pushed(mesh), _rest(spec, mesh)))
    for mesh, sense in zip(meshes, senses, strict=True):
        if sense != senses[0]:
            raise scene.refuse(
                ("measures", name, "of"),
                f"expected working flanks that push {train.output!r} one way, got those of {meshes[0].name!r} and "
                f"{mesh.name!r}, which push it two; let the train's load choose (working_flank: either), or change one",
            )
    return TransmissionError(train.name, train.output, spec.flank, tuple(backlashes), train=True)


def _mesh_of(element: Link | Parallel, scene: Scene, name: str, model: Model, train: Train) -> Mesh:
    """The mesh that a link of a train is.

    Raises:
        SceneError: it is something whose transmission error nobody states.
    """
    mesh = next((mesh for mesh in model.meshes if mesh.name == element.name), None)
    if mesh is not None:
        return mesh
    if isinstance(element, Parallel):
        what = f"the parallel load paths {element.name}"
    else:
        link = model.link(element.name)
        what = f"{element.name!r}, {scene.moves[element.name].words} {link.unfollowed}"
    raise scene.refuse(
        ("measures", name, "of"),
        f"expected meshes in series from {train.driven!r} to {train.output!r}, got {what}; measure mesh by mesh",
    )


def _period(model: Model, kind: TransmissionError) -> int:
    """Turns of the first shaft until all teeth of a train meet again in the same places."""
    rates = {name: abs(model.layout.mesh_turn[name].rate) for name in kind.meshes}
    period = least_common([model.mesh(name).pair.long_period_turns / rates[name] for name in kind.meshes])
    return period.numerator


def _refuse_coarse(spec: TransmissionErrorSpec, scene: Scene, name: str, model: Model, kind: TransmissionError) -> None:
    """Refuse positions between which the errors of single teeth would be missed.

    Raises:
        SceneError: with the number that it takes.
    """
    for mesh in map(model.mesh, kind.meshes):
        deviating = [
            gear
            for gear in (mesh.driver, mesh.driven)
            if any(contributor.effect.deviates_teeth(gear) for contributor in model.contributors)
        ]
        rate = abs(model.layout.mesh_turn[mesh.name].rate) if kind.train else 1
        needed = -(-POSITIONS_A_TOOTH * mesh.pair.pinion.teeth * rate // 1)
        if deviating and spec.positions < needed:
            raise scene.refuse(
                ("measures", name, "positions"),
                f"expected at least {needed}, {POSITIONS_A_TOOTH} for each tooth that {mesh.name!r} goes through in a "
                f"turn, because single teeth of {deviating[0]!r} deviate; got {spec.positions}",
            )
