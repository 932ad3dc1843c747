"""What is most likely a slip in a planetary set: teeth thinned away, pins far off or planets into each other."""

import math
from collections.abc import Iterator
from typing import Final

from tol3d.assembly.grammar.zone import ProcessLawSpec
from tol3d.gearing.model.implausible_teeth import implausible_teeth
from tol3d.planetary.grammar.tolerances.bore_position import BorePositionSpec
from tol3d.planetary.grammar.tolerances.planet_pin import PlanetPinSpec
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.shown import Made
from tol3d.scene import Scene
from tol3d.scene.implausible import Implausible, farthest, warned
from tol3d.scene.place import KeyPath

HALF: Final = Implausible(0.5)


def implausible_set(scene: Scene, own: PlanetarySet, made: Made) -> tuple[str, ...]:
    """Warnings of a set.

    Args:
        scene: with its tolerances.
        own: the set.
        made: its gears by their names, nominal.

    Raises:
        SceneError: a tooth is thinned until nothing is left of its tip.
    """
    return (*implausible_teeth(scene, made), *_pins(scene, own, made))


def _pins(scene: Scene, own: PlanetarySet, made: Made) -> Iterator[str]:
    """Pins off by more than half of a module; planets that overlap where all pins are at their worst places."""
    smallest, half_angle = min(own.gears, key=lambda gear: gear.module), math.pi / own.planets
    pitch, taken = 2 * own.centre_distance * math.sin(half_angle), 0.0
    room = pitch - 2 * max(made[gear.name].tip_radius for gear in own.gears)
    for path, spec in _of_pins(scene, own):
        far, low = _reach(scene, spec)
        if sentence := HALF.sentence(f"the module of {smallest.name!r}", smallest.module, far):
            yield warned(path, sentence)
        radial = isinstance(spec, PlanetPinSpec) and spec.direction == "radial"
        taken += -2 * low * math.sin(half_angle) if radial else 2 * abs(far)
    if own.planets > 1 and taken > room > 0.0:
        words = (
            f"expected planets that stay clear of their neighbours, whose pins are {pitch:.4g} mm apart, got planets "
        )
        words += f"that overlap by up to {taken - room:.4g} mm where pins are at their worst places"
        yield warned(("moves", own.name, "planets"), f"{words}; look at the units of the pins' places")


def _of_pins(scene: Scene, own: PlanetarySet) -> Iterator[tuple[KeyPath, PlanetPinSpec | BorePositionSpec]]:
    for name, pin in scene.of(PlanetPinSpec).items():
        if pin.of == own.carrier:
            yield ("tolerances", name, "distribution"), pin
    for name, bore in scene.of(BorePositionSpec).items():
        if bore.of == own.carrier:
            yield ("tolerances", name), bore


def _reach(scene: Scene, spec: PlanetPinSpec | BorePositionSpec) -> tuple[float, float]:
    """The displacement that is farthest from 0, and the least one [mm]."""
    if isinstance(spec, BorePositionSpec):
        if not isinstance(spec.law, ProcessLawSpec):
            return spec.zone.diameter.internal / 2, -spec.zone.diameter.internal / 2
        law = spec.law.distribution.resolve(scene.files)
    else:
        law = spec.distribution.resolve(scene.files)
    return farthest(law), law.extremes[0]
