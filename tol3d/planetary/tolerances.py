"""Tolerances of planetary sets: which there are, on what each acts, and how it is drawn."""

import math
from typing import Any, Final

from tol3d.assembly.from_scene.zones import drawn_by
from tol3d.assembly.zones import Process
from tol3d.assembly.zones.catalogue import axis_section
from tol3d.gearing.grammar.parts.gear import GearSpec
from tol3d.gearing.grammar.tolerances.clocking import ClockingSpec
from tol3d.gearing.grammar.tolerances.eccentricity import EccentricitySpec
from tol3d.gearing.grammar.tolerances.tooth_thickness import ToothThicknessSpec
from tol3d.planetary.deviated import Acts
from tol3d.planetary.draws import EachJudgedZone, EachZone
from tol3d.planetary.grammar.tolerances.bore_position import BorePositionSpec
from tol3d.planetary.grammar.tolerances.planet_pin import PlanetPinSpec
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.scene import Scene
from tol3d.scene.direction import At
from tol3d.scene.entry import kind_of
from tol3d.system.draw import Draw, Each, Planar, Scalar
from tol3d.system.each_planar import EachPlanar

KINDS: Final = (ToothThicknessSpec, EccentricitySpec, ClockingSpec, PlanetPinSpec, BorePositionSpec)
"""Tolerances of planetary sets; those of gears are shared with trains."""


def refuse_other_tolerance(scene: Scene, name: str) -> None:
    """Refuse a tolerance of a set that no set has.

    Raises:
        SceneError: with those that it has.
    """
    spec = scene.tolerances[name]
    if not isinstance(spec, KINDS):
        words = ", ".join(str(kind_of(kind)) for kind in KINDS)
        sentence = f"expected of planetary sets {words}, got {kind_of(type(spec))}"
        raise scene.refuse(("tolerances", name, "kind"), sentence)


def acts_of(scene: Scene, own: PlanetarySet, name: str, spec: Any) -> Acts:
    """What a tolerance acts on."""
    if isinstance(spec, PlanetPinSpec | BorePositionSpec):
        if spec.of != own.carrier:
            raise scene.refuse(("tolerances", name, "of"), f"expected {own.carrier!r}, got {spec.of!r}")
        if isinstance(spec, BorePositionSpec) or spec.direction == "random":
            return Acts("pin")
        return Acts("pin", direction=spec.direction)
    known = [mesh.central.name for mesh in own.meshes] + [gear.name for gear in own.gears]
    if spec.of not in known:
        raise scene.refuse(("tolerances", name, "of"), f"expected a gear of {own.name!r}, got {spec.of!r}")
    if isinstance(spec, ToothThicknessSpec):
        part = scene.parts[spec.of]
        assert isinstance(part, GearSpec)
        counted = 1 / math.cos(part.pressure_angle.internal) if spec.measured == "normal" else 1.0
        return Acts("thickness", spec.of, factor=counted)
    return Acts("clocking" if isinstance(spec, ClockingSpec) else "offset", spec.of)


def draw_of(scene: Scene, own: PlanetarySet, spec: Any) -> Draw:
    """How its components are drawn: of planets, pins and bores each one's own."""
    return _bores(scene, own, spec) if isinstance(spec, BorePositionSpec) else _of_distribution(scene, own, spec)


def _bores(scene: Scene, own: PlanetarySet, spec: BorePositionSpec) -> Draw:
    """Each bore in its zone, its axis parallel to the set's."""
    zone = axis_section(spec.zone.diameter.internal)
    draw = drawn_by(spec.law, zone, scene.files)
    return (EachJudgedZone if isinstance(draw, Process) else EachZone)(draw, planet_names(own))


def planet_names(own: PlanetarySet) -> tuple[str, ...]:
    """Of columns, counted from 1."""
    return tuple(f"planet {planet + 1}" for planet in range(own.planets))


def _of_distribution(scene: Scene, own: PlanetarySet, spec: Any) -> Draw:
    law, names = spec.distribution.resolve(scene.files), planet_names(own)
    of_planets = isinstance(spec, PlanetPinSpec) or spec.of in {gear.name for gear in own.gears}
    if isinstance(spec, EccentricitySpec):
        direction = spec.direction.at.internal if isinstance(spec.direction, At) else None
        return EachPlanar(law, names, direction) if of_planets else Planar(law, direction)
    if isinstance(spec, PlanetPinSpec) and spec.direction == "random":
        return EachPlanar(law, names, None)
    return Each(law, names) if of_planets else Scalar(law)
