"""Checks across the entries of a scene of gears, and warnings of likely slips."""

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

from tol3d.gearing.grammar.measures import FlankMeasureSpec
from tol3d.gearing.grammar.moves import GearMeshSpec, HelicalMoveSpec, MeshSpec, ReducerSpec
from tol3d.gearing.grammar.parts import (
    BearingSpec,
    BoredGearSpec,
    GearSpec,
    HelicalGearSpec,
    InternalGearSpec,
    ShaftReference,
    ShaftSpec,
    carried,
    gears_on,
)
from tol3d.gearing.grammar.tolerances.axes import (
    AxisInPlaneSpec,
    AxisOutOfPlaneSpec,
    CentreDistanceSpec,
    ShaftAngleSpec,
)
from tol3d.gearing.grammar.tolerances.axial_play import AxialPlaySpec, shaft_at
from tol3d.gearing.grammar.tolerances.bearing_clearance import BearingClearanceSpec
from tol3d.gearing.grammar.tolerances.flank_shape import ProfileFormSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import (
    GearToleranceSpec,
    MeshToleranceSpec,
    ReducerBacklashSpec,
)
from tol3d.gearing.grammar.tolerances.gears import AxialShiftSpec
from tol3d.scene import Scene
from tol3d.scene.implausible import Implausible, another_size, larger_end
from tol3d.scene.place import KeyPath
from tol3d.units import angle_text


def general_distances(scene: Scene) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """A tolerance for each stated centre distance without one of its own, as general tolerance of its scene."""
    own = {spec.of for spec in scene.of(CentreDistanceSpec).values()}
    for name, move in scene.of(MeshSpec).items():
        if name not in own and move.centre_distance is not None:
            law = {"general": scene.general_sizes, "of": str(move.centre_distance)}
            yield f"centre distance of {name}", {"kind": "centre_distance", "of": name, "distribution": law}


def carried_again(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Gears that a shaft above carries too."""
    first: dict[str, str] = {}
    for shaft, gear in carried(scene.parts):
        if (other := first.setdefault(gear, shaft)) != shaft:
            path: KeyPath = ("parts", shaft, "carries", gear)
            yield path, f"expected a gear that no other shaft carries, got {gear!r}, which {other!r} carries"


def forms_of_two_shapes(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Gears whose profile forms have two shapes."""
    first: dict[str, tuple[str, ProfileFormSpec]] = {}
    for name, spec in scene.tolerances.items():
        if not isinstance(spec, ProfileFormSpec):
            continue
        other, known = first.setdefault(spec.of, (str(name), spec))
        if spec.waves != known.waves:
            yield ("tolerances", str(name), "shape"), f"expected the shape of {other!r}, the form of {spec.of!r} too"


def helical_gears(scene: Scene) -> Mapping[str, HelicalGearSpec | InternalGearSpec]:
    """Helical gears of a scene, rings among them."""
    rings = {name: ring for name, ring in scene.of(InternalGearSpec).items() if ring.helix_angle.number}
    return {**scene.of(HelicalGearSpec), **rings}


def helices_elsewhere(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Helical gears that moves other than meshes name: what these compute of them was never derived."""
    helical = helical_gears(scene)
    for name, move in scene.moves.items():
        if isinstance(move, HelicalMoveSpec):
            continue
        own = [reference.name for reference in move.references() if not isinstance(reference, ShaftReference)]
        for gear in (gear for gear in helical if gear in own):
            ring = helical[gear] if isinstance(helical[gear], InternalGearSpec) else None
            field, expected = ("helix_angle", f"0 deg, got {ring.helix_angle}") if ring else ("kind", "a spur_gear")
            words = f"expected {expected}, for {name!r} is {move.words}"
            yield (
                ("parts", gear, field),
                f"{words}: helical gears run in meshes and planetary sets alone",
            )


def second_axial_plays(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Axial plays of a shaft that has one, or a bearing whose clearance is one: the nearer stops decide, no sum."""
    first: dict[str, str] = {}
    for name, spec in scene.tolerances.items():
        if not isinstance(spec, AxialPlaySpec | BearingClearanceSpec):
            continue
        part = scene.parts[spec.of]
        if isinstance(spec, BearingClearanceSpec) and not (isinstance(part, BearingSpec) and part.raceways):
            continue
        shaft = shaft_at(spec.of, scene.parts)
        if (other := first.setdefault(shaft, str(name))) == str(name):
            continue
        words = f"expected one axial play of {shaft!r}, got another draw of it beside {other!r}"
        if all(isinstance(scene.tolerances[own], AxialPlaySpec) for own in (name, other)):
            advice = "state the play between the stops that are nearest"
        else:
            advice = "a clearance of a bearing with contact_angle or grooves is radial and axial at once; take out one"
        yield ("tolerances", str(name), "of"), f"{words}; {advice}"


def readings_of_helices(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Measures of helical meshes that are read in a section or of one tooth: their contact lines cross the face."""
    helical = helical_gears(scene)
    for name, measure in scene.measures.items():
        if not isinstance(measure, FlankMeasureSpec) or not helical:
            continue
        path: KeyPath = ("measures", str(name))
        if measure.read_at not in (None, "face"):
            words = f"expected face, got {measure.read_at}: helical teeth are read over the face"
            yield (*path, "read_at"), f"{words}, which their contact lines cross"
        if measure.tooth != "all":
            words = f"expected all, got {measure.tooth}: of helical teeth several touch at once"
            yield (*path, "tooth"), words


def forces_of_helices(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Bearings that move along the tooth force of a helical gear, and no other one takes the couple of its thrust."""
    helical = helical_gears(scene)
    for name, spec in scene.of(BearingClearanceSpec).items():
        bearing = scene.parts[spec.of]
        if spec.direction not in ("tooth_force", "reversing") or not isinstance(bearing, BearingSpec):
            continue
        gear = next((g for g in gears_on(bearing.shaft, scene.parts) if g in helical), None)
        bearings = [own for own in scene.of(BearingSpec).values() if own.shaft == bearing.shaft]
        if gear is not None and len(bearings) < 2:
            words = f"expected apart, random, {{at: …}} or a second bearing, got {spec.direction}: the thrust of the"
            yield ("tolerances", str(name), "direction"), f"{words} helical gear {gear!r} would turn the shaft over"


def unloaded_bearings(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Bearings in which no force pushes their shaft to and fro: the other one, at the spur gear, carries all of it."""
    helical = helical_gears(scene)
    for name, spec in scene.of(BearingClearanceSpec).items():
        bearing, mesh = scene.parts[spec.of], scene.moves.get(spec.mesh or "")
        if spec.direction != "reversing" or not isinstance(bearing, BearingSpec) or not isinstance(mesh, GearMeshSpec):
            continue
        shaft, own = scene.parts[bearing.shaft], set(gears_on(bearing.shaft, scene.parts)).intersection(mesh.gears)
        for gear in own.difference(helical):
            at = shaft.carries[gear].at.internal if isinstance(shaft, ShaftSpec) else 0.0
            if any(
                other.shaft == bearing.shaft and other.at.internal == at != bearing.at.internal
                for other in scene.of(BearingSpec).values()
            ):
                words = f"expected apart, random, tooth_force or {{at: …}}, got reversing: the gear {gear!r} sits at"
                advice = f"the other bearing of {bearing.shaft!r}, so that its force does not load this one"
                yield ("tolerances", str(name), "direction"), f"{words} {advice}"


def steep_helices(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Helix angles that nobody cuts for parallel axes."""
    for name, gear in helical_gears(scene).items():
        if gear.helix_angle.internal > STEEPEST_USUAL + ROUNDING:
            words = f"{gear.helix_angle} is steeper than the 45 deg that gears on parallel axes have at most as a rule"
            yield ("parts", name, "helix_angle"), f"{words}; simulated as it is, check the unit"


def implausible_displacements(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Axes that lie off their places by more than half of a module, as teeth are two modules deep."""
    for name, spec in scene.distributed.items():
        if not (isinstance(spec, GearToleranceSpec | MeshToleranceSpec) and spec.displaces):
            continue
        gears = {gear: part for gear in _displaced(scene, spec.of) if isinstance(part := scene.parts[gear], GearSpec)}
        if not gears:
            continue
        gear, part = min(gears.items(), key=lambda own: own[1].module.internal)
        far = larger_end(spec.distribution.resolve(scene.files))
        if sentence := HALF.sentence(f"the module of {gear!r}", part.module.internal, far):
            yield ("tolerances", name, "distribution"), sentence


def implausible_faces(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Faces of gears as thin as foil or wider than a metre; shifts and plays of gears beyond their own face."""
    for name, gear in scene.of(GearSpec).items():
        if gear.face_width.internal > WIDEST_FACE + ROUNDING:
            yield ("parts", name, "face_width"), f"expected at most 1 m, got {gear.face_width}; check the unit"
        if gear.face_width.internal < (least := NARROWEST_FACE * gear.module.internal) - ROUNDING:
            words = f"expected at least {least:.4g} mm, a tenth of the module, got {gear.face_width}"
            yield ("parts", name, "face_width"), f"{words}; check the unit"
    along: Mapping[str, AxialShiftSpec | AxialPlaySpec] = {**scene.of(AxialShiftSpec), **scene.of(AxialPlaySpec)}
    for name, spec in along.items():
        far = larger_end(spec.distribution.resolve(scene.files))
        widths = {
            gear: part.face_width.internal
            for gear in gears_on(shaft_at(spec.of, scene.parts), scene.parts)
            if isinstance(part := scene.parts[gear], GearSpec)
        }
        for narrowest in sorted(widths, key=widths.__getitem__)[:1]:
            if sentence := WHOLE.sentence(f"the face width of {narrowest!r}", widths[narrowest], far):
                yield ("tolerances", name, "distribution"), sentence


def implausible_shafts(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Shafts whose ends lie more than a hundred diameters from their origin."""
    for name, shaft in scene.of(ShaftSpec).items():
        for field, end in (("start", shaft.start), ("end", shaft.end)):
            if end is None or shaft.diameter is None:
                continue
            far = SLENDEREST * shaft.diameter.internal
            if abs(end.internal) > far + ROUNDING:
                words = f"expected within {far:.6g} mm of the shaft's origin, a hundred diameters, got {end}"
                yield ("parts", name, field), f"{words}; check the unit"


def implausible_angles(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Axes that lean, and reducers that turn freely, by more than some degrees."""
    for name, spec in scene.distributed.items():
        if not isinstance(spec, ReducerBacklashSpec | AxisInPlaneSpec | AxisOutOfPlaneSpec | ShaftAngleSpec):
            continue
        far = larger_end(spec.distribution.resolve(scene.files))
        if spec.unit == "um" or abs(far) <= WIDEST_ANGLE + ROUNDING:
            continue
        of = "free turn" if isinstance(spec, ReducerBacklashSpec) else "lean of an axis"
        words = f"expected a {of} of at most 5°, got {angle_text(far)}; check the unit"
        yield ("tolerances", name, "distribution"), words
    for name, move in scene.of(ReducerSpec).items():
        if move.backlash is not None and move.backlash.internal > WIDEST_ANGLE + ROUNDING:
            words = f"expected a free turn of at most 5°, got {move.backlash}; check the unit"
            yield ("moves", name, "backlash"), words


def fits_of_other_distances(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Tolerance fields of centre distances that are taken at another nominal size than the mesh has."""
    for name, spec in scene.of(CentreDistanceSpec).items():
        mesh = scene.moves.get(spec.of)
        nominal = mesh.centre_distance if isinstance(mesh, MeshSpec) else None
        sentence = nominal and another_size(
            spec.distribution.drawn, nominal.internal, f"centre distance of {spec.of!r}"
        )
        if sentence:
            yield ("tolerances", name, "distribution", "of"), sentence


def _displaced(scene: Scene, of: str) -> tuple[str, ...]:
    """The gears of a mesh, on a shaft or at a bearing of it, or the gear itself."""
    if isinstance(move := scene.moves.get(of), GearMeshSpec):
        return move.gears
    part = scene.parts[of]
    return gears_on(part.shaft if isinstance(part, BearingSpec) else of, scene.parts)


def bearings_off_shafts(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Bearings beyond an end of their shaft."""
    for name, bearing in scene.of(BearingSpec).items():
        shaft = scene.parts[bearing.shaft]
        if isinstance(shaft, ShaftSpec) and (sentence := off_shaft(bearing.shaft, shaft, bearing.at.internal)):
            yield ("parts", name, "at"), sentence


def off_shaft(name: str, shaft: ShaftSpec, at: float) -> str:
    """Error text for a place along a shaft [mm] beyond one of its ends; "" if there is none."""
    for field, end, sense in (("start", shaft.start, -1.0), ("end", shaft.end, 1.0)):
        if end is not None and (beyond := sense * (at - end.internal)) > ROUNDING:
            words = f"expected a place on {name!r}, whose {field} is at {end}, got {at:.6g} mm, {beyond:.4g} mm beyond"
            return f"{words}; check the unit, and the shaft's origin"
    return ""


def shafts_thicker_than_hubs(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Shafts that do not go through the bore of a gear on them."""
    for name, shaft in scene.of(ShaftSpec).items():
        for gear in shaft.carries:
            hub = scene.parts[gear]
            bore = hub.bore.internal if isinstance(hub, BoredGearSpec) and hub.bore is not None else None
            if sentence := too_thick(shaft, bore, f"the bore of {gear!r}"):
                yield ("parts", name, "diameter"), sentence


def too_thick(shaft: ShaftSpec, bore: float | None, words: str) -> str:
    """Error text for a shaft thicker than a bore [mm] around it; "" if there is none, or a size is unknown."""
    if bore is None or shaft.diameter is None or shaft.diameter.internal <= bore + ROUNDING:
        return ""
    return f"expected at most {bore:.6g} mm, the diameter of {words}, got {shaft.diameter}; check both, and the units"


HALF: Final = Implausible(0.5)
WHOLE: Final = Implausible(1.0)
WIDEST_FACE: Final = 1000.0  # mm; that of the widest mill gears
NARROWEST_FACE: Final = 0.1  # modules; watch gears have 2
SLENDEREST: Final = 100.0  # diameters from a shaft's origin to its end
STEEPEST_USUAL: Final = math.radians(45.0)  # rad; herringbones of steel mills have that much
WIDEST_ANGLE: Final = math.radians(5.0)  # rad; free turns are minutes, and axes that cross are another mesh
ROUNDING: Final = 1e-9  # mm; the same number in two units
