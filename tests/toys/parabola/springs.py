"""The numbers of a scene of springs, in mm."""

import csv
import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.scene import Scene
from tol3d.scene.bases import ToleranceSpec
from tol3d.study.system.draw import Draw, Each, Scalar
from tol3d.study.system.positions import AT_RANDOM, Positions
from tol3d.study.system.spectrum import Spectrum
from toys.contributor import ToyContributor
from toys.measure import ToyMeasure
from toys.parabola.grammar import HeightSpec, LiftMeasureSpec, LiftSpec, RippleSpec, RoomSpec, SpringOptions, SpringSpec

Array = NDArray[np.float64]

LOST_LEVER = 0.05  # of the offset, which the theory leaves out
STEPS = 24  # a turn
AT_REST = Positions("at", 1, 1)
OVER_A_TURN = Positions("turn", 1, STEPS)


@dataclass(frozen=True)
class Spring:
    """A spring: lifts by a x + b x^2 + t + q t^2 + ...; lengths mm, b and q 1/mm."""

    name: str
    length: float
    a: float
    b: float
    q: float


@dataclass(frozen=True)
class Room:
    """Room that a spring lifts into [mm], and the |x| beyond which it is lost [mm]."""

    room: float
    lost_beyond: float


@dataclass(frozen=True)
class Springs:
    """A scene: one spring, its tolerances by the names of their terms, its measures."""

    name: str
    spring: Spring
    contributors: tuple[ToyContributor, ...]
    measures: tuple[ToyMeasure, ...]
    rooms: tuple[tuple[str, Room], ...]
    chords: int

    def room(self, measure: ToyMeasure) -> Room | None:
        return dict(self.rooms).get(measure.name)


def coil_weights(coils: int) -> Array:
    """By how much each coil's ripple counts, (coils,)."""
    return np.cos(2 * np.pi * np.arange(coils) / coils)


def springs_of(scene: Scene) -> Springs:
    """The numbers of a scene."""
    (name, spec), *more = scene.of(SpringSpec).items()
    if more:
        raise scene.refuse(("parts", more[0][0]), "expected one spring, got another")
    measures = scene.of(LiftMeasureSpec)
    assert len(scene.of(LiftSpec)) == 1
    return Springs(
        scene.scene,
        Spring(name, spec.length.internal, *_characteristic(scene, name, spec)),
        tuple(_contributor(name, spec, scene.files) for name, spec in scene.distributed.items()),
        tuple(_measure(name, spec) for name, spec in measures.items()),
        tuple((name, Room(own.room.internal, own.lost_beyond.internal)) for name, own in scene.of(RoomSpec).items()),
        scene.options(SpringOptions).knots,
    )


def _characteristic(scene: Scene, name: str, spec: SpringSpec) -> tuple[float, float, float]:
    rows = list(csv.DictReader(io.StringIO(scene.files[spec.characteristic].content.decode())))
    try:
        return float(rows[0]["a"]), float(rows[0]["b"]), float(rows[0]["q"])
    except (IndexError, KeyError, ValueError):
        path = ("parts", name, "characteristic")
        raise scene.refuse(path, f"{spec.characteristic}: expected a row of a, b and q") from None


def _contributor(name: str, spec: ToleranceSpec, files: Files) -> ToyContributor:
    law = spec.distribution.resolve(files)
    draw: Draw = Scalar(law)
    if isinstance(spec, RippleSpec):
        draw = Each(law, tuple(f"{coil:02d}" for coil in range(spec.coils)))
    return ToyContributor(name, spec.kind, draw, spec.description)


def _measure(name: str, spec: LiftMeasureSpec) -> ToyMeasure:
    lower, upper = (None if limit is None else limit.internal for limit in (spec.lower_limit, spec.upper_limit))
    if isinstance(spec, HeightSpec):
        positions = {"rest": AT_REST, "random": AT_RANDOM, "turn": OVER_A_TURN}[spec.at]
        spectrum = Spectrum.over(positions, spec.orders) if spec.orders else None
        return ToyMeasure(name, spec.kind, spec.of, positions, spec.take, lower, upper, spectrum=spectrum)
    return ToyMeasure(name, spec.kind, spec.of, AT_REST, "value", lower, upper, keeps_overlap=True)


def toy(thing: object) -> ToyContributor:
    """A contributor that a study hands back."""
    if not isinstance(thing, ToyContributor):
        raise InputError(f"expected a spring's contributor, got {thing!r}")
    return thing


def own_measure(thing: object) -> ToyMeasure:
    """A measure that a study hands back."""
    if not isinstance(thing, ToyMeasure):
        raise InputError(f"expected a spring's measure, got {thing!r}")
    return thing
