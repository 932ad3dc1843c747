"""Gears of one scene, the assembly that holds them, and the bores between the two.

Deviations that a scene counts twice: those of axes that bores give, and tolerances that state them again.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tol3d.assembly.grammar.checks import pose_names
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.measures.pose_errors import PositionErrorSpec
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.grammar.parts import SolidSpec, likes
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.grammar.tolerances.plus_minus import SizeSpec
from tol3d.assembly.mechanism import ASSEMBLY
from tol3d.assembly.placing import method as placing
from tol3d.assembly.system import AssemblySystem, assembly_system, meaning_of
from tol3d.gearing.effects import NOTHING, LinkDeviation
from tol3d.gearing.grammar.checks import off_shaft
from tol3d.gearing.grammar.parts import BearingSpec, ShaftSpec
from tol3d.gearing.grammar.tolerances.bearing_clearance import BearingClearanceSpec, Lever
from tol3d.gearing.grammar.tolerances.gearing_tolerance import MeshToleranceSpec, together
from tol3d.gearing.machine.bores import Bores, bores_of, twin_name
from tol3d.gearing.machine.grammar.bores import ShaftInBoresSpec
from tol3d.gearing.machine.grammar.open_chain import FLANK, OpenChainSpec, WorstPositionErrorSpec
from tol3d.gearing.machine.joined import HIDDEN, TURN, is_hidden
from tol3d.gearing.machine.mechanism import MACHINE
from tol3d.gearing.machine.methods import WorstMeasure
from tol3d.gearing.machine.nominal import HousedShaft, housed
from tol3d.gearing.machine.open_chains import drives_of
from tol3d.gearing.machine.pins import displacement_name, pins_of, with_bores, with_pins
from tol3d.gearing.machine.system import MachineSystem
from tol3d.gearing.mechanism import GEARING
from tol3d.gearing.model import Contributor, Model
from tol3d.gearing.system import GearSystem, gear_system
from tol3d.scene import Scene, Vocabulary
from tol3d.scene.implausible import warned
from tol3d.scene.schema import SECTIONS
from tol3d.scene.temperature import TemperatureSpec
from tol3d.statistics.distributions.constant import Constant
from tol3d.study.system.draw import Planar
from tol3d.study.system.measure import Measure
from tol3d.study.system.plain import stated_of
from tol3d.study.system.stated import component_slices


def machine_system(scene: Scene) -> MachineSystem:
    """System of gears in a housing, from its scene.

    Raises:
        SceneError: one of its parts refuses it, bores do not fit the meshes, or a deviation counts twice.
    """
    parts = _parts_of(scene)
    meaning = meaning_of(parts)
    poses = {pose: assembly_system(parts, pose, meaning) for pose in pose_names(parts) or ("",)}
    drawn = next(iter(poses.values()))
    place = housed(scene, _gears_of(scene), drawn.assembly)
    gears = gear_system(place.scene)
    pins = pins_of(scene, gears.model, drawn.assembly)
    model = with_pins(with_bores(place.scene, gears.model, place), pins)
    read = (*place.shafts.values(), *(shaft for pin in pins for shaft in pin.shafts))
    bores = bores_of(drawn.assembly, read)
    model = replace(model, contributors=(*model.contributors, *_by_bores(model, bores)))
    by_name: dict[str, Measure] = {measure.name: measure for measure in gears.measures}
    by_name |= {measure.name: measure for system in poses.values() for measure in system.measures}
    by_name |= {name: _worst(scene, name, spec) for name, spec in scene.of(WorstPositionErrorSpec).items()}
    made = MachineSystem(
        name=scene.scene,
        contributors=_in_order(scene, gears, drawn),
        measures=tuple(by_name[name] for name in scene.measures),
        gears=GearSystem(model),
        poses=poses,
        bores=bores,
        worlds=place.worlds,
        off_shafts=tuple(_off_shafts(scene, bores)),
        drives=tuple(drives_of(scene, model)),
        up=_up(scene),
        parts=parts,
    )
    refuse_counted_twice(scene, made)
    _refuse_turned_bores(scene, made)
    return made


def _up(scene: Scene) -> tuple[float, float, float]:
    """Against the gravity of a chain; by default along y."""
    for spec in scene.of(OpenChainSpec).values():
        if spec.gravity is not None:
            x, y, z = (-np.array(spec.gravity) / np.linalg.norm(spec.gravity) + 0.0).tolist()
            return x, y, z
    return 0.0, 1.0, 0.0


def _parts_of(scene: Scene) -> Scene:
    """Its assembly: parts with drawings, the moves that place them, and their measures, in every pose."""
    parts = _entries_of(scene, ASSEMBLY)
    moves = scene.of(AssemblyMoveSpec)
    measures: dict[str, Any] = dict(parts.measures)
    for spec in scene.of(WorstPositionErrorSpec).values():
        for pose in spec.poses or pose_names(scene):
            given = {"kind": "position_error", "of": spec.of, "from": spec.from_, "at": pose}
            measures[_size_name(spec, pose)] = PositionErrorSpec.model_validate(given)
    return parts.model_copy(update={"moves": moves, "measures": measures})


def _size_name(spec: WorstPositionErrorSpec, pose: str) -> str:
    """The measure of the assembly that is a worst one's in a pose; scenes cannot name one so."""
    return f"{HIDDEN}{spec.of} from {spec.from_} at {pose}"


def _worst(scene: Scene, name: str, spec: WorstPositionErrorSpec) -> WorstMeasure:
    sizes = tuple((pose, _size_name(spec, pose)) for pose in spec.poses or pose_names(scene))
    return WorstMeasure(
        *stated_of(name, spec), worse="high", adds_up=False, sizes=sizes, any_flank=spec.flanks == "any"
    )


def _refuse_turned_bores(scene: Scene, system: MachineSystem) -> None:
    """Refuse shafts between parts that a joint turns against each other: the shaft would turn its own bearings.

    Raises:
        SceneError: at the move that lays the shaft.
    """
    slices = component_slices(system.drawn)
    for drive in system.drives:
        turned = system.displacing[:, slices[drive.turn]].reshape(-1, 4)
        with_part = _turned_against_hosts(system, slices[drive.turn].start)
        for own, displaced in zip(system.bores.shafts, turned, strict=True):
            if displaced.any() or own.shaft in with_part:
                first, last = (bore.words for bore in own.bores)
                words = f"expected bores that no joint turns, got {first!r} and {last!r}, which {drive.joint!r} turns"
                ring = f"the shaft is in a ring of reads: {own.shaft}, {drive.joint}, its bores"
                raise scene.refuse(("moves", own.move, "in"), f"{words} with what its shafts drive; {ring}")


def _turned_against_hosts(system: MachineSystem, column: int) -> set[str]:
    """Held parts of links whose bores a turn of a joint turns, be it about their own axis, against their hosts."""
    held = [shaft for shaft in system.bores.shafts if shaft.shaft in {link.held for link in system.gears.model.links}]
    if not held:
        return set()
    rows = np.zeros((2, system.bores.assembly.width))
    rows[1, column] = TURN
    frames = placing.features_placed(system.bores.assembly, rows)
    found = set()
    for own in held:
        host, bore = (frames[name] for name in (twin_name(own, 0), own.bores[0].feature))
        seen = np.linalg.inv(host) @ bore
        if np.abs(seen[1] - seen[0]).max() > TURN / 2:
            found.add(own.shaft)
    return found


def _off_shafts(scene: Scene, bores: Bores) -> Iterator[str]:
    """Warnings of bores whose middles lie beyond an end of the shaft that they hold."""
    for own in bores.shafts:
        shaft, places = scene.parts.get(own.shaft), [own.along(bore) for bore in own.bores]
        if own.bores[0].end is not None:  # of a long bore, which may stand out, its middle
            places = [sum(places) / 2]
        for k, at in enumerate(places):
            if isinstance(shaft, ShaftSpec) and (sentence := off_shaft(own.shaft, shaft, at)):
                yield warned(scene.origin, ("moves", own.move, "in", k), sentence)


def _entries_of(scene: Scene, vocabulary: Vocabulary) -> Scene:
    """The scene with the entries of some kinds only."""
    kept = {
        section: {
            name: entry for name, entry in scene.section(section).items() if type(entry) in vocabulary.specs(section)
        }
        for section in SECTIONS
    }
    return scene.model_copy(update=kept)


def _others_than(scene: Scene, vocabulary: Vocabulary) -> Scene:
    """The scene without the kinds of a vocabulary, but those that gears have too, and without moves between both."""
    kept = {
        section: {name: entry for name, entry in scene.section(section).items() if not _is_between(entry, vocabulary)}
        for section in SECTIONS
    }
    return scene.model_copy(update=kept)


def _is_between(entry: Any, vocabulary: Vocabulary) -> bool:
    kinds = {spec for own in (vocabulary, MACHINE) for section in SECTIONS for spec in own.specs(section)}
    shared = {spec for section in SECTIONS for spec in GEARING.specs(section)}
    return type(entry) in kinds - shared or isinstance(entry, AssemblyMoveSpec)


def _gears_of(scene: Scene) -> Scene:
    """Its gears; temperatures of those among their parts that are of gears."""
    gears = _others_than(scene, ASSEMBLY)
    tolerances = {name: spec for name, spec in gears.tolerances.items() if not isinstance(spec, TemperatureSpec)}
    for name, spec in gears.of(TemperatureSpec).items():
        if own := tuple(part for part in spec.of if part in gears.parts):
            tolerances[name] = spec.model_copy(update={"of": own})
    ordered = {name: tolerances[name] for name in scene.tolerances if name in tolerances}
    return gears.model_copy(update={"tolerances": ordered})


def _by_bores(model: Model, bores: Bores) -> Iterator[Contributor]:
    """Effects on the gears of the displacement across the axis of each point of a shaft's axis; they are not drawn.

    Two a shaft, of components x and y each, in the order of the columns of `bores`.
    """
    for shaft in bores.shafts:
        places = [shaft.along(bore) for bore in shaft.bores]
        for k in range(2):
            yield Contributor(
                name=displacement_name(shaft, k),
                kind="shaft_in_bores",
                effect=_effect(model, shaft, k, places),
                draw=Planar(Constant(0.0), None),
                unit="um",
            )


def _effect(model: Model, shaft: HousedShaft, k: int, places: Sequence[float]) -> Any:
    own = [each for name, each in model.layout.carrying.values() if name == shaft.shaft]
    levers = [Lever(each, places[k], places[1 - k], rate=1.0) for each in own]
    effects = [effect for lever in levers for effect in lever.anywhere()]
    name = displacement_name(shaft, k)
    effects += [LinkDeviation(link.name) for link in model.links if any(own.contributor == name for own in link.moved)]
    return together(effects) if effects else NOTHING


def _in_order(scene: Scene, gears: GearSystem, drawn: AssemblySystem) -> tuple[Any, ...]:
    """All contributors in the scene's order, flanks last; a copy's after its original's; one of both is the gears'."""
    by_parts = [contributor for contributor in drawn.contributors if not is_hidden(contributor)]
    every: tuple[Any, ...] = (*by_parts, *gears.contributors)
    by_name = {str(own.name): own for own in every}
    places = {name: place for place, name in enumerate(scene.tolerances)}
    before: dict[str, int] = {contributor.name: places[contributor.name] for contributor in gears.contributors}
    last = 0
    for by_part in by_parts:
        last = before[by_part.name] = len(places) if by_part.kind == FLANK else places.get(by_part.name, last)
    return tuple(by_name[name] for name in sorted(by_name, key=lambda name: before[name]))


def refuse_counted_twice(scene: Scene, system: MachineSystem) -> None:
    """Refuse tolerances of axes that deviate as bores do already, and bore sizes beside bearing clearances.

    Raises:
        SceneError: at the tolerance of the gears, naming the other one.
    """
    for name, spec in scene.tolerances.items():
        if isinstance(spec, MeshToleranceSpec):
            for other in system.moving_apart(spec.of):
                words = f"expected no {spec.kind} of {spec.of!r}, for {other!r} moves the bores of its shafts"
                raise scene.refuse(("tolerances", name), f"{words} already, and both would count; take out one")
        elif isinstance(spec, BearingClearanceSpec):
            for other in _sizes(scene, spec):
                words = (
                    f"expected no clearance beside {other!r}, the size of a bore of the same shaft, for both say how "
                )
                raise scene.refuse(("tolerances", name), f"{words}loose it is; take out one")


def _sizes(scene: Scene, spec: BearingClearanceSpec) -> Iterator[str]:
    """Tolerances of the sizes of the bores of a shaft."""
    part = scene.parts[spec.of]
    gear = part.shaft if isinstance(part, BearingSpec) else spec.of
    carrying = (name for name, own in scene.parts.items() if gear in getattr(own, "carries", {}))
    shaft = next(carrying, gear)
    bores = {bore for move in scene.of(ShaftInBoresSpec).values() if move.shaft == shaft for bore in move.in_}
    modified = {own.of for own in scene.of(FeatureTolerance).values() if getattr(own, "modifier", None)}
    for name, size in scene.of(SizeSpec).items():
        if size.of in modified:
            continue  # it widens a zone
        if size.of in bores or any(_is_copy(scene, bore, size.of) for bore in bores):
            yield name


def _is_copy(scene: Scene, bore: str, original: str) -> bool:
    """True if a bore belongs to a part identical to the toleranced one."""
    solids, feature = scene.of(SolidSpec), bore.partition(".")[2]
    others = likes(part_of(bore), solids)[1:] if part_of(bore) in solids else ()
    return any(f"{other}.{feature}" == original for other in others)
