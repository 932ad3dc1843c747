"""The CAD side of every kind of gear and body, and STEP. Import it through tol3d.cad.solids.lazy.

A kind of gear registers here what its own file does; a BuiltShape of any mechanism has its own builder.
"""

import itertools
import os
from collections.abc import Callable, Sequence
from functools import singledispatch
from pathlib import Path

import cadquery as cq
from OCP.gp import gp_Trsf

from tol3d.cad.solids import bevel_cad, body_cad, named_faces, spur_cad, swept_cad
from tol3d.cad.solids.built_shape import BuiltShape, SweptShape
from tol3d.cad.solids.lazy import Arrays
from tol3d.cad.solids.pick import Pick, PickedFace
from tol3d.cad.solids.posed_gear import ArmBody, Body, PosedPart, ShaftBody
from tol3d.errors import unwritable
from tol3d.gears import BevelGear, Gear, InternalGear, SpurGear
from tol3d.import_path import named
from tol3d.numerics.arrays import Array
from tol3d.parts import arm, bevel_gear, shaft
from tol3d.parts.named_solid import NamedSolid, refuse_cut_step


@singledispatch
def solid_of(shape: Gear | Body | BuiltShape) -> NamedSolid:
    """The solid of a gear or a body, from its builder."""
    raise TypeError(f"cad.py has no builder for {type(shape).__name__}")


@singledispatch
def sample_flanks(gear: Gear, steps: int) -> Arrays:
    """Arrays of FlankStrips, read off the faces "tooth 0 right flank" and "tooth 0 left flank".

    Returns:
        parameter (steps + 1,), inner, outer and normals (2, steps + 1, 3) for RIGHT and LEFT, chord_error,
        flank_error.
    """
    raise TypeError(f"cad.py samples no {type(gear).__name__}")


def sample_faces(shape: BuiltShape, faces: Sequence[str], steps: int) -> Arrays:
    """Arrays of FaceStrips, read off the named faces of a shape that is swept along z.

    Returns:
        parameter (faces, steps + 1), points and normals (faces, steps + 1, 2), chord_error.
    """
    return swept_cad.sample_faces(solid_of(shape), faces, steps)


@singledispatch
def tessellate(shape: Gear | Body | BuiltShape, deflection: float) -> Arrays:
    """Arrays of DisplayMesh, its faces followed within about `deflection` [mm].

    Raises:
        GeometryError: OCC could not triangulate the solid.
    """
    raise TypeError(f"cad.py tessellates no {type(shape).__name__}")


def _builder_of(shape: BuiltShape) -> Callable[[BuiltShape], NamedSolid]:
    found: Callable[[BuiltShape], NamedSolid] = named(shape.builder)
    return found


for gear in (SpurGear, InternalGear):
    solid_of.register(gear, spur_cad.build)
    sample_flanks.register(gear, spur_cad.sample_flanks)
    tessellate.register(gear, spur_cad.tessellate)

solid_of.register(BevelGear, bevel_gear.build)
sample_flanks.register(BevelGear, bevel_cad.sample_flanks)
tessellate.register(BevelGear, bevel_cad.tessellate)

solid_of.register(ShaftBody, lambda body: shaft.shaft(body.diameter, body.start, body.end, body.collars))
solid_of.register(ArmBody, lambda body: arm.arm(body.points, body.diameter))
solid_of.register(BuiltShape, lambda shape: _builder_of(shape)(shape))
for kind in (ShaftBody, ArmBody, BuiltShape):
    tessellate.register(kind, lambda body, deflection: body_cad.tessellate(solid_of(body), deflection))
tessellate.register(
    SweptShape, lambda shape, deflection: swept_cad.tessellate(solid_of(shape), shape.width, deflection)
)


def pick_faces(shape: BuiltShape, picks: Sequence[Pick]) -> Sequence[PickedFace]:
    """See tol3d.cad.solids.pick.picked."""
    return tuple(named_faces.pick_faces(solid_of(shape), picks))


def box_around(shape: BuiltShape) -> tuple[list[float], list[float]]:
    """See tol3d.cad.solids.display_mesh."""
    box = solid_of(shape).solid.BoundingBox()
    return [box.xmin, box.ymin, box.zmin], [box.xmax, box.ymax, box.zmax]


def write_step(parts: Sequence[PosedPart], path: Path, colours: Sequence[str]) -> None:
    """See tol3d.cad.solids.export_step."""
    assembly = cq.Assembly(name=f"assembly: {path.stem}")  # no part is called so: their names hold no colon
    for part, colour in zip(parts, itertools.cycle(colours), strict=False):
        place = _location(part.world_from_part)
        assembly.add(solid_of(part.shape).solid, name=_part21(part.name), loc=place, color=cq.Color(colour))
    unfinished = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        assembly.export(str(unfinished), exportType="STEP")
        refuse_cut_step(unfinished)
        unfinished.replace(path)
    except OSError as error:
        raise unwritable(path, error, "choose another file") from error
    finally:
        unfinished.unlink(missing_ok=True)


def _part21(text: str) -> str:
    """Text in the ASCII escapes of ISO 10303-21, 6.4.3; CadQuery would hand OCC UTF-8 as if it were Latin-1."""
    return "".join(letter if letter.isascii() else _part21_letter(letter) for letter in text)


def _part21_letter(letter: str) -> str:
    if ord(letter) > 0xFFFF:
        return f"\\X4\\{ord(letter):08X}\\X0\\"
    return f"\\X2\\{ord(letter):04X}\\X0\\"


def _location(world_from_part: Array) -> cq.Location:
    transform = gp_Trsf()
    transform.SetValues(*world_from_part[:3].ravel().tolist())
    return cq.Location(transform)
