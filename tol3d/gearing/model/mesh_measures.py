"""Measures of meshes from their entries in a scene."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import singledispatch
from typing import Final, Literal

import numpy as np

from tol3d.gearing.grammar.measures import (
    AngularBacklashSpec,
    CircumferentialBacklashSpec,
    FlankMeasureSpec,
    NormalBacklashSpec,
    TransmissionErrorSpec,
)
from tol3d.gearing.model.links import Link, Parallel, least_common
from tol3d.gearing.model.measure import Backlash, Kind, Measure, Reading, TransmissionError
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.reversals import of_reversals
from tol3d.gearing.model.slides import slides_of_mesh
from tol3d.gearing.shafts import Mesh, Train
from tol3d.gears import one_tooth_acts, one_tooth_share
from tol3d.scene import Scene
from tol3d.scene.bases import MeasureEntry
from tol3d.scene.direction import At
from tol3d.study.system.positions import Positions

Reader = Callable[[Mesh], Reading]
"""Reading of each mesh on a path."""


def default_reading(mesh: Mesh) -> Reading:
    """Reading of all teeth: over the whole face of cylindrical pairs, in the middle section of bevel pairs."""
    return Reading("section", "section") if mesh.pair.arm_spread > 0.0 else Reading()


def reader_of(spec: FlankMeasureSpec) -> Reader:
    """Reading as stated, else the default of the pair; only a normal gap may be read elsewhere than the contact."""

    def read(mesh: Mesh) -> Reading:
        default = default_reading(mesh)
        read_at = spec.read_at or ("mean_section" if default.contact == "section" else "face")
        contact: Literal["face", "section"] = "section" if read_at == "mean_section" else "face"
        gap = "section" if read_at == "face_contact" and spec.kind == "normal_backlash" else contact
        return Reading(contact, gap, spec.tooth)

    return read


def reader_like(kind: Kind | None) -> Reader:
    """Reading as by another measure of the mesh; the default if it does not read the mesh, or there is none."""
    known = {} if kind is None else {backlash.mesh: backlash.reading for _, backlash in kind.backlashes}
    return lambda mesh: known.get(mesh.name) or default_reading(mesh)


def refuse_idle_teeth(scene: Scene, place: tuple[str, ...], measure: Measure, model: Model) -> None:
    """Refuse to read one tooth at positions at which its flanks are not both in action.

    Args:
        scene, place: of the entry that is refused.
        measure: with its readings and positions.
        model: with its meshes.

    Raises:
        SceneError: with the number or the fraction of positions at which both are.
    """
    for tooth in _idle(measure, model):
        raise scene.refuse(
            place,
            f"expected all, got {tooth}; elsewhere a neighbour carries, and a tip edge is all that could be read of it",
        )


def _idle(measure: Measure, model: Model) -> Iterator[str]:
    """Teeth that a measure reads and that are out of action at some positions, in words."""
    for _, backlash in measure.kind.backlashes:
        mesh, owner = model.mesh(backlash.mesh), backlash.reading.teeth
        if owner == "all":
            continue
        angles = model.driver_angles(measure, mesh.name)
        name = mesh.driver if owner == "driver" else mesh.driven
        where = f"next to the line of centres of {mesh.name!r}"
        tooth = f"{owner}: both flanks of the tooth of {name!r} {where} are in action at"
        if angles is None:
            share = one_tooth_share(mesh.pair, owner)
            if share < 1.0:
                yield f"{tooth} {100 * share:.3g} % of the positions only"
        else:
            acts = one_tooth_acts(mesh.pair, np.array(angles), owner)
            if not acts.all():
                yield f"{tooth} {np.count_nonzero(acts)} of {len(acts)} positions only"


def measure_of(scene: Scene, name: str, model: Model) -> Measure:
    """A measure of a scene, with its limits.

    Args:
        scene: with its entry.
        name: of the measure.
        model: of the scene, without measures yet.

    Raises:
        SceneError: a shaft or an arm that is not on the train, a swing without a load, one tooth that is out of action.
    """
    spec = scene.measures[name]
    measure = measured(spec, scene, name, model)
    refuse_idle_teeth(scene, ("measures", name, "tooth"), measure, model)
    return replace(
        measure,
        lower_limit=None if spec.lower_limit is None else spec.lower_limit.internal,
        upper_limit=None if spec.upper_limit is None else spec.upper_limit.internal,
    )


@singledispatch
def measured(spec: MeasureEntry, scene: Scene, name: str, model: Model) -> Measure:
    """A measure without its limits; each kind registers its own function.

    Args:
        spec: its entry.
        scene: with that entry.
        name: of the measure.
        model: of the scene, without measures yet.

    Raises:
        SceneError: it cannot be read of that mesh or train.
        TypeError: no function is registered for its kind.
    """
    raise TypeError(f"model/mesh_measures.py has no function for {type(spec).__name__}")


BacklashSpec = NormalBacklashSpec | CircumferentialBacklashSpec | AngularBacklashSpec


@measured.register(NormalBacklashSpec)
@measured.register(CircumferentialBacklashSpec)
@measured.register(AngularBacklashSpec)
def _(spec: BacklashSpec, scene: Scene, name: str, model: Model) -> Measure:
    mesh = model.mesh(spec.of)
    gear = getattr(spec, "gear", None) or mesh.driven
    reading = reader_of(spec)(mesh)
    if spec.kind == "angular_backlash":
        slides = slides_of_mesh(model, mesh, gear)
        kind = Backlash(spec.kind, mesh.name, gear, of_reversals(model, mesh, reading), slides)
    else:
        kind = Backlash(spec.kind, mesh.name, gear, reading)
    return Measure(name, kind, _positions_of_mesh(spec, mesh), spec.take)


def _positions_of_mesh(spec: BacklashSpec, mesh: Mesh) -> Positions:
    if isinstance(spec.over, At):
        return Positions("at", 1, 1, spec.over.at.internal)
    if spec.over == "random":
        return Positions("random", mesh.pair.long_period_turns, 1)
    turns = 1 if spec.over == "turn" else mesh.pair.long_period_turns
    return Positions(spec.over, turns, turns * spec.positions)


POSITIONS_A_TOOTH: Final = 16  # resolves the eighth harmonic of tooth mesh, and its peak to 1e-3 by a parabola
MOST_IN_ALL: Final = 1_000_000  # positions of a trial: 8 MB, and as many contacts


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
    """Angle of the mesh's driven gear with the flank in contact."""
    reading = replace(reader_of(spec)(mesh), flank=spec.flank)
    return Backlash("rest_angle", mesh.name, mesh.driven, reading)


def _pushed(mesh: Mesh) -> float:
    """Sense about its z in which the driven gear is pushed: +1 on its right flanks, -1 on its left ones."""
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
    """The mesh of a train's link.

    Raises:
        SceneError: it is a link of another kind, or load paths in parallel.
    """
    mesh = model.mesh_of(element.name)
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
    """Turns of the first shaft after which all teeth of a train meet again in the same places."""
    rates = {name: abs(model.layout.mesh_turn[name].rate) for name in kind.meshes}
    period = least_common([model.mesh(name).pair.long_period_turns / rates[name] for name in kind.meshes])
    return period.numerator


def _refuse_coarse(spec: TransmissionErrorSpec, scene: Scene, name: str, model: Model, kind: TransmissionError) -> None:
    """Refuse positions so coarse that errors of single teeth would be missed.

    Raises:
        SceneError: with the number needed.
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
