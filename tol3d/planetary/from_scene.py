"""From a scene to a planetary set, its deviations and what is read of it."""

import math
from typing import Any, Final

from tol3d.distributions import Distribution
from tol3d.gearing.grammar.parts.gear import GearSpec
from tol3d.gearing.grammar.tolerances.clocking import ClockingSpec
from tol3d.gearing.grammar.tolerances.eccentricity import EccentricitySpec
from tol3d.gearing.grammar.tolerances.tooth_thickness import ToothThicknessSpec
from tol3d.gearing.model.pairs.spur_pair import cylindrical_gear
from tol3d.planetary.deviated import Acts
from tol3d.planetary.draws import EachPlanar
from tol3d.planetary.grammar.measures.planetary_lost_motion import PlanetaryLostMotionSpec
from tol3d.planetary.grammar.measures.planetary_measure import PlanetaryMeasureSpec
from tol3d.planetary.grammar.measures.planetary_transmission_error import PlanetaryTransmissionErrorSpec
from tol3d.planetary.grammar.tolerances.planet_pin import PlanetPinSpec
from tol3d.planetary.measure import PlanetaryMeasure, Reading
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.refusals import planetary_set
from tol3d.planetary.system import PlanetarySystem
from tol3d.scene import Scene
from tol3d.scene.direction import At
from tol3d.scene.entry import kind_of
from tol3d.system.draw import Draw, Each, Planar, Scalar
from tol3d.system.plain import UNITS, PlainContributor
from tol3d.system.positions import AT_RANDOM, Positions, Take

KINDS: Final = (ToothThicknessSpec, EccentricitySpec, ClockingSpec, PlanetPinSpec)
"""Tolerances of planetary sets; those of gears are shared with trains."""


def planetary_system(scene: Scene) -> PlanetarySystem:
    """What a scene of a planetary set means.

    Raises:
        SceneError: kinds that do not act on such a set, or a set that nobody can build, with its numbers.
    """
    own = planetary_set(scene)
    _refuse_other_tolerances(scene)
    contributors, acts = [], {}
    for name, spec in scene.distributed.items():
        acts[name] = _acts(scene, own, name, spec)
        draw = _draw(own, spec, spec.distribution.resolve(scene.files))
        unit, per_unit = UNITS[spec.dimensions[0]]
        contributors.append(PlainContributor(name, spec.kind, draw, unit, per_unit, spec.description))
    measures = {name: _measure(scene, own, name, spec) for name, spec in scene.measures.items()}
    made = {gear.name: cylindrical_gear(scene, gear.name) for gear in own.all_gears}
    return PlanetarySystem(scene.scene, tuple(contributors), tuple(measures.values()), own, acts, measures, made)


def _refuse_other_tolerances(scene: Scene) -> None:
    """Refuse what acts on trains alone: nothing may be stated and left out."""
    for name, spec in scene.tolerances.items():
        if not isinstance(spec, KINDS):
            words = ", ".join(str(kind_of(kind)) for kind in KINDS)
            sentence = f"expected of planetary sets {words}, got {kind_of(type(spec))}"
            raise scene.refuse(("tolerances", name, "kind"), sentence)


def _acts(scene: Scene, own: PlanetarySet, name: str, spec: Any) -> Acts:
    """What a tolerance acts on."""
    if isinstance(spec, PlanetPinSpec):
        if spec.of != own.carrier:
            raise scene.refuse(("tolerances", name, "of"), f"expected {own.carrier!r}, got {spec.of!r}")
        return Acts("pin", direction="" if spec.direction == "random" else spec.direction)
    known = [mesh.central.name for mesh in own.meshes] + [gear.name for gear in own.gears]
    if spec.of not in known:
        raise scene.refuse(("tolerances", name, "of"), f"expected a gear of {own.name!r}, got {spec.of!r}")
    if isinstance(spec, ToothThicknessSpec):
        part = scene.parts[spec.of]
        assert isinstance(part, GearSpec)
        counted = 1 / math.cos(part.pressure_angle.internal) if spec.measured == "normal" else 1.0
        return Acts("thickness", spec.of, factor=counted)
    return Acts("clocking" if isinstance(spec, ClockingSpec) else "offset", spec.of)


def _draw(own: PlanetarySet, spec: Any, law: Distribution) -> Draw:
    """How its components are drawn: of planets and pins each one's own."""
    names = tuple(f"planet {planet + 1}" for planet in range(own.planets))
    of_planets = isinstance(spec, PlanetPinSpec) or spec.of in {gear.name for gear in own.gears}
    if isinstance(spec, EccentricitySpec):
        direction = spec.direction.at.internal if isinstance(spec.direction, At) else None
        return EachPlanar(law, names, direction) if of_planets else Planar(law, direction)
    if isinstance(spec, PlanetPinSpec) and spec.direction == "random":
        return EachPlanar(law, names, None)
    return Each(law, names) if of_planets else Scalar(law)


def _measure(scene: Scene, own: PlanetarySet, name: str, spec: Any) -> PlanetaryMeasure:
    if not isinstance(spec, PlanetaryMeasureSpec):
        words = "planetary_lost_motion or planetary_transmission_error"
        raise scene.refuse(("measures", name, "kind"), f"expected of a planetary set {words}, got {spec.kind}")
    if isinstance(spec, PlanetaryLostMotionSpec):
        shaft = own.output if spec.at == "output" else own.input
        positions = Positions("at", 1, 1, spec.over.at.internal) if isinstance(spec.over, At) else AT_RANDOM
        return _read(own, name, spec, "lost motion", positions, "value", shaft)
    assert isinstance(spec, PlanetaryTransmissionErrorSpec)
    if spec.over == "long_period":
        turns = own.period_planet_turns
        raise scene.refuse(
            ("measures", name, "over"),
            f"expected turn, got long_period: the same teeth meet again as they did after {turns} turns of the planets "
            f"on their pins, {float(own.period):.6g} turns of the output; take turn, one of the output",
        )
    reading: Reading = "lag" if spec.flank == "drive" else "lead"
    return _read(own, name, spec, reading, Positions("turn", 1, spec.positions), spec.take, own.output)


def _read(
    own: PlanetarySet, name: str, spec: PlanetaryMeasureSpec, reading: Reading, at: Positions, take: Take, shaft: str
) -> PlanetaryMeasure:
    unit, per_unit = UNITS[spec.dimension]
    return PlanetaryMeasure(
        name,
        spec.kind,
        None if spec.lower_limit is None else spec.lower_limit.internal,
        None if spec.upper_limit is None else spec.upper_limit.internal,
        unit,
        1 / per_unit,
        worse="high",
        adds_up=False,
        positions=at,
        take=take,
        reading=reading,
        set_name=own.name,
        shaft=shaft,
    )
