"""From one scene to gears, the assembly that holds them, and the bores between the two."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from tol3d.assembly.mechanism import ASSEMBLY
from tol3d.assembly.system import AssemblySystem, assembly_system
from tol3d.distributions.constant import Constant
from tol3d.gearing.effects import NOTHING
from tol3d.gearing.grammar.checks import off_shaft
from tol3d.gearing.grammar.parts import ShaftSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import together
from tol3d.gearing.grammar.tolerances.lever import Lever
from tol3d.gearing.mechanism import GEARING
from tol3d.gearing.model import Contributor, Model
from tol3d.gearing.system import GearSystem, gear_system
from tol3d.machine.bores import Bores, bores_of
from tol3d.machine.counted import refuse_counted_twice
from tol3d.machine.nominal import HousedShaft, housed
from tol3d.machine.system import MachineSystem
from tol3d.scene import Scene, Vocabulary
from tol3d.scene.implausible import warned
from tol3d.scene.schema import SECTIONS
from tol3d.scene.temperature import TemperatureSpec
from tol3d.system.draw import Planar

KIND = "shaft_in_bores"


def machine_system(scene: Scene) -> MachineSystem:
    """What a scene of gears in a housing means.

    Raises:
        SceneError: what one of its parts does not allow, bores that do not fit the meshes, or what counts twice.
    """
    drawn = assembly_system(_entries_of(scene, ASSEMBLY))
    place = housed(scene, _gears_of(scene), drawn.assembly)
    bores = bores_of(drawn.assembly, tuple(place.shafts.values()))
    gears = gear_system(place.scene)
    model = replace(gears.model, contributors=(*gears.model.contributors, *_by_bores(gears.model, bores)))
    made = MachineSystem(
        name=scene.scene,
        contributors=_in_order(scene, gears, drawn),
        measures=tuple(own for name in scene.measures for own in _of_name(gears, drawn) if own.name == name),
        gears=GearSystem(model),
        drawn=drawn,
        bores=bores,
        worlds=place.worlds,
        off_shafts=tuple(_off_shafts(scene, bores)),
    )
    refuse_counted_twice(scene, made)
    return made


def _off_shafts(scene: Scene, bores: Bores) -> Iterator[str]:
    """Warnings of bores whose middles lie beyond an end of the shaft that they hold."""
    for own in bores.shafts:
        shaft, places = scene.parts[own.shaft], [own.along(bore) for bore in own.bores]
        if own.bores[0].end is not None:  # of a long bore, which may stand out, its middle
            places = [sum(places) / 2]
        for k, at in enumerate(places):
            if isinstance(shaft, ShaftSpec) and (sentence := off_shaft(own.shaft, shaft, at)):
                yield warned(("moves", own.move, "in", k), sentence)


def _of_name(*systems: GearSystem | AssemblySystem) -> Iterator[Any]:
    return (measure for system in systems for measure in system.measures)


def _entries_of(scene: Scene, vocabulary: Vocabulary) -> Scene:
    """The scene with the entries of some kinds only."""
    kept = {
        section: {
            name: entry for name, entry in scene.section(section).items() if type(entry) in vocabulary.specs(section)
        }
        for section in SECTIONS
    }
    return scene.model_copy(update=kept)


def _gears_of(scene: Scene) -> Scene:
    """Its gears; temperatures of those among their parts that are of gears."""
    gears = _entries_of(scene, GEARING)
    tolerances = {name: spec for name, spec in gears.tolerances.items() if not isinstance(spec, TemperatureSpec)}
    for name, spec in gears.of(TemperatureSpec).items():
        if own := tuple(part for part in spec.of if part in gears.parts):
            tolerances[name] = spec.model_copy(update={"of": own})
    ordered = {name: tolerances[name] for name in scene.tolerances if name in tolerances}
    return gears.model_copy(update={"tolerances": ordered})


def _by_bores(model: Model, bores: Bores) -> Iterator[Contributor]:
    """For each point of the axis of a shaft what its displacement across the axis does to the gears; nobody draws it.

    Two a shaft, of components x and y each, in the order of the columns of `bores`.
    """
    for shaft in bores.shafts:
        places = [shaft.along(bore) for bore in shaft.bores]
        for k, bore in enumerate(shaft.bores):
            yield Contributor(
                name=f".{shaft.shaft} at {bore.words}",
                kind=KIND,
                effect=_effect(model, shaft, places[k], places[1 - k]),
                draw=Planar(Constant(0.0), None),
                unit="um",
            )


def _effect(model: Model, shaft: HousedShaft, moved: float, fixed: float) -> Any:
    levers = [Lever(own, moved, fixed, rate=1.0) for name, own in model.layout.carrying.values() if name == shaft.shaft]
    effects = [effect for lever in levers for effect in lever.anywhere()]
    return together(effects) if effects else NOTHING


def _in_order(scene: Scene, gears: GearSystem, drawn: AssemblySystem) -> tuple[Any, ...]:
    """All contributors in the scene's order; a copy's after its original's; one of both is that of the gears."""
    every: tuple[Any, ...] = (*drawn.contributors, *gears.contributors)
    by_name = {str(own.name): own for own in every}
    places = {name: place for place, name in enumerate(scene.tolerances)}
    before: dict[str, int] = {own.name: places[own.name] for own in gears.contributors}
    last = 0
    for each in drawn.contributors:
        last = before[each.name] = places.get(each.name, last)
    return tuple(by_name[name] for name in sorted(by_name, key=lambda name: before[name]))
