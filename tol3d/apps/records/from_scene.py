"""Between scenes and rigs: a mesh's nominal numbers, a build, and a scene of the identified pair.

A rig counts each gear in its own sense of rotation; tol3d counts about +z. The driver turns counter-clockwise about +z
where its left flank works (sigma = -1) and clockwise where its right one does (sigma = +1), so its azimuth is
-sigma phi1, with phi1 = 0 at tooth 0 of the driver on the line of centres. With psi the direction of an eccentricity in
its gear's frame, and the driven gear lagging by half the constant part j_c of the backlash on the drive flank,

    theta1 = -sigma psi1
    theta2 = sigma (psi2 + pi + pi/z2) - j_c/2
"""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final, cast

from tol3d.apps.records.pair import RigPair, Specimen
from tol3d.errors import InputError
from tol3d.gearing import Mesh, MeshBuild

if TYPE_CHECKING:
    from tol3d.gears import SpurGear, SpurPair


DIGITS: Final = 15  # of numbers in a written scene
POSITIONS: Final = 72  # a turn of the driver, in a written scene


def mesh_of(meshes: Mapping[str, Mesh], scene: str, name: str | None) -> Mesh:
    """The mesh of that name, or the only one, of two external spur gears.

    Args:
        meshes: those of the scene, by name.
        scene: its name.
        name: of the mesh, if stated.

    Raises:
        InputError: there is none, or several and no name, or other gears.
    """
    spur = {own: mesh for own, mesh in meshes.items() if _is_external(mesh)}
    names = ", ".join(repr(own) for own in spur)
    if not spur:
        raise InputError(f"{scene}: expected a mesh of two external spur gears, got none")
    if name is None and len(spur) > 1:
        raise InputError(f"--mesh: which of {names} was on the rig?")
    if name is not None and name not in spur:
        raise InputError(f"--mesh: expected a mesh of two external spur gears ({names}), got {name!r}")
    return spur[name] if name is not None else next(iter(spur.values()))


def _is_external(mesh: Mesh) -> bool:
    """True of two external spur gears; transmission error of helical ones was not derived here."""
    straight = mesh.pair.pinion.twist == 0.0 and mesh.pair.arm_spread == 0.0
    return straight and mesh.driven_flank == mesh.working_flank


def specimen_of(build: MeshBuild) -> Specimen:
    """The pair of one build, its axes as far apart as there.

    Axes' tilts, temperatures and deviations of single flanks are left out.
    """
    mesh, pair = build.mesh, rig_pair(build.mesh, build.centre_distance)
    spur = _spur(mesh)
    flat = math.tan(pair.working_angle) - pair.working_angle
    backlash = 2 * pair.base_radii * (flat - spur.zero_backlash_involute) - build.thickening
    (x1, y1), (x2, y2) = build.eccentricities
    theta1 = -mesh.working_flank * math.atan2(y1, x1)
    constant = backlash / pair.driven_base_radius
    theta2 = mesh.working_flank * (math.atan2(y2, x2) + math.pi + math.pi / spur.wheel.teeth) - constant / 2
    return Specimen(pair, math.hypot(x1, y1), theta1, math.hypot(x2, y2), theta2, backlash)


def _spur(mesh: Mesh) -> "SpurPair":
    """The pair of a mesh that `mesh_of` found."""
    return cast("SpurPair", mesh.pair)


def rig_pair(mesh: Mesh, centre_distance: float) -> RigPair:
    """A mesh's nominal numbers at a distance of the axes [mm]."""
    pinion, wheel = _spur(mesh).pinion, _spur(mesh).wheel
    return RigPair(pinion.teeth, wheel.teeth, pinion.base_radius, wheel.base_radius, centre_distance)


def scene_text(specimen: Specimen, mesh: Mesh, name: str) -> str:
    """A scene of the specimen with constant deviations, read over its long period.

    Args:
        specimen: the identified one.
        mesh: its gears.
        name: of the scene.
    """
    spur, pair = _spur(mesh), specimen.pair
    sigma, constant = mesh.working_flank, specimen.constant_part
    psi1 = -sigma * specimen.theta1
    psi2 = sigma * (specimen.theta2 + constant / 2) - math.pi - math.pi / spur.wheel.teeth
    flat = math.tan(pair.working_angle) - pair.working_angle
    nominal = 2 * pair.base_radii * (flat - spur.zero_backlash_involute)
    thicker = (nominal - specimen.normal_backlash) / math.cos(spur.wheel.pressure_angle)
    driver, driven, own = (json.dumps(text, ensure_ascii=False) for text in (mesh.driver, mesh.driven, mesh.name))
    lines = [
        f"scene: {json.dumps(name, ensure_ascii=False)}",
        "description: identified from two-sided transmission error; every deviation is a constant; the driver's angle "
        f"about +z is {'-' if sigma == 1 else ''}phi1",
        "",
        "parts:",
        *(f"  {part}: {_gear_text(gear)}" for part, gear in ((driver, spur.pinion), (driven, spur.wheel))),
        "",
        "tolerances:",
        _eccentricity("identified e1", driver, specimen.e1, psi1),
        _eccentricity("identified e2", driven, specimen.e2, psi2),
        f"  identified thickness: {{kind: tooth_thickness, of: {driven}, distribution: {_constant(thicker)}}}",
        "",
        "moves:",
        f"  {own}: {{kind: mesh, driver: {driver}, driven: {driven}, centre_distance: "
        f"{_number(pair.centre_distance)} mm, working_flank: {'right' if sigma == 1 else 'left'}}}",
        "",
        "measures:",
        *_measures(own, driven),
        "",
        "study: {trials: 2, seed: 1, engine: exact}",
        "",
    ]
    return "\n".join(lines)


def _measures(mesh: str, driven: str) -> list[str]:
    own = f"kind: angular_backlash, of: {mesh}, gear: {driven}, over: long_period"
    takes = {"backlash curve": "curve", "least backlash": "min", "largest backlash": "max"}
    lines = [f"  {name}: {{{own}, take: {take}, positions: {POSITIONS}}}" for name, take in takes.items()]
    error = f"kind: transmission_error, of: {mesh}, over: long_period, positions: {POSITIONS}"
    for side in ("drive", "back"):
        lines += [f"  {side} TE curve: {{{error}, flank: {side}, take: curve}}"]
    return lines


def _gear_text(gear: "SpurGear") -> str:
    words = {"kind": "spur_gear", "teeth": str(gear.teeth), "module": f"{_number(gear.module)} mm"}
    words["pressure_angle"] = f"{_number(math.degrees(gear.pressure_angle))} deg"
    words["face_width"] = f"{_number(gear.face_width)} mm"
    words |= {name: _number(getattr(gear, name)) for name in ("profile_shift", "addendum", "dedendum")}
    lengths = {"root_fillet": gear.root_fillet, "bore": gear.bore}
    words |= {name: f"{_number(length)} mm" for name, length in lengths.items() if length}
    return "{" + ", ".join(f"{key}: {value}" for key, value in words.items()) + "}"


def _eccentricity(name: str, gear: str, length: float, direction: float) -> str:
    angle = f"{_number(math.degrees(math.remainder(direction, 2 * math.pi)))} deg"
    return (
        f"  {name}: {{kind: eccentricity, of: {gear}, direction: {{at: {angle}}}, distribution: {_constant(length)}}}"
    )


def _constant(length: float) -> str:
    return f"{{kind: constant, value: {_number(1e3 * length)} um}}"


def _number(value: float) -> str:
    return f"{value:.{DIGITS}g}"
