"""A planetary set from a scene, with its deviations and measures, and warnings of probable slips."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

import numpy as np

from tol3d.assembly.grammar.zone import ProcessLawSpec
from tol3d.gearing.grammar.measures import GearStudyOptions
from tol3d.gearing.grammar.tolerances.axial_play import AxialPlaySpec
from tol3d.gearing.model.from_scene import implausible_teeth
from tol3d.gearing.planetary.exact.shown import Made, made_gears
from tol3d.gearing.planetary.grammar.measures import (
    PlanetaryFreeTurnSpec,
    PlanetaryLostMotionSpec,
    PlanetaryLowStiffnessSpec,
    PlanetaryMeasureSpec,
    PlanetaryTransmissionErrorSpec,
)
from tol3d.gearing.planetary.grammar.moves import PlanetarySpec
from tol3d.gearing.planetary.grammar.parts import CarrierSpec, FlexibleCarrierSpec, PlanetSpec
from tol3d.gearing.planetary.grammar.tolerances import BorePositionSpec, PlanetPinSpec
from tol3d.gearing.planetary.model.draws import acts_of, draw_of
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.refusals import set_of
from tol3d.gearing.planetary.spring_curve import LeafSpring
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gearing.reducers.from_scene import ReducerKind
from tol3d.gearing.reducers.trials import ReducerMeasure, reducer_measure
from tol3d.scene import Scene
from tol3d.scene.implausible import Implausible, larger_end, warned
from tol3d.scene.place import KeyPath

HALF: Final = Implausible(0.5)


def _implausible(scene: Scene, planetary_set: PlanetarySet) -> tuple[str, ...]:
    """Warnings of a set.

    Raises:
        SceneError: a tooth is thinned until nothing is left of its tip.
    """
    made = made_gears(scene, planetary_set)
    return (*implausible_teeth(scene, made), *_pins(scene, planetary_set, made), *_idle(scene, planetary_set))


def _pins(scene: Scene, planetary_set: PlanetarySet, made: Made) -> Iterator[str]:
    """Pins off by more than half of a module; planets that overlap where all pins are at their worst places."""
    smallest, half_angle = min(planetary_set.gears, key=lambda gear: gear.module), math.pi / planetary_set.planets
    pitch, taken = 2 * planetary_set.centre_distance * math.sin(half_angle), 0.0
    room = pitch - 2 * max(made[gear.name].tip_radius for gear in planetary_set.gears)
    for path, spec in _of_pins(scene, planetary_set):
        far, low = _reach(scene, spec)
        if sentence := HALF.sentence(f"the module of {smallest.name!r}", smallest.module, far):
            yield warned(scene.origin, path, sentence)
        radial = isinstance(spec, PlanetPinSpec) and spec.direction == "radial"
        taken += -2 * low * math.sin(half_angle) if radial else 2 * abs(far)
    if planetary_set.planets > 1 and taken > room > 0.0:
        words = (
            f"expected planets that stay clear of their neighbours, whose pins are {pitch:.4g} mm apart, got planets "
        )
        words += f"that overlap by up to {taken - room:.4g} mm where pins are at their worst places"
        words += "; check the units of the pins' places"
        yield warned(scene.origin, ("moves", planetary_set.name, "planets"), words)


def _idle(scene: Scene, own: PlanetarySet) -> Iterator[str]:
    """Axial plays that turn nothing, with the reason."""
    planet = scene.of(PlanetarySpec)[own.name].planet
    turning = np.abs([own.slide_turns(shaft) for shaft in (own.output, own.input)]).max(axis=0)
    acting = {shaft for shaft, turn in zip(own.shafts, turning, strict=True) if turn}
    if own.planet_slides.any():
        acting.add(planet)
    for name, spec in scene.of(AxialPlaySpec).items():
        if spec.of in acting or spec.of not in (*own.shafts, planet):
            continue
        if not any(mesh.planet.twist for mesh in own.meshes):
            words = f"no gear of {own.name!r} is helical, and spur gears do not screw"
        else:
            words = "the thrusts of its meshes cancel on each planet, whose gears have one lead"
        yield warned(scene.origin, ("tolerances", name), f"acts on nothing: {words}")


def _of_pins(scene: Scene, planetary_set: PlanetarySet) -> Iterator[tuple[KeyPath, PlanetPinSpec | BorePositionSpec]]:
    for name, pin in scene.of(PlanetPinSpec).items():
        if pin.of == planetary_set.carrier:
            yield ("tolerances", name, "distribution"), pin
    for name, bore in scene.of(BorePositionSpec).items():
        if bore.of == planetary_set.carrier:
            yield ("tolerances", name), bore


def _reach(scene: Scene, spec: PlanetPinSpec | BorePositionSpec) -> tuple[float, float]:
    """The displacement that is larger_end from 0, and the least one [mm]."""
    if isinstance(spec, BorePositionSpec):
        if not isinstance(spec.law, ProcessLawSpec):
            return spec.zone.diameter.internal / 2, -spec.zone.diameter.internal / 2
        law = spec.law.distribution.resolve(scene.files)
    else:
        law = spec.distribution.resolve(scene.files)
    return larger_end(law), law.extremes[0]


SETS: Final = ReducerKind(
    "a set", PlanetarySpec, PlanetaryMeasureSpec, (PlanetSpec, CarrierSpec), set_of, _implausible, acts_of, draw_of
)


def planetary_system(scene: Scene) -> PlanetarySystem:
    """System of a planetary set, from its scene.

    Raises:
        SceneError: kinds that do not act on such a set, or a set that cannot be built, with its numbers.
    """
    own = SETS.alone(scene)
    contributors, acts = SETS.contributors(scene, own)
    measures = tuple(_measure(scene, own, name, spec) for name, spec in scene.measures.items())
    return PlanetarySystem(
        scene.scene,
        contributors,
        measures,
        own,
        acts,
        made_gears(scene, own),
        scene.of(PlanetarySpec)[own.name].friction,
        scene.options(GearStudyOptions).profile_steps,
        _leaf_spring(scene.parts[own.carrier]),
        implausible=(*_implausible(scene, own), *_unread(scene, acts, measures)),
    )


def _unread(scene: Scene, acts: Mapping[str, Acts], measures: Sequence[ReducerMeasure]) -> Iterator[str]:
    """Axial plays of shafts that no measure reads: each side of a load has them at one end."""
    if any(measure.reading == "lost motion" for measure in measures):
        return
    for name, own in acts.items():
        if own.effect == "slide" and own.gear:
            yield warned(scene.origin, ("tolerances", name), "acts on nothing: no planetary_lost_motion is measured")


def _leaf_spring(carrier: Any) -> LeafSpring | None:
    """Leaf spring that presses planets apart, if given."""
    if not isinstance(carrier, FlexibleCarrierSpec) or carrier.force is None:
        return None
    others = (0.0 if own is None else own.internal for own in (carrier.stiffness, carrier.friction))
    return LeafSpring(carrier.force.internal, *others)


def _measure(scene: Scene, planetary_set: PlanetarySet, name: str, spec: Any) -> ReducerMeasure:
    if not isinstance(spec, PlanetaryMeasureSpec):
        words = "planetary_lost_motion, planetary_low_stiffness or planetary_transmission_error"
        raise scene.refuse(("measures", name, "kind"), f"expected of a planetary set {words}, got {spec.kind}")
    if isinstance(spec, PlanetaryLowStiffnessSpec) and not any(spring.pushes for spring in planetary_set.springs):
        words = "expected a set on a flexible carrier whose springs press"
        raise scene.refuse(("measures", name, "of"), f"{words}, got {planetary_set.name!r}, where none does")
    if isinstance(spec, PlanetaryTransmissionErrorSpec):
        if spec.over == "long_period":
            turns = planetary_set.period_planet_turns
            raise scene.refuse(
                ("measures", name, "over"),
                f"expected turn, got long_period: the same teeth meet again as they did after {turns} turns of the "
                f"planets on their pins, {float(planetary_set.period):.6g} turns of the output; "
                "take turn, one of the output",
            )
        return reducer_measure(name, spec, spec.flank, planetary_set.output, spec.take)
    assert isinstance(spec, PlanetaryFreeTurnSpec)
    lost_motion = isinstance(spec, PlanetaryLostMotionSpec)
    shaft = planetary_set.output if spec.at == "output" else planetary_set.input
    return reducer_measure(name, spec, "lost motion" if lost_motion else "low stiffness", shaft)
